"""A pair of eyes: each denoised alone, and both together."""

import numpy as np

from benches.stereo.run import REFERENCE_SPP, Shot
from benches.stereo.shots import read
from demo_parts.use_runs import Use, displayed
from pictures.colours import map_colours

SCENE = "spheres"
SIZE = (384, 216)
FRAMES = range(1, 6)
SPP = 2
FULL_DIFFERENCE = 0.1  # of white: the brightest colour


def anaglyph(pair):
    """For glasses with a red filter at the left eye and a cyan one at the right."""
    return np.concatenate([pair["left"][..., :1], pair["right"][..., 1:]], axis=-1)


def difference_colours(reprojection, pair):
    """Between the left eye and the right one moved to where the left one sees it; 0 where only one sees."""
    warped, sees = reprojection.warped(np.clip(pair["right"], 0, 1), "left")
    difference = np.abs(np.clip(pair["left"], 0, 1) - warped).mean(axis=-1)
    return map_colours(np.where(sees, difference, 0) / FULL_DIFFERENCE)


def stereo(runs):
    shot = Shot(runs.becalm, SCENE, runs.folder, SIZE, FRAMES)
    noisy, alone, together = shot.noisy(SPP), runs.folder / "alone", runs.folder / "together"
    runs.run("denoise", noisy / "f.####.exr", "-o", alone / "f.####.exr", "--no-stereo")
    runs.run("denoise", noisy / "f.####.exr", "-o", together / "f.####.exr")
    frames = list(shot.measured)
    results = {name: {frame: read(folder, frame) for frame in frames}
               for name, folder in {"noisy": noisy, "each eye alone": alone, "both together": together}.items()}
    truth = [shot.reference[frame]["left"] for frame in frames]
    pictures = {name: [pairs[frame]["left"] for frame in frames] for name, pairs in results.items()} | {"reference": truth}
    shown = {name: displayed(images, truth) for name, images in pictures.items()}
    shown["in 3D"] = displayed([anaglyph(results["both together"][frame]) for frame in frames], truth)
    for short, name in (("alone", "each eye alone"), ("together", "both together")):
        shown[f"difference, {short}"] = [difference_colours(shot.reprojection[frame], results[name][frame]) for frame in frames]
    rows = [["", "RMSE", "SSIM", "stereo difference"]]
    for name, pairs in results.items():
        rows.append([name, *(f"{value:.4f}" for value in shot.measure(pairs))])
    rows.append(["reference", "", "", f"{shot.reference_difference():.4f}"])
    return Use(
        "stereo", "Stereo",
        f"Both eyes of scenes/{SCENE}.json at {SPP} samples a pixel; pictures are of the left one, or of both for red and cyan glasses. Denoised "
        "together, an eye takes from the other what both see: less noise is left, and above all less that differs between the eyes, which "
        f"disturbs when seen in stereo. Differences are shown up to {FULL_DIFFERENCE:g} of white.",
        frames, shown, "noisy", "both together",
        f"Against {REFERENCE_SPP} samples a pixel; the difference is that of an eye from the other one, moved to where this eye sees it", rows, runs.shown)
