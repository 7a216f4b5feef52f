import numpy as np


def geometric_mean(values):
    """None without values, or if one is None or not positive: the estimate of an error from noisy references can be negative."""
    return float(np.exp(np.mean(np.log(values)))) if values and all(value is not None and value > 0.0 for value in values) else None
