"""A wall with a round window, through which a beam falls into the slab."""

import numpy as np

from .mesh import Mesh

WINDOW_RADIUS = 0.22


def window_wall(width=200.0, below=1.0, above=5.0, segments=48):
    """Faces +z, without thickness; the window is around the origin."""
    angle = 2 * np.pi * np.arange(segments) / segments
    window = WINDOW_RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # Each point of the rim looks at the rectangle's border in its own direction; the corners are among the
    # directions, since the rectangle is stretched from a square.
    square = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    square /= abs(square).max(axis=1, keepdims=True)
    border = square * [width / 2, 1] * np.where(square[:, 1:] < 0, [[1, below]], [[1, above]])
    points = np.concatenate([window, border])
    positions = np.concatenate([points, np.zeros((2 * segments, 1))], axis=1)
    faces = []
    for i in range(segments):
        k = (i + 1) % segments
        faces.append((i, segments + i, segments + k, k))
    return Mesh(positions, faces)


MESHES = {"window_wall": window_wall}
