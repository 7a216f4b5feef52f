"""Plots as PNG files, drawn without a display."""

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

SIZE_IN = (9.0, 5.2)
DPI = 110


def save(path, figure, below=0.0):
    """below: the share of the height that is left free for a legend of all panels."""
    figure.tight_layout(rect=(0.0, below, 1.0, 1.0))
    FigureCanvasAgg(figure).print_png(str(path))


def label_log_axis(axis):
    """Labels 1, 2 and 5 of each decade as plain numbers."""
    axis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def plot_panels(titles, x, ys, size_in=SIZE_IN):
    """A figure with axes side by side."""
    figure = Figure(figsize=size_in, dpi=DPI)
    panels = figure.subplots(1, len(titles), squeeze=False)[0]
    for axes, title, y in zip(panels, titles, ys):
        axes.set(title=title, xlabel=x, ylabel=y)
        axes.grid(True, which="both", alpha=0.3)
    return figure, panels


def plot_axes(title, x, y):
    figure, (axes,) = plot_panels([title], x, [y])
    return figure, axes
