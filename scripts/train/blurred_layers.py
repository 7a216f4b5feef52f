"""Things before each other, blurred by a lens and by motion, as few samples a pixel show them: albedo, normal and depth of every sample are
those of the first thing that its ray meets. Some things mirror others in part of their samples. The truth is the mean of many samples.

    blurred_layers.py DATA [--count N]    writes DATA/blurred.npz; some things have colours of the shots in DATA
"""

import argparse
import os

import numpy as np

import shots
from albedo_noise import smooth_field
from patterns import GOLDEN, Pattern

FILE = "blurred.npz"
SIZE = 128
MOST_THINGS = 4  # behind each other, the background included
LARGEST_RADIUS_PX = 14.0  # of a circle of confusion
SHARP = 0.3  # share of things without blur by the lens
MOVING = 0.35  # share of things
LARGEST_MOTION_PX = 24.0
MIRRORING = 0.3  # share of things
EMPTY_BACKGROUND = 0.15
FILTER_PX = 0.4  # standard deviation of the pixel filter
MOST_SAMPLES = 32
SAMPLES_OF_TRUTH = 72
MARGIN = 32  # pixels around, from which blur takes


def random_shape(rng, size):
    """Which pixels a thing covers: blobs, a disk, one side of a line, bars or boxes."""
    y, x = np.mgrid[:size, :size].astype(np.float32)
    kind = rng.integers(5)
    if kind == 0:
        return smooth_field(rng, size, 12) < rng.uniform(0.3, 0.6)
    centre = rng.uniform(0.2, 0.8, 2) * size
    turn = rng.random() * np.pi
    along = np.cos(turn) * (x - centre[0]) + np.sin(turn) * (y - centre[1])
    across = np.cos(turn) * (y - centre[1]) - np.sin(turn) * (x - centre[0])
    if kind == 1:
        return along**2 + (across * rng.uniform(0.7, 3.0)) ** 2 < rng.uniform(4.0, 0.4 * size) ** 2
    if kind == 2:
        return along > 0
    if kind == 3:
        period = rng.uniform(6.0, 50.0)
        return along % period < rng.uniform(0.1, 0.6) * period
    return (np.abs(along) < rng.uniform(2.0, 0.3 * size)) & (np.abs(across) < rng.uniform(2.0, 0.3 * size))


def random_colours(rng, size, clean):
    """(3, size, size): one colour, two that blend, a pattern, or a cut of a clean albedo."""
    kind = rng.choice(4, p=(0.3, 0.2, 0.25, 0.25))
    one = rng.random((3, 1, 1), np.float32) ** rng.uniform(0.5, 2.0)
    if kind == 0:
        return np.broadcast_to(one, (3, size, size))
    if kind == 1:
        share = smooth_field(rng, size)
        return one * share + rng.random((3, 1, 1), np.float32) * (1.0 - share)
    if kind == 2:
        y, x = np.mgrid[:size, :size].astype(np.float32)
        return Pattern(rng, size).at(x, y)
    extra = size - clean.shape[-1]
    before = rng.integers(0, extra + 1, 2)
    return np.pad(clean, ((0, 0), *((b, extra - b) for b in before)), mode="symmetric")


class Things:
    """A random scene; what a ray meets is found by its pixel, a point of the lens and a time."""

    def __init__(self, rng, size, clean):
        self.size, self.side = size, size + 2 * MARGIN
        self.count = rng.integers(2, MOST_THINGS + 1)
        side, count = self.side, self.count
        self.shapes = [random_shape(rng, side) for _ in range(count - 1)] + [np.ones((side, side), bool)]
        self.radii = [0.0 if rng.random() < SHARP else LARGEST_RADIUS_PX ** rng.uniform(-0.2, 1.0) for _ in range(count)]
        self.motions = [rng.normal(size=2).clip(-2, 2) * rng.random() ** 2 * LARGEST_MOTION_PX / 4 if rng.random() < MOVING else np.zeros(2)
                        for _ in range(count)]
        self.mirrored = [rng.uniform(0.1, 0.8) * smooth_field(rng, side) if rng.random() < MIRRORING else None for _ in range(count)]
        depths = np.sort(rng.uniform(0.1, 1.9, count))
        self.seen = np.empty((count + 1, side, side, 7), np.float32)  # the last is what mirrors show
        for i in range(count + 1):
            normal = rng.normal(size=(3, 1, 1)) + 0.7 * rng.random() * np.stack([smooth_field(rng, side) - 0.5 for _ in range(3)])
            self.seen[i, ..., :3] = random_colours(rng, side, clean).transpose(1, 2, 0)
            self.seen[i, ..., 3:6] = (normal / np.linalg.norm(normal, axis=0)).transpose(1, 2, 0)
            self.seen[i, ..., 6] = depths[min(i, count - 1)] + 0.1 * smooth_field(rng, side)
        if rng.random() < EMPTY_BACKGROUND:
            self.seen[count - 1, ..., :3] = rng.integers(2)
            self.seen[count - 1, ..., 3:] = 0.0
        self.seen = self.seen.reshape(-1, 7)

    def mean_of(self, rng, samples):
        """Albedo, normal and depth (7, size, size) by so many samples a pixel, which are spread evenly from a random one."""
        n, side = self.size * self.size, self.side
        y, x = (a.ravel().astype(np.float32) + MARGIN for a in np.mgrid[: self.size, : self.size])
        start = rng.random((4, n), np.float32)
        sum_ = np.zeros((n, 7), np.float32)
        for i in range(samples):
            u = (start + np.float32(i) * np.float32([*GOLDEN, 0.6180339887, 0.4142135624])[:, None]) % 1
            r, angle = np.sqrt(u[0]), np.float32(2 * np.pi) * u[1]
            lens_x, lens_y, time = r * np.cos(angle), r * np.sin(angle), u[2] - np.float32(0.5)
            filter_x, filter_y = FILTER_PX * rng.standard_normal((2, n), np.float32)
            found = np.full(n, -1)
            for k in range(self.count):
                at_x = x + filter_x + np.float32(self.radii[k]) * lens_x + np.float32(self.motions[k][0]) * time
                at_y = y + filter_y + np.float32(self.radii[k]) * lens_y + np.float32(self.motions[k][1]) * time
                place = np.rint(at_y).astype(np.int32).clip(0, side - 1) * side + np.rint(at_x).astype(np.int32).clip(0, side - 1)
                met = (found < 0) & self.shapes[k].ravel()[place]
                here = k * side * side + place
                if self.mirrored[k] is not None:
                    here = np.where(u[3] < self.mirrored[k].ravel()[place], self.count * side * side + place, here)
                found = np.where(met, here, found)
            sum_ += self.seen[found]
        return np.ascontiguousarray((sum_ / np.float32(samples)).T.reshape(7, self.size, self.size))


def random_blur(rng, clean):
    """(noisy, truth), float32 of (7, size, size): albedo, normal, depth; of things some of which look like `clean`, an albedo."""
    things = Things(rng, clean.shape[-1], clean)
    return things.mean_of(rng, int(round(MOST_SAMPLES ** rng.random()))), things.mean_of(rng, SAMPLES_OF_TRUTH)


def made_pairs(folder):
    """Pairs of albedos from FILE, if it is there."""
    path = os.path.join(folder, FILE)
    if not os.path.exists(path):
        return []
    with np.load(path) as packed:
        both = zip(packed["noisy"], packed["truth"])
    return shots.of_albedo([shots.Pair(f"blurred/{i}", None, [], list(pair), [None, None]) for i, pair in enumerate(both)])


def clean_albedos(data):
    """(3, height, width), float32: one of each shot that is learned from."""
    pairs = [shots.load_shot(folder)[:1] for folder in shots.complete_shots(data, of_albedo=True) if not shots.is_held_out(folder)]
    return [pair.features[1][:3].astype(np.float32) for first in pairs for pair in first]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    rng = np.random.default_rng(asked.seed)
    albedos = clean_albedos(asked.data)
    noisy, truth = np.empty((2, asked.count, 7, SIZE, SIZE), np.float16)
    for i in range(asked.count):
        clean = albedos[rng.integers(len(albedos))]
        y, x = (rng.integers(length - SIZE + 1) for length in clean.shape[1:])
        noisy[i], truth[i] = random_blur(rng, clean[:, y : y + SIZE, x : x + SIZE])
    np.savez(os.path.join(asked.data, FILE), noisy=noisy, truth=truth)


if __name__ == "__main__":
    main()
