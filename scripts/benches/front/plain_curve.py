"""What plain rendering costs and reaches at any number of samples per pixel, from what was measured at some."""

import math

import numpy as np


class PlainCurve:
    """
    Between measured counts the error is interpolated in logarithms; beyond them it falls as 1/N. Seconds a frame are a constant
    and a share for each sample, fitted by least relative squares.
    """

    def __init__(self, measured, seconds):
        """measured: the error by sample count. seconds: the time of a frame by sample count; empty if it is not known."""
        usable = sorted((spp, error) for spp, error in measured.items() if error > 0.0)
        if not usable:
            raise ValueError("plain rendering has no measured error above zero")
        self.spps, self.errors = zip(*usable)
        self.fixed, self.of_sample = _fit_cost(seconds) if seconds else (None, None)

    def is_measured(self, samples):
        return self.spps[0] <= samples <= self.spps[-1]

    def error(self, samples):
        if samples <= self.spps[0]:
            return self.errors[0] * self.spps[0] / samples
        if samples >= self.spps[-1]:
            return self.errors[-1] * self.spps[-1] / samples
        return float(np.exp(np.interp(math.log(samples), np.log(self.spps), np.log(self.errors))))

    def samples(self, error):
        """The least number of samples, not rounded, with at most this error, which must be above zero."""
        if error >= self.errors[0]:
            return self.spps[0] * self.errors[0] / error
        for i, (low, high) in enumerate(zip(self.errors, self.errors[1:])):
            if high <= error:
                share = math.log(low / error) / math.log(low / high)
                return self.spps[i] * (self.spps[i + 1] / self.spps[i]) ** share
        return self.spps[-1] * self.errors[-1] / error

    def seconds(self, samples):
        """None if the time of rendering is not known."""
        return None if self.fixed is None else self.fixed + samples * self.of_sample

    def samples_in(self, seconds):
        """The number of samples that plain rendering takes in so many seconds a frame; None if the time is not known or too short for one."""
        if self.fixed is None or seconds < self.fixed + self.of_sample:
            return None
        return (seconds - self.fixed) / self.of_sample


def _fit_cost(seconds):
    """Seconds of no samples and of one, neither below zero."""
    spp, taken = np.array(list(seconds), float), np.array(list(seconds.values()), float)
    if len(spp) > 1:
        rows = np.stack([1.0 / taken, spp / taken], axis=1)
        fixed, of_sample = np.linalg.lstsq(rows, np.ones(len(spp)), rcond=None)[0]
        if fixed >= 0.0 and of_sample > 0.0:
            return float(fixed), float(of_sample)
    share = spp / taken
    return 0.0, float(share.sum() / np.square(share).sum())
