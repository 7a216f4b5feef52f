"""Noise for clean albedos, of the two kinds that renderers write: of coats that mirror some of a pixel's samples, and of blur by lens
or motion, where each sample sees another place. The truth is known exactly, and such shots are rare among random ones. Some albedos
are tiled instead, with and without noise: fine tiles of two colours must not be taken for it."""

import numpy as np
import torch
import torch.nn.functional as F

SHARE = 0.35  # of the crops
TILED = 0.6  # of these
WITHOUT_NOISE = 0.5  # of the tiled ones
MOST_SAMPLES = 32
LARGEST_BLUR = 6  # radius in pixels


def sample_count(rng):
    return int(round(MOST_SAMPLES ** rng.random()))


def smooth_field(rng, size):
    """Values within [0, 1] that vary over tens of pixels."""
    side = rng.integers(2, 7)
    coarse = torch.from_numpy(rng.random((1, 1, side, side)))
    return F.interpolate(coarse, size=(size, size), mode="bilinear", align_corners=True)[0, 0].numpy()


def tiles(rng, size):
    """Tiles of two colours, in turn or at random, or of any colours; of 1 to 12 pixels, turned at random or not at all."""
    y, x = np.mgrid[:size, :size].astype(np.float64)
    angle = rng.choice([0.0, rng.random() * np.pi])
    along, across = np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x
    sides = 12.0 ** rng.random(2)
    if angle == 0.0:
        sides = sides.round()
    column, row = (np.floor(v / side + rng.random()).astype(int) for v, side in zip((along, across), sides))
    column, row = column - column.min(), row - row.min()
    kind = rng.integers(3)
    if kind == 2:
        return rng.random((3, column.max() + 1, row.max() + 1))[:, column, row]
    which = (column + row) % 2 if kind == 0 else rng.integers(0, 2, (column.max() + 1, row.max() + 1))[column, row]
    return rng.random((3, 2))[:, which]


def coated(rng, clean):
    """(noisy, truth) where a share of the samples is mirrored by a coat, which counts as white or tinted."""
    count = sample_count(rng)
    share = smooth_field(rng, clean.shape[-1])
    coat = np.ones((3, 1, 1)) if rng.random() < 0.5 else rng.random((3, 1, 1))
    mixed = lambda mirrored: clean + mirrored * (coat - clean)
    return mixed(rng.binomial(count, share) / count), mixed(share)


def blurred(rng, clean):
    """(noisy, truth) where the samples are spread over a square around the pixel."""
    count, radius = sample_count(rng), rng.integers(1, LARGEST_BLUR + 1)
    size = clean.shape[-1]
    padded = F.pad(torch.from_numpy(clean)[None], (radius,) * 4, mode="replicate")
    truth = F.avg_pool2d(padded, 2 * radius + 1, 1)[0].numpy()
    y, x = np.mgrid[:size, :size]
    around = lambda: rng.integers(0, 2 * radius + 1, (size, size))
    noisy = sum(padded[0].numpy()[:, y + around(), x + around()] for _ in range(count)) / count
    return noisy, truth


def with_noise(rng, clean):
    """(noisy, truth), float32, from an albedo (3, size, size) without noise, or from tiles in its place."""
    clean = clean.astype(np.float64)
    if rng.random() < TILED:
        clean = tiles(rng, clean.shape[-1])
        if rng.random() < WITHOUT_NOISE:
            return [clean.astype(np.float32)] * 2
    make = coated if rng.random() < 0.5 else blurred
    return [image.astype(np.float32) for image in make(rng, clean)]
