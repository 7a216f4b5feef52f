"""Temporal antialiasing of one jittered sample a pixel: RMSE and SSIM against references of many samples, by each method, beside the
table of Philippi, Frisvad and Jensen, section 5.1. Called by `scripts/bench antialias`."""

import argparse
import sys
from pathlib import Path

import cv2
import numpy as np

from benches.antialias import noisy, stutter, upsample, zone_plate
from benches.antialias.shots import CHOOSING, CYCLE, REPORTED, antialias, read, render
from benches.markdown_report import figure, markdown

METHODS = {  # the options of becalm antialias
    "1 spp": None,
    "clamping": ["--preset", "clamping"],
    "gain": ["--preset", "gain"],
    "paper": ["--preset", "paper"],
    "forward": ["--preset", "forward"],
    "best": ["--preset", "best"],
}
PUBLISHED = {"fence": {"1 spp": 0.015, "clamping": 0.009, "gain": 0.006}, "classroom": {"1 spp": 0.074, "clamping": 0.048, "gain": 0.037},
             "blocks": {"1 spp": 0.050, "clamping": 0.032, "gain": 0.029}}
REFERENCE_SPP = 128
INPUTS = ("jittered", "reference")  # folders beside those of the methods


def ssim(a, b):
    """Wang et al. 2004 over linear colours in [0,1], with a Gaussian window of 1.5 px."""
    a, b = np.clip(a, 0, 1).astype(np.float64), np.clip(b, 0, 1).astype(np.float64)

    def blur(image):
        return cv2.GaussianBlur(image, (11, 11), 1.5)

    mean_a, mean_b = blur(a), blur(b)
    var_a, var_b, cov = blur(a * a) - mean_a**2, blur(b * b) - mean_b**2, blur(a * b) - mean_a * mean_b
    c1, c2 = 0.01**2, 0.03**2
    return float(np.mean((2 * mean_a * mean_b + c1) * (2 * cov + c2) / ((mean_a**2 + mean_b**2 + c1) * (var_a + var_b + c2))))


def measure(reference, test):
    """RMSE, SSIM, and the RMSE of the differences between frames, over a sequence."""
    error = [np.mean((r - t) ** 2) for r, t in zip(reference, test)]
    change = [np.mean(((r1 - r0) - (t1 - t0)) ** 2) for r0, r1, t0, t1 in zip(reference, reference[1:], test, test[1:])]
    return np.sqrt(np.mean(error)), np.mean([ssim(r, t) for r, t in zip(reference, test)]), np.sqrt(np.mean(change))


def chosen(texts, parser):
    """Options by name of the methods that --method asks for; all methods without any."""
    methods = {}
    for text in texts:
        name, _, options = text.partition(":")
        if name in INPUTS:
            parser.error(f"--method {name}: is the folder of the input")
        if not options and name not in METHODS:
            parser.error(f"no method '{name}'; there are {', '.join(METHODS)}")
        methods[name] = options.split() if options else METHODS[name]
    return methods or METHODS


def rows_of(scene, figures):
    """Rows by method of (RMSE, SSIM, RMSE of changes), and the published ones below."""
    clamping = figures["clamping"][0] if "clamping" in figures else 0
    rows = [(scene, name, f"{rmse:.4f}", figure(rmse / clamping if clamping else None, 2), f"{similarity:.4f}", f"{changes:.4f}")
            for name, (rmse, similarity, changes) in figures.items()]
    published = PUBLISHED.get(scene, {})
    return rows + [(scene, f"{name}, published", f"{rmse:.3f}", f"{rmse / published['clamping']:.2f}", "-", "-") for name, rmse in published.items()]


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench antialias", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: {', '.join(REPORTED)}")
    parser.add_argument("--choosing", action="store_true", help=f"the shots that settings are chosen on: {', '.join(CHOOSING)}")
    parser.add_argument("--method", action="append", default=[], metavar="NAME[:OPTIONS]",
                        help="a method alone; with options of becalm antialias, such as 'try:--preset best --set rectify=clamp'")
    parser.add_argument("--stutter", action="store_true", help="the stutter of slow motion by the search, with and without subpixel refinement")
    parser.add_argument("--size", default="320x180", metavar="WxH")
    parser.add_argument("--frames", type=int, default=24, help="of each shot (default: 24)")
    parser.add_argument("--becalm", default="build/release/becalm")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/antialias"), metavar="DIR")
    parser.add_argument("--upsample", action="store_true", help="the curves of full size, checkerboard, 1.5x and 2x at equal time instead, at 192x108")
    parser.add_argument("--noisy", action="store_true", help="noisy frames of half the size made full-size and calm instead, at 192x108")
    parser.add_argument("--zone-plate", action="store_true", help="the transfer function of a panned zone plate instead")
    asked = parser.parse_args()
    methods = chosen(asked.method, parser)
    if asked.upsample:
        return print(upsample.curves(asked.becalm, asked.output / "upsample", (192, 108), 16))
    if asked.noisy:
        return print(noisy.table(asked.becalm, asked.output / "noisy", noisy.CHOOSING if asked.choosing else noisy.REPORTED, (192, 108), 12))
    if asked.zone_plate:
        return print(zone_plate.table(asked.becalm, asked.output / "zone_plate"))
    size = tuple(int(side) for side in asked.size.split("x"))
    frames = range(1, asked.frames + 1)
    if asked.stutter:
        print("\n".join(stutter.table(asked.becalm, asked.output, size, frames)))
        return
    rows = []
    for scene in asked.scenes or (CHOOSING if asked.choosing else REPORTED):
        root = asked.output / asked.size / scene
        jittered, clean = (root / name for name in INPUTS)
        render(asked.becalm, scene, jittered, frames, size, 1, CYCLE)
        render(asked.becalm, scene, clean, frames, size, REFERENCE_SPP, 0)
        reference = [read(clean, frame) for frame in frames]
        figures = {}
        for name, options in methods.items():
            folder = jittered
            if options is not None:
                folder = root / name
                antialias(asked.becalm, jittered, folder, options)
            figures[name] = measure(reference, [read(folder, frame) for frame in frames])
            print(scene, name, *(f"{error:.4f}" for error in figures[name]), file=sys.stderr, flush=True)
        rows += rows_of(scene, figures)
    print(markdown(("scene", "method", "RMSE", "of clamping's", "SSIM", "RMSE of changes"), rows), end="")


if __name__ == "__main__":
    main()
