"""Quality of offsets, judged by the clean images. Everything is measured on compressed values (pictures/exposure.py)."""

import numpy as np

from benches.align.warp import warp
from pictures.exposure import compressed, exposure


def _rms(difference):
    return float(np.sqrt(np.mean(np.square(difference, dtype=np.float64))))


def _noise_correlation(target, source, other_target, other_source):
    """Correlation of the noise (deviations from the clean images) of target and warped source.

    Compression gives noise a mean that is equal in every rendering. The covariance that this makes is measured with the other
    rendering of one of the two, whose noise the offsets cannot follow, and subtracted.
    """
    def covariance(a, b):
        return (a * b).mean(dtype=np.float64)

    expected = 0.5 * (covariance(target, other_source) + covariance(other_target, source))
    return float(2.0 * (covariance(target, source) - expected) / (_rms(target - other_target) * _rms(source - other_source)))


def _squared_difference(halves_a, halves_b):
    """Squared difference of each pixel, free of the halves' own noise; where only that noise differs it may be negative."""
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
    correlation      between the noise of the warped source and of the target
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
    """The clean difference that the noise of the clean images makes even if offsets are perfect."""
    scale = exposure(pair.clean_target)
    a, b = (compressed(half, scale) for half in pair.halves_target)
    # The difference of the halves has 4 times the variance of their mean, that of the two clean images 2 times.
    return float(np.abs(a - b).mean() / np.sqrt(2.0))
