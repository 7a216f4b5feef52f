"""Writes blocks.json: a world of unit blocks, with a house, trees and a far ship whose ropes are finer than a pixel."""

import json

import numpy as np

from .mesh import Mesh, beam, merge
from .texture import noise, ramp, to_indices

WIDTH, DEPTH, SEA = 52, 60, 3
ROCK = 8  # columns from this height on are of stone


def heights():
    """Integer heights of the columns: hills around a bay that opens to the back."""
    z, x = np.mgrid[0:DEPTH, 0:WIDTH]
    hills = 9 * noise(128, 10, 21)[:DEPTH, :WIDTH] + 2 * noise(128, 24, 22)[:DEPTH, :WIDTH]
    bay = np.exp(-(((x - 30) / 10.0) ** 2 + ((z - 8) / 20.0) ** 2))
    near = np.exp(-(((x - 27) / 9.0) ** 2 + ((z - 58) / 14.0) ** 2))
    return np.clip(np.round(hills - 11 * bay - 2.5 * near + 0.6), 0, 11).astype(int)


class Blocks:
    """Quads with uvs in blocks."""

    def __init__(self):
        self.corners, self.uvs = [], []

    def quad(self, corners, width, height):
        self.corners += corners
        self.uvs += [(0, 0), (width, 0), (width, height), (0, height)]

    def side(self, axis, outward, at, first, last, low, high):
        """A wall across x (axis 0) or z from `first` to `last` along the other."""
        a, b = (first, last) if (axis == 0) != outward else (last, first)
        if axis == 0:
            corners = [(at, low, a), (at, low, b), (at, high, b), (at, high, a)]
        else:
            corners = [(a, low, at), (b, low, at), (b, high, at), (a, high, at)]
            corners = corners[1::-1] + corners[:1:-1]
        self.quad(corners, abs(last - first), high - low)

    def top(self, x0, x1, z0, z1, y):
        self.quad([(x0, y, z1), (x1, y, z1), (x1, y, z0), (x0, y, z0)], x1 - x0, z1 - z0)

    def box(self, low, high):
        (x0, y0, z0), (x1, y1, z1) = low, high
        self.top(x0, x1, z0, z1, y1)
        self.quad([(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)], x1 - x0, z1 - z0)
        for axis, first, last in ((0, z0, z1), (2, x0, x1)):
            for outward in (False, True):
                self.side(axis, outward, (high if outward else low)[axis], first, last, y0, y1)

    def mesh(self):
        corners = np.array(self.corners, float) - [WIDTH / 2, SEA, 0] * np.ones((len(self.corners), 1))
        faces = [tuple(range(i, i + 4)) for i in range(0, len(corners), 4)]
        return Mesh(corners * [1, 1, 1] - [0, 0, DEPTH], faces, np.array(self.uvs, float))


def terrain():
    """Tops of grass and of stone, and the earth between them. Runs of equal blocks are one quad."""
    h = heights()
    grass, stone, earth = Blocks(), Blocks(), Blocks()
    for z in range(DEPTH):
        x = 0
        while x < WIDTH:
            run = x
            while run < WIDTH and h[z, run] == h[z, x]:
                run += 1
            if h[z, x] > 0:
                (stone if h[z, x] >= ROCK else grass).top(x, run, z, z + 1, h[z, x])
            x = run
    padded = np.pad(h, 1)
    for axis, across in ((0, h.shape[1]), (2, h.shape[0])):
        for outward in (False, True):
            step = 1 if outward else -1
            near = padded[1:-1, 1 + step:WIDTH + 1 + step] if axis == 0 else padded[1 + step:DEPTH + 1 + step, 1:-1]
            for at in range(across):
                mine, other = (h[:, at], near[:, at]) if axis == 0 else (h[at], near[at])
                along = 0
                while along < len(mine):
                    run = along
                    while run < len(mine) and mine[run] == mine[along] and other[run] == other[along]:
                        run += 1
                    if mine[along] > other[along]:
                        wall = stone if mine[along] >= ROCK else earth
                        wall.side(axis, outward, at + outward, along, run, other[along], mine[along])
                    along = run
    return {"blocks_grass": grass.mesh, "blocks_stone": stone.mesh, "blocks_earth": earth.mesh}


def wood():
    """The house's walls and roof, the trees' trunks, and a fence along the shore."""
    h = heights()
    blocks = Blocks()
    y = h[40:46, 12:19].max()
    blocks.box((12, 0, 40), (19, y, 46))
    blocks.box((13, y, 41), (18, y + 3, 45))
    for i in range(3):
        blocks.box((12 + i, y + 3 + i, 40), (19 - i, y + 4 + i, 46))
    for x, z in trees():
        blocks.box((x + 0.3, h[z, x], z + 0.3), (x + 0.7, h[z, x] + 4, z + 0.7))
    for x in range(20, 44, 2):
        foot = h[44, x]
        blocks.box((x + 0.42, foot, 44.42), (x + 0.58, foot + 1.2, 44.58))
        blocks.box((x, foot + 0.7, 44.46), (x + 2, foot + 0.8, 44.54))
        blocks.box((x, foot + 1.0, 44.46), (x + 2, foot + 1.1, 44.54))
    return blocks.mesh()


def trees():
    h = heights()
    random = np.random.RandomState(5)
    places = [(int(x), int(z)) for x, z in zip(random.randint(2, WIDTH - 3, 90), random.randint(4, 50, 90))]
    return [(x, z) for x, z in places if SEA + 1 <= h[z, x] < ROCK and not (9 < x < 21 and z > 37) and abs(x - 28) > 3][:20]


def leaves():
    h = heights()
    blocks = Blocks()
    for x, z in trees():
        y = h[z, x] + 3
        blocks.box((x - 1, y, z - 1), (x + 2, y + 2, z + 2))
        blocks.box((x, y + 2, z), (x + 1, y + 3, z + 1))
    return blocks.mesh()


def ship():
    """Hull, masts, yards and ropes, about its own origin; 14 long."""
    hull = Blocks()
    for i, (low, high) in enumerate(((-4, 4), (-5, 5), (-6, 6))):
        hull.box((low, i, -1.5 - 0.3 * i), (high, i + 1, 1.5 + 0.3 * i))
    corners = np.array(hull.corners, float)
    parts = [Mesh(corners, [tuple(range(i, i + 4)) for i in range(0, len(corners), 4)])]
    for x, height in ((-3, 10), (1, 12), (4.5, 8)):
        parts.append(beam((x, 2, 0), (x, height, 0), 0.2))
        for y in np.arange(5, height, 2.2):
            parts.append(beam((x, y, -2.2), (x, y, 2.2), 0.12))
        for side in (-1.9, 1.9):
            for foot in (-1.2, -0.4, 0.4, 1.2):
                parts.append(beam((x + foot, 3, side), (x, height - 0.5, 0), 0.04))
    return merge(parts)


def block_texture(seed, tones):
    """16x16 flat pixels: a block's face."""
    def make():
        return to_indices(np.random.RandomState(seed).rand(16, 16)), ramp(tones)
    return make


def planks():
    y, x = np.mgrid[0:16, 0:16]
    field = 0.35 + 0.5 * np.random.RandomState(9).rand(16, 16)
    return to_indices(np.where(y % 4 == 3, 0.05, field)), ramp([(0, "#3d2a16"), (0.3, "#7a5a33"), (1, "#a5824e")])


MESHES = {**terrain(), "blocks_wood": wood, "blocks_leaves": leaves, "ship": ship}
TEXTURES = {
    "block_grass": block_texture(1, [(0, "#3c6b24"), (1, "#7fb04a")]),
    "block_earth": block_texture(2, [(0, "#4e3521"), (1, "#8f6a45")]),
    "block_stone": block_texture(3, [(0, "#5c5c60"), (1, "#a2a2a4")]),
    "block_leaves": block_texture(4, [(0, "#16340f"), (1, "#4f8a33")]),
    "block_planks": planks,
}


def write_scene(path):
    def look(frame, eye, target):
        return {"frame": frame, "eye": eye, "target": target}

    textured = {name: {"type": "diffuse", "reflectance": {"image": f"textures/block_{name}.png", "space": "srgb"}}
                for name in ("grass", "earth", "stone", "leaves", "planks")}
    meshes = {name: f"blocks_{name}" for name in ("grass", "earth", "stone", "leaves")} | {"planks": "blocks_wood"}
    scene = {
        "frames": {"first": 1, "last": 24, "rate": 24},
        "film": {"width": 640, "height": 360, "filter": {"type": "blackman_harris", "radius_px": 1.5}},
        "integrator": {"max_depth": 4, "roulette_depth": 3, "direct": "mis", "heuristic": "power"},
        "camera": {"fov_y_deg": 50, "look_at": {"interpolation": "smooth", "keys": [
            look(1, [-1.5, 9.0, 3.0], [2.0, 1.5, -40.0]), look(13, [0.9, 8.6, 0.0], [3.0, 1.4, -42.0]),
            look(24, [3.2, 8.0, -2.6], [3.8, 1.4, -45.0])]}},
        "environment": {"radiance": [0.42, 0.58, 0.85]},
        "lights": {"sun": {"type": "sun", "azimuth_deg": -58, "elevation_deg": 38, "irradiance": [3.4, 3.1, 2.6]}},
        "materials": {**textured, "water": {"type": "diffuse", "reflectance": [0.05, 0.14, 0.22]},
                      "ship": {"type": "diffuse", "reflectance": [0.16, 0.09, 0.05]}},
        "meshes": {"sea": {"shape": "rectangle"}, "ship": {"obj": "meshes/ship.obj"},
                   **{name: {"obj": f"meshes/{mesh}.obj"} for name, mesh in meshes.items()}},
        "objects": [{"name": "sea", "mesh": "sea", "material": "water", "transform": {"scale": [300, 1, 300], "translate": [0, -0.2, -200]}},
                    {"name": "ship", "mesh": "ship", "material": "ship",
                     "transform": {"rotate_deg": [0, 28, 0], "translate": [7.0, -0.4, -78.0]}},
                    *({"name": name, "mesh": name, "material": name} for name in meshes)],
    }
    path.write_text(json.dumps(scene, indent=1) + "\n")
