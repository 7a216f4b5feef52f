"""Shots of other renderers: FOLDER/SHOT/n8, a, b, or one folder with n8, a, b. Names and numbers of their files are free."""

import re
from pathlib import Path

from benches.quality.data import REFERENCES, Data, require

RENDERER = "scripts/benches/quality/cycles/render.py"
KNOWN = {"cycles": Path("build/quality/cycles")}  # rendered by RENDERER


def numbers(pattern):
    """The frame numbers of the files that match a pattern."""
    stem = re.compile(re.sub("#+", r"(\\d+)", re.escape(pattern.name).replace(r"\#", "#")))
    return {int(found[1]) for path in pattern.parent.iterdir() if (found := stem.fullmatch(path.name))}


def pattern_in(folder):
    """The pattern of the folder's only sequence of EXR files."""
    found = [match for path in sorted(folder.glob("*.exr")) if (match := re.fullmatch(r"(.*?)(\d+)\.exr", path.name))]
    names = {match[1] for match in found}
    if len(names) != 1:
        raise OSError(f"{folder}: expected one sequence of numbered EXR files, found {len(names)}")
    return folder / f"{names.pop()}{'#' * min(len(match[2]) for match in found)}.exr"


def _sampled(folder):
    """The folders of noisy frames by samples per pixel."""
    return {int(path.name[1:]): path for path in folder.iterdir() if path.is_dir() and re.fullmatch(r"n\d+", path.name)} if folder.is_dir() else {}


def _span(frames):
    return list(range(min(frames), max(frames) + 1))


class Shots(Data):
    """A set of shots by name or folder. Frames, measured frames and sample counts are those of all its shots together, unless given."""

    def __init__(self, what, frames=None, measured=None, spps=None):
        folder = KNOWN.get(what, Path(what))
        single = bool(_sampled(folder))
        self.roots = {path.name: path for path in ([folder] if single else sorted(folder.glob("*"))) if _sampled(path)}
        if not self.roots:
            made = f": {RENDERER} renders them" if what == "cycles" else ""
            raise OSError(f"--shots {what}: no folder n8 or the like in {folder} or in a folder there{made}")
        noisy = [folder for root in self.roots.values() for folder in _sampled(root).values() if any(folder.glob("*.exr"))]
        clean = [root / name for root in self.roots.values() for name in REFERENCES if any((root / name).glob("*.exr"))]
        if not noisy or not clean:
            raise OSError(f"--shots {what}: no noisy frames or no references in {folder}")
        frames = frames or _span(set.union(*(numbers(pattern_in(folder)) for folder in noisy)))
        measured = measured or _span(set.union(*(numbers(pattern_in(folder)) for folder in clean)) & set(frames))
        spps = spps or {spp for root in self.roots.values() for spp in _sampled(root)}
        super().__init__(folder, frames, measured, spps)

    def _pattern(self, scene, name, frames, spp, seed, aovs):
        folder = self.roots[scene] / name
        return require(pattern_in(folder) if any(folder.glob("*.exr")) else folder / "f.####.exr", frames)
