"""The space in which images are matched and compared: exposed and compressed, so that fireflies do not decide."""

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def luminance(rgb):
    return rgb[..., :3] @ LUMINANCE


def exposure(rgb):
    """1 / geometric mean of the luminances above a millionth of their mean, as the filter exposes its frames."""
    values = luminance(rgb).astype(np.float64).ravel()
    values = values[values > 0]
    if values.size == 0:
        return 1.0
    return float(1.0 / np.exp(np.log(values[values > 1e-6 * values.mean()]).mean()))


def compressed(rgb, scale):
    """x / (1 + x) of the exposed values: half for the typical pixel, below 1 for any."""
    exposed = np.maximum(rgb, 0.0) * scale
    return exposed / (1.0 + exposed)


def eight_bit(rgb, scale):
    """Compressed luminance in 0..255, what aligners of photographs take."""
    return np.rint(255.0 * compressed(luminance(rgb), scale)).astype(np.uint8)
