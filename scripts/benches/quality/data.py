"""The frames that the variants are measured on: noisy ones in FOLDER/SCENE/nSPP, references in FOLDER/SCENE/a and b."""

import functools
import hashlib
import re
import subprocess
import tempfile
import time
from pathlib import Path

import OpenImageIO as oiio

from benches.made_of import content_hash, keep_if_recipe
from benches.quality import render_time
from benches.timed import timed

SCENES = Path(__file__).resolve().parents[3] / "scenes"
AOVS = ["variance", "albedo", "normal", "depth", "motion", "object_id"]
HALVES = ["half_a", "half_b"]  # exist from 2 spp on
TRACED = ["--reproducible", "--frames", "8", "--size", "192x108", "--spp", "4", "--seed", "1", "--aovs", ",".join(AOVS + HALVES)]  # tells tracers apart
REFERENCES = {"a": 1001, "b": 1002}  # folders and seeds; the seed of noisy frames is their number of samples per pixel


class MissingFrames(Exception):
    pass


def noisy_aovs(spp):
    return AOVS + (HALVES if spp > 1 else [])


class Data:
    def __init__(self, folder, frames, measured, spps, render=None):
        """render: a Renderer, which makes frames that do not exist; None: they are missing."""
        self.folder, self.frames, self.measured, self.spps, self.render = Path(folder), frames, measured, sorted(spps), render
        self._rendered = set()  # patterns

    def noisy(self, scene, spp):
        """The pattern of the noisy frames. Raises MissingFrames if one does not exist."""
        return self._pattern(scene, f"n{spp}", self.frames, spp, spp, noisy_aovs(spp))

    def cleanest(self, scene):
        """The pattern of the noisy frames with the largest sample count that exists."""
        for spp in reversed(self.spps):
            try:
                return self.noisy(scene, spp)
            except MissingFrames:
                continue
        raise MissingFrames(f"{self.folder / scene} has no noisy frames")

    def references(self, scene, spp):
        """The patterns of the two references."""
        return [self._pattern(scene, name, self.measured, spp, seed, []) for name, seed in REFERENCES.items()]

    def _pattern(self, scene, name, frames, spp, seed, aovs):
        pattern = self.folder / scene / name / "f.####.exr"
        if self.render and pattern not in self._rendered:
            self.render(SCENES / f"{scene}.json", pattern, frames, spp, seed, aovs)
            self._rendered.add(pattern)
        return require(pattern, frames)


def require(pattern, frames):
    """Returns the pattern. Raises MissingFrames if one of its frames does not exist."""
    missing = next((path for path in (frame_path(pattern, frame) for frame in frames) if not path.exists()), None)
    if missing:
        raise MissingFrames(f"{missing} is not there")
    return pattern


def frame_path(pattern, frame):
    """The pattern with its last run of # replaced by the frame, padded to its length with zeros."""
    pattern = Path(pattern)
    return pattern.with_name(re.sub("#+(?=[^#]*$)", lambda signs: f"{frame:0{len(signs[0])}d}", pattern.name))


def frame_range(frames):
    return f"{frames[0]}-{frames[-1]}"


class Renderer:
    """Renders frames of our scenes, and notes what they cost."""

    def __init__(self, becalm, size):
        self.becalm, self.size, self.made_by = becalm, size, content_hash(becalm)

    def __call__(self, scene_file, pattern, frames, spp, seed, aovs):
        """Renders the frames that do not exist or that another tracer rendered, or of another scene. Those of other options are refused by `--resume`."""
        print(f"render {scene_file.stem}, {spp} spp, frames {frame_range(frames)}", flush=True)
        keep_if_recipe(pattern.parent, {"tracer": self._tracer(scene_file), "scene": scene_file.read_text(), "aovs": aovs})
        started = time.time()
        cost = self._render(scene_file, pattern, frames, spp, seed, aovs)
        rendered = sum(frame_path(pattern, frame).stat().st_mtime >= started for frame in frames)
        if rendered:
            render_time.note(pattern.parent, rendered, cost.wall_s, cost.processor_s, self.made_by)

    def note_time(self, scene_file, pattern, frames, spp, seed, aovs):
        """Notes what frames cost of which this program has noted none, by rendering these again."""
        with tempfile.TemporaryDirectory() as folder:
            cost = self._render(scene_file, Path(folder) / "f.####.exr", frames, spp, seed, aovs)
        render_time.note(pattern.parent, len(frames), cost.wall_s, cost.processor_s, self.made_by)

    @functools.cache
    def _tracer(self, scene_file):
        """The hash of a small frame's pixels. That of the program changes with its filter, and references take hours."""
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([self.becalm, "render", scene_file, "-o", f"{folder}/f.exr", *TRACED, "--type=float", "--quiet"], check=True)
            frame = oiio.ImageBuf(f"{folder}/f.exr")
            if frame.has_error:
                raise OSError(f"{scene_file.stem}: {frame.geterror()}")
            return hashlib.sha256(str(frame.spec().channelnames).encode() + frame.get_pixels(oiio.FLOAT).tobytes()).hexdigest()[:16]

    def _render(self, scene_file, pattern, frames, spp, seed, aovs):
        _, cost = timed([self.becalm, "render", scene_file, "-o", pattern, "--frames", frame_range(frames), "--size", self.size,
                         "--spp", spp, "--seed", seed, "--type=float", "--quiet", "--resume", *(["--aovs", ",".join(aovs)] if aovs else [])])
        return cost
