"""A garden's fence: pickets and wire, whose shadows are finer than what they fall on."""

import numpy as np

from .mesh import Mesh, beam, bezier, box, lathe, merge
from .texture import fractal, noise, ramp, to_indices


def pickets(length=4.0, count=31):
    """A run of pointed pickets on two rails along x from the origin, with a post at each end. The front faces +z."""
    parts = [box((0, y, -0.05), (length, y + 0.07, -0.015)) for y in (0.25, 0.78)]
    for k in range(count):
        x = (k + 0.5) * length / count
        outline = [(x - 0.04, 0.06), (x + 0.04, 0.06), (x + 0.04, 1.0), (x, 1.09), (x - 0.04, 1.0)]
        front = [(px, py, 0.012) for px, py in outline]
        back = [(px, py, -0.012) for px, py in outline]
        n = len(outline)
        sides = [(i, n + i, n + (i + 1) % n, (i + 1) % n) for i in range(n)]
        parts.append(Mesh(np.array(front + back), [tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *sides]))
    for x in (0, length):
        parts.append(box((x - 0.055, 0, -0.055 - 0.06), (x + 0.055, 1.16, 0.055 - 0.06)))
        cap = [(x - 0.075, 1.16, -0.135), (x + 0.075, 1.16, -0.135), (x + 0.075, 1.16, 0.015), (x - 0.075, 1.16, 0.015)]
        top = [x, 1.24, -0.06]
        parts.append(Mesh(np.array([*cap, top]), [(0, 1, 2, 3), (1, 0, 4), (2, 1, 4), (3, 2, 4), (0, 3, 4)]))
    return merge(parts)


def wire(width=1.5, height=1.15, pitch=0.11):
    """Crossed wires along both diagonals, from the origin along x and up."""
    parts = []
    for k in np.arange(-height + 0.5 * pitch, width, pitch):
        low, high = max(k, 0.0), min(k + height, width)
        for mirror in (False, True):
            ends = [(low, low - k), (high, high - k)]
            ends = [(width - x, y) for x, y in ends] if mirror else ends
            parts.append(beam((*ends[0], 0), (*ends[1], 0), 0.007))
    return merge(parts)


def gate_frame(width=1.5, height=1.15):
    bars = [beam((x, 0, 0), (x, height, 0), 0.035) for x in (0, width)]
    bars += [beam((0, y, 0), (width, y, 0), 0.035) for y in (0, height)]
    return merge(bars)


def grass_tuft(blades=26):
    """Bent blades from one root, about 0.2 high."""
    random = np.random.RandomState(12)
    parts = []
    for _ in range(blades):
        turn = 2 * np.pi * random.rand()
        root = 0.05 * random.normal(size=2)
        height, lean = 0.10 + 0.12 * random.rand(), 0.02 + 0.09 * random.rand()
        outward = np.array([np.cos(turn), 0, np.sin(turn)])
        across = 0.005 * np.array([-np.sin(turn), 0, np.cos(turn)])
        spine = bezier([(0, 0, 0), height * np.array([0, 0.7, 0]), np.array([0, height, 0]) + lean * outward], 4)
        spine += [root[0], 0, root[1]]
        positions = [p + s * across * (1 - i / 3) for i, p in enumerate(spine[:3]) for s in (-1, 1)] + [spine[3]]
        parts.append(Mesh(np.array(positions), [(0, 1, 3, 2), (2, 3, 5, 4), (4, 5, 6)]))
    return merge(parts)


def bucket():
    body = [[(0.0, 0.0), (0.13, 0.0)], [(0.13, 0.0), (0.12, 0.26)], [(0.12, 0.26), (0.115, 0.27), (0.09, 0.31)],
            [(0.085, 0.31), (0.11, 0.02)]]
    return lathe(body, 24)


def lawn(size=256):
    """Short grass with worn patches."""
    blades = 0.5 * noise(size, 128, 3) + 0.5 * noise(size, 64, 4)
    field = 0.15 + 0.55 * blades + 0.45 * (fractal(size, 4, 4, 50) - 0.5)
    return to_indices(np.clip(field, 0, 1)), ramp([(0, "#2c3a17"), (0.35, "#4a6123"), (0.7, "#728338"), (1, "#b0a662")])


def paving(size=256, rows=6):
    """Slabs of several lengths in rows, each of a tone of its own, with sandy joints."""
    y, x = np.mgrid[0:size, 0:size] / size
    wobble = 0.05 * (fractal(size, 16, 3, 5) - 0.5)
    row_position = y * rows + wobble
    row = np.floor(row_position).astype(int)
    shift = np.array([0.0, 0.37, 0.71, 0.18, 0.55, 0.86])[row % rows]
    u = (x * 4 + shift + wobble) % 4
    starts = np.array([0, 1.2, 2.0, 3.1, 4.0])
    slab = np.searchsorted(starts, u, side="right") - 1
    along = np.minimum(u - starts[slab], starts[slab + 1] - u) * rows / 4
    edge = np.minimum(along, np.minimum(row_position - row, row + 1 - row_position))
    tone = np.random.RandomState(3).rand(rows, 4)[row % rows, slab]
    grain = noise(size, 128, 13)
    field = 0.5 + 0.32 * (tone - 0.5) + 0.2 * (grain - 0.5) + 0.25 * (fractal(size, 8, 4, 70) - 0.5)
    field = np.where(edge < 0.045, 0.03 + 0.15 * grain, np.clip(field, 0.25, 1))
    return to_indices(field), ramp(
        [(0, "#4f4636"), (0.2, "#6b604c"), (0.25, "#84796a"), (0.6, "#b3a794"), (1, "#d9cfba")])


MESHES = {
    "pickets": pickets, "wire": wire, "gate_frame": gate_frame, "grass_tuft": grass_tuft, "bucket": bucket,
}
TEXTURES = {"lawn": lawn, "paving": paving}
