"""Temporal upsampling and checkerboards beside full size, at equal time: relMSE and temporal error against processor seconds a frame, tracer
and filter together. Called by `scripts/bench antialias --upsample`."""

import sys

import numpy as np

from benches.antialias.shots import read, render
from benches.markdown_report import markdown
from benches.timed import timed

SCENES = ("fence", "classroom", "blocks", "crossing")
SAMPLES = (1, 2)
REFERENCE_SPP = 128
# name: size over the output's, jitter cycle (16 positions a pixel of the output), options of render and of antialias
MODES = {
    "full size": (1, 16, [], []),
    "checkerboard": (1, 16, ["--checkerboard"], ["--checkerboard"]),
    "1.5x": (2 / 3, 36, [], ["--scale", "3/2"]),
    "2x": (1 / 2, 64, [], ["--scale", "2"]),
}


def rel_mse(reference, test):
    return float(np.mean([np.mean((r - t) ** 2 / (r**2 + 0.01)) for r, t in zip(reference, test)]))


def temporal_error(reference, test):
    """relMSE of the differences between frames."""
    pairs = zip(reference, reference[1:], test, test[1:])
    return float(np.mean([np.mean(((r1 - r0) - (t1 - t0)) ** 2 / (r1**2 + 0.01)) for r0, r1, t0, t1 in pairs]))


def per_frame(command, frames, *one):
    """Processor seconds of a frame: those of all frames less those of the first, so that starting up is not counted."""
    def spent(options):
        return timed([*command, *options, "--overwrite", "--quiet"])[1].processor_s

    return (spent(["--frames", f"1-{frames}"]) - spent(["--frames", "1", *one])) / (frames - 1)


def measure(becalm, root, size, frames):
    """Yields (scene, mode, samples, seconds of render, seconds of antialias, relMSE, temporal error)."""
    numbers = range(1, frames + 1)
    for scene in SCENES:
        folder = root / scene
        render(becalm, scene, folder / "reference", numbers, size, REFERENCE_SPP, 0)
        reference = [read(folder / "reference", frame) for frame in numbers]
        for mode, (share, cycle, of_render, of_filter) in MODES.items():
            for spp in SAMPLES:
                source = folder / f"{mode.replace(' ', '_')}.{spp}"
                small = tuple(round(share * side) for side in size)
                render(becalm, scene, source, numbers, small, spp, cycle, of_render)
                render_s = per_frame([becalm, "render", source / "scene.json", "-o", source / "timed.####.exr", "--spp", str(spp), "--aov-spp", str(spp),
                                      "--float", "--aovs", "albedo,normal,depth,motion,object_id", *of_render], frames)
                result = source / "result"
                filter_s = per_frame([becalm, "antialias", source / "f.####.exr", "-o", result / "f.####.exr", *of_filter], frames, "--context", "none")
                test = [read(result, frame) for frame in numbers]
                yield scene, mode, spp, render_s, filter_s, rel_mse(reference, test), temporal_error(reference, test)


def curves(becalm, root, size, frames):
    """The table, one row a scene, mode and number of samples."""
    rows = []
    for scene, mode, spp, render_s, filter_s, error, change in measure(becalm, root, size, frames):
        rows.append([scene, mode, spp, f"{render_s:.3f}", f"{filter_s:.3f}", f"{error:.5f}", f"{change:.5f}"])
        print(*rows[-1], file=sys.stderr, flush=True)
    return markdown(["scene", "mode", "spp", "render, s", "filter, s", "relMSE", "temporal error"], rows)
