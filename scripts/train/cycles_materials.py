"""Random Cycles materials."""

import bpy

from cycles_textures import Graph, ranged, texture

KINDS = {"diffuse": 4, "plastic": 5, "metal": 3, "mirror": 0.7, "glass": 1.3, "coated": 1.5, "sheen": 0.8, "translucent": 0.8,
         "subsurface": 0.25, "layered": 1.5, "anisotropic": 0.6, "anything": 2, "glowing": 0.5}
WALL_KINDS = {"diffuse": 6, "plastic": 5, "metal": 0.5, "coated": 0.7, "sheen": 0.3, "layered": 1.5, "anything": 0.5}


class Inputs:
    """Draws the inputs of shaders: constants, or driven by textures in a textured material."""

    def __init__(self, graph, dice, extent, is_textured):
        self.graph, self.dice = graph, dice
        self.extent = extent
        self.colour_socket, self.value = texture(graph, dice, extent) if is_textured else (None, None)
        self.is_textured = is_textured

    def colour(self):
        return self.colour_socket if self.is_textured else self.dice.colour()

    def roughness(self, low=0.0, high=1.0):
        if self.is_textured and self.dice.chance(0.4):
            return ranged(self.graph, self.dice, self.value, low, high)
        return self.dice.uniform(low, high)

    def normal(self):
        """A bumped normal's inputs, for a third of the textured materials and a quarter of those of one colour."""
        if not self.dice.chance(0.35 if self.is_textured else 0.25):
            return {}
        own = self.is_textured and self.dice.chance(0.6)
        height = self.value if own else texture(self.graph, self.dice, self.extent)[1]
        bump = self.graph.add("Bump", {"Height": height, "Strength": self.dice.uniform(0.1, 0.9),
                                       "Distance": self.extent * self.dice.log_uniform(0.002, 0.03)})
        return {"Normal": bump.outputs["Normal"]}


def _principled(source, settings):
    return source.graph.add("BsdfPrincipled", {"Base Color": source.colour(), **settings, **source.normal()}).outputs["BSDF"]


def _shader(source, kind):
    graph, dice = source.graph, source.dice
    if kind == "diffuse":
        return graph.add("BsdfDiffuse", {"Color": source.colour(), "Roughness": dice.choice((0.0, 0.0, 0.7)),
                                         **source.normal()}).outputs["BSDF"]
    if kind == "plastic":
        return _principled(source, {"Roughness": source.roughness(), "Specular": dice.uniform(0.1, 0.9)})
    if kind == "metal":
        return _principled(source, {"Roughness": source.roughness(0.03, 0.7), "Metallic": 1.0})
    if kind == "mirror":
        return graph.add("BsdfGlossy", {"Color": (0.9, 0.9, 0.9, 1.0), "Roughness": dice.choice((0.0, 0.0, 0.05)),
                                        **source.normal()}).outputs["BSDF"]
    if kind == "glass":
        tint = tuple(0.6 + 0.4 * channel for channel in dice.colour()[:3])
        return graph.add("BsdfGlass", {"Color": (*tint, 1.0), "IOR": dice.uniform(1.2, 1.9),
                                       "Roughness": 0.0 if dice.chance(0.5) else source.roughness(0.0, 0.5),
                                       **source.normal()}).outputs["BSDF"]
    if kind == "coated":
        return _principled(source, {"Roughness": source.roughness(0.2, 0.8), "Clearcoat": dice.uniform(0.3, 1.0),
                                    "Clearcoat Roughness": dice.choice((0.0, 0.03, 0.2))})
    if kind == "sheen":
        return _principled(source, {"Roughness": source.roughness(0.5, 1.0), "Sheen": 1.0, "Sheen Tint": dice.random()})
    if kind == "translucent":
        front = graph.add("BsdfDiffuse", {"Color": source.colour(), **source.normal()})
        back = graph.add("BsdfTranslucent", {"Color": source.colour()})
        return _mixed(graph, dice.uniform(0.2, 0.8), front.outputs[0], back.outputs[0])
    if kind == "subsurface":
        return _principled(source, {"Subsurface": dice.uniform(0.2, 1.0), "Roughness": source.roughness(0.2, 0.8),
                                    "Subsurface Radius": [source.extent * dice.uniform(0.02, 0.15) for _ in range(3)]})
    if kind == "anisotropic":
        return _principled(source, {"Metallic": 1.0, "Roughness": source.roughness(0.1, 0.6),
                                    "Anisotropic": dice.uniform(0.4, 0.95), "Anisotropic Rotation": dice.random()})
    if kind == "anything":
        return _principled(source, {"Roughness": source.roughness(), "Metallic": dice.random(), "Specular": dice.random(),
                                    "Transmission": dice.random() if dice.chance(0.3) else 0.0, "Sheen": dice.random(),
                                    "Clearcoat": dice.random()})
    if kind == "glowing":
        return graph.add("Emission", {"Color": source.colour(), "Strength": dice.log_uniform(0.05, 3.0)}).outputs[0]
    first, second = (_shader(source, dice.choice(("diffuse", "plastic", "metal", "coated"))) for _ in range(2))
    mask = ranged(graph, dice, source.value, 0.0, 1.0) if source.is_textured else dice.random()
    return _mixed(graph, mask, first, second)


def _mixed(graph, fraction, first, second):
    return graph.add("MixShader", {0: fraction, 1: first, 2: second}).outputs[0]


def _start(name):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, Graph(made.node_tree)


def material(dice, extent, textured, kinds=KINDS):
    """A material of a random kind for things of about the size `extent`; `textured` is the chance of textures."""
    kind = dice.pick(kinds)
    made, graph = _start(kind)
    source = Inputs(graph, dice, extent, dice.chance(textured))
    graph.add("OutputMaterial", {"Surface": _shader(source, kind)})
    return made


def card_material(dice, extent):
    """Cut out by a mask: leaves, lace, perforated sheets. Half-transparent film at times."""
    made, graph = _start("card")
    source = Inputs(graph, dice, extent, dice.chance(0.6))
    solid = _shader(source, dice.choice(("diffuse", "translucent", "plastic", "translucent")))
    mask = texture(graph, dice, extent, dice.log_uniform(1.0, 15.0))[1]
    if dice.chance(0.8):
        mask = graph.add("Math", {0: mask, 1: dice.uniform(0.3, 0.65)}, operation="GREATER_THAN").outputs[0]
    hole = graph.add("BsdfTransparent").outputs[0]
    graph.add("OutputMaterial", {"Surface": _mixed(graph, mask, hole, solid)})
    return made


def blade_material(dice, extent):
    made, graph = _start("blade")
    source = Inputs(graph, dice, extent, dice.chance(0.4))
    graph.add("OutputMaterial", {"Surface": _shader(source, dice.choice(("diffuse", "translucent", "plastic")))})
    return made


def emitter(colour, strength):
    made, graph = _start("emitter")
    graph.add("OutputMaterial", {"Surface": graph.add("Emission", {"Color": (*colour, 1.0), "Strength": strength}).outputs[0]})
    return made


def medium(dice, density):
    """A homogeneous medium of `density` per unit of length."""
    made, graph = _start("medium")
    colour = tuple(0.5 + 0.5 * channel for channel in dice.colour()[:3])
    shader = graph.add("VolumeScatter", {"Color": (*colour, 1.0), "Density": density, "Anisotropy": dice.uniform(-0.3, 0.8)})
    graph.add("OutputMaterial", {"Volume": shader.outputs[0]})
    made.cycles.homogeneous_volume = True
    return made
