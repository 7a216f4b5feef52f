"""A random shot as a becalm scene: layout, materials, lights, motion, lens and media of one seed."""

import numpy as np

from becalm_layouts import LAYOUTS, Stage
from becalm_materials import Materials

LAST_FRAME = 8


def layout_of(seed, attempt):
    """Each decade of seeds has every layout, and so have the seeds of one last digit, by which shots are held out."""
    names = list(LAYOUTS)
    return names[(seed + seed // len(names) + attempt * 3) % len(names)]


def make_scene(seed, attempt, assets, width, height):
    """The scene, and what shot.json tells of it. Another attempt is another scene for the same seed."""
    rng = np.random.default_rng([seed, attempt, 0x53484F54])
    layout = layout_of(seed, attempt)
    materials = Materials(rng, assets["textures"], textured_share=rng.choice([0.2, 0.6, 0.9, 0.9]))
    stage = Stage(rng, materials, assets["meshes"])
    view = LAYOUTS[layout](stage)
    lit = Lights(stage, view)
    _move_objects(stage, view)
    media, transmits = _media(stage, view)
    needs_depth = transmits or any(m["type"] == "dielectric" for m in materials.entries.values())
    depth = int(rng.choice([6, 8, 10] if needs_depth else [1, 2, 3, 3, 4, 5]))
    camera, depth_of_field, motion_blur = _camera(stage, view)
    filters = [{"type": "blackman_harris", "radius_px": 1.5}] * 3 + [{"type": "box", "radius_px": 0.5},
                                                                     {"type": "tent", "radius_px": 1.0}]
    scene = {
        "frames": {"first": 1, "last": LAST_FRAME, "rate": 24},
        "film": {"width": width, "height": height, "filter": filters[rng.integers(len(filters))]},
        "integrator": {"max_depth": depth, "roulette_depth": 3},
        "camera": camera,
        **({"environment": lit.environment} if lit.environment else {}),
        "lights": lit.lights, "materials": materials.entries, "media": media,
        "meshes": stage.meshes, "objects": stage.objects,
    }
    facts = {"layout": layout, "has_depth_of_field": depth_of_field, "has_motion_blur": motion_blur, "has_volume": bool(media)}
    return scene, facts


def scale_light(scene, factor):
    """Multiplies every light of the scene."""
    def scaled(value):
        if isinstance(value, dict):
            return {**value, "keys": [{**key, "value": scaled(key["value"])} for key in value["keys"]]}
        return [float(f"{v * factor:.6g}") for v in value]

    environment = scene.get("environment")
    if environment:
        if "image" in environment:
            environment["scale"] = float(f"{environment['scale'] * factor:.6g}")
        else:
            environment["radiance"] = scaled(environment["radiance"])
    for light in scene["lights"]:
        key = "irradiance" if light["type"] == "sun" else "intensity"
        light[key] = scaled(light[key])
    for thing in scene["objects"]:
        if "emission" in thing:
            thing["emission"] = scaled(thing["emission"])


def _keys(first, last, smooth=False):
    """Values over the shot; the keys lie beyond it by a frame, so that a shutter never meets a stop."""
    return {"interpolation": "smooth" if smooth else "linear",
            "keys": [{"frame": 0, "value": first}, {"frame": LAST_FRAME + 1, "value": last}]}


def _rounded(values):
    return [round(float(v), 5) for v in values]


class Lights:
    """Lamps, suns and the environment. Powers are relative: the whole is scaled to an exposure after a probe."""

    def __init__(self, stage, view):
        self.stage, self.view, self.rng = stage, view, stage.rng
        self.lights, self.environment = [], None
        rng = self.rng
        low, high = np.asarray(view.lamps, float)
        self.low, self.extent = low, high - low
        self.reach = float(np.linalg.norm(self.extent)) / 2
        with_environment = rng.random() < (0.55 if view.enclosed else 0.85)
        if with_environment:
            self._environment()
        if rng.random() < (0.2 if view.enclosed else 0.45):
            self._sun()
        lamps = int(rng.choice([0, 1, 2, 3, 6, 14, 40], p=[0.2, 0.2, 0.2, 0.15, 0.1, 0.1, 0.05]))
        if view.enclosed or not (self.environment or self.lights):
            lamps = max(lamps, 1)
        # One kind for all lamps in half of the shots.
        kinds = ["area", "area", "sphere", "sphere", "spot", "point", "tiny"]
        common = str(rng.choice(kinds)) if rng.random() < 0.5 else None
        for _ in range(lamps):
            getattr(self, "_" + (common or str(rng.choice(kinds))))(10 ** rng.uniform(-0.7, 0.7) / lamps)

    def _color(self, level):
        warmth = self.rng.normal() * self.rng.choice([0.1, 0.6])
        spread = self.rng.choice([0.05, 0.5], p=[0.8, 0.2])
        tint = np.array([np.exp(warmth), 1.0, np.exp(-warmth)]) * np.exp(self.rng.normal(size=3) * spread)
        return _rounded(tint / tint.mean() * level)

    def _varying(self, color):
        """A fifth of the lamps grow, fade or flicker."""
        if self.rng.random() < 0.8:
            return color
        return _keys(color, _rounded(np.array(color) * self.rng.choice([0.1, 0.5, 2.0])))

    def _place(self):
        return self.low + self.extent * self.rng.random(3)

    def _moving(self, place):
        if self.rng.random() < 0.6:
            return _rounded(place)
        return _keys(_rounded(place), _rounded(place + self.rng.normal(size=3) * 0.2 * self.extent))

    def _environment(self):
        rng = self.rng
        if rng.random() < 0.35:
            self.environment = {"radiance": self._color(10 ** rng.uniform(-1.5, 0.3))}
        else:
            names = self.stage.materials.textures["environment"]
            self.environment = {"image": "../assets/textures/" + str(rng.choice(names)),
                                "scale": 1.0, "rotate_y_deg": round(float(rng.uniform(0, 360)), 2)}

    def _sun(self):
        rng = self.rng
        azimuth, elevation = rng.uniform(0, 360), rng.uniform(8, 80)
        turn = rng.choice([0, 0, rng.uniform(-12, 12)])
        self.lights.append({"type": "sun", "irradiance": self._color(10 ** rng.uniform(0, 1)),
                            "diameter_deg": round(float(rng.choice([0, 0.533, 0.533, 3, 12])), 3),
                            "azimuth_deg": _keys(round(azimuth, 3), round(float(azimuth + turn), 3)),
                            "elevation_deg": round(elevation, 3)})

    def _point(self, power):
        self.lights.append({"type": "point", "position": self._moving(self._place()),
                            "intensity": self._varying(self._color(power * self.reach**2))})

    def _spot(self, power):
        rng = self.rng
        outer = rng.uniform(8, 60)
        aim = np.array(self.view.target) + rng.normal(size=3) * 0.15 * self.reach
        self.lights.append({"type": "spot", "position": self._moving(self._place()), "target": _rounded(aim),
                            "intensity": self._varying(self._color(3 * power * self.reach**2)),
                            "outer_deg": round(outer, 2), "inner_deg": round(outer * rng.uniform(0.2, 1), 2)})

    def _lamp(self, mesh, scale, rotate, area, power):
        material = self.stage.materials.black()
        lamp = self.stage.put(self.stage.shape(mesh), material, self._place(), scale, rotate)
        lamp["emission"] = self._varying(self._color(power * self.reach**2 / area))

    def _area(self, power):
        rng = self.rng
        size = self.reach * 10 ** rng.uniform(-1.6, -0.4) * np.array([1, 1, 10 ** rng.uniform(-1, 0)])
        turn = [180 + rng.normal() * 25, rng.uniform(0, 360), rng.normal() * 25]
        self._lamp("rectangle", size, turn, 4 * size[0] * size[2], power)

    def _tiny(self, power):
        size = self.reach * 10 ** self.rng.uniform(-2.4, -1.7)
        self._lamp("cube", size, [0, 0, 0], 6 * size**2, power)

    def _sphere(self, power):
        size = self.reach * 10 ** self.rng.uniform(-2, -0.7)
        self._lamp("exact_sphere", size, [0, 0, 0], 3 * size**2, power)


def _move_objects(stage, view):
    """Between no and most things of the shot move and turn; what is large (walls, ground) and what is scattered stays."""
    rng = stage.rng
    share, speed = rng.choice([0, 0.2, 0.6, 1.0]), 10 ** rng.uniform(-1.6, 0.2)
    grounds = {o["scatter"]["on"] for o in stage.objects if "scatter" in o}
    for thing in stage.objects:
        place = thing["transform"]
        if "scatter" in thing or thing["name"] in grounds or max(place["scale"]) > 2.4 * view.size or rng.random() > share:
            continue
        way = rng.normal(size=3) * [1, 0.3 * (rng.random() < 0.4), 1] * speed * view.size
        turn = rng.normal(size=3) * [0.2, 1, 0.2] * 60 * speed * (rng.random() < 0.7)
        ends = [{"frame": frame, "scale": place["scale"],
                 "rotate_deg": _rounded(np.array(place["rotate_deg"]) + side * turn),
                 "translate": _rounded(np.array(place["translate"]) + side * way)}
                for frame, side in ((0, -0.5), (LAST_FRAME + 1, 0.5))]
        thing["transform"] = {"interpolation": "linear", "keys": ends}


def _camera(stage, view):
    rng = stage.rng
    eye, target = np.array(view.eye, float), np.array(view.target, float)
    distance = np.linalg.norm(target - eye)
    speed = 0.0 if rng.random() < 0.15 else 10 ** rng.uniform(-1.7, -0.1)
    ends = []
    eye_way, target_way = rng.normal(size=3) * [1, 0.4, 0.7], rng.normal(size=3) * [0.8, 0.5, 0.3] * rng.choice([0, 1, 1])
    up = _rounded([rng.normal() * rng.choice([0, 0.15]), 1, 0])
    for frame, side in ((0, -0.5), (LAST_FRAME + 1, 0.5)):
        ends.append({"frame": frame, "eye": _rounded(eye + side * speed * view.travel * eye_way), "up": up,
                     "target": _rounded(target + side * speed * view.travel * target_way)})
    camera = {"fov_y_deg": round(float(view.fov), 3), "look_at": {"interpolation": "linear", "keys": ends}}
    motion_blur, depth_of_field = bool(rng.random() < 0.2), bool(rng.random() < 0.2)
    if motion_blur:
        camera["shutter"] = [0, round(float(rng.uniform(0.2, 1)), 3)]
    if depth_of_field:
        camera["aperture_radius"] = round(float(distance * 10 ** rng.uniform(-2.3, -1.2)), 5)
        camera["focus_distance"] = round(float(distance * rng.uniform(0.6, 1.2)), 4)
        camera["blades"] = int(rng.choice([0, 5, 6]))
    return camera, depth_of_field, motion_blur


def _media(stage, view):
    """Media of about a tenth of the shots: haze or a cloud in one of the layout's regions, or a turbid solid."""
    rng = stage.rng
    if rng.random() > 0.11:
        return {}, False
    low, high = np.array(view.media, float)
    extent = float(np.linalg.norm(high - low))
    albedo = _rounded(1 - rng.uniform(0, 0.3, 3))
    g = round(float(rng.uniform(-0.2, 0.8)), 3)
    draw = rng.random()
    if draw < 0.4:
        extinction = round(float(10 ** rng.uniform(-0.7, 0.5) / extent), 5)
        media = {"haze": {"type": "homogeneous", "extinction": extinction, "albedo": albedo, "g": g}}
    elif draw < 0.75:
        media = {"cloud": {"type": "cloud", "extinction": round(float(20 / extent), 4), "albedo": albedo, "g": g,
                           "resolution": [64, 32, 64], "frequency": round(float(rng.uniform(1, 4)), 3),
                           "offset": _keys([0, 0, 0], _rounded(rng.normal(size=3) * 0.1)),
                           "coverage": round(float(rng.uniform(0.35, 0.7)), 3), "octaves": 4,
                           "seed": int(rng.integers(1000))}}
    else:
        size = view.size * rng.uniform(0.5, 1.2)
        extinction = round(float(10 ** rng.uniform(0, 1) / size), 4)
        albedo = _rounded(1 - rng.uniform(0, 0.1, 3))
        media = {"turbid": {"type": "homogeneous", "extinction": extinction, "albedo": albedo, "g": g}}
        place = low * [0.6, 1, 0.5] + high * [0.4, 0, 0.5] + [0, size * 0.55, 0]
        low, high = place - size / 2, place + size / 2
    name = next(iter(media))
    material = stage.materials.interface() if name != "turbid" or rng.random() < 0.5 else stage.materials.dielectric()
    stage.put(stage.shape("cube"), material, (low + high) / 2, (high - low) / 2, interior=name)
    return media, True
