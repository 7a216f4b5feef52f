"""The courtyard's stonework and leaves, and the sky above it."""

import numpy as np

from .files import few_bits
from .mesh import Mesh, bezier, box, lathe, limb, merge, polygon, rotation
from .texture import fractal

BAY, OPENING, SPRING, TOP, DEPTH = 2.0, 0.78, 2.1, 4.6, 0.45


def arcade(bays=4):
    """A wall on round arches, from x = 0; the front is at z = 0. It stands on columns, so it begins at the springing."""
    faces = []
    angles = np.linspace(np.pi, 0, 13)
    for bay in range(bays):
        middle = (bay + 0.5) * BAY
        arch = [(middle + OPENING * np.cos(a), SPRING + OPENING * np.sin(a)) for a in angles]
        outline = [(bay * BAY, SPRING), *arch, ((bay + 1) * BAY, SPRING)]
        for (x0, y0), (x1, y1) in zip(outline, outline[1:]):
            front = [(x0, y0, 0), (x1, y1, 0), (x1, TOP, 0), (x0, TOP, 0)]
            faces.append(polygon(front, [(x, y) for x, y, _ in front]))
            back = [(x1, y1, -DEPTH), (x0, y0, -DEPTH), (x0, TOP, -DEPTH), (x1, TOP, -DEPTH)]
            faces.append(polygon(back, [(x, y) for x, y, _ in back]))
            under = [(x0, y0, -DEPTH), (x1, y1, -DEPTH), (x1, y1, 0), (x0, y0, 0)]
            faces.append(polygon(under, [(x, z) for x, _, z in under]))
    top = [(0, TOP, 0), (bays * BAY, TOP, 0), (bays * BAY, TOP, -DEPTH), (0, TOP, -DEPTH)]
    faces.append(polygon(top, [(x, z) for x, _, z in top]))
    return merge(faces)


def column():
    shaft = [(0.165, 0.26), (0.168, 0.8), (0.145, 1.78)]
    base = [[(0.24, 0.12), (0.24, 0.18), (0.20, 0.21), (0.21, 0.25), (0.165, 0.26)]]
    capital = [[(0.145, 1.78), (0.17, 1.80), (0.15, 1.83), (0.17, 1.90), (0.23, 1.97)]]
    turned = lathe([*base, shaft, *capital], 18)
    blocks = merge([box((-0.26, 0, -0.26), (0.26, 0.12, 0.26)), box((-0.245, 1.96, -0.245), (0.245, 2.1, 0.245))])
    return merge([Mesh(turned.positions, turned.faces), blocks])


def roof(width=8.4, length=1.5, rows=4, pitch=0.21):
    """Rows of half-round tiles, each row lapping over the next, on boards; slopes down towards +z from the origin."""
    angles = np.linspace(0, np.pi, 5)
    count = int(width / pitch)
    parts = []
    for row in range(rows):
        z0, z1 = row * length / rows, (row + 1.12) * length / rows
        for k in range(count):
            radius = 0.5 * pitch
            x = -0.2 + (k + 0.5) * pitch
            ring = [(x - radius * np.cos(a), radius * 0.8 * np.sin(a)) for a in angles]
            lift = 0.035
            upper = [(px, py, z0) for px, py in ring]
            lower = [(px, py + lift, z1) for px, py in ring]
            faces = [(i, 5 + i, 6 + i, i + 1) for i in range(4)]
            parts.append(Mesh(np.array(upper + lower), faces))
    boards = [(-0.2, -0.01, 0), (-0.2, -0.01, length), (width - 0.2, -0.01, length), (width - 0.2, -0.01, 0)]
    return merge([*parts, polygon(boards)])


def fountain():
    """An eight-sided basin around a stem that carries a bowl."""
    basin = [[(1.25, 0.0), (1.25, 0.10)], [(1.25, 0.10), (1.10, 0.12)], [(1.10, 0.12), (1.10, 0.46)],
             [(1.10, 0.46), (1.18, 0.48)], [(1.18, 0.48), (1.18, 0.56)], [(1.18, 0.56), (0.94, 0.56)],
             [(0.94, 0.56), (0.94, 0.1)]]
    stem = [[(0.20, 0.1), (0.20, 0.5), (0.10, 0.62), (0.085, 0.95), (0.16, 1.08)]]
    dish = [bezier([(0.16, 1.08), (0.40, 1.10), (0.56, 1.20), (0.62, 1.30)], 6), [(0.62, 1.30), (0.57, 1.30)],
            bezier([(0.57, 1.30), (0.48, 1.20), (0.2, 1.17), (0.09, 1.17)], 5)]
    finial = [[(0.09, 1.17), (0.06, 1.3), (0.11, 1.40), (0.05, 1.50), (0.0, 1.52)]]
    octagon, round_part = lathe(basin, 8), lathe(stem + dish + finial, 22)
    flat = Mesh(octagon.positions, octagon.faces)
    return flat, round_part


def foliage(leaves=300):
    """A ball of leaves of radius about 1, denser towards its surface; each leaf is a folded diamond."""
    random = np.random.RandomState(6)
    parts = []
    for _ in range(leaves):
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        centre = direction * (0.35 + 0.65 * random.rand() ** 0.5) * [1, 0.85, 1]
        axis = direction + 0.9 * random.normal(size=3)
        axis /= np.linalg.norm(axis)
        side = np.cross(axis, random.normal(size=3))
        side /= np.linalg.norm(side)
        size = 0.10 + 0.07 * random.rand()
        fold = 0.25 * size * np.cross(side, axis)
        corners = [centre, centre + 0.55 * size * side + size * axis + fold, centre + 2 * size * axis,
                   centre - 0.55 * size * side + size * axis + fold]
        parts.append(Mesh(np.array(corners), [(0, 1, 2), (0, 2, 3)]))
    return merge(parts)


def trunk():
    stem = bezier([(0, 0, 0), (0.10, 0.9, 0.05), (-0.15, 1.4, 0), (0.05, 2.3, 0)], 9)
    parts = [limb(stem, np.linspace(0.16, 0.07, 9), 9)]
    for turn, height, reach in ((20, 1.35, 0.9), (150, 1.6, 0.8), (265, 1.5, 0.85), (80, 1.9, 0.6)):
        branch = bezier([(0, height, 0), (0.35 * reach, height + 0.15, 0), (reach, height + 0.9, 0)], 6)
        parts.append(limb(branch, np.linspace(0.07, 0.02, 6), 6).moved(rotation("y", turn)))
    return merge(parts)


def bench():
    planks = [box((-0.8, 0.42, z), (0.8, 0.46, z + 0.10)) for z in (-0.20, -0.08, 0.04, 0.16)]
    back = [box((-0.8, y, -0.30), (0.8, y + 0.11, -0.26)) for y in (0.58, 0.73)]
    feet = [box((x - 0.04, 0, -0.27), (x + 0.04, 0.42, 0.24)) for x in (-0.62, 0.62)]
    posts = [box((x - 0.03, 0.42, -0.26), (x + 0.03, 0.84, -0.22)) for x in (-0.62, 0.62)]
    return merge(planks + back + feet + posts)


def sky(width=512, height=256, sun_elevation=38.0, sun_radius=1.6):
    """Latitude-longitude, the sun in the centre column: a scene turns it with rotate_y_deg. Radiance is about 1 at the
    horizon; the sun is wider than the real one and as much dimmer, so that it covers several texels."""
    elevation = np.radians(90 - (np.arange(height) + 0.5) * 180 / height)[:, None]
    azimuth = np.radians((np.arange(width) + 0.5) * 360 / width - 180)[None, :]
    up = np.sin(elevation)
    blend = np.clip(up, 0, 1) ** 0.45
    horizon, zenith = np.array([0.58, 0.72, 0.93]), np.array([0.11, 0.26, 0.64])
    image = horizon + (zenith - horizon) * blend[..., None] + np.zeros((height, width, 1))

    sun = np.radians(sun_elevation)
    cosine = np.cos(elevation) * np.cos(azimuth) * np.cos(sun) + up * np.sin(sun)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    image += np.array([0.9, 0.72, 0.45]) * (0.55 * np.exp(-angle / 9.0))[..., None]

    clouds = fractal(width, 4, 5, 77)[:height]
    cover = np.clip((clouds - 0.52) * 2.6, 0, 1) * np.clip(up * 5, 0, 1) * np.clip(1.6 - up * 1.2, 0, 1)
    image += cover[..., None] * 0.75 * (np.array([1.05, 1.0, 0.95]) - 0.6 * image)

    ground = np.array([0.22, 0.19, 0.15])
    image = np.where((up < 0)[..., None], ground, image)
    disc = np.clip((sun_radius + 0.35 - angle) / 0.7, 0, 1)
    image += np.array([1.0, 0.86, 0.66]) * (3200.0 * disc)[..., None]
    return few_bits(image)


MESHES = {
    "arcade": arcade, "column": column, "roof": roof, "fountain_basin": lambda: fountain()[0],
    "fountain_bowl": lambda: fountain()[1], "foliage": foliage, "trunk": trunk, "bench": bench,
}
