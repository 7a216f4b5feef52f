"""Stereo pairs: RMSE, SSIM and reprojected stereo difference of the denoiser with and without the other eye, beside the table of Philippi,
Frisvad and Jensen, section 5.3; and the other eye's weight as estimated, beside fixed and true weights (figures 5 and 6). Called by
`scripts/bench stereo`."""

import argparse
import os
import statistics
from pathlib import Path

import cv2
import numpy as np

from benches.antialias.run import ssim
from benches.stereo.measures import Reprojection, squared_error
from benches.stereo.shots import CHOOSING, EYES, REPORTED, attribute, read, render
from benches.timed import timed

TEMPORAL = ["--set", "smooth=none"]  # as the paper has it: no smoothing
METHODS = {  # the options of becalm denoise
    "none": None,
    "temporal": [*TEMPORAL, "--no-stereo"],
    "temporal + stereo": TEMPORAL,
    "denoised": ["--no-stereo"],
    "denoised + stereo": [],
}
PUBLISHED = {  # RMSE and SSIM
    "spheres": {"none": (0.071, 0.591), "temporal": (0.023, 0.910), "temporal + stereo": (0.016, 0.958)},
    "statue": {"none": (0.046, 0.749), "temporal": (0.018, 0.960), "temporal + stereo": (0.017, 0.980)},
}
AOVS = "albedo,normal,depth,motion,variance"
REFERENCE_SPP = 256  # with 64 the true weight's RMSE is 7 % more (statue): its moments are the references'
WEIGHT_SPP = 16
COST_SIZE, COST_FRAMES, COST_RUNS = (960, 540), 4, 3


class Shot:
    """A rendered scene with its references."""

    def __init__(self, becalm, scene, root, size, frames):
        self.becalm, self.root, self.size, self.frames = becalm, root / scene, size, frames
        self.scene = scene
        self.measured = frames[2::2]
        self.of_reference = self.root / f"reference{REFERENCE_SPP}"
        render(becalm, scene, self.of_reference, self.measured, size, ["--spp", str(REFERENCE_SPP), "--seed", "7", "--aovs", "half_a,half_b,variance,depth"])
        self.reference, self.halves, self.reprojection = {}, {}, {}
        for frame in self.measured:
            self.reference[frame] = read(self.of_reference, frame)
            self.halves[frame] = [read(self.of_reference, frame, half) for half in ("half_a", "half_b")]
            self.reprojection[frame] = Reprojection(read(self.of_reference, frame, "depth"), attribute(self.of_reference, frame))

    def noisy(self, spp):
        folder = self.root / f"noisy{spp}"
        render(self.becalm, self.scene, folder, self.frames, self.size, ["--spp", str(spp), "--aovs", AOVS])
        return folder

    def reference_difference(self):
        return float(np.sqrt(max(np.mean([self.reprojection[f].difference(*self.halves[f]) for f in self.measured]), 0)))

    def measure(self, images):
        """RMSE, SSIM and root mean square stereo difference of {frame: both eyes}."""
        errors, likeness, differences = [], [], []
        for frame, pair in images.items():
            a, b = self.halves[frame]
            errors += [squared_error(pair[eye], a[eye], b[eye]) for eye in EYES]
            likeness += [ssim(pair[eye], self.reference[frame][eye]) for eye in EYES]
            differences.append(self.reprojection[frame].difference(pair))
        return np.sqrt(max(np.mean(errors), 0)), np.mean(likeness), np.sqrt(np.mean(differences))

    def energy(self, images):
        """Mean radiance of {frame: both eyes} over the reference's."""
        return sum(pair[eye].mean(dtype=float) for pair in images.values() for eye in EYES) / sum(
            self.reference[frame][eye].mean(dtype=float) for frame in images for eye in EYES)


def denoise(becalm, source, target, options):
    """Processor seconds."""
    return timed([becalm, "denoise", source / "f.####.exr", "-o", target / "f.####.exr", *options, "--overwrite", "--quiet"])[1].processor_s


def table(shot, spp, methods):
    noisy = shot.noisy(spp)
    print(f"| {shot.scene} | reference | | | | | {shot.reference_difference():.4f} |", flush=True)
    none = None
    for name, options in methods.items():
        folder = noisy if options is None else shot.root / name.replace(" ", "")
        if options is not None:
            denoise(shot.becalm, noisy, folder, options)
        error, likeness, difference = shot.measure({frame: read(folder, frame) for frame in shot.measured})
        none = error if none is None else none
        print(f"| {shot.scene} | {name} | {spp} | {error:.4f} | {error / none:.2f} | {likeness:.3f} | {difference:.4f} |", flush=True)
    if shot.scene in PUBLISHED:
        for name, (error, likeness) in PUBLISHED[shot.scene].items():
            print(f"| {shot.scene} | {name}, published | | {error:.3f} | {error / PUBLISHED[shot.scene]['none'][0]:.2f} | {likeness:.3f} | |")


def three_by_three(image):
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    return [padded[y : y + image.shape[0], x : x + image.shape[1]] for y in range(3) for x in range(3)]


def weights(shot):
    """Noisy frames blended with the other eye's, reprojected by depth, with each kind of weight."""
    noisy = shot.noisy(WEIGHT_SPP)
    folder = shot.root / "weights"
    denoise(shot.becalm, noisy, folder, [*TEMPORAL, "--set", "directions=forward", "--context", "none", "--cuts",
                                         ",".join(str(frame) for frame in shot.frames), "--diagnostics"])
    kinds = ("own eye alone", "fixed 0.5", "estimate of the paper", "ours", "true moments")
    images = {kind: {} for kind in kinds}
    chosen, true, published = [], [], []
    for frame in shot.measured:
        pair, estimated = read(noisy, frame), read(folder, frame, "stereo_weight")
        variance = {eye: image.mean(axis=2) * REFERENCE_SPP / WEIGHT_SPP for eye, image in read(shot.of_reference, frame, "variance").items()}
        a, b = shot.halves[frame]
        for kind in kinds:
            images[kind][frame] = {}
        for eye, other in (("left", "right"), ("right", "left")):
            own, reprojection = pair[eye], shot.reprojection[frame]
            theirs, sees = reprojection.warped(pair[other], eye)
            variance_theirs = reprojection.warped(variance[other][..., None], eye)[0] * reprojection.shrinking(eye)
            biases = [x[eye] - reprojection.warped(x[other], eye)[0] for x in (a, b)]
            # Moments of the references are noisy, too: means of 5x5 pixels.
            of_own, of_other, bias = (cv2.blur(image, (5, 5)) for image in (variance[eye], variance_theirs, (biases[0] * biases[1]).mean(axis=2)))
            best = 1 - of_own / np.maximum(np.maximum(bias, 0) + of_own + of_other, 1e-12)
            taps = np.stack(three_by_three(own))
            of_taps = np.maximum((taps**2).mean(axis=0) - taps.mean(axis=0) ** 2, 0).mean(axis=2)
            squares = np.mean([(theirs - tap) ** 2 for tap in three_by_three(own)], axis=0).mean(axis=2)
            paper = np.clip(1 - of_taps / np.maximum(squares, 1e-12), 0, 1)
            ours = 1 - estimated[eye][..., 0]
            chosen.append(ours[sees]), true.append(best[sees]), published.append(paper[sees])
            for kind, beta in zip(kinds, (np.ones_like(best), np.full_like(best, 0.5), paper, ours, best)):
                beta = np.where(sees, beta, 1)[..., None]
                images[kind][frame][eye] = beta * own + (1 - beta) * theirs
    for kind in kinds:
        error, likeness, difference = shot.measure(images[kind])
        estimate = {"ours": chosen, "estimate of the paper": published}.get(kind)
        beside = " | | "
        if estimate:
            e, t = np.concatenate(estimate), np.concatenate(true)
            beside = f"{e.mean():.3f} of {t.mean():.3f} | {np.sqrt(np.mean((e - t) ** 2)):.3f} | {np.corrcoef(e, t)[0, 1]:.2f}"
        print(f"| {shot.scene} | {kind} | {error:.4f} | {shot.energy(images[kind]):.3f} | {likeness:.3f} | {difference:.4f} | {beside} |", flush=True)


def cost(becalm, scene, root, spp):
    """Processor time of a pair of eyes over that of an eye by itself, with files, by runs that alternate."""
    frames = range(1, COST_FRAMES + 1)
    folder = root / f"{COST_SIZE[0]}x{COST_SIZE[1]}" / scene
    noisy = folder / f"noisy{spp}"
    render(becalm, scene, noisy, frames, COST_SIZE, ["--spp", str(spp), "--aovs", AOVS])
    for preset in ("draft", "balanced", "final"):
        apart, together = [], []
        for _ in range(COST_RUNS):
            for options, spent in ((["--no-stereo"], apart), ([], together)):
                spent.append(denoise(becalm, noisy, folder / "timed", ["--preset", preset, *options]) / COST_FRAMES)
        one, pair = statistics.median(apart) / 2, statistics.median(together)
        print(f"| {preset} | {one:.2f} | {pair:.2f} | {pair / one:.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench stereo", description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: {', '.join(REPORTED)}")
    parser.add_argument("--choosing", action="store_true", help=f"the shots that constants are chosen on: {', '.join(CHOOSING)}")
    parser.add_argument("--size", default="320x180", metavar="WxH")
    parser.add_argument("--frames", type=int, default=8, help="of each shot (default: 8)")
    parser.add_argument("--spp", type=int, default=2, help="of the first table (default: 2)")
    parser.add_argument("--becalm", default="build/release/becalm")
    parser.add_argument("-o", "--output", type=Path, default=Path("build/stereo"), metavar="DIR")
    asked = parser.parse_args()
    becalm = os.path.abspath(asked.becalm)
    size = tuple(int(side) for side in asked.size.split("x"))
    names = asked.scenes or (CHOOSING if asked.choosing else REPORTED)
    shots = [Shot(becalm, name, asked.output / asked.size, size, range(1, asked.frames + 1)) for name in names]
    print("| scene | method | spp | RMSE | of none's | SSIM | stereo difference |\n| --- | --- | --- | --- | --- | --- | --- |")
    for shot in shots:
        table(shot, asked.spp, METHODS)
    print(f"\nOne frame of {WEIGHT_SPP} samples, not smoothed, the other eye reprojected by depth. Energy is the\nmean radiance over the "
          "reference's. The last columns compare the weight of the own eye with that of\nthe true moments. The paper's estimate follows from the "
          "values that it weighs: it takes bright outliers\nout, which lowers both the error and the energy.\n")
    print("| scene | weight | RMSE | energy | SSIM | stereo difference | mean weight, of the true one | its RMSE | correlation |\n"
          "| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for shot in shots:
        weights(shot)
    print(f"\nProcessor seconds of a frame of {COST_SIZE[0]}x{COST_SIZE[1]}, files included:\n\n| preset | one eye | both eyes | ratio |\n| --- | --- | --- | --- |")
    cost(becalm, names[0], asked.output, asked.spp)


if __name__ == "__main__":
    main()
