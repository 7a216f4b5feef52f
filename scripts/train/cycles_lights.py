"""Random lights, environments and media around what a shot shows."""

import math

import bpy
from mathutils import Vector

import cycles_things as things
from cycles_materials import emitter, medium
from cycles_textures import Graph, PATTERNS

ENVIRONMENTS = {"constant": 1.5, "gradient": 1.5, "sky": 3, "pattern": 2, "none": 2}
RIGS = {"sun": 2, "area": 3, "tiny area": 1, "point": 2, "spot": 2, "many": 1.5, "meshes": 1.5, "strips": 0.7}


def set_environment(dice, strength, kind=None):
    """The world of the scene; `strength` is its mean radiance, roughly."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    graph = Graph(world.node_tree)
    kind = kind or dice.pick(ENVIRONMENTS)
    colour = (*dice.light_colour(), 1.0)
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = 512 if kind == "sky" else 256
    if kind == "sky":
        sky = graph.add("TexSky", sky_type=dice.pick({"NISHITA": 3, "PREETHAM": 1, "HOSEK_WILKIE": 1}))
        if sky.sky_type == "NISHITA":
            sky.sun_elevation, sky.sun_rotation = dice.uniform(0.02, 1.5), dice.uniform(0.0, 6.3)
            sky.sun_size = math.radians(dice.log_uniform(0.5, 8.0))
            sky.sun_disc = dice.chance(0.75)
            sky.dust_density = dice.uniform(0.0, 4.0)
            strength *= 0.1
        else:
            direction = dice.direction()
            sky.sun_direction = (direction[0], direction[1], abs(direction[2]) + 0.05)
            sky.turbidity = dice.uniform(2.0, 8.0)
        colour = sky.outputs["Color"]
    elif kind == "gradient":
        up = graph.add("SeparateXYZ", {"Vector": graph.add("TexCoord").outputs["Generated"]}).outputs["Z"]
        level = graph.add("MapRange", {"Value": up, "From Min": dice.uniform(-1.0, 0.0), "From Max": dice.uniform(0.1, 1.0)})
        colour = graph.add("MixRGB", {"Fac": level.outputs["Result"], "Color1": (*dice.light_colour(), 1.0),
                                      "Color2": colour}).outputs["Color"]
    elif kind == "pattern":
        vector = graph.add("VectorMath", {0: graph.add("TexCoord").outputs["Generated"], "Scale": dice.log_uniform(1.0, 12.0)},
                           operation="SCALE").outputs["Vector"]
        value = dice.pick(PATTERNS)(graph, dice, vector)[1]
        sharp = graph.add("Math", {0: value, 1: dice.log_uniform(0.7, 10.0)}, operation="POWER", use_clamp=True)
        colour = graph.add("MixRGB", {"Fac": sharp.outputs[0], "Color1": (0.05, 0.05, 0.06, 1.0),
                                      "Color2": colour}).outputs["Color"]
    elif kind == "none":
        strength = 0.0
    background = graph.add("Background", {"Color": colour, "Strength": strength})
    graph.add("OutputWorld", {"Surface": background.outputs[0]})
    return kind


class Lights:
    """Adds lights that reach the space of the given centre and radius."""

    def __init__(self, dice, centre, radius, inside=None):
        """`inside` is the box (low, high) that lights stay in, for closed rooms."""
        self.dice, self.centre, self.radius, self.inside = dice, Vector(centre), radius, inside
        self.made = []

    def place(self, nearest=0.7, farthest=3.0):
        dice = self.dice
        if self.inside:
            low, high = self.inside
            return Vector([l + (h - l) * dice.uniform(0.12, 0.88 if axis < 2 else 0.95)
                           for axis, (l, h) in enumerate(zip(low, high))])
        x, y, z = dice.direction()
        return self.centre + Vector((x, y, abs(z) + 0.15)) * self.radius * dice.uniform(nearest, farthest)

    def lamp(self, kind, position, irradiance, **settings):
        """A lamp that gives about `irradiance` at the centre, turned towards a point near it."""
        dice = self.dice
        data = bpy.data.lights.new(kind, kind)
        target = self.centre + Vector(dice.direction()) * self.radius * 0.4
        distance = max((position - target).length, 0.3 * self.radius)
        data.color = dice.light_colour()
        data.energy = irradiance if kind == "SUN" else irradiance * distance ** 2 * (3.0 if kind == "AREA" else 12.0)
        for name, value in settings.items():
            setattr(data, name, value)
        made = things.add(data, position, (target - position).to_track_quat("-Z", "Y").to_euler())
        self.made.append(made)

    def rig(self, kind, irradiance):
        dice, radius = self.dice, self.radius
        if kind == "sun":
            self.lamp("SUN", self.centre + Vector(dice.direction()) * 5 + Vector((0, 0, 6)), irradiance,
                      angle=math.radians(dice.log_uniform(0.3, 30.0)))
        elif kind in ("area", "tiny area"):
            size = radius * (dice.log_uniform(0.01, 0.08) if kind == "tiny area" else dice.log_uniform(0.1, 2.0))
            for _ in range(dice.choice((1, 1, 2, 3))):
                self.lamp("AREA", self.place(), irradiance, shape=dice.choice(("SQUARE", "DISK", "RECTANGLE")),
                          size=size, size_y=size * dice.log_uniform(0.1, 1.0))
        elif kind == "point":
            for _ in range(dice.choice((1, 1, 2, 3))):
                self.lamp("POINT", self.place(0.5, 1.5), irradiance, shadow_soft_size=radius * dice.log_uniform(0.002, 0.2))
        elif kind == "spot":
            for _ in range(dice.choice((1, 1, 2, 4))):
                self.lamp("SPOT", self.place(), irradiance, spot_size=math.radians(dice.uniform(12.0, 80.0)),
                          spot_blend=dice.random(), shadow_soft_size=radius * dice.log_uniform(0.003, 0.1))
        elif kind == "many":
            count = dice.randint(8, 40)
            for _ in range(count):
                self.lamp("POINT", self.place(0.3, 1.1), irradiance * dice.log_uniform(0.3, 3.0) / count,
                          shadow_soft_size=radius * dice.log_uniform(0.002, 0.03))
        else:
            self.glowing(kind, irradiance)

    def glowing(self, kind, irradiance):
        """Emissive solids, or long thin tubes."""
        dice, radius = self.dice, self.radius
        count = dice.choice((1, 2, 3, 6, 12))
        for _ in range(count):
            position, size = self.place(0.5, 1.4), radius * dice.log_uniform(0.02, 0.15)
            distance = max((position - self.centre).length, 0.3 * radius)
            shape = Vector((1, 1, 1)) if kind == "meshes" else Vector((0.1, 0.1, dice.uniform(3.0, 8.0)))
            strength = irradiance / count * distance ** 2 / (size * size * max(shape.x * shape.z, 0.5))
            data = things.solid(dice) if kind == "meshes" else things.box_mesh()
            self.made.append(things.add(data, position, dice.turn(), shape * size, emitter(dice.light_colour(), strength)))

    def add_any(self, has_environment):
        dice = self.dice
        count = dice.pick({0: 2, 1: 4, 2: 3, 3: 1}) if has_environment else dice.pick({1: 4, 2: 3, 3: 2})
        for _ in range(count):
            kind = dice.pick(RIGS)
            if self.inside and kind in ("sun", "tiny area"):
                kind = "area"
            self.rig(kind, dice.log_uniform(0.2, 6.0))


def add_medium(dice, centre, radius):
    """A box of thin medium around the space, whose optical thickness across is 0.1 to 2, with a spot in it at times."""
    size = radius * dice.uniform(1.5, 3.0)
    substance = medium(dice, dice.log_uniform(0.1, 2.0) / (2.0 * size))
    things.add(things.box_mesh(), centre, scale=(size, size, size), material=substance)
    if dice.chance(0.5):
        above = Vector(centre) + Vector(dice.direction()) * radius * 0.3 + Vector((0, 0, radius))
        Lights(dice, centre, radius * 0.8).lamp("SPOT", above, dice.log_uniform(1.0, 10.0), shadow_soft_size=0.02 * radius,
                                                spot_size=math.radians(dice.uniform(15.0, 50.0)))


def scale_lights(factor):
    """All light of the scene by a factor, keyframed energies included."""
    for lamp in bpy.data.lights:
        lamp.energy *= factor
        for curve in lamp.animation_data.action.fcurves if lamp.animation_data else ():
            for key in curve.keyframe_points:
                key.co.y *= factor
                key.handle_left.y *= factor
                key.handle_right.y *= factor
    for owner in (*bpy.data.materials, *bpy.data.worlds):
        for node in owner.node_tree.nodes:
            if node.bl_idname in ("ShaderNodeEmission", "ShaderNodeBackground"):
                node.inputs["Strength"].default_value *= factor
