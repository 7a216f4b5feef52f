"""Tables of the trade, as markdown."""

from benches.front.points import METRICS, mean_worth
from benches.markdown_report import markdown, wrapped

EXTRAPOLATED = "*"
NOTE = ("Plain spp: the samples that plain rendering needs for the same error. "
        f"`{EXTRAPOLATED}`: beyond the measured sample counts of plain rendering (in a mean: of one scene at least), "
        "extrapolated by 1/N. Faster: the seconds that plain rendering takes for the same error, over those of rendering and denoising. "
        "Equal time: the error over that of plain rendering with as many samples as fit into the same seconds.\n")


def number(value, unit=""):
    """Three digits; None, which is not known, is a dash."""
    if value is None:
        return "-"
    return (f"{value:.0f}" if value >= 100 else f"{value:.3g}") + unit


def samples(worth):
    return "-" if worth is None else number(worth.samples) + ("" if worth.is_measured else EXTRAPOLATED)


def seconds(point):
    if point.kind == "plain":
        return number(point.render_s)
    return f"{number(point.render_s)} + {number(point.denoise_s)}" if point.render_s is not None else number(point.denoise_s)


def seconds_title(trade):
    return ("rendering + denoising" if trade.has_render_time else "denoising") + ", s a frame"


def worth_table(trade, worth_of):
    """What plain rendering needs for the errors of presets and recipes, by worth_of(point, metric)."""
    rows = []
    for point in compared(trade):
        found = {metric: worth_of(point, metric) for metric in METRICS}
        of_error = found["relmse"]
        rows.append((point.label, seconds(point),
                     *(text for worth in found.values() for text in (samples(worth), number(worth and worth.times, "x"))),
                     number(of_error and of_error.at_equal_time)))
    return markdown(("point", seconds_title(trade), *(text for title in METRICS.values() for text in
                     (f"plain spp, equal {title}", "faster")), "relMSE of plain's, equal time"), rows)


def compared(trade):
    """The points of presets and recipes, by sample count."""
    return sorted((p for p in trade.points if p.kind in ("preset", "recipe")), key=lambda p: p.spp)


def scene_worth_table(trade):
    return worth_table(trade, trade.worth)


def mean_worth_table(trades, mean):
    return worth_table(mean, lambda point, metric: mean_worth(trades, point, metric))


def statement(point, worth):
    """"4 spp + final = 260 spp: 31 times faster"."""
    faster = f": {number(worth.times)} times faster" if worth.times is not None else ""
    return f"{point.label} = {samples(worth)} spp{faster}"


def dominated(trade):
    """(preset point, metric, the point that dominates it) of every preset that lies not on the front."""
    return [(point, metric, better) for point in trade.points if point.kind == "preset" for metric in METRICS
            if getattr(point, metric) is not None and (better := trade.dominator(point, metric))]


def dominated_table(trade):
    """One row for each dominated preset; a sentence if there is none."""
    rows = [(point.label, METRICS[metric], better.label, number(better.seconds / point.seconds),
             number(getattr(better, metric) / getattr(point, metric))) for point, metric, better in dominated(trade)]
    if not rows:
        return "No preset is dominated.\n"
    least = min(getattr(better, metric) / getattr(point, metric) for point, metric, better in dominated(trade))
    note = wrapped(f"Presets that are not on the front: another point takes less time and has an error up to {100.0 * (1.0 - least):.0f} % lower.")
    return note + "\n" + markdown(("dominated preset", "by time and", "better", "its time over the preset's", "its error"), rows)


def count_table(trades):
    """How many points of each preset are dominated, of those on all scenes by themselves."""
    found = [(point.name, metric) for trade in trades for point, metric, _ in dominated(trade)]
    points = [point.name for trade in trades for point in trade.points if point.kind == "preset"]
    rows = [(name, *(f"{found.count((name, metric))} of {points.count(name)}" for metric in METRICS)) for name in dict.fromkeys(points)]
    return markdown(("dominated on single scenes", *(f"by time and {title}" for title in METRICS.values())), rows)


def front_tables(trade):
    """Nothing without the time of rendering: sample counts would seem free."""
    return "\n".join(markdown((f"front of time and {title}", seconds_title(trade), title), [
        (point.label, seconds(point), f"{getattr(point, metric):.3g}") for point in trade.front(metric)])
        for metric, title in METRICS.items()) if trade.has_render_time else ""


def point_table(trade):
    rows = [(point.label, seconds(point), *("-" if (error := getattr(point, metric)) is None else f"{error:.3g}" for metric in METRICS))
            for point in trade.points]
    return markdown((trade.title, seconds_title(trade), *METRICS.values()), rows)
