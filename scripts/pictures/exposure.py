"""Exposed and compressed radiance: a typical pixel becomes 0.5 and no firefly exceeds 1."""

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def luminance(rgb):
    return rgb[..., :3] @ LUMINANCE


def exposure(rgb):
    """1 / geometric mean of the finite luminances above a millionth of their mean, nearly as the filter exposes its frames."""
    values = luminance(rgb).astype(np.float64).ravel()
    values = values[(values > 0) & np.isfinite(values)]
    if values.size == 0:
        return 1.0
    return float(1.0 / np.exp(np.log(values[values > 1e-6 * values.mean()]).mean()))


def compressed(rgb, scale):
    """x / (1 + x) of the exposed values, always below 1."""
    exposed = np.maximum(rgb, 0.0) * scale
    return exposed / (1.0 + exposed)
