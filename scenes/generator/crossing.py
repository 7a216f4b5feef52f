"""Closed curved bodies with long silhouettes, to be made of metal and glass."""

import numpy as np

from .mesh import Mesh, lathe, tube


def trefoil():
    def centre(t):
        a = 2 * np.pi * t
        return np.array([np.sin(a) + 2 * np.sin(2 * a), np.cos(a) - 2 * np.cos(2 * a), -1.1 * np.sin(3 * a)]) / 3

    return tube(centre, 0.20, 84, 9)


def ring():
    def centre(t):
        return np.array([np.cos(2 * np.pi * t), 0, np.sin(2 * np.pi * t)])

    return tube(centre, 0.22, 40, 11)


def icosahedron():
    """Twenty flat facets, radius 1."""
    g = (1 + np.sqrt(5)) / 2
    points = np.array([(a, b * g, 0) for a in (-1, 1) for b in (-1, 1)])
    points = np.concatenate([np.roll(points, k, axis=1) for k in range(3)]) / np.hypot(1, g)
    edge = min(np.linalg.norm(points[0] - p) for p in points[1:])
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < edge * 1.01
    faces = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if near[i, j] and near[j, k] and near[i, k]:
                    outward = np.dot(np.cross(points[j] - points[i], points[k] - points[i]), points[i]) > 0
                    faces.append((i, j, k) if outward else (i, k, j))
    return Mesh(points, faces)


def cone():
    return lathe([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (0.04, 1.96), (0.0, 2.0)]], 32)


def pillar():
    return lathe([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (1.0, 1.0)], [(1.0, 1.0), (0.0, 1.0)]], 28)


MESHES = {"trefoil": trefoil, "ring": ring, "icosahedron": icosahedron, "cone": cone, "pillar": pillar}
