"""What adaptive sampling gains: `becalm render --adaptive --denoise=final` beside uniform sampling. `scripts/bench front --adaptive` calls it."""

import json
import math
import subprocess
from pathlib import Path

import numpy as np

from benches.front import page
from benches.front.points import METRICS, positive_errors
from benches.geometric_mean import geometric_mean
from benches.markdown_report import figure, markdown
from benches.quality.data import SCENES, frame_range
from benches.timed import timed

SPP = 8
UNIFORM = (SPP // 2, SPP, 2 * SPP)  # the curve that adaptive sampling is compared with
TARGETS = (0.3, 0.2)  # of --noise-target
MOST = 256            # samples with a target


class Runs:
    """Renders with the filter, and measures error and processor seconds of a frame."""

    def __init__(self, becalm, data, size, output, reference_spp):
        self.becalm, self.data, self.size, self.output, self.reference_spp = becalm, data, size, Path(output) / "adaptive", reference_spp

    def measure(self, scene, spp, *options):
        self.output.mkdir(parents=True, exist_ok=True)
        pattern, figures = self.output / "f.####.exr", self.output / "figures.json"
        _, cost = timed([self.becalm, "render", SCENES / f"{scene}.json", "-o", pattern, "--frames", frame_range(self.data.frames), "--context", "none",
                         "--size", self.size, "--spp", spp, "--seed", spp, "--denoise=final", "--type=float", "--quiet", "--overwrite", *options])
        first, second = self.data.references(scene, self.reference_spp)
        subprocess.run([self.becalm, "compare", first, pattern, "--reference-b", second, "--frames", frame_range(self.data.measured),
                        "--json", figures], check=True, stdout=subprocess.DEVNULL)
        return {"seconds": cost.processor_s / len(self.data.frames)} | positive_errors(json.loads(figures.read_text())["mean"])


def at_time(curve, seconds, metric):
    """The error of uniform sampling in so many seconds a frame, by the points of `curve`: linear in logarithms. None if a point has none."""
    if any(point[metric] is None for point in curve):
        return None
    times, errors = zip(*sorted((math.log(point["seconds"]), math.log(point[metric])) for point in curve))
    low = int(np.clip(np.searchsorted(times, math.log(seconds)) - 1, 0, len(times) - 2))
    slope = (errors[low + 1] - errors[low]) / (times[low + 1] - times[low])
    return math.exp(errors[low] + slope * (math.log(seconds) - times[low]))


def ratio(error, other):
    return None if None in (error, other) else error / other


def table(found):
    """found: (scene, uniform points by samples, the adaptive point) of each scene."""
    rows = []
    for scene, uniform, adaptive in found:
        rows.append([scene, f"{uniform[SPP]['seconds']:.3g}", f"{adaptive['seconds']:.3g}"] + [
            ratio(adaptive[metric], other) for metric in METRICS
            for other in (uniform[SPP][metric], at_time(uniform.values(), adaptive["seconds"], metric))])
    mean = ["geometric mean", "", ""] + [geometric_mean(column) for column in list(zip(*rows))[3:]]
    text = [[cell if isinstance(cell, str) else figure(cell, 3) for cell in row] for row in (*rows, mean)]
    return markdown(("scene", "uniform, s a frame", "adaptive, s a frame", "relMSE, equal samples", "equal time", "temporal error, equal samples",
                     "equal time"), text)


def target_table(found):
    """found: (scene, points by target) of each scene."""
    def cell(point):
        return f"{figure(point['relmse'] and math.sqrt(point['relmse']), 3)} in {point['seconds']:.3g} s"

    rows = [[scene, *map(cell, points.values())] for scene, points in found]
    return markdown(("root of relMSE, and time of a frame", *(f"--noise-target {target}" for target in TARGETS)), rows)


def write(runs, scenes, output):
    found, of_targets = [], []
    for scene in scenes:
        of_targets.append((scene, {target: runs.measure(scene, MOST, "--noise-target", target) for target in TARGETS}))
        uniform = {spp: runs.measure(scene, spp) for spp in UNIFORM}
        adaptive = runs.measure(scene, SPP, "--adaptive")
        print(f"{scene:>10}  {uniform}  adaptive {adaptive}  targets {of_targets[-1][1]}", flush=True)
        found.append((scene, uniform, adaptive))
    text = f"""`becalm render --adaptive --denoise=final` of {SPP} samples on average, over uniform sampling:
errors as shares of those of {SPP} samples each, and of as many as take the same processor time
(interpolated between {', '.join(map(str, UNIFORM))}). Pilots are included in the time.

{table(found)}
`--noise-target`, at most {MOST} samples:

{target_table(of_targets)}"""
    page.write_adaptive(output, text, {"adaptive": found, "targets": of_targets})
