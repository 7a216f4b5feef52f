"""OpenCV's non-local means of each frame, on 16-bit logarithms of radiance."""

import cv2
import numpy as np

from pictures.exposure import exposure

DARK = 1 / 8     # of a typical pixel: below this radiance the encoding is linear, above it logarithmic
BRIGHT = 1e4     # of a typical pixel: brighter ones are clipped
PATCH_PX, SEARCH_PX = 7, 21  # OpenCV's defaults
STRENGTH = 3.0   # of the noise's standard deviation: the best of 1, 2, 3, 4 and 6 on `penumbra` at 4 samples per pixel

_TOP = np.iinfo(np.uint16).max
_SCALE = _TOP / np.log1p(BRIGHT / DARK)
_LAPLACIAN = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32) / 6  # of white noise: the same variance


def _noise(code):
    """The standard deviation of noise, from the median of second differences, which edges hardly change (Immerkaer 1996)."""
    return np.median(np.abs(cv2.filter2D(code.astype(np.float32), -1, _LAPLACIAN))) / 0.6745


def _filtered(radiance, strength):
    scale = exposure(radiance) / DARK
    code = np.clip(np.rint(np.log1p(np.maximum(radiance, 0.0) * scale) * _SCALE), 0, _TOP).astype(np.uint16)
    h = max(float(strength * _noise(code)), 1.0)
    code = cv2.fastNlMeansDenoising(code, h=[h], templateWindowSize=PATCH_PX, searchWindowSize=SEARCH_PX, normType=cv2.NORM_L1)
    return np.expm1(code / _SCALE) / scale


def non_local_means(frames, strength=STRENGTH):
    for radiance, _ in frames:
        yield _filtered(radiance, strength)
