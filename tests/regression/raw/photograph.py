#!/usr/bin/python3
"""The raw files of the case `burst`, beside this script: three exposures of scenes/moving.json by a shaking hand, past which a
disc moves. With --truth the picture that a camera without noise and mosaic would have taken at the first one: the reference."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

HERE = Path(__file__).resolve().parent
sys.path[0] = str(HERE.parents[2] / "scripts")
from benches.burst import camera, dng  # noqa: E402
from pictures.files import read_layers  # noqa: E402

SIZE, SPP, FRAME = "240x192", 128, 2
EXPOSURE = 1.2  # fixed, so that raw files and truths of different renders agree
COUNT, ISO, SEED = 3, 6400, 5


def scene(becalm):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.exr"
        subprocess.run([becalm, "render", HERE.parent / "scenes/moving.json", "-o", path, "--frames", str(FRAME), "--size", SIZE,
                        "--spp", str(SPP), "--type=float", "--quiet"], check=True)
        return read_layers(path)[""][..., :3].clip(0, None) * EXPOSURE


def main():
    parser = argparse.ArgumentParser(prog="photograph.py", description=__doc__)
    parser.add_argument("becalm", help="the program that renders the scene")
    parser.add_argument("--truth", metavar="FILE", help="write this file, and no raw files")
    asked = parser.parse_args()
    burst = camera.photographed(scene(asked.becalm), "bayer", COUNT, SEED)
    if asked.truth:
        height, width, _ = burst.picture.shape
        image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
        image.set_pixels(oiio.ROI(), np.ascontiguousarray(burst.picture.clip(0, 1)))
        if not image.write(asked.truth):
            sys.exit(image.geterror())
        return
    random = np.random.default_rng(SEED)
    for number, mosaic in enumerate(burst.mosaics, 1):
        dng.write(HERE / f"{number}.dng", camera.noisy(mosaic, ISO, random), cfa=burst.cfa, black=camera.BLACK, white=camera.WHITE,
                  neutral=camera.NEUTRAL, color_matrix=camera.COLOR_MATRIX, iso=ISO, shutter_s=1 / 60)


if __name__ == "__main__":
    main()
