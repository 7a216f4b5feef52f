"""Tiling textures: a field of numbers in [0, 1] read through a ramp of 16 colours."""

import numpy as np


def noise(size, cells, seed):
    """Periodic value noise in [0, 1]; cells: a number, or (rows, columns)."""
    rows, columns = (cells, cells) if np.isscalar(cells) else cells
    lattice = np.random.RandomState(seed).rand(rows, columns)

    def axis(count):
        position = np.arange(size) * count / size
        index = position.astype(int)
        t = position - index
        return index % count, (index + 1) % count, t * t * (3 - 2 * t)

    y0, y1, ty = axis(rows)
    x0, x1, tx = axis(columns)
    ty, tx = ty[:, None], tx[None, :]
    top = lattice[y0][:, x0] * (1 - tx) + lattice[y0][:, x1] * tx
    bottom = lattice[y1][:, x0] * (1 - tx) + lattice[y1][:, x1] * tx
    return top * (1 - ty) + bottom * ty


def fractal(size, cells, octaves, seed):
    """Octaves of noise, normalised to [0, 1]."""
    total = sum(noise(size, cells << o, seed + o) / (1 << o) for o in range(octaves))
    return (total - total.min()) / (total.max() - total.min())


def ramp(stops):
    """16 colours between stops of (position, '#rrggbb'), as the display shows them."""
    positions = [p for p, _ in stops]
    colours = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for _, c in stops], float)
    at = np.linspace(0, 1, 16)
    return np.stack([np.interp(at, positions, colours[:, c]) for c in range(3)], axis=1).round()


def to_indices(field):
    return np.clip((field * 15).round(), 0, 15).astype(np.uint8)


def parquet(size=512, cells=16, length=4):
    """Herringbone of planks 1 x length cells: cell (i, j) lies in a plank along x or y by (i - j) mod 2 length."""
    y, x = np.mgrid[0:size, 0:size] * (cells / size)
    i, j = x.astype(int), y.astype(int)
    m = (i - j) % (2 * length)
    lies_along_x = m < length
    along = np.where(lies_along_x, x - i + m, y - j + 2 * length - 1 - m)
    across = np.where(lies_along_x, y - j, x - i)
    start_i = np.where(lies_along_x, i - m, i) % cells
    start_j = np.where(lies_along_x, j, j - (2 * length - 1 - m)) % cells
    random = np.random.RandomState(11)
    tone = random.rand(cells, cells)[start_j, start_i]
    phase = random.rand(cells, cells)[start_j, start_i]
    fibres = noise(256, (128, 6), 5)
    grain = fibres[((across * 0.23 + phase) * 256).astype(int) % 256, ((along / length + phase) * 256).astype(int) % 256]
    field = 0.40 + 0.38 * (tone - 0.5) + 0.34 * (grain - 0.5)
    gap = np.minimum(np.minimum(across, 1 - across), np.minimum(along, length - along))
    field = np.where(gap < 0.045, 0.0, np.clip(field + 0.12, 0.1, 1))
    return to_indices(field), ramp([(0, "#1d130c"), (0.1, "#4a2f1b"), (0.5, "#96683c"), (1, "#d3a468")])


def plaster(size=256):
    field = 0.6 * fractal(size, 4, 6, 21) + 0.4 * noise(size, 128, 40)
    field = (field - field.min()) / (field.max() - field.min())
    return to_indices(field), ramp([(0, "#cfcfcf"), (1, "#f4f4f4")])


def bricks(size=512, rows=16, columns=8):
    """Running bond with worn edges; uneven mortar."""
    y, x = np.mgrid[0:size, 0:size] / size
    wobble = 0.10 * (fractal(size, 16, 3, 3) - 0.5)
    row_position = y * rows + wobble
    row = np.floor(row_position).astype(int)
    column_position = x * columns + 0.5 * (row % 2) + 0.5 * wobble
    column = np.floor(column_position).astype(int)
    v, u = row_position - row, (column_position - column) * 2
    edge = np.minimum(np.minimum(u, 2 - u), np.minimum(v, 1 - v))
    tone = np.random.RandomState(8).rand(rows, columns)[row % rows, column % columns]
    speckle = noise(size, 256, 17)
    stone = 0.33 + 0.5 * tone + 0.22 * (speckle - 0.5) + 0.2 * (fractal(size, 8, 5, 30) - 0.5)
    mortar = 0.02 + 0.13 * speckle
    return to_indices(np.where(edge < 0.085, mortar, np.clip(stone, 0.25, 1))), ramp(
        [(0, "#9b9080"), (0.19, "#b9ad9a"), (0.2, "#6b3524"), (0.5, "#a3593c"), (0.8, "#c98158"), (1, "#dfb08a")])


def cobbles(size=448, cells=12):
    """Rounded setts: distance to the nearest of jittered centres, darker towards the joint."""
    random = np.random.RandomState(4)
    jitter = 0.22 + 0.56 * random.rand(cells, cells, 2)
    tones = random.rand(cells, cells)
    y, x = np.mgrid[0:size, 0:size] * (cells / size)
    i, j = x.astype(int), y.astype(int)
    nearest = np.full((size, size), 9.0)
    second = np.full((size, size), 9.0)
    tone = np.zeros((size, size))
    for dj in (-2, -1, 0, 1, 2):
        for di in (-2, -1, 0, 1, 2):
            ci, cj = (i + di) % cells, (j + dj) % cells
            dx = i + di + jitter[cj, ci, 0] - x
            dy = j + dj + jitter[cj, ci, 1] - y
            distance = np.maximum(np.sqrt(dx * dx + dy * dy), 0.93 * np.maximum(abs(dx), abs(dy)) + 0.1)
            closer = distance < nearest
            second = np.where(closer, nearest, np.minimum(second, distance))
            tone = np.where(closer, tones[cj, ci], tone)
            nearest = np.where(closer, distance, nearest)
    joint = second - nearest
    grain = noise(size, 256, 9)
    field = 0.45 + 0.4 * (tone - 0.5) + 0.22 * np.clip(joint * 2 - 0.4, -0.6, 0.4) + 0.22 * (grain - 0.5)
    field = np.where(joint < 0.10, 0.05 + 0.12 * grain, np.clip(field + 0.08, 0.2, 1))
    return to_indices(field), ramp([(0, "#2e2b26"), (0.2, "#544d43"), (0.55, "#978c7b"), (1, "#d2c6b0")])


def rug(size=256):
    """Bands of stepped diamonds in five colours."""
    y, x = np.mgrid[0:size, 0:size] / size
    band = np.floor(y * 8).astype(int)
    steps = np.floor((abs((x * 8) % 1 - 0.5) + abs((y * 8) % 1 - 0.5)) * 8).astype(int)
    picture = np.choose((steps + band) % 4, [1, 2, 3, 4])
    picture = np.where(band % 4 == 3, np.where((x * 32).astype(int) % 2 == 0, 5, 1), picture)
    picture = np.where(abs((y * 8) % 1 - 0.5) > 0.44, 0, picture)
    colours = ["#3a1a16", "#8c2f23", "#d9c39a", "#1f3f52", "#c7792f", "#e9dec4"]
    return picture.astype(np.uint8), _palette(colours)


def painting(width=256, height=192):
    """An abstract landscape: a low sun over overlapping hills, and brush strokes."""
    y, x = np.mgrid[0:height, 0:width].astype(float)
    x, y = x / height, y / height
    brush = fractal(256, 8, 5, 60)[:height, :width]
    picture = np.where(brush > 0.5, 0, 1)
    picture = np.where((x - 0.86) ** 2 + (y - 0.34) ** 2 < 0.030, 2, picture)
    for k, (base, size, phase) in enumerate([(0.44, 0.10, 0.3), (0.58, 0.13, 2.1), (0.74, 0.09, 4.0)]):
        hill = base + size * np.sin(3.1 * x + phase) + 0.05 * (brush - 0.5)
        shade = 3 + 2 * k + (brush + 0.3 * np.sin(40 * (y + x * (0.5 - 0.3 * k))) > 0.5)
        picture = np.where(y > hill, shade, picture)
    colours = ["#e8c9a0", "#efd9b8", "#d8502d", "#7793a0", "#66838f", "#35606b", "#2b525d", "#1c3138", "#24404a"]
    return picture.astype(np.uint8), _palette(colours)


def mosaic(size=512, cells=8):
    """Quarter discs, half discs and triangles on a grid: hard edges at every angle for what glides past them."""
    random = np.random.RandomState(27)
    kind, turn = random.randint(0, 4, (cells, cells)), random.randint(0, 4, (cells, cells))
    ground = random.randint(0, 3, (cells, cells))
    figure = 3 + random.randint(0, 5, (cells, cells))
    y, x = np.mgrid[0:size, 0:size] * (cells / size)
    i, j = x.astype(int), y.astype(int)
    u, v = x - i, y - j
    for step in range(3):
        rotate = turn[j, i] > step
        u, v = np.where(rotate, v, u), np.where(rotate, 1 - u, v)
    inside = np.choose(kind[j, i], [
        u * u + v * v < 0.92,
        (u - 0.5) ** 2 + (v - 0.5) ** 2 < 0.16,
        u + v < 1,
        (u - 0.5) ** 2 + v * v < 0.23,
    ])
    colours = ["#ece3d2", "#e2d5bd", "#23303b", "#c8452e", "#e0a030", "#2f6f73", "#23303b", "#8fb0a9"]
    return np.where(inside, figure[j, i], ground[j, i]).astype(np.uint8), _palette(colours)


def truchet(size=256, cells=8):
    """Tiles with two quarter rings, turned at random, so that the rings join into winding bands."""
    turned = np.random.RandomState(14).randint(0, 2, (cells, cells))
    y, x = np.mgrid[0:size, 0:size] * (cells / size)
    i, j = x.astype(int), y.astype(int)
    u, v = x - i, y - j
    u = np.where(turned[j, i] == 1, 1 - u, u)
    ring = np.minimum(abs(np.hypot(u, v) - 0.5), abs(np.hypot(1 - u, 1 - v) - 0.5))
    ground = np.where((i + j) % 2 == 0, 0, 1)
    picture = np.where(ring < 0.17, np.where(ring < 0.055, 3, 2), ground)
    return picture.astype(np.uint8), _palette(["#d9d2c4", "#cfc6b5", "#51606e", "#c9a25a"])


def gingham(size=128):
    """Stripes of two widths crossing in a weave."""
    y, x = np.mgrid[0:size, 0:size] / size

    def stripe(t):
        return np.where(abs(t - 0.5) < 0.2, 2, np.where(abs(t - 0.08) < 0.02, 1, 0))

    weave = (np.mgrid[0:size, 0:size].sum(axis=0) // 2) % 2
    picture = stripe(x) + stripe(y)
    picture = np.where((picture == 0) & (weave == 1), 5, picture)
    return picture.astype(np.uint8), _palette(["#e9e3d6", "#a9b6c4", "#8fa5bb", "#7d93ab", "#3f5f80", "#e2dbcc"])


def _leaves(size):
    """Of the picture of a twig with leaves: whether a leaf is there, how far along and across it."""
    v, u = np.mgrid[0:size, 0:size][:, ::-1] / size
    inside, along, across, tone = (np.zeros((size, size)) for _ in range(4))
    leaves = [(0.5, 0.60, 90, 0.36, 0.13)]
    for k in range(5):
        at, reach = 0.08 + 0.15 * k, 0.42 - 0.035 * k
        leaves += [(0.5, at, 90 - 52 + 3 * k, reach, 0.11), (0.5, at + 0.06, 90 + 54 - 3 * k, reach, 0.11)]
    for k, (u0, v0, turn, length, width) in enumerate(leaves):
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        a = ((u - u0) * c + (v - v0) * s) / length
        b = ((v - v0) * c - (u - u0) * s) / width
        half = 1.9 * np.clip(a, 0, 1) ** 0.7 * np.clip(1 - a, 0, 1) ** 0.9
        here = (a > 0) & (a < 1) & (np.abs(b) < half)
        inside = np.where(here, 1.0, inside)
        along, across = np.where(here, a, along), np.where(here, np.abs(b) / np.maximum(half, 1e-6), across)
        tone = np.where(here, (k * 0.618) % 1.0, tone)
    twig = (np.abs(u - 0.5) < 0.012) & (v < 0.62)
    return np.where(twig, 1.0, inside), along, across, tone


def twig_mask(size=128):
    """1 where there is leaf; grey at the edges, where a texel is part of both."""
    inside = _leaves(4 * size)[0].reshape(size, 4, size, 4).mean(axis=(1, 3))
    return to_indices(inside), ramp([(0, "#000000"), (1, "#ffffff")])


def twig(size=128):
    """Leaf green everywhere, so that nothing else bleeds in at the edges of the mask."""
    inside, along, across, tone = _leaves(size)
    field = 0.45 + 0.3 * (tone - 0.5) + 0.25 * (along - 0.5) + np.where(across < 0.08, 0.25, 0.0)
    return to_indices(np.where(inside > 0, field, 0.45)), ramp([(0, "#3c5a1d"), (0.5, "#628434"), (1, "#a9bb62")])


def _palette(colours):
    return np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in colours])
