"""Bursts with truth: noise against the ideal 1/sqrt(N), error of a single frame, of the plain average and of the merged burst, outside
and inside of where a thing moves, and the time and memory of a 16-megapixel burst. Called by `scripts/bench burst`."""

import argparse
import re
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.burst import camera
from benches.geometric_mean import geometric_mean
from benches.timed import timed

REPORTED = ("dining", "penumbra", "meadow")
CHOOSING = ("courtyard", "spheres")  # what constants are chosen on
FRAME, SPP, SIZE = 6, 16, "1536x1024"
ISOS = (100, 1600, 12800)
COUNTS = (1, 3, 6, 12)
LARGE = (4896, 3264)  # of the paper's camera


def render(becalm, scene, root):
    """A frame of a scene, denoised, so that its own noise is not taken for texture or the camera's."""
    pattern = root / f"{scene}.####.exr"
    subprocess.run([becalm, "render", f"scenes/{scene}.json", "-o", pattern, "--frames", str(FRAME), "--context", "none", "--spp", str(SPP),
                    "--size", SIZE, "--denoise=final", "--type=float", "--resume", "--quiet"], check=True)
    return root / f"{scene}.{FRAME:04}.exr"


def merged(becalm, paths, target, options=()):
    """The merged mosaic of these files."""
    if len(paths) == 1:
        return camera.samples_of(paths[0])
    subprocess.run([becalm, "burst", *paths, "-o", target, "--mosaic", "--reference", "first", "--quiet", *options], check=True)
    # Not through ImageBuf, whose cache keeps files that were written again within a second.
    return oiio.ImageInput.open(str(target)).read_image(oiio.FLOAT)[..., 0].astype(np.float64)


def rms(image, where):
    return float(np.sqrt(np.mean(image[where] ** 2)))


class Shot:
    """A scene photographed twice, with other noise and the same hand."""

    def __init__(self, becalm, scene, mosaic, root, options):
        self.becalm, self.root, self.options = becalm, root / scene / mosaic, options
        self.burst = camera.photographed(camera.scene(render(becalm, scene, root)), mosaic, max(COUNTS), seed=7)

    def results(self, iso, count):
        """Of both times: the files, and what they are merged to."""
        for time in (1, 2):
            paths = camera.write(self.root / f"{iso}.{time}", self.burst, iso, seed=100 * iso + time)[:count]
            yield paths, merged(self.becalm, paths, self.root / "merged.exr", self.options)

    def noise(self, iso, count):
        """Noise of the result where nothing moves, in that of a single frame over sqrt(count)."""
        (paths, a), (others, b) = self.results(iso, count)
        single = camera.samples_of(paths[0]) - camera.samples_of(others[0])
        where = self.burst.outside
        return rms(a - b, where) / (rms(single, where) / np.sqrt(count))

    def errors(self, iso, count):
        """RMSE by method, each where nothing moves and where something does."""
        paths, ours = next(self.results(iso, count))
        frames = [camera.samples_of(path) for path in paths]
        truth = self.burst.mosaics[0]
        results = {"single": frames[0], "average": np.mean(frames, axis=0), "merged": ours}
        return {name: [rms(result - truth, where) for where in (self.burst.outside, self.burst.swept)] for name, result in results.items()}


def noise_table(shots):
    print("| mosaic | ISO | " + " | ".join(f"{count} frames" for count in COUNTS[1:]) + " |\n" + "| --- " * (len(COUNTS) + 1) + "|")
    for mosaic, of_mosaic in shots.items():
        for iso in ISOS:
            cells = [geometric_mean([shot.noise(iso, count) for shot in of_mosaic]) for count in COUNTS[1:]]
            print(f"| {mosaic} | {iso} | " + " | ".join(f"{cell:.2f}" for cell in cells) + " |", flush=True)


def error_table(shots, count=6):
    print("| mosaic | ISO | single frame, RMSE x 1000 | plain average | merged | where something moves: plain average | merged |")
    print("| --- " * 7 + "|")
    for mosaic, of_mosaic in shots.items():
        for iso in ISOS:
            errors = [shot.errors(iso, count) for shot in of_mosaic]
            single = [geometric_mean([error["single"][where] for error in errors]) for where in (0, 1)]

            def ratio(name, where):
                return f"{geometric_mean([error[name][where] for error in errors]) / single[where]:.2f}"

            print(f"| {mosaic} | {iso} | {1000 * single[0]:.2f} | {ratio('average', 0)} | {ratio('merged', 0)} | {ratio('average', 1)} | "
                  f"{ratio('merged', 1)} |", flush=True)


def large_burst(shot, root, count):
    """DNG files of the paper's size: a burst repeated in both directions."""
    random = np.random.default_rng(3)
    folder = root / "large"
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, mosaic in enumerate(shot.burst.mosaics[:count]):
        paths.append(folder / f"{number:02}.dng")
        repeats = [-(-side // have) for side, have in zip(LARGE[::-1], mosaic.shape)]
        whole = np.tile(mosaic, repeats)[: LARGE[1], : LARGE[0]]
        camera.dng.write(paths[-1], camera.noisy(whole, 3200, random), cfa=shot.burst.cfa, black=camera.BLACK, white=camera.WHITE,
                         neutral=camera.NEUTRAL, color_matrix=camera.COLOR_MATRIX, iso=3200, shutter_s=1 / 60)
    return paths


def time_table(becalm, shots, root, count=6):
    print("| mosaic | seconds | processor seconds | processor seconds a megapixel and frame | peak memory, MiB | made of |")
    print("| --- " * 6 + "|")
    for mosaic, of_mosaic in shots.items():
        paths = large_burst(of_mosaic[0], root / mosaic, count)
        run, cost = timed([becalm, "burst", *paths, "-o", root / "large.dng", "--reference", "first", "--profile", "--overwrite"],
                          capture_output=True, text=True)
        megapixels = LARGE[0] * LARGE[1] * count / 1e6
        kernels = {}
        for kernel, ms in re.findall(r"^ +((?:align|burst)/\w+) .*?([\d.]+) ms$", run.stderr, re.MULTILINE):
            kernels[kernel] = kernels.get(kernel, 0.0) + float(ms)
        whole = sum(kernels.values())
        made_of = ", ".join(f"{kernel} {100 * ms / whole:.0f} %" for kernel, ms in sorted(kernels.items(), key=lambda item: -item[1])
                            if ms > 0.02 * whole)
        print(f"| {mosaic} | {cost.wall_s:.1f} | {cost.processor_s:.1f} | {cost.processor_s / megapixels:.3f} | {cost.peak_mib:.0f} | {made_of} |",
              flush=True)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench burst", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: {', '.join(REPORTED)}")
    parser.add_argument("--choosing", action="store_true", help=f"the scenes that constants are chosen on: {', '.join(CHOOSING)}")
    parser.add_argument("--mosaic", action="append", choices=list(camera.MOSAICS), help="one alone (default: both)")
    parser.add_argument("--table", action="append", choices=["noise", "error", "time"], help="one alone (default: all)")
    parser.add_argument("--option", action="append", default=[], help="of becalm burst, such as --option=--set=blur_radius=2")
    parser.add_argument("--becalm", default="build/release/becalm")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/burst"), metavar="DIR")
    asked = parser.parse_args()
    scenes = asked.scenes or (CHOOSING if asked.choosing else REPORTED)
    tables = asked.table or ["noise", "error", "time"]
    shots = {mosaic: [Shot(asked.becalm, scene, mosaic, asked.output, asked.option) for scene in scenes]
             for mosaic in asked.mosaic or camera.MOSAICS}
    if "noise" in tables:
        print("Noise where nothing moves, in that of a single frame over the root of the number of frames:\n")
        noise_table(shots)
    if "error" in tables:
        print("\nRMSE of six frames, in that of a single frame:\n")
        error_table(shots)
    if "time" in tables:
        print(f"\nSix frames of {LARGE[0]}x{LARGE[1]} px, and what the device's time is made of:\n")
        time_table(asked.becalm, shots, asked.output)


if __name__ == "__main__":
    main()
