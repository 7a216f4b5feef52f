"""What rendered shots hardly show: textures of hardly any noise, and fireflies of the frame itself."""

import numpy as np

CELLS = [1, 2, 3, 4, 6]  # pixels
LEAST_NOISE, LARGEST_NOISE = 0.003, 0.09  # relative
BARE = 0.7  # of the textures: no feature shows them
WITHOUT_VARIANCE = 0.25
FIREFLIES = 0.003  # of the pixels


def random_texture(rng, size):
    """Even cells of random colours, as (3, size, size)."""
    cell = rng.choice(CELLS)
    count = -(-size // cell)
    colours = rng.random((3, count, count)) * rng.random() + rng.random((1, count, count)) * rng.random() + 0.05
    return colours.repeat(cell, 1).repeat(cell, 2)[:, :size, :size].astype(np.float32)


def textured_crop(rng, size, history=1):
    """A crop as batches.crop has it, of a texture; what is to be smoothed has `history` times the frame's samples."""
    texture = random_texture(rng, size)
    noise = np.exp(rng.uniform(np.log(LEAST_NOISE), np.log(LARGEST_NOISE)))
    noisy = lambda deviation: texture * (1 + deviation * rng.normal(size=texture.shape))
    first = noisy(noise)
    own = noisy(noise * np.sqrt(history)) if history > 1 else first
    told = history > 1 or rng.random() >= WITHOUT_VARIANCE
    variance = ((noise * texture) ** 2).mean(0, keepdims=True) if told else np.full((1, size, size), -1.0)
    features = np.zeros((7, size, size))
    features[:3] = 1.0 if rng.random() < BARE else texture.clip(0, 1)
    arrays = np.concatenate([first, own]), variance, np.concatenate([features] * 2), np.stack([texture, texture])
    return [a.astype(np.float32) for a in arrays]


def with_fireflies(rng, own):
    """The frame's own radiance with single pixels of 10 to 1e6."""
    hit = rng.random(own.shape[1:]) < FIREFLIES
    return np.where(hit, np.float32(10 ** rng.uniform(1, 6)), own)
