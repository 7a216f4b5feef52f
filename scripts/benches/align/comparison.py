"""Accuracy of our offsets and of optical flow's on the same noisy pairs (numbers for figures 13 and 14 of Hanika et al. 2021)."""

import numpy as np

from benches.align.measure import measure, reference_floor
from benches.align.peers import PEERS, eight_bit_pair, timed
from benches.align.pictures import DIFFERENCE_GAIN, difference, halved
from benches.align.warp import warp
from benches.geometric_mean import geometric_mean
from benches.markdown_report import figure, markdown
from pictures.colours import display_like, map_colours, offset_colours
from pictures.files import write_picture
from pictures.panel import panel

OURS = "ours"
# By name: settings that change the default preset, and whether the albedo and normal layers are matched too.
FINAL = ["match_downsample=1"]
VARIANTS = {
    OURS: (FINAL, True),
    "ours, radiance": (FINAL, False),
    "ours, balanced": ([], True),
    "ours, draft": (["match_downsample=4"], True),
}
PRESET = "balanced"  # the default
CORRELATION_GOAL = 0.02


def _zero(pair):
    return np.zeros((*pair.clean_target.shape[:2], 2), np.float32)


def compare(aligners, pair, variants, peers):
    """A row for each method, and the offsets by method."""
    grey = eight_bit_pair(pair)
    rows, offsets = [], {}

    def add(method, offset, milliseconds=None):
        offsets[method] = offset
        rows.append({"pair": pair.name, "noise": pair.noise, "method": method, "ms": milliseconds} | measure(pair, offset))

    built = []
    for name, (settings, with_guides) in variants.items():
        aligner = aligners.get(pair.size, settings, aovs=pair.aovs if with_guides else [], preset=PRESET)
        same = (aligner.built["settings"], aligner.aovs)
        if same in built:
            continue  # equal to an earlier variant, for example because the pair has no guides
        built.append(same)
        aligner.load(pair.target, pair.source)
        report = aligner.run()
        add(name, aligner.result()[0], report["device_ms"])
    for name in peers:
        add(name, *timed(name, *grey))
    add("no motion", _zero(pair))
    if pair.motion is not None:
        add("motion vectors", pair.motion)
    for row in rows:
        row["floor"] = reference_floor(pair)
    return rows, offsets


def write_panel(path, pair, offsets):
    """A panel: the frames, and for each method the warped clean source, its difference from the clean target, and the offsets."""
    like = pair.clean_target
    long_px = [np.percentile(np.hypot(*np.moveaxis(offset, -1, 0)), 95) for offset in offsets.values()]
    scale_px = max(1.0, float(np.median(long_px)))
    rows = [[("noisy target", display_like(pair.target["beauty"], like)), ("clean source", display_like(pair.clean_source, like)),
             (f"disoccluded; offsets' full colour is {scale_px:.0f} px", map_colours(~pair.visible * 1.0))]]
    for method, offset in offsets.items():
        warped = warp(pair.clean_source, offset)
        rows.append([(method, display_like(warped, like)),
                     (f"difference x{DIFFERENCE_GAIN:g}", difference(warped, pair.clean_target, like)),
                     ("offsets", offset_colours(offset, scale_px))])
    write_picture(path, panel([[(text, halved(picture)) for text, picture in row] for row in rows]))


COMPARED = {"clean": "clean diff.", "clean_visible": "not disoccluded", "rms": "RMS", "rms_visible": "RMS, not disoccluded"}


def verdicts(rows):
    """One entry for each pair and noise: in each measure ours over the best peer's, and the values that have goals."""
    result = []
    for key in dict.fromkeys((row["pair"], row["noise"]) for row in rows):
        of_pair = {row["method"]: row for row in rows if (row["pair"], row["noise"]) == key}
        ours, peers = of_pair[OURS], [row for name, row in of_pair.items() if name in PEERS]
        verdict = {"pair": key[0], "noise": key[1], "against": {}}
        for measured in COMPARED:
            best = min(peers, key=lambda row: row[measured])
            verdict["against"][measured] = {"peer": best["method"], "ratio": ours[measured] / best[measured]}
        result.append(verdict | {name: ours[name] for name in ("correlation", "average", "average_visible", "floor")})
    return result


def row_table(rows):
    cells = [(row["pair"], row["noise"], row["method"], *(figure(row[measured], 5) for measured in COMPARED), figure(row["correlation"]),
              figure(row["average"], 3), figure(row["average_visible"], 3), figure(row["epe"], 3), figure(row["ms"], 1)) for row in rows]
    return markdown(("pair", "noise", "method", *COMPARED.values(), "noise corr.", "50/50", "not disoccluded", "EPE px", "ms"), cells)


def verdict_table(found):
    def against(best):
        return f"{best['ratio']:.3f} of {best['peer']}" + ("" if best["ratio"] < 1.0 else " MISSED")

    cells = [(row["pair"], row["noise"], *(against(row["against"][measured]) for measured in COMPARED),
              f"{row['correlation']:+.4f}" + ("" if abs(row["correlation"]) < CORRELATION_GOAL else " MISSED"),
              f"{row['average']:.3f}" + ("" if row["average"] < 1.0 else " MISSED"), figure(row["floor"])) for row in found]
    return markdown(("pair", "noise", *(f"{title} against the best peer" for title in COMPARED.values()),
                     f"noise corr. (goal {CORRELATION_GOAL})", "50/50 (goal below 1)", "clean diff. by noise alone"), cells)


def overview_table(rows, measured):
    """The measure over the best peer's of the same pair and noise, as geometric means by pair and by noise."""
    def of(row):
        return row["pair"], row["noise"]

    best = {}
    for row in rows:
        if row["method"] in PEERS:
            best[of(row)] = min(row[measured], best.get(of(row), np.inf))
    groups = list(dict.fromkeys([row["pair"] for row in rows] + [row["noise"] for row in rows]))
    cells = []
    for method in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == method]
        ratios = {of(row): row[measured] / best[of(row)] for row in mine}
        by_group = [[ratio for key, ratio in ratios.items() if group in key] for group in groups]
        cells.append((method, *(figure(geometric_mean(r), 3) for r in by_group),
                      figure(geometric_mean(list(ratios.values())), 3), figure(max(abs(row["correlation"]) for row in mine), 3),
                      figure(max(row["average"] for row in mine), 3)))
    return markdown((f"{COMPARED[measured]} over the best peer's", *groups, "all", "largest noise corr.", "worst 50/50"), cells)


def goal_line(found):
    counts = {f"ours has the lowest {title}": sum(row["against"][measured]["ratio"] < 1.0 for row in found)
              for measured, title in COMPARED.items()}
    counts[f"noise correlation below {CORRELATION_GOAL}"] = sum(abs(row["correlation"]) < CORRELATION_GOAL for row in found)
    counts["50/50 average better than the frame"] = sum(row["average"] < 1.0 for row in found)
    return "; ".join(f"{text}: {count} of {len(found)}" for text, count in counts.items())
