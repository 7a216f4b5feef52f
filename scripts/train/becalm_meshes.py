"""Random meshes for training shots, written as OBJ files.

Every mesh stands on y = 0, is centred in x and z, and its largest extent is 1, so that a layout can place any of
them without knowing which it is. Mesh number n is a pure function of n.
"""

import json

import numpy as np

KINDS = ["lathe", "prism", "knot", "noise_sphere", "sheet", "cards", "grass", "stairs", "column", "gear", "frame",
         "lattice", "rock", "spring", "bevelled_box", "terrain", "shell", "slab_stack", "star", "spikes"]
# Flat things, grass and terrain are placed by layouts that ask for them.
SPECIAL_KINDS = {"sheet", "cards", "grass", "frame", "terrain"}


def make_library(folder, count):
    """Writes `count` meshes and meshes.json, the list of their names and kinds."""
    folder.mkdir(parents=True, exist_ok=True)
    entries = []
    for number in range(count):
        rng = np.random.default_rng([number, 0x4D455348])
        kind = KINDS[number % len(KINDS)]
        positions, uvs, normals, triangles = BUILDERS[kind](rng)
        positions = _standing(positions)
        name = f"mesh_{number:02d}.obj"
        _write_obj(folder / name, positions, uvs, normals, triangles)
        entries.append({"file": name, "kind": kind})
    (folder / "meshes.json").write_text(json.dumps(entries, indent=1))


def _standing(positions):
    low, high = positions.min(0), positions.max(0)
    centre = (low + high) / 2
    centre[1] = low[1]
    return (positions - centre) / (high - low).max()


def _write_obj(path, positions, uvs, normals, triangles):
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in positions]
    lines += [f"vt {u:.4f} {v:.4f}" for u, v in uvs]
    lines += [f"vn {x:.3f} {y:.3f} {z:.3f}" for x, y, z in normals]
    lines += ["f " + " ".join(f"{i}/{i}/{i}" for i in corner) for corner in triangles + 1]
    path.write_text("\n".join(lines) + "\n")


# Builders return positions, uvs, normals (one a vertex each) and triangles of vertex numbers.


def _grid(positions, repeat=(1.0, 1.0), faceted=False):
    """Surface through a grid of points (rows, columns, 3); u runs along columns, v along rows."""
    rows, columns, _ = positions.shape
    v, u = np.meshgrid(np.linspace(0, repeat[1], rows), np.linspace(0, repeat[0], columns), indexing="ij")
    uvs = np.stack([u, v], -1).reshape(-1, 2)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    positions = positions.reshape(-1, 3)
    triangles = triangles[_areas(positions, triangles) > 1e-10]
    return _flat(positions, uvs, triangles) if faceted else _smooth(positions, uvs, triangles)


def _areas(positions, triangles):
    p = positions[triangles]
    return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=-1)


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def _face_normals(positions, triangles):
    p = positions[triangles]
    return np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])


def _smooth(positions, uvs, triangles):
    """Vertices at one place share a normal, so that seams of a closed grid do not show."""
    _, place = np.unique(positions.round(5), axis=0, return_inverse=True)
    place = place.reshape(-1)
    sums = np.zeros((place.max() + 1, 3))
    faces = _face_normals(positions, triangles)
    for corner in range(3):
        np.add.at(sums, place[triangles[:, corner]], faces)
    return positions, uvs, _unit(sums)[place], triangles


def _flat(positions, uvs, triangles):
    normals = np.repeat(_unit(_face_normals(positions, triangles)), 3, axis=0)
    corners = triangles.reshape(-1)
    return positions[corners], uvs[corners], normals, np.arange(len(corners)).reshape(-1, 3)


def _join(parts):
    offset, joined = 0, []
    for positions, uvs, normals, triangles in parts:
        joined.append((positions, uvs, normals, triangles + offset))
        offset += len(positions)
    return tuple(np.concatenate(arrays) for arrays in zip(*joined))


def _box(low, high):
    """Axis-aligned box with outward faces and uvs in [0,1] on each."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    faces = []
    for axis in range(3):
        for side in (0, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            corner = np.zeros((2, 2, 3))
            corner[..., axis] = high[axis] if side else low[axis]
            corner[:, 0, u], corner[:, 1, u] = (low[u], high[u]) if side else (high[u], low[u])
            corner[0, :, v], corner[1, :, v] = low[v], high[v]
            faces.append(_grid(corner, faceted=True))
    return _join(faces)


def _noise(rng, points, octaves=4, frequency=1.5):
    """Sum of randomly oriented sine waves: smooth, cheap, and about unit amplitude."""
    total, amplitude = np.zeros(points.shape[:-1]), 1.0
    for _ in range(octaves):
        for _ in range(4):
            direction = rng.normal(size=3) * frequency
            total += amplitude * 0.35 * np.sin(points @ direction + rng.uniform(0, 2 * np.pi))
        amplitude *= 0.5
        frequency *= 2.1
    return total


def _around(count):
    return np.append(np.linspace(0, 2 * np.pi, count, endpoint=False), 0.0)


def _revolve(radii, heights, count, faceted=False, flutes=0, depth=0.0):
    """Around y; rows from the bottom. Flutes modulate the radius around the axis."""
    angle = _around(count)
    wave = 1 - depth * (0.5 + 0.5 * np.cos(flutes * angle))
    radius = np.asarray(radii)[:, None] * wave
    points = np.stack([radius * np.sin(angle), np.repeat(np.asarray(heights)[:, None], count + 1, 1),
                       radius * np.cos(angle)], -1)
    return _grid(points, (3, 2), faceted)


def _lathe(rng):
    count = rng.integers(4, 9)
    knots = np.sort(rng.uniform(0, 1, count))
    radii = rng.uniform(0.08, 0.5, count)
    height = np.linspace(0, 1, 60)
    radius = np.interp(height, knots, radii)
    if rng.random() < 0.7:
        radius = np.convolve(np.pad(radius, 6, "edge"), np.hanning(13) / np.hanning(13).sum(), "valid")
    height, radius = np.append(np.append(0, height), 1), np.append(np.append(1e-4, radius), 1e-4)
    return _revolve(radius, height * rng.uniform(0.6, 1.6), 56, flutes=int(rng.integers(3, 13)),
                    depth=rng.choice([0, 0, 0.2]))


def _column(rng):
    height = np.concatenate([[0, 0, 0.05, 0.05, 0.09, 0.12], np.linspace(0.13, 0.87, 8), [0.9, 0.93, 0.93, 1, 1]])
    radius = np.concatenate([[1e-4, 0.2, 0.2, 0.17, 0.17, 0.13], np.linspace(0.13, 0.105, 8), [0.14, 0.15, 0.2, 0.2, 1e-4]])
    return _revolve(radius, height * rng.uniform(0.8, 1.6), 96, flutes=int(rng.integers(8, 24)),
                    depth=rng.uniform(0, 0.15))


def _shell(rng):
    """An open bowl with an inner side."""
    t = np.linspace(0, rng.uniform(0.35, 0.75) * np.pi, 24)
    outer = np.stack([np.sin(t), -np.cos(t)], -1)
    profile = np.concatenate([outer, outer[::-1] * rng.uniform(0.85, 0.96)])
    return _revolve(profile[:, 0].clip(1e-4), profile[:, 1], 64, flutes=int(rng.integers(4, 20)),
                    depth=rng.choice([0, 0.1, 0.25]))


def _prism(rng):
    corners = int(rng.integers(3, 9)) * 2
    angle = _around(corners)
    radius = np.where(np.arange(corners + 1) % 2, rng.uniform(0.35, 1.0), 1.0)
    rows = 40
    t = np.linspace(0, 1, rows)
    turn = rng.uniform(-2.5, 2.5) * t
    size = 0.45 * (1 - rng.uniform(0, 0.8) * t ** rng.uniform(0.5, 2))
    size = np.concatenate([[1e-4], size, [1e-4]])
    turn, t = np.pad(turn, 1, "edge"), np.pad(t, 1, "edge")
    a = angle[None] + turn[:, None]
    r = radius[None] * size[:, None]
    points = np.stack([r * np.sin(a), np.repeat(t[:, None], corners + 1, 1) * rng.uniform(0.6, 1.5), r * np.cos(a)], -1)
    return _grid(points, (4, 2), faceted=True)


def _tube(path, radius, around=16, closed=True, repeat=(1, 16)):
    tangent = _unit(np.gradient(path, axis=0))
    if closed:
        tangent[0] = tangent[-1] = _unit(path[1] - path[-2])
    side = np.cross(tangent, [0.13, 1.0, 0.07])
    normal = _unit(side)
    binormal = np.cross(tangent, normal)
    a = _around(around)
    ring = np.cos(a)[None, :, None] * normal[:, None] + np.sin(a)[None, :, None] * binormal[:, None]
    radius = np.broadcast_to(radius, len(path))[:, None, None]
    return _grid(path[:, None] + radius * ring, repeat)


def _knot(rng):
    p, q = [(2, 3), (3, 2), (2, 5), (3, 4), (1, 5), (5, 2)][rng.integers(6)]
    t = np.linspace(0, 2 * np.pi, 241)
    r = 1 + rng.uniform(0.3, 0.5) * np.cos(q * t)
    path = np.stack([r * np.cos(p * t), r * np.sin(p * t), -rng.uniform(0.3, 0.5) * np.sin(q * t)], -1)
    return _tube(path, rng.uniform(0.08, 0.22))


def _spring(rng):
    turns = rng.integers(3, 9)
    t = np.linspace(0, 1, 40 * turns)
    a = t * turns * 2 * np.pi
    r = 0.4 * (1 - rng.uniform(0, 0.7) * t)
    path = np.stack([r * np.cos(a), t * rng.uniform(0.6, 1.4), r * np.sin(a)], -1)
    return _tube(path, rng.uniform(0.02, 0.06), 12, closed=False)


def _sphere_points(rows, columns):
    theta = np.linspace(1e-3, np.pi - 1e-3, rows)[::-1, None]
    phi = _around(columns)[None]
    return np.stack([np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.cos(phi)], -1)


def _noise_sphere(rng):
    points = _sphere_points(64, 96)
    relief = _noise(rng, points, int(rng.integers(1, 6)), rng.uniform(1, 4))
    if rng.random() < 0.3:
        relief = -np.abs(relief)
    return _grid(points * (1 + rng.uniform(0.1, 0.35) * relief.clip(-1.5, 2))[..., None], (2, 1))


def _rock(rng):
    points = _sphere_points(int(rng.integers(6, 12)), int(rng.integers(7, 13)))
    points = points * (1 + 0.2 * _noise(rng, points, 2, 3))[..., None] * rng.uniform(0.5, 1, 3)
    return _grid(points, (2, 1), faceted=True)


def _spikes(rng):
    points = _sphere_points(48, 96)
    waves = np.sin(rng.integers(4, 12) * np.linspace(0, np.pi, 48))[:, None] * np.sin(rng.integers(4, 14) * _around(96))
    return _grid(points * (1 + 0.6 * np.abs(waves) ** rng.uniform(1, 4))[..., None], (2, 1))


def _star(rng):
    """A superquadric: between octahedron, cushion and cube."""
    p = _sphere_points(48, 64)
    e = rng.uniform(0.25, 2.6)
    return _grid(np.sign(p) * np.abs(p) ** e * rng.uniform(0.6, 1, 3), (2, 1))


def _sheet(rng):
    u, v = np.meshgrid(np.linspace(-1, 1, 90), np.linspace(-1, 1, 90))
    flat = np.stack([u, 0 * u, -v], -1)
    height = rng.uniform(0.05, 0.3) * _noise(rng, flat, int(rng.integers(1, 4)), rng.uniform(1, 5))
    folds = rng.choice([0, 0.12]) * np.sin(rng.uniform(6, 20) * u + rng.uniform(0, 2) * v)
    flat[..., 1] = height + folds
    return _grid(flat, (1, 1))


def _terrain(rng):
    x, z = np.meshgrid(np.linspace(-1, 1, 128), np.linspace(1, -1, 128))
    points = np.stack([x, 0 * x, z], -1)
    height = _noise(rng, points, 6, rng.uniform(1.2, 3.5))
    style = rng.integers(3)
    if style == 0:
        height = -np.abs(height)
    elif style == 1:
        height = np.round(height * 4) / 4 * 0.7 + height * 0.3
    points[..., 1] = height * rng.uniform(0.06, 0.22)
    return _grid(points, (1, 1), faceted=bool(rng.random() < 0.3))


def _cards(rng):
    """Crossing rectangles with a whole texture each, for opacity masks."""
    parts = []
    for _ in range(int(rng.integers(5, 24))):
        centre = rng.normal(size=3) * [0.35, 0.3, 0.35] + [0, 0.5, 0]
        right = _unit(rng.normal(size=3)) * rng.uniform(0.15, 0.4)
        up = _unit(np.cross(right, rng.normal(size=3))) * np.linalg.norm(right)
        corners = np.array([[centre - right - up, centre + right - up], [centre - right + up, centre + right + up]])
        parts.append(_grid(corners, faceted=True))
    return _join(parts)


def _grass(rng):
    """A tuft of bent blades, three segments each."""
    parts, bend = [], rng.uniform(0.1, 0.6)
    for _ in range(int(rng.integers(14, 40))):
        root = np.array([*rng.normal(size=2) * 0.12, 0])[[0, 2, 1]]
        way = rng.uniform(0, 2 * np.pi)
        along, across = np.array([np.cos(way), 0, np.sin(way)]), np.array([-np.sin(way), 0, np.cos(way)])
        t = np.linspace(0, 1, 4)[:, None]
        spine = root + t * [0, rng.uniform(0.5, 1), 0] + t**2 * along * bend * rng.uniform(0.3, 1.5)
        width = across * 0.02 * (1.05 - t)
        parts.append(_grid(np.stack([spine - width, spine + width], 1), faceted=True))
    return _join(parts)


def _stairs(rng):
    steps, rise, run = int(rng.integers(3, 10)), rng.uniform(0.5, 1.2), rng.uniform(0.8, 1.5)
    width = rng.uniform(1, 5)
    return _join([_box([0, 0, -(i + 1) * run], [width, (i + 1) * rise, -i * run]) for i in range(steps)])


def _slab_stack(rng):
    parts, y = [], 0.0
    for _ in range(int(rng.integers(3, 9))):
        size, height = rng.uniform(0.2, 0.6, 2), rng.uniform(0.05, 0.3)
        shift = rng.normal(size=2) * 0.08
        parts.append(_box([shift[0] - size[0], y, shift[1] - size[1]], [shift[0] + size[0], y + height, shift[1] + size[1]]))
        y += height
    return _join(parts)


def _lattice(rng):
    parts, count, bar = [], rng.integers(2, 5, 3) + 1, rng.uniform(0.03, 0.08)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for a in np.linspace(-0.5, 0.5, count[u]):
            for b in np.linspace(-0.5, 0.5, count[v]):
                low, high = np.full(3, -0.5 - bar), np.full(3, 0.5 + bar)
                low[[u, v]], high[[u, v]] = [a - bar, b - bar], [a + bar, b + bar]
                parts.append(_box(low, high))
    return _join(parts)


def _bevelled_box(rng):
    p = _sphere_points(49, 64)
    cube = p / np.abs(p).max(-1, keepdims=True)
    bevel = rng.uniform(0.05, 0.4)
    return _grid((cube.clip(bevel - 1, 1 - bevel) + bevel * p) * rng.uniform(0.3, 1, 3), (2, 1))


def _gear(rng):
    teeth = int(rng.integers(6, 20))
    a = _around(teeth * 8)
    rim = 1 + rng.uniform(0.1, 0.3) * np.clip(3 * np.sin(teeth * a), -1, 1)
    hole, thick = rng.uniform(0.2, 0.7), rng.uniform(0.1, 0.5)
    profile = [(hole, -thick), (rim, -thick), (rim, thick), (hole, thick), (hole, -thick)]
    points = np.stack([np.stack([r * np.cos(a), r * np.sin(a), z + 0 * a], -1) for r, z in profile])
    return _grid(points, (4, 2), faceted=True)


def _frame(rng):
    """An upright panel with a grid of openings: light through it falls in patches."""
    columns, rows = int(rng.integers(1, 6)), int(rng.integers(1, 5))
    bar, depth, aspect = rng.uniform(0.08, 0.3), rng.uniform(0.02, 0.1), rng.uniform(0.4, 1.0)
    parts = []
    for i in range(columns + 1):
        x = i * (1 + bar)
        parts.append(_box([x, 0, 0], [x + bar, rows * (aspect + bar) + bar, depth]))
    for j in range(rows + 1):
        y = j * (aspect + bar)
        parts.append(_box([0, y, 0.001], [columns * (1 + bar) + bar, y + bar, depth - 0.001]))
    return _join(parts)


BUILDERS = {"lathe": _lathe, "prism": _prism, "knot": _knot, "noise_sphere": _noise_sphere, "sheet": _sheet,
            "cards": _cards, "grass": _grass, "stairs": _stairs, "column": _column, "gear": _gear, "frame": _frame,
            "lattice": _lattice, "rock": _rock, "spring": _spring, "bevelled_box": _bevelled_box, "terrain": _terrain,
            "shell": _shell, "slab_stack": _slab_stack, "star": _star, "spikes": _spikes}
