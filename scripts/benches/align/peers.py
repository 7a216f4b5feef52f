"""OpenCV's optical flow from the target to the source, on 8-bit compressed luminance."""

import time

import cv2
import numpy as np

from benches.align.service import THREADS
from pictures.exposure import compressed, exposure, luminance

cv2.setNumThreads(THREADS)


def _farneback(target, source):
    """The settings of OpenCV's own sample, samples/python/opt_flow.py."""
    return cv2.calcOpticalFlowFarneback(target, source, None, pyr_scale=0.5, levels=3, winsize=15, iterations=3,
                                        poly_n=5, poly_sigma=1.2, flags=0)


def _calc(make):
    flow = None

    def run(target, source):
        nonlocal flow
        flow = flow or make()
        return flow.calc(target, source, None)

    return run


def _dis(preset):
    return _calc(lambda: cv2.DISOpticalFlow_create(preset))


PEERS = {
    "Farneback": _farneback,
    "DIS ultrafast": _dis(cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST),
    "DIS fast": _dis(cv2.DISOPTICAL_FLOW_PRESET_FAST),
    "DIS medium": _dis(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM),
    "Dual TV-L1": _calc(lambda: cv2.optflow.DualTVL1OpticalFlow_create()),
}


def timed(method, target, source):
    """Offsets and milliseconds."""
    started = time.perf_counter()
    flow = PEERS[method](target, source)
    return flow, 1e3 * (time.perf_counter() - started)


def eight_bit_pair(pair):
    """The peers' input: compressed luminance of both noisy frames in 0..255, with the noisy target's exposure."""
    scale = exposure(pair.target["beauty"])
    return [np.rint(255.0 * compressed(luminance(side["beauty"]), scale)).astype(np.uint8) for side in (pair.target, pair.source)]
