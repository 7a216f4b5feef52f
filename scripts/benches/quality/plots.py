"""Plots of the results, as PNG files."""

import numpy as np

from benches.plotting import plot_axes, save
from benches.quality.tables import METRICS
from benches.quality.variants import NOISY


def _samples_axis(axes, spps):
    axes.set_xscale("log", base=2)
    axes.set_xticks(spps, [str(spp) for spp in spps])


def plot_errors(path, results, metric):
    """Mean over the scenes against samples per pixel, a line for each variant that is no ablation."""
    figure, axes = plot_axes(f"{METRICS[metric]}, mean over the scenes", "samples per pixel", METRICS[metric])
    spps = results.spps()
    for variant in results.variants:
        if variant.ablation:
            continue
        means = {spp: np.mean([cell["mean"][metric] for cell in cells.values()])
                 for spp in spps if (cells := results.of(spp, variant.name))}
        if means:
            axes.plot(list(means), list(means.values()), marker="o", label=variant.title, color="0.6" if variant is NOISY else None)
    _samples_axis(axes, spps)
    if metric in ("relmse", "temporal"):
        axes.set_yscale("log")
    axes.legend(fontsize=8)
    save(path, figure)


def plot_energy(path, results, limit):
    """A point for each scene and sample count, which shows the worst ones."""
    figure, axes = plot_axes("energy of every scene", "samples per pixel", "mean over the reference's, less 1, in %")
    spps, variants = results.spps(), [v for v in results.variants if not v.ablation]
    for index, variant in enumerate(variants):
        points = [(spp * 2.0 ** (0.06 * (index - len(variants) / 2)), 100 * cell["mean"]["energy"])
                  for spp in spps for cell in results.of(spp, variant.name).values()]
        if points:
            axes.scatter(*zip(*points), s=14, label=variant.title, color="0.6" if variant is NOISY else None)
    axes.axhspan(-100 * limit, 100 * limit, color="C2", alpha=0.12, label="goal")
    _samples_axis(axes, spps)
    axes.legend(fontsize=8)
    save(path, figure)


def plot_time(path, results, spp):
    """relMSE over noisy's against seconds per frame, a point for each variant."""
    figure, axes = plot_axes(f"time against error at {spp} spp, means over the scenes", "seconds of the filter a frame", "relMSE over that of noisy")
    for variant in results.variants:
        seconds = [cell["times"]["filter"] for cell in results.of(spp, variant.name).values() if "filter" in cell["times"]]
        if not seconds:
            continue
        point = np.mean(seconds), np.mean(list(results.ratios(spp, variant.name, "relmse").values()))
        axes.scatter(*point, color="C1" if variant.ablation else "C0", s=22)
        axes.annotate(variant.name, point, fontsize=7, xytext=(4, 3), textcoords="offset points")
    axes.set_yscale("log")
    save(path, figure)


def write_plots(folder, results, energy_limit, time_spp):
    """Writes all plots. Returns their files by title."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {f"{title} against samples per pixel": folder / f"{metric}.png" for metric, title in METRICS.items() if metric != "energy"}
    for metric in ("relmse", "temporal", "ssim", "flip"):
        plot_errors(folder / f"{metric}.png", results, metric)
    paths["energy of every scene"] = folder / "energy.png"
    plot_energy(paths["energy of every scene"], results, energy_limit)
    paths["time against error"] = folder / "time.png"
    plot_time(paths["time against error"], results, time_spp)
    return paths
