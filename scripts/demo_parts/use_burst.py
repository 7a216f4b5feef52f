"""A handheld burst: raw files that a camera model makes of a rendered frame, merged before demosaicing."""

import shutil
import subprocess

import numpy as np

from benches.burst import camera
from demo_parts.use_runs import Use
from pictures.colours import display
from pictures.files import read_layers

SCENE, FRAME, SIZE, SPP = "penumbra", 6, "1056x672", 16
BRIGHTNESS = 2  # of the pictures: most of the room is dark
COUNT, ISO, SEED = 6, 6400, 3


def rendered(runs):
    """Denoised, so that its own noise is not taken for the camera's."""
    path = runs.folder / "scene.exr"
    subprocess.run([runs.becalm, "render", f"scenes/{SCENE}.json", "-o", path, "--frames", str(FRAME), "--context", "none", "--spp", str(SPP),
                    "--size", SIZE, "--denoise=final", "--type=float", "--overwrite", "--quiet"], check=True)
    return camera.scene(path)


def developed_alone(runs, path):
    """A file merged with its own copy is that file."""
    copy, target = runs.folder / "copy.dng", runs.folder / "alone.exr"
    shutil.copyfile(path, copy)
    subprocess.run([runs.becalm, "burst", path, copy, "-o", target, "--overwrite", "--quiet"], check=True)
    return read_layers(target)[""][..., :3]


def rms(image, truth, where):
    return float(np.sqrt(np.mean((image - truth)[where] ** 2)))


def burst(runs):
    runs.folder.mkdir(parents=True, exist_ok=True)
    photographed = camera.photographed(rendered(runs), "bayer", COUNT, SEED)
    paths = camera.write(runs.folder, photographed, ISO, SEED)
    developed = [developed_alone(runs, path) for path in paths]
    merged = runs.folder / "merged.exr"
    runs.run("burst", *paths, "--reference", "first", "-o", merged)
    truth = photographed.picture.clip(0, 1)
    pictures = {"one raw file": developed[0], "plain average": np.mean(developed, axis=0), "merged": read_layers(merged)[""][..., :3],
                "without noise": truth}
    rows = [["", "RMSE where nothing moves", "where something does"]]
    for name, picture in pictures.items():
        if picture is not truth:
            rows.append([name, *(f"{rms(picture, truth, where):.4f}" for where in (photographed.outside, photographed.swept))])
    return Use(
        "burst", "Bursts of raw files",
        f"{COUNT} exposures at ISO {ISO} by a shaking hand, with a disc that moves, as raw files of a camera model. becalm burst aligns and "
        "merges them before demosaicing; what moves is kept from the first exposure alone, where a plain average has ghosts.",
        [1], {name: [display(BRIGHTNESS * picture)] for name, picture in pictures.items()}, "one raw file", "merged",
        "Against the picture without noise and mosaic", rows, runs.shown)
