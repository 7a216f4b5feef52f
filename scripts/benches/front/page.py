"""The report and the page of `scripts/bench front`: a section for the trade as a whole, for each set, and for scaling."""

import json
from dataclasses import asdict
from pathlib import Path

from benches.front import plots, scaling, tables
from benches.front.points import mean_trade, mean_worth
from benches.markdown_report import Report, items, wrapped
from pictures.files import file_uri
from pictures.page import write_page

CONTENT = Path(__file__).with_name("page.html")
TITLE = "The trade of speed for accuracy"
SUBTITLE = "Time against error, both lower is better; the front joins the points that no other undercuts in both."
OF_THE_TRADE = ("trade", "scenes", "shots", "missing")
SECTIONS = (*OF_THE_TRADE, "adaptive", "scaling")
FOLDED = ("scenes", "shots")


def _plot_files(folder, key):
    return sorted((folder / "plots").glob(f"{key}.*.png"))


def _clear(folder, keys):
    """Removes what an earlier run, perhaps of other scenes, wrote for these sections."""
    (folder / "plots").mkdir(parents=True, exist_ok=True)
    for key in keys:
        for path in (*_plot_files(folder, key), folder / f"{key}.md", folder / f"{key}.json"):
            path.unlink(missing_ok=True)


def _write_index(folder, subtitle):
    """The page of all sections that exist in the folder."""
    sections = []
    for key in SECTIONS:
        file = folder / f"{key}.md"
        if file.exists():
            title, _, text = file.read_text().partition("\n\n")
            shown = [{"title": path.stem, "uri": file_uri(path)} for path in _plot_files(folder, key)]
            sections.append({"title": title.removeprefix("## "), "text": text, "plots": shown, "folded": key in FOLDED})
    write_page(folder / "index.html", "the trade", CONTENT, {"subtitle": subtitle, "sections": sections})


def _trade_text(sets, clock):
    """What RESULTS.md shows: what plain rendering needs for equal error, and the presets that are dominated."""
    parts = [wrapped(f"Time is {'that of all processors' if clock == 'processor' else 'wall time'}, with files and the program's start; figures are geometric means. "
                      + tables.NOTE)]
    for one in sets:
        mean = mean_trade(one.trades)
        parts += [wrapped(f"{one.title} ({', '.join(trade.title for trade in one.trades)}), {len(one.data.frames)} frames:"),
                  tables.mean_worth_table(one.trades, mean), tables.dominated_table(mean), tables.count_table(one.trades)]
        if not mean.has_render_time:
            parts.append(wrapped("Their time of rendering is not known: seconds are those of denoising, and dominance is among equal sample counts."))
    return "\n".join(parts)


def _statements(trades, mean):
    return "".join(f"- {tables.statement(point, worth)}\n" for point in tables.compared(mean)
                   if point.kind == "preset" and (worth := mean_worth(trades, point, "relmse")))


def _set_text(one):
    mean = mean_trade(one.trades)
    parts = [wrapped("Plain rendering of equal relMSE, geometric means:"), _statements(one.trades, mean), tables.point_table(mean),
             tables.front_tables(mean)]
    for trade in one.trades:
        parts += [f"{trade.title}:\n", tables.scene_worth_table(trade), tables.dominated_table(trade),
                  tables.front_tables(trade), tables.point_table(trade)]
    return "\n".join(part for part in parts if part)


def _draw(folder, one):
    mean = mean_trade(one.trades)
    for index, trade in enumerate((mean, *one.trades)):
        plots.plot_trade(folder / "plots" / f"{one.key}.{index + 1:02d}.png", f"{one.title}, {trade.title}", trade)
    plots.plot_worth(folder / "plots" / f"{one.key}.00.png", one.title, one.trades, mean)


def write(folder, sets, missing, clock):
    _clear(folder, OF_THE_TRADE)
    report = Report(folder, SECTIONS, TITLE)
    for one in sets:
        _draw(folder, one)
        report.add(one.key, one.title, _set_text(one), [trade.figures() for trade in (*one.trades, mean_trade(one.trades))])
    if missing:
        report.add("missing", "Not measured", items(missing), missing)
    means = {one.key: mean_trade(one.trades) for one in sets}
    report.add("trade", "The trade", "\n".join([_trade_text(sets, clock), *(["Not measured:\n\n" + items(missing)] if missing else [])]),
               {key: [{"preset": point.label, "metric": metric, "dominated_by": better.label}
                      for point, metric, better in tables.dominated(mean)] for key, mean in means.items()})
    _write_index(folder, SUBTITLE)


def write_adaptive(folder, text, data):
    Report(folder, SECTIONS, TITLE).add("adaptive", "Adaptive sampling", text, data)
    _write_index(folder, SUBTITLE)


def write_scaling(folder, preset, by_pixels, by_frames, clock):
    _clear(folder, ("scaling",))
    scaling.plot_scaling(folder / "plots" / "scaling.00.png", preset, by_pixels, by_frames, clock)
    Report(folder, SECTIONS, TITLE).add("scaling", "Time and memory against pixels and frames", scaling.report(preset, by_pixels, by_frames, clock), {
        "pixels": [asdict(run) for run in by_pixels], "frames": [asdict(run) for run in by_frames],
        "exponents": scaling.summary(by_pixels, by_frames, clock)})
    _write_index(folder, SUBTITLE)
