"""How good offsets are, judged by the clean images. Everything is measured on compressed values (align_space)."""

import cv2
import numpy as np

from align_space import compressed, exposure
from align_warp import warp

NOISE_WINDOW = 9  # px; compression shifts the noise's mean, which is removed over such windows


def _noise(noisy, clean):
    difference = noisy - clean
    return difference - cv2.blur(difference, (NOISE_WINDOW, NOISE_WINDOW))


def _rms(difference):
    return float(np.sqrt(np.mean(np.square(difference, dtype=np.float64))))


def measure(pair, offset):
    """
    clean            mean absolute difference between the warped clean source and the clean target
    clean_visible    the same over pixels that the source shows
    correlation      of the warped source's noise with the target's
    average          RMS error of the 50/50 average of target and warped source, over that of the target alone
    average_visible  the same over pixels that the source shows
    epe              mean distance from the true offset over visible pixels, in pixels; None where it is not known
    """
    scale = exposure(pair.clean_target)
    target, source = (compressed(frame["beauty"], scale) for frame in (pair.target, pair.source))
    clean_target, clean_source = (compressed(image, scale) for image in (pair.clean_target, pair.clean_source))
    warped, warped_clean = warp(source, offset), warp(clean_source, offset)
    difference = np.abs(warped_clean - clean_target).mean(axis=-1)
    noise_target, noise_source = _noise(target, clean_target), _noise(warped, warped_clean)
    error_target, error_average = target - clean_target, 0.5 * (target + warped) - clean_target
    epe = None
    if pair.truth is not None:
        epe = float(np.hypot(*np.moveaxis(offset - pair.truth, -1, 0))[pair.visible].mean())
    return {
        "clean": float(difference.mean()),
        "clean_visible": float(difference[pair.visible].mean()),
        "correlation": float((noise_target * noise_source).mean() / (_rms(noise_target) * _rms(noise_source))),
        "average": _rms(error_average) / _rms(error_target),
        "average_visible": _rms(error_average[pair.visible]) / _rms(error_target[pair.visible]),
        "epe": epe,
    }
