"""A pair of frames to align: noisy layers, clean images, and what is known of the motion."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Pair:
    """All images are (height, width, channels) float32. Offsets lead from the target into the source, in pixels."""

    name: str
    noise: str                  # of the noisy frames: "4 spp", "2 %"
    target: dict                # noisy layers; the beauty under "beauty"
    source: dict
    other_target: np.ndarray    # beauty with independent noise of the same strength, which no aligner sees
    other_source: np.ndarray
    clean_target: np.ndarray
    clean_source: np.ndarray
    halves_target: list         # two clean images with independent rests of noise, whose mean clean_target is; equal ones without
    halves_source: list
    visible: np.ndarray         # (height, width): the target's pixels whose surface the source shows too
    motion: np.ndarray | None = None   # the renderer's motion vectors
    truth: np.ndarray | None = None    # exact offsets, of synthetic pairs
    aovs: list = field(default_factory=list)  # layers that both frames have besides the beauty

    @property
    def size(self):
        height, width = self.clean_target.shape[:2]
        return width, height
