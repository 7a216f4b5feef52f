"""Pixels where nothing changes, and the error there relative to that of the plain mean of all frames, the ideal."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

STILL_PX = 0.01         # longest motion of a still pixel
MARGIN_PX = 2           # neighbours that must be still too: the reach of the filters of pixels and of resampling
WINDOW_PX = 9           # width of the windows over which brightness is averaged before it is compared
STEADY = 0.05           # largest relative change of brightness between any two frames
STANDARD_ERRORS = 4.0   # by which the means of noisy frames may differ in addition
LEAST_SHARE = 0.01      # of the image that must be still for a judgement
RELATIVE_FLOOR = 0.01   # added to squared brightness in relative errors, as in relMSE


def _windows(image, width_px, axis):
    """The window of odd width around each pixel along an axis; beyond its border the image is mirrored."""
    pad = [(width_px // 2, width_px // 2) if a == axis else (0, 0) for a in range(2)]
    return sliding_window_view(np.pad(image, pad, mode="symmetric"), width_px, axis=axis)


def window_mean(image, width_px=WINDOW_PX):
    return _windows(_windows(image, width_px, 0).mean(axis=-1), width_px, 1).mean(axis=-1)


def all_in_window(mask, width_px):
    return _windows(_windows(mask, width_px, 0).all(axis=-1), width_px, 1).all(axis=-1)


def _spread(means):
    """The largest difference between frames over their mean."""
    return np.ptp(means, axis=0) / (np.mean(means, axis=0) + RELATIVE_FLOOR)


def still_pixels(frames, references):
    """A mask of still pixels. frames: layers of noisy frames; references: clean radiances of some of them."""
    still = np.all([np.hypot(*np.moveaxis(f["motion"], -1, 0)) <= STILL_PX for f in frames], axis=0)
    still &= np.all([f["object_id"] == frames[0]["object_id"] for f in frames], axis=0)[..., 0]
    still = all_in_window(still, 2 * MARGIN_PX + 1)
    still &= _spread([window_mean(r.mean(axis=-1)) for r in references]) <= STEADY
    means = np.array([window_mean(f["beauty"].mean(axis=-1)) for f in frames])
    # The channels of a pixel have the same samples and are correlated: the variance of their mean is taken as the mean of their
    # variances, not as a third of it.
    variance = np.mean([window_mean(f["variance"].mean(axis=-1)) for f in frames], axis=0) / WINDOW_PX**2
    tolerance = STANDARD_ERRORS * np.sqrt(2.0 * variance) / (means.mean(axis=0) + RELATIVE_FLOOR)
    return still & (_spread(means) <= STEADY + tolerance)


def relative_error(test, a, b):
    """The squared relative error of each pixel, in the product form of two references; its mean is relMSE."""
    return ((test - a) * (test - b) / (np.square(0.5 * (a + b)) + RELATIVE_FLOOR)).mean(axis=-1)


def over_ideal(tests, noisy, references, still, history):
    """
    Mean error of `tests` in the still pixels over that of the mean of independent noisy frames; None if too few pixels are still.

    tests: images by measured frame; references: pairs of images by measured frame; noisy: images of all frames. A frame without
    references is compared with the mean of the others' references, as nothing changes. history: the ideal is the mean of all noisy
    frames ("all") or of those up to the tested one ("before").
    """
    if still.mean() < LEAST_SHARE:
        return None
    a, b = (np.mean([pair[i] for pair in references.values()], axis=0) for i in (0, 1))
    noise = {frame: relative_error(image, *references.get(frame, (a, b)))[still].mean() for frame, image in noisy.items()}
    ideal = []
    for frame in tests:
        merged = [noise[other] for other in noise if history == "all" or other <= frame]
        ideal.append(sum(merged) / len(merged) ** 2)
    reached = [relative_error(tests[frame], *references[frame])[still].mean() for frame in tests]
    return float(np.mean(reached) / np.mean(ideal))
