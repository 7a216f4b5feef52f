"""Skies without a sun's disc, for scenes that have a sun of their own."""

import numpy as np

from .files import few_bits
from .texture import noise


def clear_sky(horizon, zenith, glow, ground, sun_elevation, streaks=0.0, width=256, height=128):
    """Latitude-longitude, brightest around the centre column, where the sun belongs. horizon, zenith, glow and ground
    are radiances; the ground begins at the horizon with the horizon's own and darkens downward, so that what ends
    before the horizon fades into it. streaks: strength of flat clouds above the horizon."""
    elevation = np.radians(90 - (np.arange(height) + 0.5) * 180 / height)[:, None]
    azimuth = np.radians((np.arange(width) + 0.5) * 360 / width - 180)[None, :]
    up = np.sin(elevation)
    horizon, zenith, glow, ground = (np.array(c, float) for c in (horizon, zenith, glow, ground))
    image = horizon + (zenith - horizon) * (np.clip(up, 0, 1) ** 0.4)[..., None] + np.zeros((height, width, 1))
    below = ground + (horizon - ground) * np.exp(14 * np.clip(up, -1, 0))[..., None]
    image = np.where((up < 0)[..., None], below, image)

    sun = np.radians(sun_elevation)
    cosine = np.cos(elevation) * np.cos(azimuth) * np.cos(sun) + up * np.sin(sun)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    above = np.clip(up * 8 + 0.6, 0, 1)
    image += glow * ((0.6 * np.exp(-angle / 7) + 0.4 * np.exp(-angle / 26)) * above)[..., None]

    if streaks > 0:
        field = 0.6 * noise(width, (48, 7), 41) + 0.4 * noise(width, (96, 18), 42)
        cover = np.clip((field[:height] - 0.5) * 3, 0, 1) * np.clip(up * 9, 0, 1) * np.clip(1.3 - 2 * up, 0, 1)
        image += streaks * cover[..., None] * (0.5 * horizon + glow * np.exp(-angle / 20)[..., None] - 0.45 * image)
    return few_bits(image)


def morning_sky():
    return clear_sky((0.62, 0.74, 0.90), (0.10, 0.25, 0.62), (0.9, 0.72, 0.45), (0.40, 0.46, 0.54), 22)


def evening_sky():
    return clear_sky((0.40, 0.32, 0.32), (0.05, 0.10, 0.25), (1.5, 0.72, 0.22), (0.03, 0.045, 0.06), 8, streaks=0.9)


SKIES = {"morning_sky": morning_sky, "evening_sky": evening_sky}
