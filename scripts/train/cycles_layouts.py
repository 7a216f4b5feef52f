"""Random arrangements of things: each returns what the camera may look at and from where."""

import math
from dataclasses import dataclass, field

from mathutils import Vector

import cycles_things as things
from cycles_materials import KINDS, WALL_KINDS, blade_material, card_material, material


@dataclass
class View:
    centre: tuple  # of what the lights should reach
    radius: float
    targets: list  # points that the camera may aim at
    distance: tuple  # of the camera from its target: least and greatest
    elevation: tuple = (0.05, 1.0)  # of the camera, in radians
    inside: tuple = None  # box (low, high) that the camera and the lights stay in
    azimuth: tuple = (0.0, math.tau)
    least_hits: float = 0.6  # part of the frame that shows a surface
    least_objects: int = 3  # in the frame
    has_walls: bool = False  # the environment's light comes through openings only


@dataclass
class Stage:
    """The dice of a shot, its chance of textures, and the objects that may move."""
    dice: object
    textured: float
    movable: list = field(default_factory=list)

    def material(self, extent=2.0, kinds=KINDS):
        return material(self.dice, extent, self.textured, kinds)

    def fixed(self, data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1), kinds=WALL_KINDS):
        return things.add(data, location, rotation, scale, self.material(2.0, kinds))

    def prop(self, data, location, size, rotation=None, surface=None):
        made = things.add(data, location, rotation or self.dice.turn(), stretch(self.dice, size), surface or self.material())
        self.movable.append(made)
        return made

    def floor(self, extent, z=0.0):
        """A ground plane, or a gently curved sheet."""
        data = things.plane_mesh() if self.dice.chance(0.8) else things.sheet(self.dice)
        self.fixed(data, (0, 0, z), (0, 0, self.dice.uniform(0.0, 6.3)), (extent, extent, 0.1 * extent))


def stretch(dice, size):
    if dice.chance(0.6):
        return (size, size, size)
    return tuple(size * dice.log_uniform(0.4, 1.6) for _ in range(3))


def spread(dice, count, extent, gap):
    """Up to `count` points of [-extent, extent]^2, at least `gap` apart."""
    points = []
    for _ in range(count * 6):
        point = (dice.uniform(-extent, extent), dice.uniform(-extent, extent))
        if all(math.dist(point, other) > gap for other in points):
            points.append(point)
        if len(points) == count:
            break
    return points


def open_floor(stage):
    dice = stage.dice
    stage.floor(dice.uniform(8.0, 25.0))
    targets = []
    for x, y in spread(dice, dice.randint(3, 14), 3.0, 0.9):
        size = dice.uniform(0.25, 0.8)
        lift = dice.uniform(0.5, 2.0) if dice.chance(0.2) else size * 0.9
        stage.prop(things.solid(dice), (x, y, lift), size, None if dice.chance(0.4) else (0, 0, dice.uniform(0, 6.3)))
        targets.append((x, y, lift))
    if dice.chance(0.3):
        stage.fixed(things.plane_mesh(), (0, 4.5, 2), (math.pi / 2, 0, 0), (8, 3, 1))
        return View((0, 0, 0.5), 4.0, targets, (2.0, 7.0), inside=((-9, -9, 0.1), (9, 4.3, 6)))
    return View((0, 0, 0.5), 4.0, targets, (2.0, 7.0))


def plain(stage):
    """A ground that reaches far, whose texture is finer than a pixel in the distance, with things on it."""
    dice = stage.dice
    extent = dice.log_uniform(30.0, 150.0)
    surface = material(dice, dice.log_uniform(0.15, 3.0), 1.0, WALL_KINDS)
    things.add(things.plane_mesh(), scale=(extent, extent, 1), material=surface)
    targets = []
    for x, y in spread(dice, dice.randint(3, 12), 4.0, 1.0):
        size = dice.log_uniform(0.2, 1.2)
        stage.prop(things.solid(dice), (x, y, 0.9 * size), size, (0, 0, dice.uniform(0, 6.3)))
        targets.append((x, y, 0.9 * size))
    return View((0, 0, 0.5), 4.0, targets, (3.0, 9.0), (0.03, 0.35))


def walls_of(stage, width, depth, height, holes):
    """Four pierced walls, a floor and a ceiling around the origin; `holes` in each wall, in turn."""
    dice = stage.dice
    x, y = width / 2, depth / 2
    for count, length, corner, turn in zip(holes, (width, depth, width, depth), ((-x, -y), (x, -y), (x, y), (-x, y)), range(4)):
        wall = things.pierced_wall(dice, length, height, dice.randint(3, 9), dice.randint(2, 5), count)
        stage.fixed(wall, (*corner, 0.0), (math.pi / 2, 0, turn * math.pi / 2))
    stage.fixed(things.plane_mesh(), scale=(x, y, 1))
    stage.fixed(things.plane_mesh(), (0, 0, height), (math.pi, 0, 0), (x, y, 1))


def room(stage):
    """A closed hall of solids with several openings or slits, or with none but lamps."""
    dice = stage.dice
    width, depth, height = dice.uniform(4.0, 9.0), dice.uniform(4.0, 9.0), dice.uniform(2.4, 5.0)
    holes = [dice.choice((0, 1, 2, 4)) for _ in range(4)]
    walls_of(stage, width, depth, height, holes)
    targets = []
    for x, y in spread(dice, dice.randint(4, 16), 0.5 * min(width, depth) - 0.7, 0.7):
        size = dice.uniform(0.15, 0.6)
        z = size if dice.chance(0.8) else dice.uniform(1.0, height - size)
        stage.prop(things.solid(dice), (x, y, z), size, (0, 0, dice.uniform(0, 6.3)))
        targets.append((x, y, z))
    if dice.chance(0.4):
        stage.prop(things.box_mesh(), (0, 0, 0.1), 0.1, (0, 0, 0)).scale = (width * 0.3, depth * 0.3, 0.1)
    inside = ((-0.46 * width, -0.46 * depth, 0.3), (0.46 * width, 0.46 * depth, height - 0.1))
    return View((0, 0, 0.4 * height), 0.4 * width, targets, (1.5, 6.0), (-0.1, 0.7), inside, least_hits=0.8, has_walls=True)


def corridor(stage):
    """Bays repeated along y, with ribs, openings and things on the way."""
    dice = stage.dice
    width, length, height = dice.uniform(1.6, 4.0), dice.uniform(12.0, 24.0), dice.uniform(2.2, 4.5)
    side_holes = dice.choice((0, 3, 8))
    walls_of(stage, width, length, height, (dice.choice((0, 2)), side_holes, dice.choice((0, 2)), dice.choice((0, side_holes))))
    rib, rib_surface = things.box(dice) if dice.chance(0.6) else things.cylinder(dice), stage.material(0.3, WALL_KINDS)
    bays = dice.randint(4, 10)
    for k in range(bays):
        y = length * ((k + 0.5) / bays - 0.5)
        for x in (-0.5 * width, 0.5 * width):
            things.add(rib, (x, y, height / 2), scale=(0.12, 0.12, height / 2), material=rib_surface)
        if dice.chance(0.7):
            things.add(rib, (0, y, height), (0, math.pi / 2, 0), (0.1, 0.1, width / 2), rib_surface)
    targets = [(0.0, dice.uniform(0.0, 0.5) * length, dice.uniform(0.3, 0.7) * height) for _ in range(4)]
    for _ in range(dice.randint(2, 10)):
        size = dice.uniform(0.1, 0.35)
        stage.prop(things.solid(dice), (dice.uniform(-0.3, 0.3) * width, dice.uniform(-0.3, 0.5) * length, size), size)
    inside = ((-0.42 * width, -0.48 * length, 0.4), (0.42 * width, 0.48 * length, height - 0.2))
    return View((0, 0, 0.5 * height), 3.0, targets, (4.0, 10.0), (-0.05, 0.2), inside, least_hits=0.8, has_walls=True)


def terrain(stage):
    """A heightfield with scattered rocks, columns and tufts, or bare."""
    dice = stage.dice
    extent = 12.0
    data, z = things.heightfield(dice, extent, dice.log_uniform(0.3, 3.0))
    stage.fixed(data)
    targets = []
    for _ in range(dice.choice((0, 6, 12, 30))):
        x, y, size = dice.gauss(0.0, 4.0), dice.gauss(0.0, 4.0), dice.log_uniform(0.1, 0.9)
        stage.prop(things.rock(dice) if dice.chance(0.5) else things.solid(dice), (x, y, z(x, y) + 0.5 * size), size)
    if dice.chance(0.35):
        grass, surface = [things.tuft(dice) for _ in range(2)], blade_material(dice, 1.0)
        for _ in range(150):
            x, y, size = dice.gauss(0.0, 3.0), dice.gauss(0.0, 3.0), dice.uniform(0.15, 0.5)
            things.add(dice.choice(grass), (x, y, z(x, y)), (0, 0, dice.uniform(0, 6.3)), (size, size, size), surface)
    if dice.chance(0.3):  # water
        level = dice.uniform(-0.3, 0.3)
        stage.fixed(things.sheet(dice), (0, 0, level), scale=(extent, extent, 0.15), kinds={"coated": 1, "mirror": 1, "glass": 1})
    for _ in range(5):
        x, y = dice.gauss(0.0, 2.5), dice.gauss(0.0, 2.5)
        targets.append((x, y, z(x, y) + 0.3))
    return View((0, 0, 0), 6.0, targets, (2.0, 8.0), (0.12, 0.9), least_hits=0.5, least_objects=1 if not stage.movable else 3)


def tabletop(stage):
    """Small things close by on a slab, before a backdrop at times."""
    dice = stage.dice
    stage.fixed(things.box(dice), (0, 0, -0.1), scale=(dice.uniform(0.8, 2.0), dice.uniform(0.8, 2.0), 0.1))
    if dice.chance(0.7):
        stage.floor(6.0, -1.2)
    if dice.chance(0.6):
        stage.fixed(things.sheet(dice), (0, dice.uniform(1.5, 3.0), 0), (math.pi / 2, 0, 0), (4, 3, dice.choice((0.02, 0.6))))
    targets = []
    for x, y in spread(dice, dice.randint(3, 25), 0.6, 0.17):
        size = dice.uniform(0.04, 0.2)
        stage.prop(things.solid(dice), (x, y, size * 0.95), size, dice.choice((None, (0, 0, dice.uniform(0, 6.3)))))
        targets.append((x, y, size))
    return View((0, 0, 0.1), 0.9, targets, (0.35, 1.4), (0.1, 1.2))


def clutter(stage):
    """Many small copies of a few shapes, heaped or strewn."""
    dice = stage.dice
    stage.floor(8.0)
    shapes = [things.solid(dice) for _ in range(dice.randint(3, 8))]
    surfaces = [stage.material() for _ in range(dice.randint(4, 14))]
    is_heap, extent = dice.chance(0.5), dice.uniform(1.2, 3.0)
    for _ in range(dice.randint(60, 220)):
        size = dice.log_uniform(0.06, 0.3)
        x, y = (dice.gauss(0.0, 0.4 * extent), dice.gauss(0.0, 0.4 * extent)) if is_heap else (
            dice.uniform(-extent, extent), dice.uniform(-extent, extent))
        top = 1.3 * math.exp(-(x * x + y * y) / (0.25 * extent * extent)) if is_heap else 0.1
        stage.prop(dice.choice(shapes), (x, y, 0.6 * size + dice.random() * top), size, surface=dice.choice(surfaces))
    targets = [(dice.gauss(0.0, 0.3), dice.gauss(0.0, 0.3), dice.uniform(0.1, 0.8)) for _ in range(4)]
    return View((0, 0, 0.4), 2.5, targets, (1.0, 4.0), (0.1, 1.2))


def wall(stage):
    """A wall with pictures, ledges with small things, pipes and reliefs."""
    dice = stage.dice
    width, height = 6.0, 3.2
    stage.fixed(things.plane_mesh(), (0, 0, height / 2), (math.pi / 2, 0, 0), (width, height, 1))
    stage.floor(6.0)
    targets = [(dice.uniform(-1.5, 1.5), 0.0, dice.uniform(0.8, 2.2)) for _ in range(4)]
    border = stage.material(0.5, WALL_KINDS)
    for x, z in spread(dice, dice.randint(2, 9), 1.6, 0.8):
        w, h = dice.uniform(0.2, 0.5), dice.uniform(0.2, 0.5)
        things.add(things.box(dice), (x, -0.02, z + 1.7), scale=(w, 0.03, h), material=border)
        things.add(things.plane_mesh(), (x, -0.06, z + 1.7), (math.pi / 2, 0, 0), (0.85 * w, 0.85 * h, 1),
                   material(dice, 2.0, 1.0, {"diffuse": 3, "plastic": 3, "coated": 2, "glowing": 1}))
    for _ in range(dice.randint(0, 3)):
        z = dice.uniform(0.4, 2.4)
        stage.fixed(things.box_mesh(), (0, -0.15, z), scale=(dice.uniform(1.0, 3.0), 0.15, 0.02))
        for _ in range(dice.randint(3, 14)):
            size = dice.uniform(0.04, 0.14)
            stage.prop(things.solid(dice), (dice.uniform(-2.0, 2.0), -0.15, z + 0.02 + size), size, (0, 0, dice.uniform(0, 6.3)))
    if dice.chance(0.4):
        pipe, surface = things.cylinder(dice), stage.material()
        for _ in range(dice.randint(1, 6)):
            x, z = dice.uniform(-3.0, 3.0), dice.uniform(0.0, 3.0)
            end = (x, -0.1, 3.2) if dice.chance(0.5) else (dice.uniform(-3.0, 3.0), -0.1, z)
            things.between((x, -0.1, 0.0 if end[2] == 3.2 else z), end, dice.uniform(0.02, 0.08), pipe, surface)
    for _ in range(dice.randint(0, 5)):
        size = dice.uniform(0.15, 0.5)
        stage.prop(things.solid(dice), (dice.uniform(-2.0, 2.0), dice.uniform(-1.5, -0.4), size), size)
    return View((0, -0.8, 1.3), 2.2, targets, (1.2, 4.0), (-0.1, 0.5), ((-4, -5, 0.2), (4, -0.25, 4)), (math.pi, math.tau))


def abstract(stage):
    """Large shapes through one another that fill the frame."""
    dice = stage.dice
    targets = []
    for _ in range(dice.randint(6, 24)):
        point = Vector(dice.direction()) * dice.uniform(0.2, 2.0)
        stage.prop(things.sheet(dice) if dice.chance(0.2) else things.solid(dice), point, dice.uniform(0.4, 1.4))
        targets.append(tuple(point))
    stage.fixed(things.rock(dice), scale=(14, 14, 14))
    return View((0, 0, 0), 2.5, targets[:6], (1.5, 4.5), (-1.2, 1.2), ((-5, -5, -5), (5, 5, 5)), has_walls=True)


def sparse(stage):
    """A few things afloat in the environment."""
    dice = stage.dice
    targets = []
    for _ in range(dice.randint(1, 6)):
        point = Vector(dice.direction()) * dice.uniform(0.0, 1.6)
        stage.prop(things.solid(dice), point, dice.uniform(0.5, 1.1))
        targets.append(tuple(point))
    return View((0, 0, 0), 2.0, targets, (2.0, 4.5), (-0.8, 1.0), least_hits=0.25, least_objects=1)


def colonnade(stage):
    """Rows of columns, arches of bars, stairs and blocks outdoors."""
    dice = stage.dice
    stage.floor(30.0)
    rows, pitch, height = dice.choice((2, 3, 4)), dice.uniform(1.0, 2.2), dice.uniform(2.0, 4.0)
    column = dice.choice((things.lathe, things.cylinder, things.box, things.twisted))(dice)
    surface = stage.material(1.0, WALL_KINDS)
    beam, beam_surface = things.box(dice), stage.material(1.0, WALL_KINDS)
    for i in range(rows):
        x = (i - (rows - 1) / 2) * dice.uniform(1.0, 1.1) * pitch * 1.5
        for k in range(7):
            things.add(column, (x, (k - 3) * pitch, height / 2), scale=(0.25, 0.25, height / 2), material=surface)
        things.add(beam, (x, 0, height), scale=(0.3, 3.6 * pitch, 0.15), material=beam_surface)
    if dice.chance(0.4):  # laths that throw striped shadows
        for k in range(24):
            things.add(beam, (0, (k - 12) * 0.28 * pitch, height + 0.25), scale=(rows * pitch, 0.05, 0.08), material=beam_surface)
    for _ in range(dice.randint(1, 4)):
        size = dice.uniform(0.5, 1.2)
        made = things.stairs(dice) if dice.chance(0.6) else things.box(dice)
        stage.prop(made, (dice.uniform(-4.0, 4.0), dice.uniform(-5.0, 5.0), size), size, (0, 0, dice.uniform(0, 6.3)))
    for _ in range(dice.randint(0, 8)):
        size = dice.uniform(0.1, 0.5)
        stage.prop(things.solid(dice), (dice.uniform(-3.0, 3.0), dice.uniform(-4.0, 4.0), size), size)
    targets = [(dice.uniform(-1.0, 1.0), dice.uniform(-2.0, 2.0), dice.uniform(0.5, 0.7 * height)) for _ in range(4)]
    return View((0, 0, 1), 5.0, targets, (3.0, 9.0), (0.0, 0.6))


def hangings(stage):
    """Wavy sheets, perforated and translucent ones among them, hung behind one another."""
    dice = stage.dice
    stage.floor(8.0)
    targets = []
    for _ in range(dice.randint(3, 9)):
        point = (dice.uniform(-1.8, 1.8), dice.uniform(-1.8, 1.8), dice.uniform(0.7, 1.4))
        surface = card_material(dice, 2.0) if dice.chance(0.5) else stage.material()
        stage.prop(things.sheet(dice), point, dice.uniform(0.5, 1.1),
                   (math.pi / 2, dice.uniform(-0.2, 0.2), dice.uniform(0, 6.3)), surface)
        targets.append(point)
    for _ in range(dice.randint(1, 6)):
        size = dice.uniform(0.15, 0.5)
        stage.prop(things.solid(dice), (dice.uniform(-1.5, 1.5), dice.uniform(-1.5, 1.5), size), size)
    return View((0, 0, 0.8), 2.5, targets, (1.5, 4.5), (0.0, 0.7))


def cards(stage):
    """Cut-out cards and tufts of blades or hairs in a loose cloud or on a slab."""
    dice = stage.dice
    stage.floor(6.0)
    surfaces = [card_material(dice, 1.0) for _ in range(dice.randint(1, 4))]
    shapes = [things.sheet(dice, 12) for _ in range(3)] + [things.plane_mesh()]
    for _ in range(dice.randint(25, 110)):
        point = Vector((dice.gauss(0.0, 0.9), dice.gauss(0.0, 0.9), dice.uniform(0.1, 1.8)))
        stage.prop(dice.choice(shapes), point, dice.uniform(0.1, 0.4), surface=dice.choice(surfaces))
    fur = [things.tuft(dice, 120) for _ in range(2)]
    surface = blade_material(dice, 1.0)
    for _ in range(dice.choice((0, 20, 70))):
        size = dice.uniform(0.2, 0.5)
        things.add(dice.choice(fur), (dice.uniform(-1.5, 1.5), dice.uniform(-1.5, 1.5), 0), (0, 0, dice.uniform(0, 6.3)),
                   (size, size, size), surface)
    targets = [(dice.gauss(0.0, 0.4), dice.gauss(0.0, 0.4), dice.uniform(0.3, 1.2)) for _ in range(4)]
    return View((0, 0, 0.8), 2.0, targets, (1.2, 3.5), (0.0, 0.9))


LAYOUTS = {open_floor: 2, plain: 3, room: 2, corridor: 1.2, terrain: 1.5, tabletop: 2, clutter: 1.5, wall: 1.5, abstract: 1.3, sparse: 1,
           colonnade: 1.2, hangings: 1, cards: 1}
