"""Furniture of the room: things with slats, legs and leaves, whose shadows have more edges than they have."""

import numpy as np

from .mesh import Mesh, beam, bezier, box, lathe, merge, rotation


def lamp_shade():
    """Hangs from the origin, so that rotating it makes it swing."""
    outside = [(0.30, -1.16), (0.285, -1.06), (0.20, -0.94), (0.05, -0.87), (0.03, -0.80)]
    inside = [(r - 0.006, y - 0.006) for r, y in reversed(outside[:-1])]
    cord = [(0.006, -0.82), (0.006, 0.0)]
    return lathe([outside, inside, cord], 26)


def lamp_bulb():
    """A disc that faces down inside the shade; it swings with it about the origin."""
    angle = -2 * np.pi * np.arange(24) / 24
    rim = np.stack([0.15 * np.cos(angle), np.full(24, -1.10), -0.15 * np.sin(angle)], axis=1)
    return Mesh(np.concatenate([[[0, -1.10, 0]], rim]), [(0, 1 + i, 1 + (i + 1) % 24) for i in range(24)])


def chair():
    legs = [beam((x, 0, 0.20), (0.9 * x, 0.46, 0.18), 0.035) for x in (-0.21, 0.21)]
    posts = [beam((x, 0, -0.22), (x, 0.46, -0.19), 0.035) for x in (-0.20, 0.20)]
    back = [beam((x, 0.44, -0.19), (x, 1.00, -0.29), 0.032) for x in (-0.20, 0.20)]
    slats = [beam((x, 0.56, -0.212), (x, 0.97, -0.284), 0.020) for x in np.linspace(-0.14, 0.14, 5)]
    rails = [beam((-0.21, y, z), (0.21, y, z), 0.04) for y, z in ((0.55, -0.210), (0.98, -0.286))]
    stretchers = [beam((x, 0.20, -0.20), (x, 0.22, 0.19), 0.022) for x in (-0.2, 0.2)]
    seat = box((-0.235, 0.45, -0.22), (0.235, 0.48, 0.23))
    return merge([*legs, *posts, *back, *slats, *rails, *stretchers, seat])


def table():
    top = [[(0.0, 0.70), (0.47, 0.70)], [(0.47, 0.70), (0.48, 0.715), (0.47, 0.73)], [(0.47, 0.73), (0.0, 0.73)]]
    foot = [[(0.28, 0.0), (0.28, 0.015), (0.05, 0.06), (0.03, 0.14), (0.028, 0.4), (0.035, 0.6), (0.09, 0.70)]]
    return lathe(top + foot, 30)


def vase():
    outside = bezier([(0.055, 0), (0.19, 0.06), (0.13, 0.30), (0.0, 0.26), (0.06, 0.40)], 14)
    inside = [(0.054, 0.40), (0.03, 0.33), (0.03, 0.27)]
    return lathe([[(0.0, 0.0), (0.055, 0.0)], outside, inside], 24)


def bowl():
    outside = bezier([(0.05, 0), (0.15, 0.0), (0.17, 0.06), (0.19, 0.10)], 8)
    inside = [(r * 0.95, 0.008 + 0.93 * y) for r, y in outside[::-1]]
    inside[-1] = (0.0, inside[-1][1])
    return lathe([outside, inside], 24)


def pot():
    profiles = [[(0.15, 0.0), (0.22, 0.36)], [(0.22, 0.36), (0.235, 0.36), (0.235, 0.41), (0.205, 0.41)],
                [(0.205, 0.41), (0.19, 0.34), (0.0, 0.34)]]
    return lathe(profiles, 24)


def folding_screen():
    """Three panels hinged at 40 degrees; each has a frame and upright slats with gaps between."""
    width, height = 0.62, 1.75
    bars = [box((x - 0.02, 0, -0.016), (x + 0.02, height, 0.016)) for x in (0.02, width - 0.02)]
    bars += [box((0.02, y, -0.014), (width - 0.02, y + 0.04, 0.014)) for y in (0.08, 0.95, height - 0.06)]
    bars += [box((x - 0.009, 0.1, -0.008), (x + 0.009, height - 0.05, 0.008))
             for x in np.linspace(0.075, width - 0.075, 11)]
    panel = merge(bars)
    hinge, panels = np.zeros(3), []
    for turn in (-22, 24, -16):
        panels.append(panel.moved(rotation("y", turn), hinge))
        hinge = hinge + rotation("y", turn) @ [width, 0, 0]
    return merge(panels)


def plant():
    """Arching leaves from one root, folded along the midrib."""
    random = np.random.RandomState(2)
    leaves = []
    for k in range(17):
        turn = 360 * (k * 0.618) + 15 * random.rand()
        reach, rise = 0.28 + 0.30 * random.rand(), 0.55 + 0.55 * random.rand()
        spine = bezier([(0, 0, 0), (0.04, rise, 0), (reach, rise, 0), (reach * 1.35, rise * 0.62, 0)], 9)
        t = np.linspace(0, 1, 9)
        width = 0.085 * np.sin(np.pi * np.clip((t - 0.22) / 0.78, 0, 1)) ** 0.8 + 0.005
        left = spine + np.stack([0 * t, 0.35 * width, width], axis=1)
        right = spine + np.stack([0 * t, 0.35 * width, -width], axis=1)
        positions = np.stack([left, spine, right], axis=1).reshape(-1, 3)
        faces = []
        for i in range(8):
            a, b = 3 * i, 3 * (i + 1)
            faces += [(a, a + 1, b + 1, b), (a + 1, a + 2, b + 2, b + 1)]
        leaves.append(Mesh(positions, faces).moved(rotation("y", turn)))
    return merge(leaves)


MESHES = {
    "lamp_shade": lamp_shade, "lamp_bulb": lamp_bulb, "chair": chair, "table": table, "vase": vase, "bowl": bowl,
    "pot": pot, "folding_screen": folding_screen, "plant": plant,
}
