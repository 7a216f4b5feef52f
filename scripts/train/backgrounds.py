"""Clean, bright backgrounds behind a crop: a sky between leaves, a sun beside it. Rendered shots have few pixels of the kind."""

from dataclasses import dataclass

import numpy as np

SUBPIXELS = 4  # along an axis, by which the coverage of a pixel is found
REFERENCE_SAMPLES = 256
DEPTH = 6  # channel of a feature set, after three of albedo and three of the normal


@dataclass
class Background:
    radiance: np.ndarray  # (3, size, size)
    noise: float  # relative deviation of a pixel that shows nothing else
    coverage: np.ndarray  # (size, size), the share of a pixel that shows it
    albedo: np.ndarray  # (3, size, size), what the renderer calls its albedo
    samples: int  # of a pixel of the noisy frame


def smooth_field(rng, size, period):
    """Values of about unit deviation that vary over `period` pixels."""
    cells = max(2, int(np.ceil(size / period)) + 1)
    values = rng.normal(size=(cells + 1, cells + 1))
    at = np.arange(size) / period + rng.random()
    at = at.clip(0, cells - 1e-6)
    low = at.astype(int)
    share = at - low
    share = share * share * (3 - 2 * share)
    rows = values[low] + (values[np.minimum(low + 1, cells)] - values[low]) * share[:, None]
    return rows[:, low] + (rows[:, np.minimum(low + 1, cells)] - rows[:, low]) * share


def random_radiance(rng, size):
    """An even sky with detail, or with a small light that is up to 10,000 times as bright."""
    tint = np.exp(0.3 * rng.normal(size=(3, 1, 1)))
    level = np.exp(0.5 + 1.5 * rng.normal())
    radiance = np.exp(rng.uniform(0, 0.3) * smooth_field(rng, size, rng.uniform(4, 40)))
    if rng.random() < 0.4:
        detail = smooth_field(rng, size, rng.uniform(1.5, 8)) > rng.uniform(0, 1.5)
        radiance = np.where(detail, radiance * np.exp(rng.uniform(-1, 2.5)), radiance)
    if rng.random() < 0.4:
        y, x = np.mgrid[:size, :size] - rng.uniform(0, size, (2, 1, 1))
        disc = (rng.uniform(0.5, 10) + 0.5 - np.hypot(x, y)).clip(0, 1)
        radiance = radiance + disc * 10 ** rng.uniform(1, 4)
    return (level * tint * radiance).astype(np.float32)


def random_background(rng, size):
    fine = SUBPIXELS * size
    shape = smooth_field(rng, fine, SUBPIXELS * np.exp(rng.uniform(np.log(2), np.log(40)))) > rng.normal() * 0.7
    coverage = shape.reshape(size, SUBPIXELS, size, SUBPIXELS).mean((1, 3))
    radiance = random_radiance(rng, size)
    albedo = [np.zeros_like(radiance), np.ones_like(radiance), radiance.clip(0, 1)][rng.integers(3)]
    samples = int(2 ** rng.integers(1, 7))
    return Background(radiance, rng.choice([0.0, 0.005, 0.02]), coverage, albedo, samples)


def seen(rng, background, samples):
    """The share of the pixel's samples that meet the background."""
    return rng.binomial(samples, background.coverage) / samples


def noisy(rng, background, samples):
    sigma = background.noise * np.sqrt(background.samples / samples)
    return background.radiance * (1 + sigma * rng.normal(size=background.radiance.shape[1:]))


def put_behind(rng, background, colors, variance, features, references, history=1):
    """Shows the background in a crop: radiance to smooth and own (6 channels), its variance (1, or negative if unknown),
    features of both (14 channels), two references. The radiance to smooth has `history` times the frame's samples."""
    many = background.samples * history
    shares = [seen(rng, background, many), seen(rng, background, background.samples)]
    lights = [noisy(rng, background, many), noisy(rng, background, background.samples)]
    if history == 1:
        shares[1], lights[1] = shares[0], lights[0]
    mix = lambda before, behind, share: (1 - share) * before + share * behind
    difference = ((background.radiance - colors[:3]) ** 2).mean(0)
    told = (background.noise * background.radiance) ** 2 / history
    share = shares[0]
    of_share = share * (1 - share) / max(many - 1, 1)  # its variance; the difference has the pixel's noise too, which counts once
    changed = ((1 - share) ** 2 - of_share) * variance + share**2 * told.mean(0) + of_share * difference
    variance = np.where(variance < 0, variance, changed)
    colors = np.concatenate([mix(colors[:3], lights[0], shares[0]), mix(colors[3:], lights[1], shares[1])])
    both = []
    for own, share in zip((features[:7], features[7:]), shares):
        behind = np.zeros_like(own)
        behind[:3] = background.albedo
        behind[DEPTH] = 2.0  # infinitely far: shots.packed_features
        both.append(mix(own, behind, share))
    references = np.stack([mix(r, background.radiance, seen(rng, background, REFERENCE_SAMPLES)) for r in references])
    return colors, variance, np.concatenate(both), references
