"""Tables of the cells, as markdown."""

import numpy as np

from benches.geometric_mean import geometric_mean
from benches.markdown_report import figure, markdown
from benches.quality.variants import NOISY

NOT_AVAILABLE = "not available"
METRICS = {"relmse": "relMSE", "temporal": "temporal error", "energy": "energy", "ssim": "SSIM", "flip": "FLIP"}


class Results:
    """The measured cells by scene, samples per pixel and name of the variant."""

    def __init__(self, variants, refusals):
        self.variants, self.refusals = variants, refusals  # refusals: the reason by name of a variant that the program does not know
        self.cells = {}

    def add(self, cell):
        self.cells[cell["scene"], cell["spp"], cell["variant"]] = cell

    def spps(self):
        return sorted({spp for _, spp, _ in self.cells})

    def of(self, spp, name):
        """The cells of a variant at a sample count, by scene."""
        return {scene: cell for (scene, at, which), cell in self.cells.items() if (at, which) == (spp, name)}

    def ratios(self, spp, name, metric):
        """The variant's figure over noisy's, by scene."""
        noisy = self.of(spp, NOISY.name)
        return {scene: cell["mean"][metric] / noisy[scene]["mean"][metric] for scene, cell in self.of(spp, name).items()
                if scene in noisy}


def share(ratio):
    """A ratio as text: 0.05 is 1/20, 1.5 is 1.50."""
    def digits(value):
        return f"{value:.0f}" if value >= 1000.0 else f"{value:.3g}"
    return f"1/{digits(1.0 / ratio)}" if 0.0 < ratio < 1.0 else digits(ratio)


def geometric_share(results, spp, name, metric):
    """The geometric mean over the scenes of the figure over noisy's, as text."""
    mean = geometric_mean(list(results.ratios(spp, name, metric).values()))
    return "-" if mean is None else share(mean)


def percent(value):
    return f"{100.0 * value:+.2f} %"


def largest(by_scene):
    """The (scene, value) of the largest magnitude."""
    return max(by_scene.items(), key=lambda item: abs(item[1]))


def overview_table(results, spp):
    """A row for each variant: arithmetic means over the scenes, but geometric ones of the shares of noisy's errors."""
    rows = []
    for variant in results.variants:
        cells = results.of(spp, variant.name)
        if not cells:
            if variant.name in results.refusals:
                rows.append((variant.title, NOT_AVAILABLE, *[""] * 8))
            continue
        mean = {metric: np.mean([cell["mean"][metric] for cell in cells.values()]) for metric in ("relmse", "temporal", "ssim")}
        of_noisy = {metric: geometric_share(results, spp, variant.name, metric) for metric in ("relmse", "temporal")}
        scene, energy = largest({scene: cell["mean"]["energy"] for scene, cell in cells.items()})
        seconds = [[cell["times"][part] for cell in cells.values() if part in cell["times"]] for part in ("filter", "process")]
        rows.append((variant.title, len(cells), figure(mean["relmse"], 5), of_noisy["relmse"], figure(mean["temporal"], 5),
                     of_noisy["temporal"], f"{percent(energy)} {scene}", figure(mean["ssim"], 3),
                     *(figure(np.mean(of) if of else None, 2) for of in seconds)))
    return markdown(("variant", "scenes", "relMSE", "of noisy", "temporal error", "of noisy", "energy, the worst", "SSIM",
                     "filter s a frame", "with files"), rows)


def scene_table(results, spp, metric):
    """A row for each variant, a column for each scene. Errors are given over noisy's, with their geometric mean; other figures as they are."""
    scenes = list(results.of(spp, NOISY.name))
    of_noisy = metric in ("relmse", "temporal")
    rows = []
    for variant in results.variants:
        cells = results.of(spp, variant.name)
        if not cells:
            continue
        if of_noisy and variant is not NOISY:
            ratios = results.ratios(spp, variant.name, metric)
            shown = {scene: share(ratio) for scene, ratio in ratios.items()}
        else:
            shown = {scene: percent(cell["mean"][metric]) if metric == "energy" else figure(cell["mean"][metric], 4)
                     for scene, cell in cells.items()}
        mean = ["-" if variant is NOISY else geometric_share(results, spp, variant.name, metric)] if of_noisy else []
        rows.append((variant.title, *(shown.get(scene, "-") for scene in scenes), *mean))
    return markdown((METRICS[metric], *scenes, *(["geometric mean"] if of_noisy else [])), rows)


def samples_table(results, metric):
    """A row for each variant that is measured at several sample counts, a column for each count: geometric means over the scenes."""
    spps = results.spps()
    rows = [(variant.title, *(geometric_share(results, spp, variant.name, metric) for spp in spps)) for variant in results.variants
            if variant is not NOISY and sum(bool(results.of(spp, variant.name)) for spp in spps) > 1]
    return markdown((f"{METRICS[metric]} of noisy's, samples per pixel", *map(str, spps)), rows)


def kept_table(results, spp):
    """The energy of all frames over that of the noisy frames."""
    scenes = list(results.of(spp, NOISY.name))
    rows = []
    for variant in results.variants:
        cells = results.of(spp, variant.name)
        if cells and variant is not NOISY:
            rows.append((variant.title, *(percent(cells[s]["kept"]) if s in cells else "-" for s in scenes)))
    return markdown(("energy of all frames over that of the noisy ones", *scenes), rows)


def still_table(results, spp):
    """The error of still pixels over that of the ideal mean, and the share of still pixels."""
    scenes = list(results.of(spp, NOISY.name))
    rows = []
    for variant in results.variants:
        cells = results.of(spp, variant.name)
        if variant.history and cells:
            rows.append((variant.title, *(figure(cells[s].get("over_ideal"), 2) if s in cells else "-" for s in scenes)))
    shares = {s: cell["still"] for v in results.variants for s, cell in results.of(spp, v.name).items() if "still" in cell}
    if not shares:
        return ""
    rows.append(("share of still pixels", *(f"{100 * shares[s]:.0f} %" if s in shares else "-" for s in scenes)))
    return markdown(("error of still pixels over the ideal mean's", *scenes), rows)


def variant_table(results):
    rows = []
    for variant in results.variants:
        command = " ".join(variant.command or variant.options) or "-"
        if variant.without:
            command += f" (without the layers {', '.join(variant.without)})"
        refusal = results.refusals.get(variant.name)
        rows.append((variant.name, variant.title, command, f"{NOT_AVAILABLE}: {refusal}" if refusal else "measured"))
    return markdown(("name", "variant", "options of becalm denoise, or command", "state"), rows)
