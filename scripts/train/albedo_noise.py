"""Noise for clean albedos, of the two kinds that renderers write: of coats that mirror some of a pixel's samples, and of blur by lens
or motion, where each sample sees another place. The truth is known exactly, and such shots are rare among random ones. Some albedos
are fine patterns instead, with and without noise."""

import numpy as np
import torch
import torch.nn.functional as F

import patterns

SHARE = 0.6  # of the crops
PATTERNED = 0.7  # of these
WITHOUT_NOISE = 0.7  # of the patterned ones
IN_PART = 0.4  # of those with noise
MOST_SAMPLES = 32
LARGEST_BLUR = 6  # radius in pixels


def sample_count(rng):
    return int(round(MOST_SAMPLES ** rng.random()))


def smooth_field(rng, size):
    """Values within [0, 1] that vary over tens of pixels."""
    side = rng.integers(2, 7)
    coarse = torch.from_numpy(rng.random((1, 1, side, side)))
    return F.interpolate(coarse, size=(size, size), mode="bilinear", align_corners=True)[0, 0].numpy()


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
    """(noisy, truth), float32, from an albedo (3, size, size) without noise, or from a pattern in its place."""
    size = clean.shape[-1]
    noisy = truth = clean.astype(np.float64)
    if rng.random() < PATTERNED:
        noisy, truth = patterns.random_pattern(rng, size)
        if rng.random() < WITHOUT_NOISE:
            return noisy, truth
    make = coated if rng.random() < 0.5 else blurred
    made = make(rng, truth.astype(np.float64))
    noised = smooth_field(rng, size) < 0.5 if rng.random() < IN_PART else True
    return [np.where(noised, a, b).astype(np.float32) for a, b in zip(made, (noisy, truth))]
