"""Ours against optical flow on the same noisy pairs (the paper's figures 13 and 14, in numbers)."""

import numpy as np

import align_pictures as pictures
from align_measure import measure, reference_floor
from align_peers import PEERS, eight_bit_pair, timed
from align_report import figure, markdown
from align_warp import warp
from demo_pictures import write_picture
from picture_panel import panel

OURS = "ours"
VARIANTS = {  # settings over the default preset, and whether the frames' guides may be used
    OURS: ([], True),
    "ours, radiance": ([], False),
    "ours, 1x1": (["match_downsample=1"], True),
    "ours, 2x2": (["match_downsample=2"], True),
    "ours, 4x4": (["match_downsample=4"], True),
}
PRESET = "balanced"  # the default
CORRELATION_GOAL = 0.02


def _zero(pair):
    return np.zeros((*pair.clean_target.shape[:2], 2), np.float32)


def compare(aligners, pair, variants, peers):
    """A row for each method, and the offsets by method. Ours and the peers take turns."""
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
            continue  # the default under another name, or without the guides that the pair lacks
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
    """Frames, and for each method the warped clean source, its difference from the clean target, and the offsets."""
    like = pair.clean_target
    long_px = [np.percentile(np.hypot(*np.moveaxis(offset, -1, 0)), 95) for offset in offsets.values()]
    scale_px = max(1.0, float(np.median(long_px)))
    rows = [[("noisy target", pictures.shown(pair.target["beauty"], like)), ("clean source", pictures.shown(pair.clean_source, like)),
             (f"disoccluded; offsets' full colour is {scale_px:.0f} px", pictures.mask(~pair.visible * 1.0))]]
    for method, offset in offsets.items():
        warped = warp(pair.clean_source, offset)
        rows.append([(method, pictures.shown(warped, like)),
                     (f"difference x{pictures.DIFFERENCE_GAIN:g}", pictures.difference(warped, pair.clean_target, like)),
                     ("offsets", pictures.flow(offset, scale_px))])
    write_picture(path, panel([[(text, pictures.halved(picture)) for text, picture in row] for row in rows]))


def verdicts(rows):
    """One entry a pair and noise: whether ours meets the goals, and by how much."""
    result = []
    for key in dict.fromkeys((row["pair"], row["noise"]) for row in rows):
        of_pair = {row["method"]: row for row in rows if (row["pair"], row["noise"]) == key}
        ours = of_pair[OURS]
        peers = [row for name, row in of_pair.items() if name in PEERS]
        best = {m: min(peers, key=lambda row: row[m]) for m in ("clean", "clean_visible")}
        result.append({
            "pair": key[0], "noise": key[1],
            "best_peer": best["clean"]["method"], "clean_ratio": ours["clean"] / best["clean"]["clean"],
            "best_peer_visible": best["clean_visible"]["method"],
            "clean_visible_ratio": ours["clean_visible"] / best["clean_visible"]["clean_visible"],
            "correlation": ours["correlation"], "average": ours["average"], "average_visible": ours["average_visible"],
            "floor": ours["floor"],
            "lowest": ours["clean"] < best["clean"]["clean"],
            "lowest_visible": ours["clean_visible"] < best["clean_visible"]["clean_visible"],
            "decorrelated": abs(ours["correlation"]) < CORRELATION_GOAL, "average_better": ours["average"] < 1.0,
        })
    return result


def row_table(rows):
    cells = [(row["pair"], row["noise"], row["method"], figure(row["clean"], 5), figure(row["clean_visible"], 5),
              figure(row["correlation"]), figure(row["average"], 3), figure(row["average_visible"], 3), figure(row["epe"], 3),
              figure(row["ms"], 1)) for row in rows]
    return markdown(("pair", "noise", "method", "clean diff.", "not disoccluded", "noise corr.", "50/50", "not disoccluded",
                     "EPE px", "ms"), cells)


def verdict_table(found):
    def against(row, suffix):
        met = "" if row["lowest" + suffix] else " MISSED"
        return f"{row['clean' + suffix + '_ratio']:.3f} of {row['best_peer' + suffix]}{met}"

    cells = [(row["pair"], row["noise"], against(row, ""), against(row, "_visible"),
              f"{row['correlation']:+.4f}" + ("" if row["decorrelated"] else " MISSED"),
              f"{row['average']:.3f}" + ("" if row["average_better"] else " MISSED"), figure(row["floor"])) for row in found]
    return markdown(("pair", "noise", "clean diff. against the best peer", "not disoccluded", f"noise corr. (goal {CORRELATION_GOAL})",
                     "50/50 (goal below 1)", "of the clean diff. is noise"), cells)


def _geometric_mean(values):
    return float(np.exp(np.mean(np.log(values))))


def overview_table(rows):
    """Clean differences over the best peer's of the same pair and noise, as geometric means by pair and by noise."""
    def of(row):
        return row["pair"], row["noise"]

    best = {}
    for row in rows:
        if row["method"] in PEERS:
            best[of(row)] = min(row["clean"], best.get(of(row), np.inf))
    groups = list(dict.fromkeys([row["pair"] for row in rows] + [row["noise"] for row in rows]))
    cells = []
    for method in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == method]
        ratios = {of(row): row["clean"] / best[of(row)] for row in mine}
        by_group = [[ratio for key, ratio in ratios.items() if group in key] for group in groups]
        cells.append((method, *(figure(_geometric_mean(r) if r else None, 3) for r in by_group),
                      figure(_geometric_mean(list(ratios.values())), 3), figure(max(abs(row["correlation"]) for row in mine), 3),
                      figure(max(row["average"] for row in mine), 3)))
    return markdown(("clean diff. over the best peer's", *groups, "all", "largest noise corr.", "worst 50/50"), cells)


def goal_line(found):
    counts = [(sum(row[key] for row in found), text) for key, text in (
        ("lowest", "ours has the lowest clean difference"), ("lowest_visible", "also where nothing is disoccluded"),
        ("decorrelated", f"noise correlation below {CORRELATION_GOAL}"), ("average_better", "50/50 average better than the frame"))]
    return "; ".join(f"{text}: {count} of {len(found)}" for count, text in counts)
