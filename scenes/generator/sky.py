"""Skies without a sun's disc, for scenes that have a sun of their own."""

import numpy as np

from .files import few_bits
from .texture import fractal


def clear_sky(horizon, zenith, glow, ground, sun_elevation, cirrus=0.0, width=256, height=128):
    """Latitude-longitude, brightest around the centre column, where the sun belongs. horizon, zenith, glow and ground
    are radiances; the ground begins at the horizon with the horizon's own and darkens downward, so that what ends
    before the horizon fades into it. cirrus: strength of high thin clouds."""
    elevation = np.radians(90 - (np.arange(height) + 0.5) * 180 / height)[:, None]
    azimuth = np.radians((np.arange(width) + 0.5) * 360 / width - 180)[None, :]
    up = np.sin(elevation)
    horizon, zenith, glow, ground = (np.array(c, float) for c in (horizon, zenith, glow, ground))
    image = horizon + (zenith - horizon) * (np.clip(up, 0, 1) ** 0.4)[..., None] + np.zeros((height, width, 1))
    image = np.where((up < 0)[..., None], ground + (horizon - ground) * np.exp(np.clip(up, -1, 0) * 14)[..., None], image)

    sun = np.radians(sun_elevation)
    cosine = np.cos(elevation) * np.cos(azimuth) * np.cos(sun) + up * np.sin(sun)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    above = np.clip(up * 8 + 0.6, 0, 1)
    image += glow * ((0.6 * np.exp(-angle / 7) + 0.4 * np.exp(-angle / 26)) * above)[..., None]

    if cirrus > 0:
        # On a plane overhead, so that they draw together towards the horizon.
        reach = 1 / np.clip(up + 0.12, 0.05, None)
        x, y = np.sin(azimuth) * np.cos(elevation) * reach, np.cos(azimuth) * np.cos(elevation) * reach
        field = fractal(512, 3, 6, 41)
        streaks = field[((y * 30) % 512).astype(int), ((x * 90 + y * 40) % 512).astype(int)]
        cover = np.clip((streaks - 0.45) * 2.5, 0, 1) * np.clip(up * 6, 0, 1)
        image += cirrus * cover[..., None] * (horizon + 0.8 * glow * np.exp(-angle / 30)[..., None])
    return few_bits(image)


def morning_sky():
    return clear_sky((0.62, 0.74, 0.90), (0.10, 0.25, 0.62), (0.9, 0.72, 0.45), (0.18, 0.20, 0.22), 30)


def evening_sky():
    return clear_sky((0.50, 0.38, 0.33), (0.06, 0.11, 0.26), (1.5, 0.72, 0.22), (0.03, 0.045, 0.06), 8, cirrus=0.5)


SKIES = {"morning_sky": morning_sky, "evening_sky": evening_sky}
