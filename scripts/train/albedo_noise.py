"""Noise for clean albedos, as coats make it that mirror some of a pixel's samples; the truth is known exactly. Some albedos are fine
patterns instead, with and without noise. blurred_layers.py has the noise of blur."""

import numpy as np
import torch
import torch.nn.functional as F

import patterns

SHARE = 0.4  # of the crops
PATTERNED = 0.7  # of these
WITHOUT_NOISE = 0.7  # of the patterned ones
IN_PART = 0.4  # of those with noise
MOST_SAMPLES = 32


def sample_count(rng):
    return int(round(MOST_SAMPLES ** rng.random()))


def smooth_field(rng, size, most_bends=6):
    """Values within [0, 1], float32, that vary over `size` / `most_bends` pixels or more."""
    coarse = torch.from_numpy(rng.random((1, 1, *rng.integers(2, most_bends + 1, 2)), np.float32))
    return F.interpolate(coarse, size=(size, size), mode="bilinear", align_corners=True)[0, 0].numpy()


def coated(rng, clean):
    """(noisy, truth) where a share of the samples is mirrored by a coat, which counts as white or tinted."""
    count = sample_count(rng)
    share = smooth_field(rng, clean.shape[-1])
    coat = np.ones((3, 1, 1)) if rng.random() < 0.5 else rng.random((3, 1, 1))
    mixed = lambda mirrored: clean + mirrored * (coat - clean)
    return mixed(rng.binomial(count, share) / count), mixed(share)


def with_noise(rng, clean):
    """(noisy, truth), float32, from an albedo (3, size, size) without noise, or from a pattern in its place."""
    size = clean.shape[-1]
    noisy = truth = clean.astype(np.float64)
    if rng.random() < PATTERNED:
        noisy, truth = patterns.random_pattern(rng, size)
        if rng.random() < WITHOUT_NOISE:
            return noisy, truth
    made = coated(rng, truth.astype(np.float64))
    noised = smooth_field(rng, size) < 0.5 if rng.random() < IN_PART else True
    return [np.where(noised, a, b).astype(np.float32) for a, b in zip(made, (noisy, truth))]
