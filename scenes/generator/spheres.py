"""Writes spheres.json: many spheres that fly and bounce, none through another, before a camera that rushes past.

Every flight is a parabola. Its keys, linear between, lie half way between frames, every other frame, and at the moments
of impact. So every frame is at a quarter of a chord, the same small distance below the parabola, and a sphere's path
bends while the shutter is open only where it hits the floor."""

import json

import numpy as np

from .mesh import grid

FRAMES = 24
GRAVITY = 0.030  # scene units per frame squared: toys, so faster than the eye expects of a metre
BOUNCE = 0.86    # of the vertical speed
COUNT = 80
CAMERA = [(-5, (-4.6, 1.05, 7.6), (-0.7, 0.75, -1.6)), (13, (-0.6, 0.85, 6.3), (0.2, 0.72, -1.6)),
          (30, (4.2, 1.25, 5.2), (1.0, 0.70, -1.8))]
FOCUS = (0.1, 0.7, -0.6)  # the middle of the crowd stays sharp
COLOURS = {
    "vermilion": (0.72, 0.09, 0.04), "orange": (0.85, 0.33, 0.03), "sun yellow": (0.86, 0.62, 0.06),
    "leaf green": (0.16, 0.45, 0.10), "turquoise": (0.05, 0.45, 0.45), "cobalt": (0.05, 0.13, 0.58),
    "violet": (0.30, 0.09, 0.45), "rose": (0.78, 0.25, 0.38), "ivory": (0.82, 0.79, 0.70), "ink": (0.035, 0.04, 0.06),
}


def sweep():
    """The floor's far end bends up into a wall, as in a studio."""
    angle = np.linspace(0, np.pi / 2, 13)
    profile = np.array([*np.stack([-9 - 5 * np.sin(angle), 5 - 5 * np.cos(angle)], axis=1), (-14, 12)])
    tangent = np.array([*np.stack([np.cos(angle), np.sin(angle)], axis=1), (0, 1)])
    x = np.array([-25.0, 25.0]) + np.zeros((len(profile), 1))
    z, y, across, up = (np.repeat(v[:, None], 2, axis=1) for v in (*profile.T, *tangent.T))
    return grid(np.stack([x, y, z], axis=-1), normals=np.stack([0 * x, across, up], axis=-1))


def eye_at(frame):
    """Linear between the keys, which is close enough to the smooth path for keeping clear of it."""
    frames, eyes, _ = zip(*CAMERA)
    return np.array([np.interp(frame, frames, [e[axis] for e in eyes]) for axis in range(3)])


class Sphere:
    """A flight that starts at frame 0 and never ends."""

    def __init__(self, random, depth):
        self.radius = random.choice([0.18, 0.26, 0.36, 0.48, 0.66], p=[0.22, 0.28, 0.26, 0.16, 0.08])
        reach = 1.5 + 0.55 * (6.5 - depth)
        self.place = np.array([random.uniform(-reach, reach), depth])
        turn = random.uniform(0, 2 * np.pi)
        self.speed = random.uniform(0.0, 0.07) * np.array([np.cos(turn), np.sin(turn)])
        launch = np.sqrt(2 * GRAVITY * random.uniform(0.1, 2.4))  # the speed that reaches so high
        start = random.uniform(0, 2 * launch / GRAVITY)
        self.impacts = [(-start, launch)]  # time, and the speed upwards after it
        while self.impacts[-1][0] < FRAMES + 1:
            time, launch = self.impacts[-1]
            self.impacts.append((time + 2 * launch / GRAVITY, max(BOUNCE * launch, 0.02)))

    def at(self, frame):
        time, launch = [impact for impact in self.impacts if impact[0] <= frame][-1]
        t = frame - time
        x, z = self.place + self.speed * frame
        return np.array([x, self.radius + launch * t - 0.5 * GRAVITY * t * t, z])

    def keys(self):
        """The moments between which it moves almost straight."""
        between = np.arange(0.5, FRAMES + 1, 2)
        return sorted({*between, *(round(t, 2) for t, _ in self.impacts if 0.5 < t < FRAMES + 0.5)})


def crowd():
    """Spheres that keep apart from each other and from the camera at every quarter of a frame."""
    random = np.random.RandomState(31)
    times = np.arange(0.25, FRAMES + 1, 0.25)
    eyes = np.array([eye_at(t) for t in times])
    spheres, tracks = [], []
    while len(spheres) < COUNT:
        sphere = Sphere(random, random.choice([random.uniform(-9, -3), random.uniform(-4, 4.4)]))
        track = np.array([sphere.at(t) for t in times])
        if np.linalg.norm(track - eyes, axis=1).min() < sphere.radius + 1.1:
            continue
        if all(np.linalg.norm(track - other, axis=1).min() > sphere.radius + s.radius + 0.02
               for s, other in zip(spheres, tracks)):
            spheres.append(sphere)
            tracks.append(track)
    return spheres


def _rounded(vector, digits=3):
    return [round(float(x), digits) + 0.0 for x in vector]


def _object(number, sphere, material):
    keys = [{"frame": float(t), "scale": float(sphere.radius), "translate": _rounded(sphere.at(t))}
            for t in sphere.keys()]
    return {"name": f"sphere {number}", "mesh": "sphere", "material": material,
            "transform": {"interpolation": "linear", "keys": keys}}


def scene():
    random = np.random.RandomState(7)
    materials = {"floor": {"type": "diffuse", "reflectance": {"image": "textures/truchet.png", "space": "srgb",
                                                               "repeat": [5, 1.9]}},
                 "backdrop": {"type": "diffuse", "reflectance": [0.36, 0.44, 0.50]},
                 "lamp": {"type": "diffuse", "reflectance": [0, 0, 0]}}
    for name, colour in COLOURS.items():
        materials[name] = {"type": "principled", "base_color": list(colour), "roughness": 0.35, "clearcoat": 0.4,
                           "clearcoat_roughness": 0.35}
    names = list(COLOURS)
    camera_keys = [{"frame": f, "eye": list(eye), "target": list(target)} for f, eye, target in CAMERA]
    focus = [{"frame": f, "value": round(_along_view(eye, target, FOCUS), 3)} for f, eye, target in CAMERA]
    return {
        "frames": {"first": 1, "last": FRAMES, "rate": 24},
        "film": {"width": 640, "height": 360, "filter": {"type": "blackman_harris", "radius_px": 1.5}},
        "integrator": {"max_depth": 5, "roulette_depth": 3, "direct": "mis", "heuristic": "power"},
        "camera": {"fov_y_deg": 40, "shutter": [-0.25, 0.25], "aperture_radius": 0.05,
                   "focus_distance": {"interpolation": "smooth", "keys": focus},
                   "look_at": {"interpolation": "smooth", "keys": camera_keys}},
        "environment": {"radiance": [0.26, 0.33, 0.45]},
        "materials": materials,
        "meshes": {"rectangle": {"shape": "rectangle"}, "sweep": {"obj": "meshes/sweep.obj"},
                   "sphere": {"shape": "exact_sphere"}},
        "objects": [
            {"name": "floor", "mesh": "rectangle", "material": "floor",
             "transform": {"scale": [25, 1, 9.5], "translate": [0, 0, 0.5]}},
            {"name": "backdrop", "mesh": "sweep", "material": "backdrop"},
            {"name": "lamp", "mesh": "sphere", "material": "lamp", "emission": [150, 126, 96],
             "transform": {"scale": 1.0, "translate": [-5.5, 8, 4.0]}},
            *(_object(k + 1, sphere, names[random.randint(len(names))]) for k, sphere in enumerate(crowd())),
        ],
    }


def _along_view(eye, target, point):
    eye, target, point = (np.asarray(v, float) for v in (eye, target, point))
    view = (target - eye) / np.linalg.norm(target - eye)
    return float(np.dot(point - eye, view))


def write_scene(path):
    """One line for every setting, material and key-framed object, so that the file can be read and compared."""
    def lines(entry, indent):
        if isinstance(entry, dict):
            rows = [f"{json.dumps(key)}: {value}" for key, value in
                    ((k, json.dumps(v)) for k, v in entry.items())]
            return "{\n" + ",\n".join(indent + row for row in rows) + "\n" + indent[2:] + "}"
        return "[\n" + ",\n".join(indent + json.dumps(row) for row in entry) + "\n" + indent[2:] + "]"

    sections = []
    for key, value in scene().items():
        long = key in ("camera", "materials", "meshes", "objects")
        sections.append(f"  {json.dumps(key)}: " + (lines(value, "    ") if long else json.dumps(value)))
    path.write_text("{\n" + ",\n".join(sections) + "\n}\n", encoding="ascii")


MESHES = {"sweep": sweep}
