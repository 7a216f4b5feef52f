"""A pair of frames to align: noisy layers, clean images, and the known motion."""

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Pair:
    """All images are (height, width, channels) float32. Offsets lead from the target into the source, in pixels."""

    name: str
    noise: str                  # strength in the noisy frames: "4 spp", "2 %"
    target: dict                # noisy layers; the beauty under "beauty"
    source: dict
    other_target: np.ndarray    # beauty with independent noise of the same strength, which no aligner is given
    other_source: np.ndarray
    clean_target: np.ndarray
    clean_source: np.ndarray
    halves_target: list         # two clean images of independent noise, whose mean is clean_target; equal ones if it has no noise
    halves_source: list
    visible: np.ndarray         # (height, width): target pixels whose surface is also seen in the source
    motion: np.ndarray | None = None   # the renderer's motion vectors
    truth: np.ndarray | None = None    # exact offsets, of synthetic pairs
    aovs: list = field(default_factory=list)  # further layers of both frames

    @property
    def size(self):
        height, width = self.clean_target.shape[:2]
        return width, height
