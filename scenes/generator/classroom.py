"""Writes classroom.json: a room with rows of desks, walked through by a hand-held camera."""

import json

import numpy as np

from .mesh import beam, box, merge

FRAMES = 24


def desk():
    top = box((-0.62, 0.70, -0.28), (0.62, 0.73, 0.28))
    shelf = box((-0.56, 0.58, -0.24), (0.56, 0.595, 0.2))
    legs = [beam((x, 0, z), (x, 0.70, z), 0.03) for x in (-0.56, 0.56) for z in (-0.24, 0.24)]
    bars = [beam((x, 0.09, -0.24), (x, 0.09, 0.24), 0.025) for x in (-0.56, 0.56)]
    return merge([top, shelf, *legs, *bars, beam((-0.56, 0.3, -0.24), (0.56, 0.3, -0.24), 0.025)])


def blind(width=1.6, height=0.8, slats=14):
    """Tilted slats across z, hung from the origin's height down, the strings between them."""
    parts = []
    for y in np.linspace(0, height, slats):
        corners = [(-0.022, y - 0.014, 0), (0.022, y + 0.014, 0), (0.022, y + 0.017, 0), (-0.022, y - 0.011, 0)]
        ends = [np.array(corners) + [0, 0, z] for z in (-width / 2, width / 2)]
        slat = box((0, 0, 0), (1, 1, 1))
        slat.positions = np.array([ends[int(p[2])][[0, 1, 3, 2][int(p[0] + 2 * p[1])]] for p in slat.positions])
        parts.append(slat)
    parts += [beam((0, 0, z), (0, height, z), 0.006) for z in (-0.35 * width, 0.35 * width)]
    return merge(parts)


def window_side(width=8.4, height=3.0, low=0.95, high=2.45, openings=3, gap=0.75):
    """A wall in the plane x = 0 along z with openings, 0.2 thick; its bars are of their own."""
    side = (width - openings * (width / openings - gap)) / openings
    parts = [box((-0.2, 0, -width / 2), (0, low, width / 2)), box((-0.2, high, -width / 2), (0, height, width / 2))]
    pitch = width / openings
    for k in range(openings + 1):
        z = -width / 2 + k * pitch
        parts.append(box((-0.2, low, max(z - side / 2, -width / 2)), (0, high, min(z + side / 2, width / 2))))
    return merge(parts)


MESHES = {"desk": desk, "blind": blind, "window_side": window_side}


def walk():
    """Eye and target of each frame: 1.2 m/s, steps at 1.9 Hz, and a hand's tremor."""
    random = np.random.RandomState(7)
    tremor = np.cumsum(random.normal(size=(FRAMES + 8, 2)), axis=0)
    tremor -= np.stack([np.convolve(tremor[:, i], np.ones(9) / 9, mode="same") for i in range(2)], axis=1)
    keys = []
    for k in range(FRAMES):
        t = k / 24
        phase = 2 * np.pi * 1.9 * t
        eye = np.array([1.5 - 0.35 * t + 0.018 * np.sin(phase / 2), 1.58 + 0.022 * np.cos(phase), 3.6 - 1.2 * t])
        ahead = np.array([-0.42 - 0.10 * t + 0.006 * tremor[k, 0], -0.13 + 0.006 * tremor[k, 1] + 0.006 * np.sin(phase), -1.0])
        keys.append({"frame": k + 1, "eye": [round(v, 4) for v in eye], "target": [round(v, 4) for v in eye + 4 * ahead]})
    return keys


def write_scene(path):
    def thing(name, mesh, material, translate=(0, 0, 0), scale=None, rotate=None):
        transform = {"translate": [round(float(v), 3) for v in translate]}
        if scale is not None:
            transform["scale"] = scale
        if rotate is not None:
            transform["rotate_deg"] = rotate
        return {"name": name, "mesh": mesh, "material": material, "transform": transform}

    def image(file, repeat, **more):
        return {"type": "diffuse", "reflectance": {"image": f"textures/{file}.png", "space": "srgb", "repeat": repeat, **more}}

    objects = [
        thing("floor", "rectangle", "parquet", (0, 0, 0), [4, 1, 4.2]),
        thing("ceiling", "rectangle", "ceiling", (0, 3, 0), [4, 1, 4.2], [180, 0, 0]),
        thing("front wall", "rectangle", "plaster", (0, 1.5, -4.2), [4, 1, 1.5], [90, 0, 0]),
        thing("back wall", "rectangle", "plaster", (0, 1.5, 4.2), [4, 1, 1.5], [-90, 0, 0]),
        thing("right wall", "rectangle", "plaster", (4, 1.5, 0), [1.5, 1, 4.2], [0, 0, 90]),
        thing("window side", "window side", "bare plaster", (-4, 0, 0)),
        thing("blackboard", "cube", "board", (0.2, 1.65, -4.18), [1.7, 0.6, 0.02]),
        thing("board frame", "cube", "oak", (0.2, 1.02, -4.15), [1.75, 0.03, 0.05]),
        thing("map", "rectangle", "map", (-2.6, 1.75, -4.19), [0.6, 1, 0.45], [90, 0, 0]),
        thing("chart", "rectangle", "chart", (3.98, 1.7, -1.6), [0.5, 1, 0.7], [0, 0, 90]),
        thing("teacher's desk", "desk", "oak", (-1.6, 0, -2.9), [1.3, 1.05, 1.2]),
        thing("globe", "ball", "globe", (-1.2, 0.97, -2.9), 0.17),
        thing("plant pot", "pot", "clay", (3.4, 0, -3.6)),
        thing("plant", "plant", "leaf", (3.4, 0.35, -3.6)),
    ]
    for k in range(3):
        z = -2.8 + 2.8 * k
        objects.append(thing(f"blind {k + 1}", "blind", "white paint", (-3.94, 1.65, z)))
        objects.append(thing(f"window bar {k + 1}", "cube", "white paint", (-4.1, 1.7, z), [0.02, 0.75, 0.02]))
    random = np.random.RandomState(3)
    for row in range(4):
        for column in range(3):
            x, z = -2.3 + 2.1 * column, -1.5 + 1.35 * row
            turn = [0, round(float(random.uniform(-3, 3)), 2), 0]
            objects.append(thing(f"desk {row + 1}.{column + 1}", "desk", "oak", (x, 0, z), None, turn))
            for side in (-0.3, 0.3):
                seat = [0, round(180 + float(random.uniform(-14, 14)), 2), 0]
                objects.append(thing(f"chair {row + 1}.{column + 1}{'ab'[side > 0]}", "chair", "red paint" if column % 2 else "blue paint",
                                     (x + side, 0, z + 0.52 + random.uniform(-0.06, 0.12)), None, seat))
            objects.append(thing(f"book {row + 1}.{column + 1}", "cube", "lemon" if random.rand() < 0.5 else "board",
                                 (x + random.uniform(-0.4, 0.4), 0.742, z), [0.1, 0.012, 0.14], [0, round(float(random.uniform(0, 90)), 1), 0]))
    for k, x in enumerate((-1.6, 1.6)):
        lamp = thing(f"lamp {k + 1}", "rectangle", "white paint", (x, 2.75, -0.4), [0.12, 1, 2.6], [180, 0, 0])
        objects.append(lamp | {"emission": [7, 6.8, 6.2], "two_sided": True})
    scene = {
        "frames": {"first": 1, "last": FRAMES, "rate": 24},
        "film": {"width": 640, "height": 360, "filter": {"type": "blackman_harris", "radius_px": 1.5}},
        "integrator": {"max_depth": 6, "roulette_depth": 4, "direct": "mis", "heuristic": "power"},
        "camera": {"fov_y_deg": 52, "look_at": {"interpolation": "linear", "keys": walk()}},
        "environment": {"radiance": [0.9, 1.1, 1.4]},
        "lights": {"sun": {"type": "sun", "azimuth_deg": -78, "elevation_deg": 33, "irradiance": [9.0, 7.9, 6.2]}},
        "materials": {
            "parquet": image("parquet", [5, 5]), "plaster": image("plaster", [4, 2], scale=[0.78, 0.76, 0.66]),
            "map": image("mosaic", [1, 1]), "chart": image("gingham", [2, 3]), "globe": image("painting", [1, 1]),
            "ceiling": {"type": "diffuse", "reflectance": [0.82, 0.81, 0.78]},
            "board": {"type": "diffuse", "reflectance": [0.04, 0.09, 0.07]},
            "oak": {"type": "diffuse", "reflectance": [0.46, 0.29, 0.15]},
            "white paint": {"type": "diffuse", "reflectance": [0.78, 0.77, 0.74]},
            "red paint": {"type": "diffuse", "reflectance": [0.50, 0.08, 0.05]},
            "blue paint": {"type": "diffuse", "reflectance": [0.08, 0.18, 0.36]},
            "lemon": {"type": "diffuse", "reflectance": [0.78, 0.58, 0.06]},
            "clay": {"type": "diffuse", "reflectance": [0.48, 0.19, 0.09]},
            "leaf": {"type": "diffuse", "reflectance": [0.10, 0.26, 0.07]},
            "bare plaster": {"type": "diffuse", "reflectance": [0.535677, 0.521942, 0.453266]},
        },
        "meshes": {
            "rectangle": {"shape": "rectangle"}, "cube": {"shape": "cube"}, "ball": {"shape": "sphere", "segments": 32},
            **{name: {"obj": f"meshes/{name.replace(' ', '_')}.obj"}
               for name in ("desk", "blind", "window side", "chair", "pot", "plant")},
        },
        "objects": objects,
    }
    path.write_text(json.dumps(scene, indent=1) + "\n")
