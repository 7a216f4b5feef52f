"""Pictures of a cell: its frames, and maps of its errors."""

import cv2
import numpy as np

from benches.quality.still import RELATIVE_FLOOR, relative_error, window_mean
from pictures.colours import display_like, map_colours, signed_colours
from pictures.files import write_picture

ERROR_SCALE = 0.5      # relative error at which the map is brightest
ERROR_WINDOW_PX = 3    # width of the windows over which maps of error are averaged: about what an eye resolves
ENERGY_SCALE = 0.1     # relative change of brightness at which the map has full colour
ENERGY_SIGMA_PX = 4.0  # of the Gaussian that averages brightness before it is compared: single pixels would show noise
JPEG_QUALITY = 80      # about 30 kB a picture, which keeps the page of ten scenes small enough to send


def error_colours(squared):
    """The root of squared relative errors averaged over a small window."""
    return map_colours(np.sqrt(np.maximum(window_mean(squared, ERROR_WINDOW_PX), 0.0)) / ERROR_SCALE)


def temporal_squares(now, before, clean_now, clean_before):
    """Squared temporal error of each pixel, in the product form of two references."""
    step = now - before
    products = np.prod([step - (c - p) for c, p in zip(clean_now, clean_before)], axis=0)
    floor = 0.5 * sum(np.square(np.mean(pair, axis=0)) for pair in (clean_now, clean_before)) + RELATIVE_FLOOR
    return (products / floor).mean(axis=-1)


def signed_error(images, clean):
    """Mean of test minus reference over the measured frames, blurred, relative to the blurred reference."""
    def blurred(image):
        return cv2.GaussianBlur(image.astype(np.float32), (0, 0), ENERGY_SIGMA_PX)

    reference = np.mean([np.mean(pair, axis=0) for pair in clean.values()], axis=0).mean(axis=-1)
    test = np.mean([images[frame] for frame in clean], axis=0).mean(axis=-1)
    return blurred(test - reference) / (blurred(reference) + RELATIVE_FLOOR)


def _write(folder, name, colours):
    folder.mkdir(parents=True, exist_ok=True)
    write_picture(folder / f"{name}.jpg", colours, JPEG_QUALITY)


def _exposed_like(clean):
    """The reference whose exposure all pictures have; an exposure for each frame would flicker."""
    return np.mean(clean[min(clean)], axis=0)


def write_references(folder, clean):
    """Writes picture.####.jpg of the measured frames."""
    for frame, pair in clean.items():
        _write(folder, f"picture.{frame:04d}", display_like(np.mean(pair, axis=0), _exposed_like(clean)))


def write_pictures(folder, images, clean):
    """Writes picture.####.jpg of each frame, error.#### and temporal.#### of measured ones (the latter needs the frame before), and energy."""
    for frame, image in images.items():
        _write(folder, f"picture.{frame:04d}", display_like(image, _exposed_like(clean)))
    for frame, pair in clean.items():
        _write(folder, f"error.{frame:04d}", error_colours(relative_error(images[frame], *pair)))
        if frame - 1 in clean:
            squares = temporal_squares(images[frame], images[frame - 1], pair, clean[frame - 1])
            _write(folder, f"temporal.{frame:04d}", error_colours(squares))
    _write(folder, "energy", signed_colours(signed_error(images, clean) / ENERGY_SCALE))
