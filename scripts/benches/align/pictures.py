"""Pictures of offsets and of what they do to a pair of frames."""

import cv2
import numpy as np

from pictures.exposure import compressed, exposure

DIFFERENCE_GAIN = 8.0  # as in the paper's figure 16


def difference(a, b, reference):
    """Absolute difference of two radiances compressed with the reference's exposure; black is none."""
    scale = exposure(reference)
    return np.clip(DIFFERENCE_GAIN * np.abs(compressed(a, scale) - compressed(b, scale)), 0.0, 1.0)


def halved(picture):
    return cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
