"""What an eye should see of a cell: its frames, and maps of its errors."""

import cv2
import numpy as np
from matplotlib import colormaps

from align_pictures import shown
from demo_pictures import write_picture
from quality_still import RELATIVE_FLOOR, relative_error, window_mean

ERROR_SCALE = 0.5      # relative error at which the map is brightest
ERROR_WINDOW_PX = 3    # maps of error are means over so many pixels: what flickers there, the eye sees
ENERGY_SCALE = 0.1     # relative change of brightness at which the map has full colour
ENERGY_SIGMA_PX = 4.0  # the change is that of weighted means: of single pixels it would be noise
JPEG_QUALITY = 80      # of some 30 kB a picture, so that a page of seven scenes can be passed on


def error_colours(squared):
    """Root of a mean over a small window of squared relative errors."""
    error = np.sqrt(np.maximum(window_mean(squared, ERROR_WINDOW_PX), 0.0))
    return colormaps["inferno"](np.clip(error / ERROR_SCALE, 0.0, 1.0))[..., :3]


def temporal_squares(now, before, clean_now, clean_before):
    """Temporal error of each pixel, in the product form of two references."""
    step = now - before
    products = np.prod([step - (c - p) for c, p in zip(clean_now, clean_before)], axis=0)
    floor = 0.5 * sum(np.square(np.mean(pair, axis=0)) for pair in (clean_now, clean_before)) + RELATIVE_FLOOR
    return (products / floor).mean(axis=-1)


def signed_error(images, clean):
    """Mean over the measured frames of test minus reference, in weighted means, relative to the reference's."""
    def blurred(image):
        return cv2.GaussianBlur(image.astype(np.float32), (0, 0), ENERGY_SIGMA_PX)

    reference = np.mean([np.mean(pair, axis=0) for pair in clean.values()], axis=0).mean(axis=-1)
    test = np.mean([images[frame] for frame in clean], axis=0).mean(axis=-1)
    return blurred(test - reference) / (blurred(reference) + RELATIVE_FLOOR)


def energy_colours(signed):
    """Red where too bright, blue where too dark, white where right."""
    return colormaps["RdBu_r"](0.5 + 0.5 * np.clip(signed / ENERGY_SCALE, -1.0, 1.0))[..., :3]


def _write(folder, name, colours):
    folder.mkdir(parents=True, exist_ok=True)
    write_picture(folder / f"{name}.jpg", colours, JPEG_QUALITY)


def _exposed_like(clean):
    """One frame for the exposure of all, or the pictures would flicker."""
    return np.mean(clean[min(clean)], axis=0)


def write_references(folder, clean):
    """picture.####.jpg of the measured frames."""
    for frame, pair in clean.items():
        _write(folder, f"picture.{frame:04d}", shown(np.mean(pair, axis=0), _exposed_like(clean)))


def write_pictures(folder, images, clean):
    """picture.####.jpg of each frame; of measured ones error.####, and temporal.#### where the one before is too; energy."""
    for frame, image in images.items():
        _write(folder, f"picture.{frame:04d}", shown(image, _exposed_like(clean)))
    for frame, pair in clean.items():
        _write(folder, f"error.{frame:04d}", error_colours(relative_error(images[frame], *pair)))
        if frame - 1 in clean:
            squares = temporal_squares(images[frame], images[frame - 1], pair, clean[frame - 1])
            _write(folder, f"temporal.{frame:04d}", error_colours(squares))
    _write(folder, "energy", energy_colours(signed_error(images, clean)))
