"""Colours for the screen: of radiance, offsets and scalar maps. Arrays are (height, width, channels), colours in [0,1]."""

import numpy as np
import OpenImageIO as oiio

from pictures.exposure import exposure

TYPICAL_BRIGHTNESS = 0.35  # of white, for a pixel of typical luminance


def _srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def display(radiance):
    """Linear radiance by the sRGB curve, with a shoulder above 0.6 that ends at white."""
    x = np.maximum(np.nan_to_num(radiance[..., :3]), 0.0)
    return _srgb(np.where(x < 0.6, x, 0.6 + 0.4 * (1.0 - np.exp(-(x - 0.6) / 0.4))))


def display_like(radiance, reference):
    """Radiance with the exposure of `reference`."""
    return display(radiance * (TYPICAL_BRIGHTNESS * exposure(reference)))


def offset_colours(offset, scale_px):
    """Direction as hue, length as brightness: black is no offset, full colour is scale_px or more."""
    hue = (np.arctan2(offset[..., 1], offset[..., 0]) / (2 * np.pi)) % 1.0
    length = np.clip(np.hypot(offset[..., 0], offset[..., 1]) / scale_px, 0.0, 1.0)
    sectors = (hue[..., None] * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0
    pure = np.clip(np.abs(sectors - 3.0) - 1.0, 0.0, 1.0)
    return (0.25 + 0.75 * pure) * length[..., None] ** 0.7


def offset_wheel(size_px=160):
    """The legend of offset_colours: each direction and length in a disc, black outside."""
    y, x = np.mgrid[0:size_px, 0:size_px] / (size_px - 1) * 2.0 - 1.0
    inside = np.hypot(x, y) <= 1.0
    return offset_colours(np.stack([x, y], axis=-1), 1.0) * inside[..., None]


def _color_map(values, *color_map):
    """color_map: a name, or knots, of linear colours."""
    height, width = values.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, 1, "float"))
    image.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 1), np.ascontiguousarray(np.clip(values, 0.0, 1.0)[..., None], np.float32))
    mapped = oiio.ImageBufAlgo.color_map(image, 0, *color_map)
    if mapped.has_error:
        raise ValueError(mapped.geterror())
    return _srgb(mapped.get_pixels(oiio.FLOAT))


def map_colours(values, name="inferno"):
    """Values in [0,1] by one of OpenImageIO's colour maps."""
    return _color_map(values, name)


def map_ramp(name="inferno", size_px=(192, 12)):
    """The legend of map_colours, 0 at the left and 1 at the right."""
    return map_colours(np.tile(np.linspace(0.0, 1.0, size_px[0]), (size_px[1], 1)), name)


def signed_colours(values):
    """Values in [-1,1]: blue is negative, white 0, red positive."""
    return _color_map(0.5 + 0.5 * np.clip(values, -1.0, 1.0), 3, 3, (0.01, 0.08, 0.40, 1.0, 1.0, 1.0, 0.40, 0.0, 0.02))
