"""How good offsets are, judged by the clean images. Everything is measured on compressed values (align_space)."""

import numpy as np

from align_space import compressed, exposure
from align_warp import warp


def _rms(difference):
    return float(np.sqrt(np.mean(np.square(difference, dtype=np.float64))))


def _noise_correlation(target, source, other_target, other_source):
    """Of deviations from the clean images, beyond what those correlate that the offset was not found on.

    Compression shifts the mean of noise by the same in every rendering; that is no correlation of noise.
    """
    def covariance(a, b):
        return (a * b).mean(dtype=np.float64)

    expected = 0.5 * (covariance(target, other_source) + covariance(other_target, source))
    return float(2.0 * (covariance(target, source) - expected) / (_rms(target - other_target) * _rms(source - other_source)))


def _squared_difference(halves_a, halves_b):
    """Of each pixel, without what independent noise of the halves adds: it may be negative where there is nothing else."""
    (a, b), (c, d) = halves_a, halves_b
    return 0.5 * ((a - c) * (b - d) + (a - d) * (b - c)).mean(axis=-1)


def _root_mean(squares):
    return float(np.sqrt(max(squares.mean(dtype=np.float64), 0.0)))


def measure(pair, offset):
    """
    clean            mean absolute difference between the warped clean source and the clean target
    clean_visible    the same over pixels that the source shows
    rms              root of the mean squared difference of the same two, free of the clean images' own noise
    rms_visible      the same over pixels that the source shows
    correlation      of the warped source's noise with the target's
    average          RMS error of the 50/50 average of target and warped source, over that of the target alone
    average_visible  the same over pixels that the source shows
    epe              mean distance from the true offset over visible pixels, in pixels; None where it is not known
    """
    scale = exposure(pair.clean_target)
    target, source, other_target, other_source, clean_target, clean_source, *halves = (
        compressed(image, scale) for image in (pair.target["beauty"], pair.source["beauty"], pair.other_target, pair.other_source,
                                               pair.clean_target, pair.clean_source, *pair.halves_target, *pair.halves_source))
    warped, warped_other, warped_clean, *warped_halves = (
        warp(image, offset) for image in (source, other_source, clean_source, *halves[2:]))
    difference = np.abs(warped_clean - clean_target).mean(axis=-1)
    squared = _squared_difference(warped_halves, halves[:2])
    noise_target, error_average = target - clean_target, 0.5 * (target + warped) - clean_target
    epe = None
    if pair.truth is not None:
        epe = float(np.hypot(*np.moveaxis(offset - pair.truth, -1, 0))[pair.visible].mean())
    return {
        "clean": float(difference.mean()),
        "clean_visible": float(difference[pair.visible].mean()),
        "rms": _root_mean(squared),
        "rms_visible": _root_mean(squared[pair.visible]),
        "correlation": _noise_correlation(noise_target, warped - warped_clean, other_target - clean_target,
                                          warped_other - warped_clean),
        "average": _rms(error_average) / _rms(noise_target),
        "average_visible": _rms(error_average[pair.visible]) / _rms(noise_target[pair.visible]),
        "epe": epe,
    }


def reference_floor(pair):
    """The clean difference that the noise of the clean images alone would make without any warp."""
    scale = exposure(pair.clean_target)
    a, b = (compressed(half, scale) for half in pair.halves_target)
    # The halves' difference has four times the variance of the mean; target and source differ by twice of it.
    return float(np.abs(a - b).mean() / np.sqrt(2.0))
