"""Fine regular textures as a renderer sees them, with few samples a pixel and without noise: stripes, weaves, tiles, dots. Their periods
reach from two pixels to a dozen, and change across the picture as in perspective. A network that has not seen them takes them
for noise."""

import numpy as np

PERIODS_PX = 1.8, 14.0
MOST_SAMPLES = 32
SAMPLES_OF_TRUTH = 32
GOLDEN = 0.7548776662466927, 0.5698402909980532  # steps of the R2 sequence
LARGEST_STRETCH = 0.7  # how much the period changes across half the picture
LARGEST_BEND_PX = 4.0  # of waves along each axis, as of folded cloth
WAVES_PX = 20.0, 80.0  # their lengths
STRAIGHT = 0.3  # share of patterns along rows and columns


class Pattern:
    """Colours over the plane, of `size` pixels a side."""

    def __init__(self, rng, size):
        self.size = size
        self.turn = np.float32(0.0) if rng.random() < STRAIGHT else np.float32(rng.random() * np.pi)
        shortest, longest = PERIODS_PX
        self.periods = np.float32(shortest * (longest / shortest) ** rng.random(2))
        if rng.random() < 0.5:
            self.periods[1] = self.periods[0]
        self.stretch = rng.uniform(-LARGEST_STRETCH, LARGEST_STRETCH, 2).astype(np.float32)
        self.bend = np.float32(rng.uniform(0.0, LARGEST_BEND_PX, 2) * (rng.random() < 0.5))
        self.waves = np.float32(rng.uniform(*WAVES_PX, 2) / (2.0 * np.pi))
        self.phase = rng.random(2, np.float32)
        self.width = rng.uniform(0.2, 0.8)
        self.kind = KINDS[rng.integers(len(KINDS))]
        of_any_colour, of_two = rng.random((3, 64, 64), np.float32), rng.random((3, 2), np.float32)[:, rng.integers(0, 2, (64, 64))]
        self.cells = of_any_colour if rng.random() < 0.5 else of_two
        contrast = rng.random()
        self.colours = np.float32(rng.random((3, 1)) * (1.0 - contrast) + contrast * rng.random((3, 3)))

    def at(self, x, y):
        """Colours (3, ...) at positions in pixels."""
        x, y = x - 0.5 * self.size, y - 0.5 * self.size
        skew = x * y / self.size
        x, y = (x + self.stretch[0] * skew + self.bend[0] * np.sin(y / self.waves[0]),
                y + self.stretch[1] * skew + self.bend[1] * np.sin(x / self.waves[1]))
        along, across = np.cos(self.turn) * x + np.sin(self.turn) * y, np.cos(self.turn) * y - np.sin(self.turn) * x
        return self.kind(self, along / self.periods[0] + self.phase[0], across / self.periods[1] + self.phase[1])

    def mean_of(self, rng, samples):
        """The picture (3, size, size) of so many samples a pixel, which are spread evenly from a random one."""
        y, x = np.mgrid[: self.size, : self.size].astype(np.float32)
        start = rng.random((2, self.size, self.size), np.float32)
        inside = lambda axis, i: (start[axis] + np.float32(i * GOLDEN[axis])) % 1
        return sum(self.at(x + inside(0, i), y + inside(1, i)) for i in range(samples)) / samples


def _of_two(pattern, second):
    return pattern.colours[:, second.astype(np.int8)]


def stripes(pattern, u, v):
    return _of_two(pattern, u % 1.0 < pattern.width)


def soft_stripes(pattern, u, v):
    share = 0.5 + 0.5 * np.sin(2.0 * np.pi * u)
    return pattern.colours[:, 0, None, None] * share + pattern.colours[:, 1, None, None] * (1.0 - share)


def chequers(pattern, u, v):
    return _of_two(pattern, (np.floor(u) + np.floor(v)) % 2 == 0)


def dots(pattern, u, v):
    return _of_two(pattern, (u % 1.0 - 0.5) ** 2 + (v % 1.0 - 0.5) ** 2 < (0.5 * pattern.width) ** 2)


def grid(pattern, u, v):
    return _of_two(pattern, np.minimum(u % 1.0, v % 1.0) < 0.5 * pattern.width)


def weave(pattern, u, v):
    """Threads of two colours above a ground of a third."""
    across, along = u % 1.0 < pattern.width, v % 1.0 < pattern.width
    over = (np.floor(u) + np.floor(v)) % 2 == 0
    which = np.where(across & (over | ~along), 1, np.where(along, 2, 0))
    return pattern.colours[:, which]


def cells(pattern, u, v):
    """Cells of any colours, or of two at random."""
    return pattern.cells[:, np.floor(u).astype(int) % 64, np.floor(v).astype(int) % 64]


KINDS = stripes, soft_stripes, chequers, dots, grid, weave, cells


def random_pattern(rng, size):
    """(noisy, truth) of a random pattern, (3, size, size)."""
    pattern = Pattern(rng, size)
    samples = int(round(MOST_SAMPLES ** rng.random()))
    return pattern.mean_of(rng, samples), pattern.mean_of(rng, SAMPLES_OF_TRUTH)
