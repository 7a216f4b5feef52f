"""A set table. What lies on it is written ten times as large, since a mesh file has three decimals: the scene scales it
by 0.1. The unit of these meshes is therefore a decimetre."""

import numpy as np

from .mesh import Mesh, bezier, box, grid, lathe, limb, merge, rotation


def tablecloth(length=19.0, depth=12.0, drop=2.6):
    """Lies at y = 0 and hangs down in folds; uv run with the cloth, one unit a decimetre."""
    corners = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
    edges = zip(corners, np.roll(corners, -1, axis=0), (24, 15, 24, 15))
    rim = np.concatenate([np.linspace(a, b, count, endpoint=False) for a, b, count in edges] + [corners[:1]])
    outward = np.where(np.abs(rim) > 1 - 1e-9, np.sign(rim), 0.0)
    rim *= [length / 2, depth / 2]
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(rim, axis=0), axis=1))])
    turns = 2 * np.pi * along / along[-1]
    folds = 0.22 * np.sin(24 * turns) + 0.10 * np.sin(7 * turns + 1.0)
    rows, uvs = [], []
    for fall in (1.0, 0.5, 0.05, 0.0):
        out = 0.12 * min(fall * 12, 1.0) + fall * (0.25 + folds)
        place = rim + out[:, None] * outward
        rows.append(np.stack([place[:, 0], np.full(len(rim), -drop * fall), place[:, 1]], axis=1))
        uvs.append(rim + drop * fall * outward)
    skirt = grid(np.array(rows), np.array(uvs))
    top = Mesh(rows[-1][:-1], [tuple(range(len(rim) - 1))], uvs[-1][:-1])
    return merge([top, skirt])


def plate(radius=1.35):
    under = [[(0.0, 0.05), (0.55 * radius, 0.05)], [(0.55 * radius, 0.0), (0.6 * radius, 0.0), (0.62 * radius, 0.05)],
             bezier([(0.62 * radius, 0.05), (0.8 * radius, 0.08), (radius, 0.17)], 4)]
    over = bezier([(radius, 0.17), (1.01 * radius, 0.205), (0.98 * radius, 0.20), (0.80 * radius, 0.14)], 5)
    well = [(0.72 * radius, 0.13), (0.66 * radius, 0.08), (0.0, 0.075)]
    return lathe([*under, np.array([*over, *well])], 20)


def goblet():
    """One thin shell: foot, stem and bowl of a wine glass."""
    foot = bezier([(0.36, 0.0), (0.30, 0.03), (0.05, 0.05), (0.045, 0.25)], 6)
    stem = [(0.042, 0.6), (0.06, 0.9)]
    bowl = bezier([(0.06, 0.9), (0.50, 0.95), (0.50, 1.5), (0.36, 2.05)], 8)[1:]
    return lathe([np.array([*foot, *stem, *bowl])], 16)


def wine():
    """What stands in the goblet, up to half of its bowl."""
    bowl = bezier([(0.06, 0.9), (0.50, 0.95), (0.50, 1.5), (0.36, 2.05)], 17)[1:10]
    side = np.array([(r - 0.012, y + 0.01) for r, y in bowl])
    return lathe([[(0.0, side[0][1]), tuple(side[0])], side, [tuple(side[-1]), (0.0, side[-1][1])]], 16)


def tumbler():
    """Solid: thick coloured glass, filled to the brim."""
    side = [(0.30, 0.0), (0.335, 0.04), (0.36, 0.5), (0.40, 1.05), (0.385, 1.08)]
    return lathe([[(0.0, 0.0), (0.30, 0.0)], side, [(0.385, 1.08), (0.0, 1.08)]], 16)


def bottle():
    side = [(0.37, 0.04), (0.38, 0.2), (0.38, 1.9)]
    shoulder = bezier([(0.38, 1.9), (0.38, 2.25), (0.14, 2.2), (0.14, 2.6)], 6)[1:]
    return lathe([[(0.0, 0.0), (0.34, 0.0), (0.37, 0.04)], np.array([*side, *shoulder, (0.135, 3.0)]),
                  [(0.135, 3.0), (0.16, 3.0)], [(0.16, 3.0), (0.16, 3.1), (0.0, 3.1)]], 14)


def jug():
    outside = bezier([(0.45, 0.0), (1.05, 0.15), (0.75, 1.3), (0.30, 1.4), (0.48, 2.15)], 11)
    inside = [(0.46, 2.15), (0.34, 1.85), (0.30, 1.6), (0.0, 1.5)]
    body = lathe([[(0.0, 0.0), (0.45, 0.0)], outside, inside], 16)
    handle = limb(bezier([(0.40, 1.95, 0), (1.25, 2.1, 0), (1.15, 0.9, 0), (0.66, 0.7, 0)], 10),
                  [0.085, 0.08, 0.075, 0.075, 0.075, 0.075, 0.075, 0.08, 0.085, 0.09], 8)
    return merge([body, _with_normals(handle)])


def _with_normals(mesh):
    """Vertex normals as means of the faces around, so that it can join a lathe."""
    normals = np.zeros_like(mesh.positions)
    for face in mesh.faces:
        a, b, c = mesh.positions[list(face[:3])]
        normals[list(face)] += np.cross(b - a, c - a)
    return Mesh(mesh.positions, mesh.faces, None, normals / np.linalg.norm(normals, axis=1, keepdims=True))


def _blade(outline, low, high):
    """A flat body between two heights over an outline of (x, z), counter-clockwise seen from above."""
    outline = np.asarray(outline, float)
    n = len(outline)
    up = np.insert(outline, 1, high, axis=1)
    down = np.insert(outline, 1, low, axis=1)
    top, bottom = tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1))
    sides = [(i, n + i, n + (i + 1) % n, (i + 1) % n) for i in range(n)]
    return Mesh(np.concatenate([up, down]), [top, bottom, *sides])


def _handle(length=1.15):
    """From the origin towards +z, flat and widening to its end."""
    half = [(0.035, 0.0), (0.03, 0.3), (0.045, 0.8 * length), (0.065, 0.95 * length), (0.04, length)]
    return _blade([(-x, z) for x, z in half] + [(x, z) for x, z in half[::-1]], 0.02, 0.065)


def knife():
    edge = [(-0.05, 0.02), (-0.09, -0.35), (-0.075, -0.75), (0.02, -0.98), (0.04, -0.9), (0.04, 0.02)]
    return merge([_handle(), _blade(edge[::-1], 0.03, 0.05)])


def fork():
    neck = [(-0.035, 0.02), (-0.04, -0.3), (-0.11, -0.42), (-0.115, -0.55), (0.115, -0.55), (0.11, -0.42),
            (0.04, -0.3), (0.035, 0.02)]
    tines = [_blade([(x - 0.018, -0.54), (x + 0.018, -0.54), (x + 0.010, -0.95), (x - 0.010, -0.95)][::-1], 0.05, 0.085)
             for x in (-0.097, -0.032, 0.032, 0.097)]
    return merge([_handle(), _blade(neck[::-1], 0.04, 0.08), *tines])


def spoon():
    """Its bowl is a shell, open to the top."""
    neck = _blade([(-0.035, 0.02), (0.035, 0.02), (0.03, -0.32), (-0.03, -0.32)], 0.03, 0.065)
    t, s = np.meshgrid(np.linspace(0, 2 * np.pi, 19), np.linspace(1, 0, 5))
    shape = np.stack([0.2 * s * np.sin(t), 0.075 - 0.065 * (1 - s * s), -0.56 - 0.28 * s * np.cos(t)], axis=-1)
    return merge([_handle(), neck, grid(shape)])


def napkin():
    """Folded to a triangle of three layers, one corner a little open."""
    layers = []
    for k, size in enumerate((1.0, 0.95, 0.9)):
        y = 0.03 + 0.045 * k
        layers.append(_blade([(-size, 0.5 * size), (size, 0.5 * size), (0.0, -0.5 * size)], y - 0.03, y + 0.015))
    return merge(layers)


def candlestick():
    foot = [[(0.0, 0.0), (0.55, 0.0)], bezier([(0.55, 0.0), (0.56, 0.10), (0.12, 0.10), (0.10, 0.30)], 5),
            bezier([(0.10, 0.30), (0.22, 0.40), (0.05, 0.6), (0.08, 1.0), (0.13, 1.35)], 7)]
    cup = [[(0.13, 1.35), (0.30, 1.40), (0.31, 1.44)], [(0.31, 1.44), (0.14, 1.43)], [(0.14, 1.43), (0.14, 1.62)],
           [(0.14, 1.62), (0.0, 1.62)]]
    return lathe([*foot, *cup], 12)


def flame():
    return lathe([bezier([(0.0, 0.0), (0.10, 0.04), (0.05, 0.26), (0.0, 0.48)], 6)], 8)


def tray():
    """The turning part of a lazy Susan, on its foot."""
    return lathe([[(0.5, 0.0), (0.45, 0.25)], [(0.45, 0.25), (2.0, 0.25)], [(2.0, 0.25), (2.1, 0.30), (2.08, 0.40)],
                  [(2.08, 0.40), (1.98, 0.40), (1.95, 0.33)], [(1.95, 0.33), (0.0, 0.33)]], 24)


def loaf():
    """Bread with cuts across: a stretched ball whose profile is notched."""
    t = np.linspace(0, np.pi, 16)
    cuts = 0.06 * np.maximum(0, np.cos(13 * t)) ** 4 * np.sin(t)
    side = [((0.62 - c) * np.sin(a) ** 0.6 + 0.0, -1.5 * np.cos(a)) for a, c in zip(t, cuts)]
    side[0], side[-1] = (0.0, -1.5), (0.0, 1.5)
    body = lathe([side], 12).moved(rotation("z", 90))
    return Mesh(body.positions * [1, 0.75, 1], body.faces, None, body.normals)


def window_frame():
    """Around an opening 1.8 wide and 1.6 high in the xy plane, with a cross; metres."""
    outer = [box((-1.0, y, -0.06), (1.0, y + 0.1, 0.06)) for y in (-0.9, 0.8)]
    outer += [box((x, -0.9, -0.06), (x + 0.1, 0.9, 0.06)) for x in (-1.0, 0.9)]
    cross = [box((-0.025, -0.8, -0.03), (0.025, 0.8, 0.03)), box((-0.9, 0.2, -0.03), (0.9, 0.25, 0.03))]
    sill = box((-1.08, -0.96, -0.05), (1.08, -0.9, 0.16))
    return merge([*outer, *cross, sill])


MESHES = {
    "tablecloth": tablecloth, "plate": plate, "goblet": goblet, "wine": wine, "tumbler": tumbler, "bottle": bottle,
    "jug": jug, "knife": knife, "fork": fork, "spoon": spoon, "napkin": napkin, "candlestick": candlestick,
    "flame": flame, "tray": tray, "loaf": loaf, "window_frame": window_frame,
}
