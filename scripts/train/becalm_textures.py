"""Random textures and environment images for training shots.

Each texture is a pure function of its number. All but pictures tile; environments do from left to right.
"""

import json

import numpy as np
import OpenImageIO as oiio

SIZE = 256
COLOR_KINDS = ["checker", "stripes", "bricks", "noise", "voronoi", "dots", "glyphs", "rings", "plaid", "tiles", "picture",
               "marble", "speckle", "zigzag"]
GRAY_KINDS = ["noise", "voronoi", "dots", "bricks", "glyphs", "scratches", "stripes", "speckle"]


def make_library(folder, colors, grays, masks, normals, environments):
    """Writes the images and textures.json, the list of their names by use."""
    folder.mkdir(parents=True, exist_ok=True)
    names = {"color": [], "gray": [], "mask": [], "normal": [], "environment": []}

    def add(use, index, extension, make):
        rng = np.random.default_rng([index, 0x54455855, len(use)])
        name = f"{use}_{index:02d}.{extension}"
        _write(folder / name, make(rng))
        names[use].append(name)

    for index in range(colors):
        add("color", index, "png", lambda rng: _colored(rng, COLOR_KINDS[index % len(COLOR_KINDS)]))
    for index in range(grays):
        add("gray", index, "png", lambda rng: FIELDS[GRAY_KINDS[index % len(GRAY_KINDS)]](rng)[..., None])
    for index in range(masks):
        add("mask", index, "png", _leaf)
    for index in range(normals):
        add("normal", index, "png", lambda rng: _normal_map(rng, FIELDS[GRAY_KINDS[index % len(GRAY_KINDS)]](rng)))
    for index in range(environments):
        add("environment", index, "exr", lambda rng: _environment(rng, index))
    (folder / "textures.json").write_text(json.dumps(names, indent=1))


def _write(path, image):
    """image: (h, w, channels), in [0,1] as eight bits for PNG, linear half floats for EXR."""
    height, width, channels = image.shape
    spec = oiio.ImageSpec(width, height, channels, "half" if path.suffix == ".exr" else "uint8")
    output = oiio.ImageOutput.create(str(path))
    if not output or not output.open(str(path), spec):
        raise OSError(f"{path}: {oiio.geterror()}")
    output.write_image(np.ascontiguousarray(image, np.float32))
    output.close()


def _unit_grid():
    v, u = np.meshgrid(np.arange(SIZE) / SIZE, np.arange(SIZE) / SIZE, indexing="ij")
    return u, v


def _fbm(rng, slope=None):
    """Gaussian noise with a power spectrum of random slope; periodic since made by an FFT."""
    slope = rng.uniform(0.8, 2.6) if slope is None else slope
    f = np.fft.fftfreq(SIZE) * SIZE
    radius = np.hypot(*np.meshgrid(f, f))
    radius[0, 0] = np.inf
    image = np.fft.ifft2(np.fft.fft2(rng.normal(size=(SIZE, SIZE))) * radius**-slope).real
    return _stretched(image)


def _stretched(image):
    low, high = np.percentile(image, [1, 99])
    return ((image - low) / (high - low + 1e-9)).clip(0, 1)


# Fields: (SIZE, SIZE) in [0,1].


def _checker(rng):
    u, v = _unit_grid()
    n, m = rng.integers(1, 17, 2) * 2
    return ((u * n).astype(int) + (v * m).astype(int)) % 2 * 1.0


def _stripes(rng):
    u, v = _unit_grid()
    phase = (u * rng.integers(0, 24) + v * rng.integers(1, 24)) % 1
    duty = rng.uniform(0.15, 0.85)
    return (phase < duty) * 1.0 if rng.random() < 0.6 else 0.5 + 0.5 * np.sin(2 * np.pi * phase)


def _zigzag(rng):
    u, v = _unit_grid()
    n = rng.integers(2, 12)
    return ((v * rng.integers(2, 20) + np.abs((u * n) % 1 - 0.5) * rng.uniform(0.5, 2)) % 1 < rng.uniform(0.3, 0.7)) * 1.0


def _bricks(rng):
    u, v = _unit_grid()
    rows, columns, joint = rng.integers(2, 12) * 2, rng.integers(1, 8) * 2, rng.uniform(0.04, 0.14)
    row = (v * rows).astype(int)
    x, y = (u * columns + 0.5 * (row % 2)) % columns, (v * rows) % 1
    shade = rng.uniform(0.35, 1, (rows, columns))[row, x.astype(int)]
    inside = (x % 1 > joint * columns / rows) & (y > joint)
    return np.where(inside, shade * (0.85 + 0.15 * _fbm(rng)), 0.0)


def _tiles(rng):
    n = int(rng.integers(3, 24))
    u, v = _unit_grid()
    return rng.random((n, n))[(v * n).astype(int), (u * n).astype(int)]


def _cells(rng, count):
    """Distances to the nearest and second nearest of random points, and the nearest one's number."""
    u, v = _unit_grid()
    points = rng.random((count, 2))
    best, second, number = np.full((SIZE, SIZE), 9.0), np.full((SIZE, SIZE), 9.0), np.zeros((SIZE, SIZE), int)
    for i, (x, y) in enumerate(points):
        d = np.hypot((u - x + 0.5) % 1 - 0.5, (v - y + 0.5) % 1 - 0.5)
        second = np.minimum(second, np.maximum(best, d))
        number = np.where(d < best, i, number)
        best = np.minimum(best, d)
    return best, second, number


def _voronoi(rng):
    best, second, number = _cells(rng, int(rng.integers(12, 200)))
    style = rng.integers(3)
    if style == 0:
        return _stretched(best)
    shade = rng.uniform(0.2, 1, 200)[number]
    return shade if style == 1 else shade * (second - best > rng.uniform(0.004, 0.015))


def _dots(rng):
    u, v = _unit_grid()
    n = rng.integers(3, 28)
    return (np.hypot((u * n) % 1 - 0.5, (v * n) % 1 - 0.5) < rng.uniform(0.15, 0.48)) * 1.0


def _glyphs(rng):
    """Rows of letter-like marks: random strokes on a 5 by 7 raster, with spaces between words."""
    rows = int(rng.integers(4, 14))
    columns = int(rows * 1.6)
    page = np.zeros((rows * 9, columns * 6))
    for r in range(rows):
        for c in range(columns):
            if rng.random() < 0.18:
                continue
            glyph = np.zeros((7, 5))
            for _ in range(rng.integers(2, 5)):
                if rng.random() < 0.5:
                    glyph[rng.integers(7), rng.integers(3):rng.integers(3, 6)] = 1
                else:
                    glyph[rng.integers(4):rng.integers(4, 8), rng.integers(5)] = 1
            page[r * 9 + 1:r * 9 + 8, c * 6:c * 6 + 5] = glyph
    y = np.arange(SIZE) * page.shape[0] // SIZE
    x = np.arange(SIZE) * page.shape[1] // SIZE
    return page[y][:, x]


def _rings(rng):
    """Wood-like: stretched noise read through a sawtooth."""
    _, v = _unit_grid()
    warp = _fbm(rng, 2.4)
    return _stretched((warp * rng.uniform(2, 8) + v * rng.integers(1, 12)) % 1 + 0.3 * _fbm(rng, 1.2))


def _marble(rng):
    u, v = _unit_grid()
    wave = np.sin(2 * np.pi * (u * rng.integers(1, 5) + v * rng.integers(1, 5) + 2 * _fbm(rng, 1.8)))
    return np.abs(wave) ** rng.uniform(0.2, 1)


def _speckle(rng):
    return (_fbm(rng, rng.uniform(0.1, 0.7)) > rng.uniform(0.4, 0.8)) * 1.0


def _scratches(rng):
    image = 0.3 * _fbm(rng, 1.5)
    for _ in range(int(rng.integers(60, 300))):
        start, angle, length = rng.random(2) * SIZE, rng.uniform(0, 2 * np.pi), rng.uniform(10, 120)
        t = np.arange(0, length, 0.5)
        image[(start[1] + t * np.sin(angle)).astype(int) % SIZE, (start[0] + t * np.cos(angle)).astype(int) % SIZE] = 1
    return image


FIELDS = {"checker": _checker, "stripes": _stripes, "bricks": _bricks, "noise": _fbm, "voronoi": _voronoi, "dots": _dots,
          "glyphs": _glyphs, "rings": _rings, "tiles": _tiles, "marble": _marble, "speckle": _speckle, "zigzag": _zigzag,
          "scratches": _scratches}


def _palette(rng, count):
    hue, spread = rng.random(), rng.uniform(0, 0.5)
    colors = [_hsv(hue + rng.normal() * spread, rng.uniform(0, 0.9) ** 1.3, rng.uniform(0.1, 1)) for _ in range(count)]
    return np.array(sorted(colors, key=sum) if rng.random() < 0.5 else colors)


def _hsv(h, s, v):
    k = (np.array([5, 3, 1]) + h * 6) % 6
    return v - v * s * np.clip(np.minimum(k, 4 - k), 0, 1)


def _colored(rng, kind):
    if kind == "picture":
        return _picture(rng)
    if kind == "plaid":
        a, b = _stripes(rng), _stripes(rng).T
        colors = _palette(rng, 3)
        image = colors[0] + a[..., None] * (colors[1] - colors[0])
        return (image + 0.5 * b[..., None] * (colors[2] - image)).clip(0, 1)
    field = FIELDS[kind](rng)
    colors = _palette(rng, int(rng.integers(2, 6)))
    t = field * (len(colors) - 1)
    image = np.stack([np.interp(t, np.arange(len(colors)), colors[:, c]) for c in range(3)], -1)
    return (image * (1 - rng.uniform(0, 0.4) * _fbm(rng)[..., None])).clip(0, 1)


def _picture(rng):
    """Overlapping discs, boxes and bands over a gradient, with grain: stands for prints and photographs."""
    u, v = _unit_grid()
    colors = _palette(rng, 12)
    image = colors[0] + v[..., None] * (colors[1] - colors[0])
    for i in range(int(rng.integers(8, 60))):
        x, y = rng.random(2)
        size = rng.uniform(0.01, 0.3)
        shape = rng.integers(3)
        if shape == 0:
            inside = np.hypot(u - x, v - y) < size
        elif shape == 1:
            inside = (np.abs(u - x) < size) & (np.abs(v - y) < rng.uniform(0.01, 0.3))
        else:
            angle = rng.uniform(0, np.pi)
            inside = np.abs((u - x) * np.cos(angle) + (v - y) * np.sin(angle)) < size * 0.1
        image = np.where(inside[..., None], colors[i % 12] * (0.7 + 0.3 * _fbm(rng, 1.6)[..., None] if i % 4 == 0 else 1), image)
    return image.clip(0, 1)


def _leaf(rng):
    """RGBA: leaves, petals or holes; the alpha is 0 or 1 but for one pixel of edge."""
    u, v = _unit_grid()
    alpha = np.zeros((SIZE, SIZE))
    style = rng.integers(3)
    for _ in range(1 if style == 0 else int(rng.integers(4, 14))):
        x, y = (0.5, 0.5) if style == 0 else rng.uniform(0.15, 0.85, 2)
        size = 0.46 if style == 0 else rng.uniform(0.08, 0.2)
        angle = np.arctan2(v - y, u - x)
        lobes = 1 - rng.uniform(0, 0.6) * np.abs(np.sin(rng.integers(1, 5) * angle + rng.random()))
        alpha = np.maximum(alpha, ((size * lobes - np.hypot(u - x, v - y)) * SIZE / 2 + 0.5).clip(0, 1))
    if style == 2:
        alpha = 1 - alpha
    return np.concatenate([_colored(rng, "noise"), alpha[..., None]], -1)


def _normal_map(rng, height):
    """OpenGL convention: green points up the image."""
    soft = (height + np.roll(height, 1, 0) + np.roll(height, 1, 1) + np.roll(height, -1, 0) + np.roll(height, -1, 1)) / 5
    strength = rng.uniform(2, 8)
    dx = (np.roll(soft, -1, 1) - np.roll(soft, 1, 1)) * strength
    dy = (np.roll(soft, -1, 0) - np.roll(soft, 1, 0)) * strength
    normal = np.stack([-dx, dy, np.ones_like(dx)], -1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True) * 0.5 + 0.5


def _environment(rng, index):
    """A sky with a sun, studio panels in the dark, coloured blobs, or an overcast sky, in turn."""
    height, width = 128, 256
    v, u = np.meshgrid((np.arange(height) + 0.5) / height, (np.arange(width) + 0.5) / width, indexing="ij")
    theta, phi = v * np.pi, u * 2 * np.pi
    ways = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1)
    top, horizon, ground = (_hsv(rng.random(), rng.uniform(0, 0.7), rng.uniform(0.05, 1)) for _ in range(3))
    up = ways[..., 1:2]
    sky = np.where(up > 0, horizon + (top - horizon) * np.abs(up) ** rng.uniform(0.2, 1), ground * rng.uniform(0.1, 0.6))
    clouds = _fbm(rng, 1.8)[:height, :, None]

    def lobe(y_low, y_high, degrees):
        y, a = rng.uniform(y_low, y_high), rng.uniform(0, 2 * np.pi)
        axis = np.array([np.sqrt(1 - y * y) * np.cos(a), y, np.sqrt(1 - y * y) * np.sin(a)])
        return (ways @ axis > np.cos(np.radians(degrees)))[..., None] * _hsv(rng.random(), rng.uniform(0, 0.5), 1)

    style = index % 4
    if style == 0:
        return sky * (0.5 + clouds * rng.uniform(0, 1.5)) + lobe(0.1, 0.9, rng.uniform(1.5, 4)) * 10 ** rng.uniform(2, 3.7)
    if style == 1:
        image = sky * rng.uniform(0.005, 0.1)
        for _ in range(int(rng.integers(2, 7))):
            x, y, w, h = rng.random(), rng.uniform(0.1, 0.6), rng.uniform(0.01, 0.12), rng.uniform(0.01, 0.2)
            inside = (np.abs((u - x + 0.5) % 1 - 0.5) < w) & (np.abs(v - y) < h)
            image = np.where(inside[..., None], _hsv(rng.random(), rng.uniform(0, 0.4), 1) * 10 ** rng.uniform(0, 2), image)
        return image
    if style == 2:
        return sky * 0.1 + sum(lobe(-0.5, 0.95, 10 ** rng.uniform(0.3, 1.5)) * 10 ** rng.uniform(-0.5, 2) for _ in range(12))
    return sky * (0.3 + clouds)
