"""Temporal upsampling and checkerboards beside full size, at equal time: relMSE and temporal error against processor seconds a frame, tracer
and filter together. Called by `scripts/bench antialias --upsample`."""

import sys
from collections import defaultdict

from benches.antialias.shots import read, render
from benches.frame_errors import rel_mse, temporal_error
from benches.markdown_report import markdown
from benches.timed import timed

# Glints of `crossing`, brighter than all else, decided its rows; a sample of `meadow` costs more than the filter, as those of others do not.
SCENES = ("fence", "classroom", "blocks", "meadow")
SAMPLES = (1, 2, 4)
# The mean of samples of several places tells less than one of them (shaders/antialias/README.md), and without noise those of one place are one.
SCALED_SAMPLES = (1,)
REFERENCE_SPP = 128
# name: size over the output's, jitter cycle (16 positions a pixel of the output), samples, options of render and of antialias
MODES = {
    "full size": (1, 16, SAMPLES, [], []),
    "checkerboard": (1, 16, SAMPLES, ["--checkerboard"], ["--checkerboard"]),
    "1.5x": (2 / 3, 36, SCALED_SAMPLES, [], ["--scale", "3/2"]),
    "2x": (1 / 2, 64, SCALED_SAMPLES, [], ["--scale", "2"]),
}


def per_frame(command, frames, *one):
    """Processor seconds of a frame: those of all frames less those of the first, so that starting up is not counted. The first,
    which lacks its context, is made before all, so that those of the whole run stay."""
    def spent(options):
        return timed([*command, *options, "--overwrite", "--quiet"])[1].processor_s

    first_s = spent(["--frames", "1", *one])
    return (spent(["--frames", f"1-{frames}"]) - first_s) / (frames - 1)


def measure(becalm, root, size, frames):
    """Yields (scene, mode, samples, seconds of render, seconds of antialias, relMSE, temporal error)."""
    numbers = range(1, frames + 1)
    for scene in SCENES:
        folder = root / scene
        render(becalm, scene, folder / "reference", numbers, size, REFERENCE_SPP, 0)
        reference = [read(folder / "reference", frame) for frame in numbers]
        for mode, (share, cycle, samples, of_render, of_filter) in MODES.items():
            for spp in samples:
                source = folder / f"{mode.replace(' ', '_')}.{spp}"
                small = tuple(round(share * side) for side in size)
                render(becalm, scene, source, numbers, small, spp, cycle, of_render)
                render_s = per_frame([becalm, "render", source / "scene.json", "-o", source / "timed.####.exr", "--spp", str(spp), "--aov-spp", str(spp),
                                      "--type=float", "--aovs", "albedo,depth,motion", *of_render], frames)
                result = source / "result"
                filter_s = per_frame([becalm, "antialias", source / "f.####.exr", "-o", result / "f.####.exr", *of_filter], frames, "--context", "none")
                test = [read(result, frame) for frame in numbers]
                yield scene, mode, spp, render_s, filter_s, rel_mse(reference, reference, test), temporal_error(reference, reference, test)


def within(measured, budget_s):
    """The least error of those that take so many seconds at most, with 5 % for the clock, and the temporal error beside it, as cells."""
    affordable = [(error, change) for render_s, filter_s, error, change in measured if render_s + filter_s <= 1.05 * budget_s]
    return [f"{figure:.5f}" for figure in min(affordable)] if affordable else ["-", "-"]


def equal_time(measured):
    """Rows by scene and number of samples at full size: the error of each mode within the time that those take. `measured`: by scene and mode, lists of
    (seconds of render, seconds of filter, relMSE, temporal error)."""
    rows = []
    for scene in SCENES:
        for spp, (render_s, filter_s, _, _) in zip(SAMPLES, measured[scene, "full size"]):
            budget_s = render_s + filter_s
            cells = [within(measured[scene, mode], budget_s) for mode in MODES]
            rows.append([scene, spp, f"{budget_s:.3f}", *(error for error, _ in cells), *(change for _, change in cells)])
    return rows


def curves(becalm, root, size, frames):
    """Two tables: one row a scene, mode and number of samples; and what equal time gives."""
    rows, measured = [], defaultdict(list)
    for scene, mode, spp, render_s, filter_s, error, change in measure(becalm, root, size, frames):
        rows.append([scene, mode, spp, f"{render_s:.3f}", f"{filter_s:.3f}", f"{error:.5f}", f"{change:.5f}"])
        measured[scene, mode].append((render_s, filter_s, error, change))
        print(*rows[-1], file=sys.stderr, flush=True)
    header = ["scene", "spp", "s", *MODES, *(f"temporal, {mode}" for mode in MODES)]
    return (markdown(["scene", "mode", "spp", "render, s", "filter, s", "relMSE", "temporal error"], rows)
            + "\nThe least relMSE of each mode, and its temporal error, within the time of full size with so many samples:\n\n" + markdown(header, equal_time(measured)))
