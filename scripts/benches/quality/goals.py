"""The goals for the figures, each met, MISSED or not measured."""

from dataclasses import dataclass

import numpy as np

from benches.geometric_mean import geometric_mean
from benches.markdown_report import markdown
from benches.quality.tables import largest, percent, share
from benches.quality.variants import NOISY

JUDGED_SPP = 8
# Over noisy's, geometric means over the scenes: (variant, metric, of our scenes, of other renderers' shots).
ERRORS = (("final", "relmse", 1 / 30, 1 / 45), ("final", "temporal", 1 / 60, 1 / 90), ("beauty_alone", "relmse", 1 / 15, 1 / 15))
ENERGY = 0.005  # largest relative error of the mean radiance
STILL = 1.2     # error of still pixels over that of the ideal mean of frames
SEAMS = 1.05    # temporal error between two segments over that inside of one
PRESETS = ("final", "balanced", "draft")


@dataclass
class Goal:
    text: str
    reached: str
    met: bool | None  # None: not measured

    @property
    def verdict(self):
        return "not measured" if self.met is None else "met" if self.met else "MISSED"


def _not_measured(text):
    return Goal(text, "-", None)


def _mean_error(results, name, metric, limit):
    title = {"relmse": "relMSE", "temporal": "temporal error"}[metric]
    text = f"{name}: {title} at {JUDGED_SPP} spp at most {share(limit)} of noisy, geometric mean"
    reached = geometric_mean(list(results.ratios(JUDGED_SPP, name, metric).values()))
    return _not_measured(text) if reached is None else Goal(text, share(reached), reached <= limit)


def _energy(results, name):
    text = f"{name}: energy within {100 * ENERGY:g} % on every scene at every spp"
    off = {f"{scene} at {spp} spp": cell["mean"]["energy"] for (scene, spp, which), cell in results.cells.items() if which == name}
    if not off:
        return _not_measured(text)
    where, worst = largest(off)
    beyond = sum(abs(value) > ENERGY for value in off.values())
    return Goal(text, f"{percent(worst)} in {where}; {beyond} of {len(off)} beyond", beyond == 0)


def _still(results, name):
    text = f"{name}: still pixels within {STILL:g} of the ideal mean's error on every scene at every spp"
    over = {f"{scene} at {spp} spp": cell["over_ideal"] for (scene, spp, which), cell in results.cells.items()
            if which == name and cell.get("over_ideal") is not None}
    if not over:
        return _not_measured(text)
    where, worst = largest(over)
    return Goal(text, f"{worst:.2f} in {where}; {sum(v > STILL for v in over.values())} of {len(over)} beyond", worst <= STILL)


def _never_worse(results, name, metric):
    title = {"relmse": "relMSE", "temporal": "temporal error"}[metric]
    text = f"{name}: {title} never above noisy on any frame"
    ratios = {}
    for (scene, spp, which), cell in results.cells.items():
        noisy = results.cells.get((scene, spp, NOISY.name))
        if which != name or noisy is None:
            continue
        for mine, before in zip(cell["frames"], noisy["frames"]):
            if mine[metric] is not None:
                ratios[f"frame {mine['frame']} of {scene} at {spp} spp"] = mine[metric] / before[metric]
    if not ratios:
        return _not_measured(text)
    where, worst = max(ratios.items(), key=lambda item: item[1])
    return Goal(text, f"{worst:.3f} in {where}; {sum(r > 1.0 for r in ratios.values())} of {len(ratios)} above", worst <= 1.0)


def seam_ratio(segmented):
    """
    Temporal error of pairs of consecutive frames that a seam between two segments separates, over that of the same pairs when the
    input is cut so that they lie in one segment. None if no pair is measured both ways.

    segmented: (frames per segment, figures of the frames) of one input cut in several ways. A pair has a seam if its later frame is
    the first of a segment.
    """
    seams, inside = {}, {}
    for length, frames in segmented:
        for row in frames:
            if row["temporal"] is not None:
                (seams if row["frame"] % length == 0 else inside).setdefault(row["frame"], []).append(row["temporal"])
    both = seams.keys() & inside.keys()
    return sum(np.mean(seams[f]) for f in both) / sum(np.mean(inside[f]) for f in both) if both else None


def _seams(results):
    text = f"temporal error at the seams of segments at most {SEAMS:g} of the inside's"
    cuts = {variant.name: variant.segment for variant in results.variants if variant.segment}
    by_input = {}
    for (scene, spp, name), cell in results.cells.items():
        if name in cuts:
            by_input.setdefault(f"{scene} at {spp} spp", []).append((cuts[name], cell["frames"]))
    ratios = {where: ratio for where, segmented in by_input.items() if (ratio := seam_ratio(segmented)) is not None}
    if not ratios:
        return _not_measured(text)
    where, worst = max(ratios.items(), key=lambda item: item[1])
    mean = np.mean(list(ratios.values()))
    return Goal(text, f"{mean:.3f} over scenes; the worst {worst:.3f} in {where}", bool(mean <= SEAMS))


def goals(results, ours):
    """`ours`: of our own scenes, not another renderer's shots."""
    found = [_mean_error(results, name, metric, here if ours else there) for name, metric, here, there in ERRORS]
    found += [_energy(results, name) for name in PRESETS]
    found += [_still(results, name) for name in PRESETS]
    found += [_never_worse(results, name, metric) for name in PRESETS for metric in ("relmse", "temporal")]
    return [*found, _seams(results)]


def goal_table(found):
    return markdown(("goal", "reached", "verdict"), [(goal.text, goal.reached, goal.verdict) for goal in found])
