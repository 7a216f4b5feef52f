"""Pixels where nothing changes, and how near to the plain mean of all frames a merge comes there."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

STILL_PX = 0.01         # longest motion of a still pixel
MARGIN_PX = 2           # around it everything is still too: filters of pixels and of resampling reach that far
WINDOW_PX = 9           # brightness is compared in means over windows so wide
STEADY = 0.05           # of the brightness: what may change between any two frames
STANDARD_ERRORS = 4.0   # by which means of noisy frames may differ beyond that
LEAST_SHARE = 0.01      # of the image; less is too little to judge by
RELATIVE_FLOOR = 0.01   # as in relMSE


def _windows(image, width_px, axis):
    """Of odd width around each pixel along an axis, the image mirrored beyond its border."""
    pad = [(width_px // 2, width_px // 2) if a == axis else (0, 0) for a in range(2)]
    return sliding_window_view(np.pad(image, pad, mode="symmetric"), width_px, axis=axis)


def window_mean(image, width_px=WINDOW_PX):
    return _windows(_windows(image, width_px, 0).mean(axis=-1), width_px, 1).mean(axis=-1)


def all_in_window(mask, width_px):
    return _windows(_windows(mask, width_px, 0).all(axis=-1), width_px, 1).all(axis=-1)


def _spread(means):
    """Largest difference between frames, over their mean."""
    return np.ptp(means, axis=0) / (np.mean(means, axis=0) + RELATIVE_FLOOR)


def still_pixels(frames, references):
    """frames: layers of noisy frames; references: clean radiances of some of them. True where all of it says still."""
    still = np.all([np.hypot(*np.moveaxis(f["motion"], -1, 0)) <= STILL_PX for f in frames], axis=0)
    still &= np.all([f["object_id"] == frames[0]["object_id"] for f in frames], axis=0)[..., 0]
    still = all_in_window(still, 2 * MARGIN_PX + 1)
    still &= _spread([window_mean(r.mean(axis=-1)) for r in references]) <= STEADY
    means = np.array([window_mean(f["beauty"].mean(axis=-1)) for f in frames])
    # The channels of a pixel share their samples: the mean's variance is nearer to the channels' mean than to a third of it.
    variance = np.mean([window_mean(f["variance"].mean(axis=-1)) for f in frames], axis=0) / WINDOW_PX**2
    tolerance = STANDARD_ERRORS * np.sqrt(2.0 * variance) / (means.mean(axis=0) + RELATIVE_FLOOR)
    return still & (_spread(means) <= STEADY + tolerance)


def relative_error(test, a, b):
    """Squared, of each pixel, in the product form: its mean is relMSE."""
    return ((test - a) * (test - b) / (np.square(0.5 * (a + b)) + RELATIVE_FLOOR)).mean(axis=-1)


def over_ideal(tests, noisy, references, still, history):
    """
    Mean error of `tests` over that of the mean of independent frames, where `still`; None if that is too little.

    tests, references: by measured frame, the latter as (a, b). noisy: by frame, all of them; where a frame has no references,
    those of the measured ones serve, as nothing changes. history: "before" or "all".
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
