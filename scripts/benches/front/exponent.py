"""The exponent of a power law."""

import numpy as np


def exponent(sizes, costs):
    """The slope of the logarithms' least-squares line: 1 if the cost is proportional to the size, 0 if it is constant."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def local_exponents(sizes, costs):
    """The exponent between each size and the one before; None for the first."""
    return [None, *(exponent(sizes[i - 1:i + 1], costs[i - 1:i + 1]) for i in range(1, len(sizes)))]
