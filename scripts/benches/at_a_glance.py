"""The first table of RESULTS.md: what each preset reaches, by the tables that follow."""

import re

from benches.markdown_report import markdown

# Titles in the tables of all variants, and here.
ROWS = {"preset draft": "`draft`", "preset balanced": "`balanced` (default)", "preset final": "`final`",
        "OIDN, each frame alone": "OIDN, each frame alone", "OIDN, large, features prefiltered": "OIDN, large, features prefiltered"}
NONE = "-"


def _row(text, title):
    """The cells of the first row of this title, without the title."""
    found = re.search(rf"^\| {re.escape(title)} +\|(.*)\|$", text, re.MULTILINE)
    return [cell.strip() for cell in found[1].split("|")] if found else []


def at_a_glance(parts):
    """`parts`: the text of each part of RESULTS.md by its name. What a part does not have is left open."""
    rows = []
    for title, shown in ROWS.items():
        cells = []
        for part in ("quality", "scenes"):
            # scenes | relMSE | of noisy | temporal error | of noisy | ...
            overview = _row(parts.get(part, ""), title)
            cells += [overview[2], overview[4]] if overview else [NONE, NONE]
        seconds = _row(parts.get("time", ""), title.removeprefix("preset "))
        if any(cell != NONE for cell in cells):
            rows.append((shown, *cells, *((seconds[0], seconds[2]) if seconds else (NONE, NONE))))
    return markdown(("8 samples a pixel", "Cycles shots: relMSE, of noisy's", "temporal error", "our scenes: relMSE", "temporal error",
                     "1920x1080 on two cores, s a frame", "memory, MiB"), rows)
