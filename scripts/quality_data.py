"""The frames that the variants are measured on, rendered once and kept: FOLDER/SCENE/n4, n8, ..., a, b."""

import re
import subprocess
from pathlib import Path

from align_renders import SCENES

AOVS = ["variance", "albedo", "normal", "depth", "motion", "object_id"]
HALVES = ["half_a", "half_b"]  # of two samples or more
REFERENCES = {"a": 1001, "b": 1002}  # and their seeds; noisy frames have their samples per pixel as the seed


class MissingFrames(Exception):
    pass


class Data:
    def __init__(self, folder, frames, measured, spps, render=None):
        """render(scene_file, pattern, frames, spp, seed, aovs) makes what is not there; None leaves it missing."""
        self.folder, self.frames, self.measured, self.spps, self.render = Path(folder), frames, measured, sorted(spps), render

    def noisy(self, scene, spp):
        """Pattern of the noisy frames. MissingFrames if one is not there."""
        return self._pattern(scene, f"n{spp}", self.frames, spp, spp, AOVS + (HALVES if spp > 1 else []))

    def cleanest(self, scene):
        """Pattern of the noisy frames of most samples that are there."""
        for spp in reversed(self.spps):
            try:
                return self.noisy(scene, spp)
            except MissingFrames:
                continue
        raise MissingFrames(f"{self.folder / scene} has no noisy frames")

    def references(self, scene, spp):
        """Patterns of the two references."""
        return [self._pattern(scene, name, self.measured, spp, seed, []) for name, seed in REFERENCES.items()]

    def _pattern(self, scene, name, frames, spp, seed, aovs):
        pattern = self.folder / scene / name / "f.####.exr"
        if self.render:
            self.render(SCENES / f"{scene}.json", pattern, frames, spp, seed, aovs)
        return require(pattern, frames)


def require(pattern, frames):
    """The pattern. MissingFrames if one of the frames is not there."""
    missing = next((path for path in (frame_path(pattern, frame) for frame in frames) if not path.exists()), None)
    if missing:
        raise MissingFrames(f"{missing} is not there")
    return pattern


def frame_path(pattern, frame):
    """The pattern's name has the frame in place of its last signs #, as many digits at least."""
    pattern = Path(pattern)
    return pattern.with_name(re.sub("#+(?=[^#]*$)", lambda signs: f"{frame:0{len(signs[0])}d}", pattern.name))


def frame_range(frames):
    return f"{frames[0]}-{frames[-1]}"


def renderer(becalm, size):
    def render(scene_file, pattern, frames, spp, seed, aovs):
        print(f"render {scene_file.stem}, {spp} spp, frames {frame_range(frames)}", flush=True)
        subprocess.run([becalm, "render", scene_file, "-o", pattern, "--frames", frame_range(frames), "--size", size, "--spp", str(spp),
                        "--seed", str(seed), "--float", "--quiet", "--resume", *(["--aovs", ",".join(aovs)] if aovs else [])], check=True)
    return render
