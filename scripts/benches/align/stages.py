"""Time and memory of the aligner by level and stage (tables 1 and 2 of Hanika et al. 2021), and the least bytes it must move."""

import re

from benches.markdown_report import figure, markdown

MODES = {"full": 1, "2x2": 2, "4x4": 4}
MIB = 1 << 20
OFFSET_AND_RESIDUAL_BYTES = 8 + 4


def floor_bytes(width, height, downsample):
    """Bytes of two one-channel images that are read, and of an offset and a residual written for each matched pixel."""
    matched = -(-width // downsample) * -(-height // downsample)
    return 2 * 4 * width * height + OFFSET_AND_RESIDUAL_BYTES * matched


def _place(name):
    """(stage, level) of a pass named `align/KERNEL IMAGE.LN`; the level is None if the name has none."""
    kernel, _, image = name.partition(" ")
    level = re.search(r"\.L(\d+)$", image)
    return kernel.rpartition("/")[2], int(level.group(1)) if level else None


def by_level_and_stage(passes):
    """{level: {stage: {"ms", "image_bytes"}}}; passes without a level are under None."""
    levels = {}
    for row in passes:
        stage, level = _place(row["name"])
        cell = levels.setdefault(level, {}).setdefault(stage, {"ms": 0.0, "image_bytes": 0})
        cell["ms"] += row["ms"]
        cell["image_bytes"] += row["image_bytes"]
    return levels


def stage_table(passes, key="ms", scale=1.0, digits=2):
    """A row for each level, coarse to fine, and a column for each stage."""
    levels = by_level_and_stage(passes)
    stages = list(dict.fromkeys(_place(row["name"])[0] for row in passes))
    order = sorted((level for level in levels if level is not None), reverse=True) + [level for level in levels if level is None]
    rows = []
    for level in order:
        cells = [levels[level].get(stage, {}).get(key) for stage in stages]
        title = "all" if level is None else f"level {level}"
        rows.append((title, *("" if c is None else figure(c * scale, digits) for c in cells),
                     figure(sum(c for c in cells if c is not None) * scale, digits)))
    totals = [sum(levels[level].get(stage, {}).get(key, 0) for level in levels) for stage in stages]
    rows.append(("sum", *(figure(t * scale, digits) for t in totals), figure(sum(totals) * scale, digits)))
    return markdown(("", *stages, "sum"), rows)
