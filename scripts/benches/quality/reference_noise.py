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

ADDED = {"relmse": 1.5, "temporal": -0.5}  # to an error, in units of the squared relative variance: frame/metrics.h
MOST_ADDED = 0.1  # of an error that is resolved


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
    text = ("Relative variance s^2 of each reference, at the least: " + ", ".join(f"`{scene}` {value:.2g}" for scene, value in noise.items()) +
            ". Their noise is in the denominators too: it adds about 1.5 s^4 to a relMSE and takes about 0.5 s^4 from a temporal error.")
    figures = {(cell["scene"], cell["variant"]): cell["mean"] for cell in cells}
    is_resolved = lambda scene: all(abs(added) * noise[scene] ** 2 <= MOST_ADDED * figures[scene, variant][metric]
                                    for variant in variants for metric, added in ADDED.items())
    kept = [scene for scene in scenes if is_resolved(scene)]
    if kept and kept != scenes:
        of_noisy = lambda variant, metric: share(geometric_mean([figures[scene, variant][metric] / figures[scene, NOISY.name][metric] for scene in kept]))
        left_out = " and ".join(f"`{scene}`" for scene in scenes if scene not in kept)
        text += f" Of {left_out} that is more than a tenth of an error below; without, the geometric means are " + "; ".join(
            f"`{variant}` {of_noisy(variant, 'relmse')} and {of_noisy(variant, 'temporal')}" for variant in variants) + "."
    return wrapped(text).strip()
