"""Plots of the trade, as PNG files: time against error, and what plain rendering needs for the same error."""

from benches.front.points import METRICS, mean_worth
from benches.plotting import label_log_axis, plot_panels, save

SIZE_IN = (13.0, 6.2)
LEGEND = 0.11  # of the height
COLOURS = {"draft": "C0", "balanced": "C2", "final": "C3", "paper": "C4", "non_local_means": "C1", "joint_bilateral": "C5",
           "motion_average": "C6"}
PLAIN_COLOUR, SETTING_COLOUR, FRONT_COLOUR = "0.4", "0.55", "#f0cf6d"


def _save_with_legend(path, figure, axes):
    figure.legend(*axes.get_legend_handles_labels(), fontsize=9, loc="lower center", ncol=5, frameon=False)
    save(path, figure, LEGEND)


def _lines(trade, metric):
    """The points with this error, by method, of those methods that are no changed preset."""
    lines = {}
    for point in trade.points:
        if point.kind != "setting" and getattr(point, metric) is not None:
            lines.setdefault(point.name, []).append(point)
    return lines


def _draw_line(axes, points, metric):
    first = points[0]
    x, y = [p.seconds for p in points], [getattr(p, metric) for p in points]
    style = {"plain": dict(color=PLAIN_COLOUR, marker="s", linewidth=1.5), "preset": dict(color=COLOURS.get(first.name), marker="o", linewidth=2.0),
             "recipe": dict(color=COLOURS.get(first.name), marker="^", linewidth=1.0, linestyle="--")}[first.kind]
    axes.plot(x, y, markersize=5, label="plain rendering" if first.kind == "plain" else first.title, zorder=3, **style)


def _label_counts(axes, points, metric, offset):
    for point in points:
        axes.annotate(f"{point.spp} spp", (point.seconds, getattr(point, metric)), fontsize=7, xytext=offset, textcoords="offset points",
                      color="0.3", zorder=4)


def _draw_trade(axes, trade, metric):
    if trade.has_render_time:
        ahead = trade.front(metric)
        axes.plot([p.seconds for p in ahead], [getattr(p, metric) for p in ahead], color=FRONT_COLOUR, linewidth=9, alpha=0.8,
                  solid_capstyle="round", drawstyle="steps-post", label="front", zorder=1)
    lines = _lines(trade, metric)
    for points in lines.values():
        if points[0].kind != "plain" or trade.has_render_time:
            _draw_line(axes, points, metric)
        else:
            for point in points:
                axes.axhline(getattr(point, metric), color=PLAIN_COLOUR, linewidth=1.0)
                axes.annotate(f"plain rendering, {point.spp} spp", (1.0, getattr(point, metric)), xycoords=("axes fraction", "data"),
                              fontsize=7, ha="right", va="bottom", color="0.3")
    changed = [p for p in trade.points if p.kind == "setting" and getattr(p, metric) is not None]
    if changed:
        axes.scatter([p.seconds for p in changed], [getattr(p, metric) for p in changed], s=9, color=SETTING_COLOUR,
                     label="a preset with one setting changed", zorder=2)
    for name, offset in (("noisy", (5, 5)), ("final", (-8, -13))):
        if name in lines and (trade.has_render_time or name != "noisy"):
            _label_counts(axes, lines[name], metric, offset)
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        label_log_axis(axis)


def plot_trade(path, title, trade):
    """Seconds a frame against both errors."""
    x = "seconds a frame, rendering + denoising" if trade.has_render_time else "seconds a frame, denoising"
    figure, panels = plot_panels([f"{title}: {of}" for of in METRICS.values()], x, METRICS.values(), SIZE_IN)
    for axes, metric in zip(panels, METRICS):
        _draw_trade(axes, trade, metric)
    _save_with_legend(path, figure, panels[0])


def plot_worth(path, title, trades, mean):
    """The samples that plain rendering needs, against those that were denoised. Hollow markers are extrapolated."""
    figure, panels = plot_panels([f"{title}: samples for equal {of}" for of in METRICS.values()], "samples per pixel that are denoised",
                                 ["samples per pixel of plain rendering"] * len(METRICS), SIZE_IN)
    for axes, metric in zip(panels, METRICS):
        for name, points in _lines(mean, metric).items():
            found = [(p.spp, worth) for p in points if (worth := mean_worth(trades, p, metric))]
            if not found:
                continue
            spps, worths = zip(*found)
            is_plain = points[0].kind == "plain"
            colour = PLAIN_COLOUR if is_plain else COLOURS.get(name)
            axes.plot(spps, [w.samples for w in worths], color=colour, linewidth=2.0 if points[0].kind == "preset" else 1.0,
                      linestyle="--" if points[0].kind == "recipe" else "-", label="plain rendering" if is_plain else points[0].title)
            axes.scatter(spps, [w.samples for w in worths], s=26, edgecolors=colour, zorder=3,
                         facecolors=[colour if w.is_measured else "white" for w in worths])
        axes.set_xscale("log", base=2)
        axes.set_yscale("log")
        axes.set_xticks(sorted({p.spp for p in mean.points}), [str(spp) for spp in sorted({p.spp for p in mean.points})])
        label_log_axis(axes.yaxis)
    _save_with_legend(path, figure, panels[0])
