"""What the experiments' pictures show, as colours."""

import cv2
import numpy as np

from align_space import compressed, exposure
from demo_pictures import display, flow_colours, mask_colours

DIFFERENCE_GAIN = 8.0  # as in the paper's figure 16
SHOWN_EXPOSURE = 0.35  # of white for a pixel of typical brightness


def shown(radiance, like):
    """For the screen, with the exposure of `like`."""
    return display(radiance * (SHOWN_EXPOSURE * exposure(like)))


def plane(values):
    """One channel in [0,1] as grey."""
    return np.repeat(np.clip(values, 0.0, 1.0)[..., None], 3, axis=-1)


def difference(a, b, like, gain=DIFFERENCE_GAIN):
    """Absolute difference of compressed values, dark where small."""
    scale = exposure(like)
    return np.clip(gain * np.abs(compressed(a, scale) - compressed(b, scale)), 0.0, 1.0)


def flow(offset, scale_px):
    return flow_colours(offset, scale_px)


def mask(values):
    return mask_colours(values[..., None])


def halved(picture):
    return cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
