"""The running mean along motion vectors, read bilinearly. Nothing is rejected but what lies outside of the frame before."""

import numpy as np

from benches.align.warp import nearest, warp


def motion_average(frames):
    mean = count = None
    for radiance, layers in frames:
        offset = np.nan_to_num(layers["motion"][..., :2], posinf=0.0, neginf=0.0)
        if mean is None:
            mean, count = radiance, np.ones((*radiance.shape[:2], 1), np.float32)
        else:
            _, inside = nearest(mean, offset)
            before = np.where(inside[..., None], warp(count, offset), 0.0)
            mean = (before * warp(mean, offset) + radiance) / (before + 1.0)
            count = before + 1.0
        yield mean
