"""Antialiasing and upsampling: a fence whose shadows move, of one jittered sample a pixel."""

import numpy as np

from benches.antialias.run import ssim
from benches.antialias.shots import CYCLE, read, render
from benches.frame_errors import rel_mse, temporal_error
from demo_parts.use_runs import Use, displayed, enlarged

SCENE = "fence"
SIZE = (480, 270)
RENDERED = range(1, 13)
SHOWN = range(5, 9)
REFERENCE_SPP = 64
SCALE = 2


def frames_of(folder):
    return [read(folder, frame) for frame in SHOWN]


def antialiased(runs, source, target, *options):
    runs.run("antialias", source / "f.####.exr", "-o", target / "f.####.exr", *options)
    return frames_of(target)


def table(pictures, reference):
    rows = [["", "relMSE", "temporal error", "SSIM"]]
    for name, images in pictures.items():
        if images is not reference:
            likeness = np.mean([ssim(truth, image) for truth, image in zip(reference, images)])
            rows.append([name, *(f"{error(reference, reference, images):.4f}" for error in (rel_mse, temporal_error)), f"{likeness:.3f}"])
    return rows


def reference_of(runs):
    """Rendered once, for both uses."""
    folder = runs.folder.parent / "reference"
    render(runs.becalm, SCENE, folder, SHOWN, SIZE, REFERENCE_SPP, 0)
    return frames_of(folder)


MEASURED = f"Mean of {len(SHOWN)} frames against {REFERENCE_SPP} samples a pixel"


def antialias(runs):
    truth = reference_of(runs)
    jittered, clamped, best = (runs.folder / name for name in ("jittered", "clamping", "best"))
    render(runs.becalm, SCENE, jittered, RENDERED, SIZE, 1, CYCLE)
    pictures = {"one sample": frames_of(jittered), "clamping": antialiased(runs, jittered, clamped, "--preset", "clamping"),
                "antialias": antialiased(runs, jittered, best), "reference": truth}
    return Use(
        "antialias", "Temporal antialiasing",
        f"One sample a pixel, at a place within it that changes from frame to frame: edges are jagged, and thin things flicker. becalm antialias "
        f"averages each frame with those before and after it, and finds where they lie even under the shadows, which motion vectors do not tell. "
        f"Clamping is the usual method of games. (scenes/{SCENE}.json with a hard sun and ambient light.)",
        list(SHOWN), {name: displayed(frames, truth) for name, frames in pictures.items()}, "one sample", "antialias", MEASURED,
        table(pictures, truth), runs.shown)


def upsample(runs):
    truth = reference_of(runs)
    half, scaled, board, whole = (runs.folder / name for name in ("half", "scaled", "checkerboard", "whole"))
    # 16 positions a pixel of the result (filter/antialias/README.md).
    render(runs.becalm, SCENE, half, RENDERED, tuple(side // SCALE for side in SIZE), 1, CYCLE * SCALE**2)
    render(runs.becalm, SCENE, board, RENDERED, SIZE, 1, CYCLE, ["--checkerboard"])
    pictures = {"half size": [enlarged(frame, SIZE) for frame in frames_of(half)], "scaled": antialiased(runs, half, scaled, "--scale", SCALE),
                "every other pixel": frames_of(board), "checkerboard": antialiased(runs, board, whole, "--checkerboard"), "reference": truth}
    return Use(
        "upsample", "Upsampling and checkerboards",
        "A quarter of the pixels, or every other one, rendered with one jittered sample each: over time the samples lie between each other's, and "
        "becalm antialias makes full frames of them.",
        list(SHOWN), {name: displayed(frames, truth) for name, frames in pictures.items()}, "half size", "scaled", MEASURED,
        table(pictures, truth), runs.shown)
