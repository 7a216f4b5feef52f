"""A polygon mesh and the shapes that the scenes are made of. Faces are counter-clockwise seen from outside, y is up."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Mesh:
    """Every vertex carries its own uv and normal (or none does), so one index serves all three."""

    positions: np.ndarray
    faces: list
    uvs: np.ndarray = None
    normals: np.ndarray = None

    def moved(self, matrix=None, offset=(0, 0, 0)):
        """matrix: a rotation (3, 3), applied before the offset."""
        matrix = np.eye(3) if matrix is None else matrix
        normals = None if self.normals is None else self.normals @ matrix.T
        return Mesh(self.positions @ matrix.T + np.asarray(offset, float), self.faces, self.uvs, normals)


def merge(meshes):
    def joined(name):
        parts = [getattr(m, name) for m in meshes]
        return None if parts[0] is None else np.concatenate(parts)

    faces, start = [], 0
    for mesh in meshes:
        faces += [tuple(i + start for i in face) for face in mesh.faces]
        start += len(mesh.positions)
    return Mesh(joined("positions"), faces, joined("uvs"), joined("normals"))


def rotation(axis, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def polygon(corners, uvs=None):
    """One flat face."""
    corners = np.asarray(corners, float)
    return Mesh(corners, [tuple(range(len(corners)))], None if uvs is None else np.asarray(uvs, float))


def grid(positions, uvs=None, normals=None):
    """positions: (rows, columns, 3), and alike the others. Faces are seen from where columns run to the right and rows
    up or away."""
    rows, columns, _ = positions.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    faces = [tuple(face) for face in np.stack(corners, axis=-1).reshape(-1, 4)]
    return Mesh(positions.reshape(-1, 3), faces, None if uvs is None else uvs.reshape(-1, 2),
                None if normals is None else normals.reshape(-1, 3))


def box(low, high):
    """Six faces, without uvs."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side, order in ((high, (0, 1, 2, 3)), (low, (0, 3, 2, 1))):
            corners = np.zeros((4, 3))
            corners[:, axis] = side[axis]
            corners[:, u] = [low[u], high[u], high[u], low[u]]
            corners[:, v] = [low[v], low[v], high[v], high[v]]
            faces.append(polygon(corners[list(order)]))
    return merge(faces)


def beam(start, end, width):
    """A box of square section between two points."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    length = np.linalg.norm(end - start)
    y = (end - start) / length
    x = np.cross(y, [0, 0, 1] if abs(y[2]) < 0.9 else [1, 0, 0])
    x /= np.linalg.norm(x)
    frame = np.stack([x, y, np.cross(x, y)], axis=1)
    half = width / 2
    return box((-half, 0, -half), (half, length, half)).moved(frame, start)


def lathe(profiles, segments):
    """Turns each profile, a list of (radius, height) from the bottom outside, about y. Smooth within a profile, with an
    edge between two."""
    parts = []
    angle = 2.0 * np.pi * np.arange(segments) / segments
    around = np.stack([np.cos(angle), np.zeros(segments), -np.sin(angle)], axis=1)[:, None]
    for profile in profiles:
        profile = np.asarray(profile, float)
        tangent = np.gradient(profile, axis=0)
        normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        rows = len(profile)
        positions = profile[:, :1] * around + profile[:, 1:] * [0, 1, 0]
        normals = normal[:, :1] * around + normal[:, 1:] * [0, 1, 0]
        faces = []
        for i in range(segments):
            for j in range(rows - 1):
                a, b = i * rows + j, (i + 1) % segments * rows + j
                if profile[j, 0] == 0:
                    faces.append((a, b + 1, a + 1))
                elif profile[j + 1, 0] == 0:
                    faces.append((a, b, a + 1))
                else:
                    faces.append((a, b, b + 1, a + 1))
        parts.append(Mesh(positions.reshape(-1, 3), faces, None, normals.reshape(-1, 3)))
    return merge(parts)


def tube(centre, radius, segments, sides):
    """A closed tube along centre(t), t in [0, 1), framed without twist jumps by the curve's own normal."""
    t = np.arange(segments) / segments
    step = 1e-4
    points = np.array([centre(s) for s in t])
    tangents = np.array([centre(s + step) - centre(s - step) for s in t])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    outward = points - points.mean(axis=0)
    side = np.cross(tangents, outward)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, tangents)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[None, :, None] * up[:, None] + np.sin(angle)[None, :, None] * side[:, None]
    positions = points[:, None] + radius * ring
    faces = []
    for i in range(segments):
        for j in range(sides):
            a, b = i * sides, (i + 1) % segments * sides
            k = (j + 1) % sides
            faces.append((a + j, a + k, b + k, b + j))
    return Mesh(positions.reshape(-1, 3), faces, None, ring.reshape(-1, 3))


def limb(points, radii, sides):
    """An open tube through points, with a radius at each; the ends stay open."""
    points = np.asarray(points, float)
    tangents = np.gradient(points, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    angle = 2 * np.pi * np.arange(sides) / sides
    rings = []
    for point, tangent, radius in zip(points, tangents, radii):
        side = np.cross(tangent, [0.31, 0.0, 0.95])
        side /= np.linalg.norm(side)
        up = np.cross(side, tangent)
        rings.append(point + radius * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up))
    faces = []
    for i in range(len(points) - 1):
        for j in range(sides):
            k = (j + 1) % sides
            faces.append((i * sides + j, (i + 1) * sides + j, (i + 1) * sides + k, i * sides + k))
    return Mesh(np.concatenate(rings), faces)


def bezier(points, count):
    """count points of the Bezier curve with these control points."""
    points = [np.asarray(p, float) for p in points]
    result = []
    for t in np.linspace(0, 1, count):
        level = points
        while len(level) > 1:
            level = [(1 - t) * a + t * b for a, b in zip(level, level[1:])]
        result.append(level[0])
    return np.array(result)
