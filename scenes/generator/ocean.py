"""A beacon that stands in the sea."""

import numpy as np

from .mesh import beam, lathe, merge


def beacon_tower():
    """From the sea bed up; the water is to stand at height 0."""
    foot = [[(1.5, -4.0), (1.5, 0.9)], [(1.5, 0.9), (1.35, 1.05), (0.0, 1.05)]]
    shaft = [[(0.80, 1.05), (0.62, 2.4)]]
    head = [[(0.58, 3.9), (0.50, 5.0)], [(0.50, 5.0), (0.95, 5.15), (0.95, 5.3)], [(0.95, 5.3), (0.0, 5.3)]]
    return lathe(foot + shaft + head, 24)


def beacon_band():
    return lathe([[(0.62, 2.4), (0.58, 3.9)]], 24)


def beacon_lantern():
    """Railing, mullions and roof of the lantern."""
    angles = 2 * np.pi * np.arange(8) / 8

    def around(radius, height):
        return [(radius * np.cos(a), height, radius * np.sin(a)) for a in angles]

    rim = around(0.9, 5.75)
    posts = [beam(p, q, 0.04) for p, q in zip(around(0.9, 5.3), rim)]
    rails = [beam(p, q, 0.04) for p, q in zip(rim, rim[1:] + rim[:1])]
    mullions = [beam(p, q, 0.05) for p, q in zip(around(0.42, 5.3)[::2], around(0.42, 6.25)[::2])]
    roof = lathe([[(0.0, 6.25), (0.58, 6.25)], [(0.58, 6.25), (0.35, 6.55), (0.06, 6.75), (0.05, 7.1), (0.0, 7.1)]], 20)
    roof.normals = None
    return merge([*posts, *rails, *mullions, roof])


MESHES = {"beacon_tower": beacon_tower, "beacon_band": beacon_band, "beacon_lantern": beacon_lantern}
