"""The warp by which the offsets of all aligners are judged."""

import numpy as np


def pixel_grid(shape):
    y, x = np.mgrid[0 : shape[0], 0 : shape[1]].astype(np.float32)
    return x, y


def warp(image, offset):
    """image(p + offset(p)), read bilinearly; beyond the border the nearest pixel."""
    height, width = image.shape[:2]
    x, y = pixel_grid(offset.shape)
    u = np.clip(x + offset[..., 0], 0, width - 1)
    v = np.clip(y + offset[..., 1], 0, height - 1)
    x0, y0 = np.floor(u).astype(np.int32), np.floor(v).astype(np.int32)
    x1, y1 = np.minimum(x0 + 1, width - 1), np.minimum(y0 + 1, height - 1)
    tx, ty = u - x0, v - y0
    if image.ndim == 3:
        tx, ty = tx[..., None], ty[..., None]
    top = image[y0, x0] * (1 - tx) + image[y0, x1] * tx
    bottom = image[y1, x0] * (1 - tx) + image[y1, x1] * tx
    return top * (1 - ty) + bottom * ty


def nearest(image, offset):
    """The image's pixel nearest to p + offset(p), and whether that position lies inside the image."""
    height, width = image.shape[:2]
    x, y = pixel_grid(offset.shape)
    u = np.rint(x + offset[..., 0]).astype(np.int64)
    v = np.rint(y + offset[..., 1]).astype(np.int64)
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    return image[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)], inside
