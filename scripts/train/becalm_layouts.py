"""Layouts of training shots: what stands where, where the camera looks from, and where lamps may hang.

A layout fills a Stage and returns a View. Lengths are arbitrary; most things are about 1 unit large.
"""

from dataclasses import dataclass, field

import numpy as np

from becalm_meshes import SPECIAL_KINDS

SHAPES = ["cube", "sphere", "exact_sphere"]


@dataclass
class View:
    eye: list
    target: list
    lamps: list  # [low corner, high corner] of the region where lamps may hang
    fov: float = 45.0
    enclosed: bool = False  # an environment would light little or nothing
    size: float = 1.0  # of the things that the camera looks at
    travel: float = 1.0  # how far the camera may move in a shot
    media: list = field(default_factory=list)  # regions, low and high corner, that a medium may fill


class Stage:
    """The objects of one shot."""

    def __init__(self, rng, materials, meshes):
        self.rng = rng
        self.materials = materials
        self.library = meshes
        self.meshes = {}
        self.objects = []
        # Few kinds of meshes in a shot, as a production has a style.
        general = [m for m in meshes if m["kind"] not in SPECIAL_KINDS]
        self.palette = [general[i] for i in rng.choice(len(general), int(rng.integers(2, 9)), replace=False)]

    def mesh(self, name, **description):
        self.meshes[name] = description
        return name

    def shape(self, name):
        return self.mesh(name, shape=name)

    def special(self, kind):
        candidates = [m for m in self.library if m["kind"] == kind]
        return self.obj(candidates[self.rng.integers(len(candidates))])

    def obj(self, entry):
        return self.mesh(entry["file"], obj="../assets/meshes/" + entry["file"])

    def any_mesh(self):
        """A mesh of the shot's palette or a basic shape: its name, the height of its origin above its lowest point, and
        the scale that makes it about 1 unit large."""
        if self.rng.random() < 0.25:
            shape = str(self.rng.choice(SHAPES))
            return self.shape(shape), 1.0, 0.5
        entry = self.palette[self.rng.integers(len(self.palette))]
        return self.obj(entry), 0.0, 1.0

    def put(self, mesh, material, translate=(0, 0, 0), scale=1.0, rotate=(0, 0, 0), **more):
        if "procedural" in self.meshes[mesh]:
            material = self.materials.without_relief(material)
        scale = [round(float(s), 4) for s in np.broadcast_to(scale, 3)]
        self.objects.append({"name": f"object {len(self.objects)}", "mesh": mesh, "material": material, **more,
                             "transform": {"scale": scale, "rotate_deg": [round(float(r), 3) for r in rotate],
                                           "translate": [round(float(t), 4) for t in translate]}})
        return self.objects[-1]

    def stand(self, x, y, z, size, glass_share=0.1, flying=False):
        """Something of about that size on a floor at y, or afloat around that point."""
        mesh, base, factor = self.any_mesh()
        material = self.materials.any(self.rng.choice([0.7, 2.0]), glass_share)
        turn = self.rng.uniform(0, 360, 3) if flying else [0, self.rng.uniform(0, 360), 0]
        return self.put(mesh, material, [x, y + base * factor * size, z], factor * size, turn)

    def room(self, low, high, open_share):
        """A box of separate walls; that share of the sides but for the floor has slits or gaps."""
        low, high = np.asarray(low, float), np.asarray(high, float)
        centre, half = (low + high) / 2, (high - low) / 2
        sides = {"left": (0, 0), "right": (0, 1), "back": (2, 0), "front": (2, 1), "floor": (1, 0), "ceiling": (1, 1)}
        wall_material = self.materials.opaque(2.5)
        for name, (axis, side) in sides.items():
            own = name in ("floor", "ceiling") or self.rng.random() < 0.3
            material = self.materials.opaque(2.5) if own else wall_material
            if name != "floor" and self.rng.random() < open_share:
                self._pierced(axis, side, low, high, material)
                continue
            thickness = 0.05 * half.min()
            scale, place = half.copy(), centre.copy()
            scale[axis] = thickness
            place[axis] = high[axis] + thickness if side else low[axis] - thickness
            self.put(self.shape("cube"), material, place, scale + 0.02 * (np.arange(3) != axis) * half.min())

    def _pierced(self, axis, side, low, high, material):
        """A wall of bars with gaps: one hole, slits, or a ladder of openings."""
        along = [a for a in range(3) if a != axis][self.rng.integers(2)]
        bars = int(self.rng.choice([2, 2, 3, 5, 9]))
        gap = self.rng.choice([0.05, 0.15, 0.4]) * (high[along] - low[along]) / max(1, bars - 1)
        width = (high[along] - low[along] - gap * (bars - 1)) / bars
        for i in range(bars):
            scale, place = (high - low) / 2, (high + low) / 2
            scale[axis] = 0.03 * (high - low).min()
            place[axis] = high[axis] if side else low[axis]
            scale[along] = width / 2
            place[along] = low[along] + width / 2 + i * (width + gap)
            self.put(self.shape("cube"), material, place, scale)


def _near(rng, centre, spread):
    return (np.asarray(centre, float) + rng.normal(size=3) * spread).tolist()


def open_ground(stage):
    """Objects on an open plane."""
    rng = stage.rng
    stage.put(stage.shape("rectangle"), stage.materials.opaque(8), scale=30)
    for _ in range(int(rng.integers(8, 36))):
        radius, angle = 4 * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
        stage.stand(radius * np.cos(angle), 0, radius * np.sin(angle), 10 ** rng.uniform(-0.4, 0.35))
    if rng.random() < 0.3:
        stage.put(stage.shape("cube"), stage.materials.opaque(4), [0, 2, -8], [12, 2, 0.2], [0, rng.uniform(-20, 20), 0])
    eye = [rng.uniform(-3, 3), 10 ** rng.uniform(-0.4, 0.6), rng.uniform(4.2, 7)]
    return View(eye, _near(rng, [0, 0.6, 0], 0.6), [[-7, 1.2, -7], [7, 7, 7]], rng.uniform(22, 50), size=1,
                media=[[-6, 0.01, -6], [6, 3, 3]])


def closed_room(stage):
    """A room with openings, abstract things on the floor and in the air."""
    rng = stage.rng
    w, h, d = rng.uniform(2, 5), rng.uniform(2, 4.5), rng.uniform(2.5, 6)
    stage.room([-w, 0, -d], [w, h, d], rng.choice([0, 0.3, 0.5]))
    for _ in range(int(rng.integers(6, 28))):
        flying = rng.random() < 0.25
        size = 10 ** rng.uniform(-0.5, 0.15)
        stage.stand(rng.uniform(-w, w) * 0.8, rng.uniform(0.8, h - 0.8) if flying else 0, rng.uniform(-0.85, 0.4) * d,
                    size, flying=flying)
    eye = [rng.uniform(-0.7, 0.7) * w, rng.uniform(0.3, 0.8) * h, rng.uniform(0.55, 0.92) * d]
    return View(eye, [rng.uniform(-0.5, 0.5) * w, rng.uniform(0.2, 0.6) * h, -0.5 * d],
                [[-0.85 * w, 0.55 * h, -0.85 * d], [0.85 * w, 0.95 * h, 0.85 * d]], rng.uniform(45, 80), True,
                media=[[-w * 0.98, 0.02, -d * 0.98], [w * 0.98, h * 0.6, d * 0.3]])


def terrain(stage):
    """A height field, sometimes with things scattered over it."""
    rng = stage.rng
    scale = 12.0
    if rng.random() < 0.25:
        mesh = stage.mesh("ground", procedural="terrain", size=2, height=round(rng.uniform(0.1, 0.4), 3),
                          seed=int(rng.integers(1000)), mountains=round(rng.uniform(2, 7), 2), resolution=256)
        lift = 5.0
    elif rng.random() < 0.15:
        mesh = stage.mesh("ground", procedural="ocean", size=2, wavelength=round(rng.uniform(0.04, 0.3), 3), trains=16,
                          seed=int(rng.integers(1000)), wave_height=round(rng.uniform(0.004, 0.02), 4),
                          time_s={"interpolation": "linear", "keys": [{"frame": 0, "value": 0}, {"frame": 9, "value": 0.05}]})
        lift = 2.0
    else:
        mesh, lift = stage.special("terrain"), 3.5
        scale = 24.0
    ground = stage.put(mesh, stage.materials.opaque(rng.choice([3, 12])), scale=scale)
    if "procedural" not in stage.meshes[mesh] and rng.random() < 0.9:
        for _ in range(int(rng.integers(1, 4))):
            draw = rng.random()
            if draw < 0.35:
                entry, material = stage.special("cards"), stage.materials.masked()
            elif draw < 0.6:
                entry, material = stage.special("grass"), stage.materials.diffuse()
            else:
                entry, material = stage.special("rock"), stage.materials.opaque()
            stage.put(entry, material, scale=10 ** rng.uniform(-0.6, 0.1), scatter={
                "count": int(10 ** rng.uniform(1.5, 3.3)), "seed": int(rng.integers(1000)), "area": [-9, -9, 9, 9],
                "scale": [0.5, 1.5], "tilt_deg": 15, "on": ground["name"]})
    for _ in range(int(rng.integers(2, 16))):
        stage.stand(rng.uniform(-4, 4), rng.uniform(1, 5), rng.uniform(-5, 3), rng.uniform(0.5, 2.5), flying=True)
    eye = [rng.uniform(-3, 3), lift + rng.uniform(0.5, 4), rng.uniform(7, 10)]
    return View(eye, _near(rng, [0, lift * 0.3, -2], 1), [[-8, lift, -8], [8, lift + 6, 8]], rng.uniform(30, 60), size=2,
                travel=2, media=[[-10, 0.2, -10], [10, lift * 0.9, 6]])


def tabletop(stage):
    """Small things close up on a surface, before a backdrop or none."""
    rng = stage.rng
    stage.put(stage.shape("cube"), stage.materials.opaque(2), [0, -0.1, 0], [1.6, 0.1, 1.2])
    stage.put(stage.shape("rectangle"), stage.materials.opaque(4), [0, -1.5, 0], 12)
    if rng.random() < 0.6:
        stage.put(stage.shape("cube"), stage.materials.opaque(3), [0, 1, -2.2], [4, 3, 0.05], [rng.uniform(-15, 5), 0, 0])
    for _ in range(int(rng.integers(4, 22))):
        stage.stand(rng.uniform(-1.2, 1.2), 0, rng.uniform(-0.9, 0.7), 10 ** rng.uniform(-0.9, -0.15), 0.04)
    eye = [rng.uniform(-0.9, 0.9), rng.uniform(0.15, 1.3), rng.uniform(1.1, 2.4)]
    return View(eye, _near(rng, [0, 0.12, -0.1], 0.12), [[-2, 0.9, -1.8], [2, 2.5, 2]], rng.uniform(22, 50), size=0.3,
                travel=0.25, media=[[-1.5, 0.02, -1.1], [1.5, 0.8, 0.5]])


def corridor(stage):
    """A long passage with ribs, pillars or things along its sides."""
    rng = stage.rng
    w, h, d = rng.uniform(1, 2), rng.uniform(1.6, 3), rng.uniform(8, 16)
    stage.room([-w, 0, -d], [w, h, 3.5], rng.choice([0, 0.4]))
    step = rng.uniform(0.9, 2.5)
    mesh, base, factor = stage.any_mesh()
    material, other = stage.materials.any(), stage.materials.opaque(2)
    bars = rng.random() < 0.4
    for z in np.arange(1.5, -d, -step):
        if bars:
            stage.put(stage.shape("cube"), other, [0, h - 0.1, z], [w, 0.1, 0.1])
        for side in (-1, 1):
            size = rng.uniform(0.4, 0.8)
            place = [side * (w - 0.35), base * factor * size, z]
            stage.put(mesh, material, place, size * factor, [0, rng.uniform(0, 360), 0])
    for _ in range(int(rng.integers(2, 14))):
        stage.stand(rng.uniform(-0.6, 0.6) * w, 0, rng.uniform(-6, 0), rng.uniform(0.2, 0.6))
    eye = [rng.uniform(-0.3, 0.3) * w, rng.uniform(0.4, 0.75) * h, 3.2]
    return View(eye, [rng.uniform(-0.4, 0.4) * w, rng.uniform(0.3, 0.6) * h, -3],
                [[-0.8 * w, 0.6 * h, -d], [0.8 * w, 0.93 * h, 2.5]], rng.uniform(45, 75), True,
                media=[[-w * 0.98, 0.02, -d * 0.9], [w * 0.98, h * 0.9, 1]])


def clutter(stage):
    """Hundreds of small instances on the ground or in the air."""
    rng = stage.rng
    ground = stage.put(stage.shape("rectangle"), stage.materials.opaque(8), scale=20)
    for _ in range(int(rng.integers(2, 6))):
        kinds = ["rock", "knot", "gear", "bevelled_box", "star", "slab_stack", "lattice", "spikes", "prism"]
        draw = rng.random()
        if draw < 0.2:
            mesh, material = stage.special("cards"), stage.materials.masked()
        elif draw < 0.35:
            mesh, material = stage.special("grass"), stage.materials.diffuse()
        else:
            mesh = stage.shape("cube") if draw < 0.45 else stage.special(str(rng.choice(kinds)))
            material = stage.materials.any(1, 0.05)
        area = [-4, -6, 4, 4] if rng.random() < 0.7 else [-9, -9, 9, 5]
        stage.put(mesh, material, scale=10 ** rng.uniform(-1.1, -0.1), scatter={
            "count": int(10 ** rng.uniform(1.7, 3.3)), "seed": int(rng.integers(1000)), "area": area,
            "scale": [0.4, 1.6], "tilt_deg": float(rng.choice([5, 40, 180])), "on": ground["name"]})
    for _ in range(int(rng.integers(0, 7))):
        stage.stand(rng.uniform(-3, 3), 0, rng.uniform(-4, 2), rng.uniform(0.4, 1.6))
    eye = [rng.uniform(-2, 2), 10 ** rng.uniform(-0.1, 0.75), rng.uniform(3.5, 7)]
    return View(eye, _near(rng, [0, 0.3, -0.5], 0.5), [[-6, 1.2, -6], [6, 5, 6]], rng.uniform(25, 60), size=0.7,
                media=[[-6, 0.01, -6], [6, 2, 3]])


def gallery(stage):
    """A wall with pictures, panels and relief, seen obliquely."""
    rng = stage.rng
    stage.put(stage.shape("cube"), stage.materials.opaque(4), [0, 2, -0.2], [9, 4, 0.2])
    stage.put(stage.shape("rectangle"), stage.materials.opaque(6), [0, -0.3, 0], 12)
    for column in range(int(rng.integers(3, 6))):
        for row in range(int(rng.integers(1, 4))):
            x, y = (column - 2) * rng.uniform(1.3, 1.9), 0.7 + row * 1.5 + rng.normal() * 0.1
            w, h = rng.uniform(0.3, 0.75, 2)
            stage.put(stage.shape("cube"), stage.materials.opaque(0.7), [x, y, 0.04], [w + 0.06, h + 0.06, 0.04])
            image = {"image": stage.materials.image("color"), "space": "srgb"}
            entry = stage.materials.add({"type": "diffuse", "reflectance": image})
            turn = rng.normal() * 2
            stage.put(stage.shape("rectangle"), entry, [x, y, 0.085], [w, 1, h], [90, 0, turn])
            if rng.random() < 0.2:
                stage.put(stage.shape("cube"), stage.materials.dielectric(), [x, y, 0.12], [w, h, 0.015])
    if rng.random() < 0.5:
        place = [rng.uniform(-2, 2), -0.2, rng.uniform(0.8, 2)]
        stage.put(stage.special("frame"), stage.materials.opaque(1), place, rng.uniform(2, 4))
    for _ in range(int(rng.integers(0, 7))):
        stage.stand(rng.uniform(-3, 3), -0.3, rng.uniform(0.5, 2), rng.uniform(0.3, 1.3))
    eye = [rng.uniform(-4, 4), rng.uniform(0.5, 2.5), rng.uniform(2.5, 6)]
    return View(eye, [rng.uniform(-1.2, 1.2), rng.uniform(0.8, 1.8), 0], [[-4, 1.5, 0.8], [4, 4, 5]], rng.uniform(28, 60),
                travel=0.7, media=[[-4, -0.28, 0.3], [4, 3, 2]])


def abstract(stage):
    """Shapes at random angles that fill the frame, without a ground."""
    rng = stage.rng
    for _ in range(int(rng.integers(20, 90))):
        size = 10 ** rng.uniform(-0.5, 0.55)
        mesh, _, factor = stage.any_mesh()
        if rng.random() < 0.2:
            mesh, factor = stage.special("sheet" if rng.random() < 0.5 else "frame"), 1.0
        place = rng.uniform([-4.5, -3, -7], [4.5, 3, 0.5])
        stage.put(mesh, stage.materials.any(1), place, size * factor, rng.uniform(0, 360, 3))
    if rng.random() < 0.6:
        turn = [rng.uniform(-20, 20), rng.uniform(-20, 20), 0]
        stage.put(stage.shape("cube"), stage.materials.opaque(4), [0, 0, -9], [14, 9, 0.2], turn)
    return View(_near(rng, [0, 0, 6], 0.5), _near(rng, [0, 0, -1], 0.5), [[-5, -2, -3], [5, 5, 6]], rng.uniform(30, 60),
                media=[[-5, -3, -7], [5, 3, 2]])


def sparse(stage):
    """A few things afloat under an environment, blobs now and then."""
    rng = stage.rng
    for _ in range(int(rng.integers(2, 9))):
        stage.stand(*rng.uniform([-2, -1.2, -2], [2, 1.2, 1.2]), 10 ** rng.uniform(-0.3, 0.45), 0.2, flying=True)
    if rng.random() < 0.5:
        mesh = stage.mesh("blobs", procedural="blobs", count=int(rng.integers(4, 10)), seed=int(rng.integers(1000)),
                          time_s={"interpolation": "linear", "keys": [{"frame": 0, "value": 0}, {"frame": 9, "value": 0.4}]})
        stage.put(mesh, stage.materials.opaque(1), _near(rng, [0, 0, 0], 0.6), rng.uniform(0.7, 1.4))
    return View(_near(rng, [0, 0.4, 5], 0.6), _near(rng, [0, 0, 0], 0.25), [[-4, 1.6, -3], [4, 4, 5]], rng.uniform(25, 50),
                media=[[-2.4, -1.5, -2.4], [2.4, 1.5, 1.6]])


def draped(stage):
    """Wavy sheets, frames and columns behind and above each other: layers of large curved, patterned surfaces."""
    rng = stage.rng
    stage.put(stage.shape("rectangle"), stage.materials.opaque(6), [0, -1.5, 0], 14)
    for layer in range(int(rng.integers(2, 6))):
        mesh = stage.special("sheet")
        tilt = rng.choice([rng.uniform(60, 100), rng.uniform(-20, 35)])
        stage.put(mesh, stage.materials.any(2, 0.05), [rng.normal(), rng.uniform(-0.6, 1.2), -layer * 1.3], rng.uniform(3, 8),
                  [tilt, 0, rng.uniform(-25, 25)])
    for _ in range(int(rng.integers(1, 7))):
        stage.stand(rng.uniform(-2.5, 2.5), -1.5, rng.uniform(-2.5, 2), rng.uniform(0.5, 2.2))
    return View([rng.uniform(-2.5, 2.5), rng.uniform(-0.4, 2), rng.uniform(4, 6.5)], _near(rng, [0, 0, -1], 0.4),
                [[-5, 0.5, -1], [5, 4.5, 6]], rng.uniform(28, 55), media=[[-4, -1.45, -4], [4, 2, 2]])


LAYOUTS = {"open_ground": open_ground, "closed_room": closed_room, "terrain": terrain, "tabletop": tabletop,
           "corridor": corridor, "clutter": clutter, "gallery": gallery, "abstract": abstract, "sparse": sparse,
           "draped": draped}
