"""Grass, flowers, trees and hills. What is smaller than a hand is written ten times as large, since a mesh file has
three decimals: the scene scales it by 0.1."""

import numpy as np

from .mesh import Mesh, beam, bezier, box, grid, lathe, limb, merge, rotation

PATH_HALF_WIDTH = 0.75


def path_centre(z):
    """Where the path runs: x at each z."""
    return 1.6 * np.sin(0.11 * (z + 3.0)) * np.clip(-z / 14.0, 0.15, 1.0)


def height(x, z):
    """The ground: flat around the path at first, then hills."""
    away = np.clip(-z / 40.0, 0.0, 1.6)
    hills = 2.6 * np.sin(0.055 * x + 1.0) * np.sin(0.048 * z + 0.4) + 1.3 * np.sin(0.11 * x - 0.6 + 0.04 * z)
    ridge = 5.5 * np.exp(-(((z + 95.0) / 30.0) ** 2)) * (1.0 + 0.35 * np.sin(0.06 * x + 0.5))
    near_path = 1.0 - 0.6 * np.exp(-(((x - path_centre(z)) / 6.0) ** 2))
    return away * hills * near_path + ridge + 0.05 * np.sin(0.9 * x) * np.sin(0.8 * z)


def _ground(across):
    """Columns follow the path at distances `across` from its centre; rows get longer with the distance."""
    along = 8.0 - 150.0 * np.linspace(0.0, 1.0, 28) ** 1.6

    def point(u, z):
        x = path_centre(z) + u * (1.0 + np.clip(-z, 0, 150) / 150.0)
        return np.stack([x, height(x, z), z], axis=-1)

    def normal(u, z):
        p, step = point(u, z), 0.05
        x, z = p[..., 0], p[..., 2]
        slope_x = (height(x + step, z) - height(x - step, z)) / (2 * step)
        slope_z = (height(x, z + step) - height(x, z - step)) / (2 * step)
        n = np.stack([-slope_x, np.ones_like(slope_x), -slope_z], axis=-1)
        return n / np.linalg.norm(n, axis=-1, keepdims=True)

    u, z = np.meshgrid(across, along)
    return grid(point(u, z), normals=normal(u, z))


def ground():
    """Both sides of the path; nothing scattered on it stands where the path is."""
    side = PATH_HALF_WIDTH + 90.0 * np.linspace(0.0, 1.0, 9) ** 2.0
    return merge([_ground(-side[::-1]), _ground(side)])


def path():
    return _ground(np.linspace(-PATH_HALF_WIDTH, PATH_HALF_WIDTH, 3))


def grass(blades=200, tall=3.2, seed=1):
    """A patch of radius 6 of bent blades of three triangles each."""
    random = np.random.RandomState(seed)
    positions, faces = [], []
    for k in range(blades):
        turn, distance = 2 * np.pi * random.rand(), 6.0 * np.sqrt(random.rand())
        root = distance * np.array([np.cos(turn), 0, np.sin(turn)])
        lean_to = 2 * np.pi * random.rand()
        lean = np.array([np.cos(lean_to), 0, np.sin(lean_to)])
        side = 0.5 * (0.08 + 0.08 * random.rand()) * np.array([-lean[2], 0, lean[0]])
        rise = tall * (0.55 + 0.6 * random.rand()) * (1.0 - 0.25 * distance / 6.0)
        bend = rise * (0.15 + 0.5 * random.rand())
        middle = root + [0, 0.6 * rise, 0] + 0.3 * bend * lean
        tip = root + [0, rise * (1.0 - 0.25 * (bend / rise) ** 2), 0] + bend * lean
        positions += [root - side, root + side, middle + 0.8 * side, middle - 0.8 * side, tip]
        a = 5 * k
        faces += [(a, a + 1, a + 2, a + 3), (a + 3, a + 2, a + 4)]
    return Mesh(np.array(positions), faces)


def _flower_heads():
    """Foot, head and the way it faces, of each flower of a tuft."""
    random = np.random.RandomState(12)
    for k in range(7):
        turn, distance = 2 * np.pi * (k * 0.618 + 0.1 * random.rand()), 0.4 + 2.6 * np.sqrt(random.rand())
        foot = distance * np.array([np.cos(turn), 0, np.sin(turn)])
        head = 1.25 * foot + [0.3 * random.normal(), 3.1 + 1.6 * random.rand(), 0.3 * random.normal()]
        facing = np.array([0.45 * random.normal(), 1.0, 0.45 * random.normal()])
        yield foot, head, facing / np.linalg.norm(facing)


def _on_heads(make):
    """A mesh around the y axis, put on every head."""
    parts = []
    for _, head, up in _flower_heads():
        x = np.cross(up, [0.0, 0.0, 1.0])
        x /= np.linalg.norm(x)
        parts.append(make.moved(np.stack([x, up, np.cross(x, up)], axis=1), head))
    return merge(parts)


def flower_stems():
    stems = [limb(bezier([foot, foot + [0, 0.6 * head[1], 0], head], 4), [0.06, 0.05, 0.05, 0.04], 3)
             for foot, head, _ in _flower_heads()]
    leaves = []
    for k, (foot, head, _) in enumerate(_flower_heads()):
        leaf = Mesh(np.array([[0, 0.3, 0], [0.5, 1.3, 0.16], [1.2, 1.9, 0], [0.5, 1.3, -0.16]]), [(0, 1, 2), (0, 2, 3)])
        leaves.append(leaf.moved(rotation("y", 137.0 * k), foot))
    return merge(stems + leaves)


def _petals(count, length, width, rise):
    parts = []
    for k in range(count):
        petal = [(0.1, 0, 0), (0.55 * length, 0.7 * rise, width / 2), (length, rise, 0.12 * width),
                 (length, rise, -0.12 * width), (0.55 * length, 0.7 * rise, -width / 2)]
        shape = Mesh(np.array(petal), [(0, 1, 4), (1, 2, 3, 4)])
        parts.append(shape.moved(rotation("y", 360.0 * k / count)))
    return merge(parts)


def daisy_petals():
    return _on_heads(_petals(9, 0.42, 0.19, 0.05))


def poppy_petals():
    return _on_heads(_petals(5, 0.42, 0.5, 0.24))


def flower_hearts():
    dome = lathe([[(0.14, 0.0), (0.11, 0.07), (0.0, 0.1)]], 7)
    return _on_heads(Mesh(dome.positions, dome.faces))


def crown(cards=240):
    """The leaves of a tree on trunk.obj: square cards of a twig each, in clumps around the ends of the branches."""
    random = np.random.RandomState(9)
    clumps = np.array([(0.0, 3.05, 0.0, 0.85), (0.85, 2.45, -0.3, 0.68), (-0.75, 2.65, -0.45, 0.66),
                       (-0.1, 2.6, 0.85, 0.66), (0.15, 2.85, -0.75, 0.62), (0.6, 2.75, 0.55, 0.55)])
    share = clumps[:, 3] ** 2 / (clumps[:, 3] ** 2).sum()
    parts = []
    for _ in range(cards):
        clump = clumps[random.choice(len(clumps), p=share)]
        outward = random.normal(size=3)
        outward /= np.linalg.norm(outward)
        centre = clump[:3] + clump[3] * (0.45 + 0.6 * random.rand() ** 0.6) * outward * [1, 0.8, 1]
        stem = outward + 0.6 * random.normal(size=3) - [0, 0.25, 0]
        stem /= np.linalg.norm(stem)
        side = np.cross(stem, random.normal(size=3))
        side /= np.linalg.norm(side)
        size = 0.24 + 0.10 * random.rand()
        corners = np.array([centre - size * side - size * stem, centre + size * side - size * stem,
                            centre + size * side + size * stem, centre - size * side + size * stem])
        parts.append(Mesh(corners, [(0, 1, 2, 3)], np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)))
    return merge(parts)


def mill_tower():
    body = lathe([[(1.55, -0.8), (1.5, 0.0), (1.05, 4.6)], [(1.05, 4.6), (1.2, 4.65), (1.2, 4.75)],
                  [(1.2, 4.75), (0.95, 5.3), (0.5, 5.8), (0.0, 6.0)]], 16)
    return Mesh(body.positions, body.faces)


def mill_sails():
    """Four lattices in the xy plane around the origin."""
    parts = [box((-0.14, -0.14, -0.5), (0.14, 0.14, 0.12))]
    for turn in range(4):
        spar = beam((0, 0, 0), (0, 4.0, 0), 0.13)
        rungs = [beam((-0.1, y, 0), (0.85, y, 0.06), 0.05) for y in np.linspace(0.8, 3.9, 7)]
        rails = [beam((x, 0.75, 0.05 * x), (x, 3.95, 0.05 * x), 0.05) for x in (0.42, 0.85)]
        parts.append(merge([spar, *rungs, *rails]).moved(rotation("z", 90.0 * turn)))
    return merge(parts)


MESHES = {
    "meadow_ground": ground, "meadow_path": path, "grass": grass, "flower_stems": flower_stems,
    "daisy_petals": daisy_petals, "poppy_petals": poppy_petals, "flower_hearts": flower_hearts, "crown": crown,
    "mill_tower": mill_tower, "mill_sails": mill_sails,
}
