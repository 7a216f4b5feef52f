"""relMSE and temporal error of sequences as frame/metrics.h defines them, by the product of the differences from two independent references.
Where a reference has no noise it may be given twice."""

import numpy as np

FLOOR = 0.01


def rel_mse(a, b, test):
    """Means over the frames of (t - a)(t - b) / (r^2 + 0.01), with r the mean of both references."""
    return float(np.mean([np.mean((t - x) * (t - y) / ((0.5 * (x + y)) ** 2 + FLOOR)) for x, y, t in zip(a, b, test)]))


def temporal_error(a, b, test):
    """The same of the changes from frame to frame, relative to the mean of both frames' squares."""
    squares = [(0.5 * (x + y)) ** 2 for x, y in zip(a, b)]
    changes = [[after - before for before, after in zip(frames, frames[1:])] for frames in (a, b, test)]
    return float(np.mean([np.mean((t - x) * (t - y) / (0.5 * (before + after) + FLOOR))
                          for x, y, t, before, after in zip(*changes, squares, squares[1:])]))
