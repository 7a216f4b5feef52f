"""Synthetic pairs of frames whose motion is known in every pixel."""

import numpy as np

from benches.align.pair import Pair
from benches.align.warp import pixel_grid

NOISE_SEED = 7


def _lattice(ix, iy, seed):
    """A random number in [0,1) for each integer point."""
    mask = np.uint64(0xFFFFFFFFFFFFFFFF)
    h = (ix.astype(np.int64).astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
         ^ iy.astype(np.int64).astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F) ^ np.uint64(seed)) & mask
    h = (h ^ (h >> np.uint64(31))) * np.uint64(0xD6E8FEB86659FD93)
    h = (h ^ (h >> np.uint64(32))) * np.uint64(0xD6E8FEB86659FD93)
    return (h >> np.uint64(40)).astype(np.float64) / 2**24


def _value_noise(x, y, seed):
    fx, fy = np.floor(x), np.floor(y)
    tx, ty = x - fx, y - fy
    tx, ty = (t * t * t * (t * (6 * t - 15) + 10) for t in (tx, ty))
    a, b = _lattice(fx, fy, seed), _lattice(fx + 1, fy, seed)
    c, d = _lattice(fx, fy + 1, seed), _lattice(fx + 1, fy + 1, seed)
    return (a * (1 - tx) + b * tx) * (1 - ty) + (c * (1 - tx) + d * tx) * ty


def texture(x, y, seed=3):
    """A smooth function of the position in pixels, in [0,1]: octaves with wavelengths of 6, 24 and 96 px."""
    return sum(w * _value_noise(x / s, y / s, seed + i) for i, (w, s) in enumerate([(0.4, 6), (0.3, 24), (0.3, 96)]))


def noisy(plane, sigma, seed):
    """The plane with white Gaussian noise of standard deviation sigma, clipped to [0,1]."""
    return np.clip(plane + np.random.default_rng(seed).normal(0.0, sigma, plane.shape), 0.0, 1.0).astype(np.float32)


def _grey(plane):
    return np.repeat(plane[..., None], 3, axis=2).astype(np.float32)


def _pair(name, sigma, clean_target, clean_source, truth, visible):
    clean = [_grey(plane) for plane in (clean_target, clean_source)]
    target, source, other_target, other_source = (
        _grey(noisy((clean_target, clean_source)[i % 2], sigma, NOISE_SEED + i)) for i in range(4))
    return Pair(name=name, noise=f"{100 * sigma:g} %", target={"beauty": target}, source={"beauty": source}, other_target=other_target,
                other_source=other_source, clean_target=clean[0], clean_source=clean[1], halves_target=[clean[0]] * 2,
                halves_source=[clean[1]] * 2, visible=visible, truth=truth.astype(np.float32))


def _inside(x, y, shape):
    return (x >= 0) & (x <= shape[1] - 1) & (y >= 0) & (y <= shape[0] - 1)


def shift_pair(shape, sigma, shift=(7.25, -12.5)):
    """A texture displaced by `shift` in pixels."""
    x, y = pixel_grid(shape)
    truth = np.broadcast_to(np.array(shift, np.float32), (*shape, 2))
    return _pair("shift", sigma, texture(x, y), texture(x - shift[0], y - shift[1]), truth,
                 _inside(x + shift[0], y + shift[1], shape))


def zoom_pair(shape, sigma, zoom=1.04, angle_deg=3.0):
    """A texture zoomed and rotated about the centre."""
    x, y = pixel_grid(shape)
    cx, cy = (shape[1] - 1) / 2, (shape[0] - 1) / 2
    c, s = zoom * np.cos(np.radians(angle_deg)), zoom * np.sin(np.radians(angle_deg))
    # The target's point p lies at M p in the source, so the source's point q shows what is at M^-1 q.
    truth = np.stack([c * (x - cx) - s * (y - cy) + cx - x, s * (x - cx) + c * (y - cy) + cy - y], axis=-1)
    d = c * c + s * s
    back = ((c * (x - cx) + s * (y - cy)) / d + cx, (-s * (x - cx) + c * (y - cy)) / d + cy)
    return _pair("zoom", sigma, texture(x, y), texture(*back), truth, _inside(x + truth[..., 0], y + truth[..., 1], shape))
