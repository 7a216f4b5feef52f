"""The noise of pairs of references, and what of an error is below it."""

import json
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.frame_errors import FLOOR
from benches.geometric_mean import geometric_mean
from benches.markdown_report import wrapped
from benches.quality.data import REFERENCES, frame_path
from benches.quality.tables import share
from benches.quality.variants import NOISY

RESOLVED = 0.1  # relative variance of a reference from which on errors of 1 % and less are not told by two


def relative_variance(a, b):
    """That of each of two images, in units of the squared radiance of a pixel plus FLOOR."""
    return float(np.mean((a - b) ** 2 / 2 / ((0.5 * (a + b)) ** 2 + FLOOR)))


def of_scene(folder, frames):
    """The mean over the frames of a folder that has both references."""
    read = lambda name, frame: oiio.ImageBuf(str(frame_path(folder / name / "f.####.exr", frame))).get_pixels(oiio.FLOAT)[..., :3].astype(float)
    return float(np.mean([relative_variance(*(read(name, frame) for name in REFERENCES)) for frame in frames]))


def note(data, output, variants):
    """A paragraph: each scene's noise and, if that of some is too high, the geometric means of the variants without these. `output`: of a
    run of quality at one sample count, which measured all scenes on the same frames."""
    cells = [json.loads(path.read_text()) for path in sorted((Path(output) / "cells").glob("*.json"))]
    scenes = list(dict.fromkeys(cell["scene"] for cell in cells))
    noise = {scene: of_scene(Path(data) / scene, cells[0]["recipe"]["measured"]) for scene in scenes}
    text = ("Relative variance s^2 of each reference: " + ", ".join(f"`{scene}` {value:.2g}" for scene, value in noise.items()) +
            ". The references' noise is in the denominators too: it adds about 1.5 s^4 to a relMSE and takes about 0.5 s^4 from a temporal error.")
    kept = [scene for scene in scenes if noise[scene] < RESOLVED]
    if kept and kept != scenes:
        figures = {(cell["scene"], cell["variant"]): cell["mean"] for cell in cells}
        of_noisy = lambda variant, metric: share(geometric_mean([figures[scene, variant][metric] / figures[scene, NOISY.name][metric] for scene in kept]))
        left_out = " and ".join(f"`{scene}`" for scene in scenes if scene not in kept)
        text += f" Errors of {left_out} are not resolved by such references; without, the geometric means are " + "; ".join(
            f"`{variant}` {of_noisy(variant, 'relmse')} and {of_noisy(variant, 'temporal')}" for variant in variants) + "."
    return wrapped(text).strip()
