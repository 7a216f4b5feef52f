"""Random procedural textures, as shader nodes."""

import bpy
import numpy as np


class Graph:
    """A node tree with short words for adding and linking nodes."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, inputs=None, **settings):
        """A node of the type ShaderNode<kind>. An input is a value or a socket to link from."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for name, value in settings.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def coordinates(self, dice, features, extent):
        """Coordinates with about `features` periods over an object of the size `extent`."""
        source = self.add("TexCoord")
        in_units = dice.chance(0.5)
        scale = features / extent if in_units else features
        stretch = dice.log_uniform(0.15, 1.0) if dice.chance(0.2) else 1.0
        mapping = self.add("Mapping", {
            "Vector": source.outputs["Object" if in_units else "Generated"],
            "Location": [dice.uniform(-50.0, 50.0) for _ in range(3)],
            "Rotation": [dice.uniform(0.0, 6.3) if dice.chance(0.4) else 0.0 for _ in range(3)],
            "Scale": (scale, scale * stretch, scale),
        })
        return mapping.outputs["Vector"]


def _checker(graph, dice, vector):
    node = graph.add("TexChecker", {"Vector": vector, "Scale": 1.0, "Color1": dice.colour(), "Color2": dice.colour()})
    return node.outputs["Color"], node.outputs["Fac"]


def _brick(graph, dice, vector):
    node = graph.add("TexBrick", {
        "Vector": vector, "Scale": 1.0, "Color1": dice.colour(), "Color2": dice.colour(), "Mortar": dice.colour(),
        "Mortar Size": dice.uniform(0.005, 0.06), "Brick Width": dice.uniform(0.3, 1.5), "Row Height": dice.uniform(0.15, 0.5),
    }, offset=dice.choice((0.0, 0.5, 0.3)))
    return node.outputs["Color"], node.outputs["Fac"]


def _noise(graph, dice, vector):
    node = graph.add("TexNoise", {"Vector": vector, "Scale": 1.0, "Detail": dice.uniform(0.0, 8.0),
                                  "Roughness": dice.uniform(0.3, 0.8), "Distortion": dice.choice((0.0, 0.0, 1.0, 4.0))})
    return node.outputs["Color"] if dice.chance(0.15) else None, _contrast(graph, dice, node.outputs["Fac"])


def _voronoi(graph, dice, vector):
    feature = dice.pick({"F1": 3, "F2": 1, "SMOOTH_F1": 1, "DISTANCE_TO_EDGE": 2})
    settings = {"feature": feature}
    if feature != "DISTANCE_TO_EDGE":
        settings["distance"] = dice.choice(("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV"))
    node = graph.add("TexVoronoi", {"Vector": vector, "Scale": 1.0}, **settings)
    has_cells = feature == "F1" and dice.chance(0.5)
    return node.outputs["Color"] if has_cells else None, node.outputs["Distance"]


def _wave(graph, dice, vector):
    node = graph.add("TexWave", {"Vector": vector, "Scale": 0.3, "Distortion": dice.choice((0.0, 0.0, 2.0, 10.0)),
                                 "Detail": dice.uniform(0.0, 4.0)},
                     wave_type=dice.choice(("BANDS", "RINGS")), wave_profile=dice.choice(("SIN", "SAW", "TRI")))
    return None, node.outputs["Fac"]


def _magic(graph, dice, vector):
    node = graph.add("TexMagic", {"Vector": vector, "Scale": 1.0, "Distortion": dice.uniform(0.5, 3.0)},
                     turbulence_depth=dice.randint(1, 6))
    return node.outputs["Color"] if dice.chance(0.4) else None, node.outputs["Fac"]


def _gradient(graph, dice, vector):
    fraction = graph.add("VectorMath", {0: vector}, operation="FRACTION")
    node = graph.add("TexGradient", {"Vector": fraction.outputs["Vector"]},
                     gradient_type=dice.choice(("LINEAR", "EASING", "SPHERICAL", "RADIAL")))
    return None, node.outputs["Fac"]


def _musgrave(graph, dice, vector):
    node = graph.add("TexMusgrave", {"Vector": vector, "Scale": 1.0, "Detail": dice.uniform(1.0, 8.0),
                                     "Dimension": dice.uniform(0.2, 1.5)},
                     musgrave_type=dice.choice(("FBM", "MULTIFRACTAL", "RIDGED_MULTIFRACTAL")))
    return None, node.outputs["Fac"]


def _grid_of_noise(graph, dice, vector):
    """A flat random value for each cell: pixels, tiles, lit panes."""
    cells = graph.add("VectorMath", {0: vector}, operation="FLOOR")
    node = graph.add("TexWhiteNoise", {"Vector": cells.outputs["Vector"]}, noise_dimensions="3D")
    return node.outputs["Color"] if dice.chance(0.4) else None, node.outputs["Value"]


def _print(graph, dice, vector):
    """A printed page: bars, blocks, discs and rows of glyph-like marks."""
    random = np.random.default_rng(dice.getrandbits(32))
    size = 192
    page = np.ones((size, size, 4), np.float32)
    page[...] = dice.colour()
    row, column = np.mgrid[:size, :size]
    inks = [dice.colour() for _ in range(4)]
    for _ in range(dice.randint(2, 12)):
        y, x = random.integers(0, size, 2)
        height, width = random.integers(6, 80, 2)
        if dice.chance(0.4):
            page[(row - y) ** 2 + (column - x) ** 2 < (height / 2) ** 2] = dice.choice(inks)
        else:
            page[y:y + height, x:x + width] = dice.choice(inks)
    for _ in range(dice.randint(0, 5)):
        y, x = random.integers(0, size - 20, 2)
        lines, length, pitch = random.integers(1, 9), random.integers(20, 140), random.integers(5, 12)
        ink = dice.choice(inks)
        for line in range(lines):
            marks = random.random((pitch - 2, length)) < 0.55
            area = page[y + line * pitch:y + line * pitch + pitch - 2, x:x + length]
            area[marks[:area.shape[0], :area.shape[1]]] = ink
    image = bpy.data.images.new("print", size, size, float_buffer=True)
    image.pixels.foreach_set(page.ravel())
    image.pack()
    scaled = graph.add("VectorMath", {0: vector, "Scale": dice.uniform(0.2, 0.6)}, operation="SCALE")
    node = graph.add("TexImage", {"Vector": scaled.outputs["Vector"]}, image=image, projection="BOX",
                     interpolation=dice.choice(("Linear", "Closest", "Cubic")))
    grey = graph.add("RGBToBW", {"Color": node.outputs["Color"]})
    return node.outputs["Color"], grey.outputs["Val"]


PATTERNS = {_checker: 1.2, _brick: 1.2, _noise: 2, _voronoi: 1.5, _wave: 1.5, _magic: 1, _gradient: 0.6, _musgrave: 1.2,
            _grid_of_noise: 1, _print: 1.5}


def _contrast(graph, dice, value):
    """Noise hardly reaches 0 or 1: spread it."""
    spread = dice.uniform(0.05, 0.3)
    return graph.add("MapRange", {"Value": value, "From Min": 0.5 - spread, "From Max": 0.5 + spread}).outputs["Result"]


def _coloured(graph, dice, value):
    """A value through a ramp of two to six of the palette's colours."""
    ramp = graph.add("ValToRGB", {"Fac": value})
    stops = ramp.color_ramp
    stops.interpolation = dice.pick({"LINEAR": 3, "CONSTANT": 2, "EASE": 1})
    for _ in range(dice.choice((0, 0, 1, 2, 4))):
        stops.elements.new(dice.random())
    stops.elements[0].position = dice.uniform(0.0, 0.3)
    stops.elements[-1].position = dice.uniform(0.5, 1.0)
    for stop in stops.elements:
        stop.color = dice.colour()
    return ramp.outputs["Color"]


def features_of(dice):
    """Periods over an object: mostly a few, at times finer than a pixel."""
    return dice.log_uniform(1.5, 12.0) if dice.chance(0.55) else dice.log_uniform(8.0, 90.0)


def texture(graph, dice, extent, features=None):
    """(colour socket, value socket) of a random pattern."""
    vector = graph.coordinates(dice, features or features_of(dice), extent)
    if dice.chance(0.2):  # wobbly lines
        wobble = graph.add("TexNoise", {"Vector": vector, "Scale": dice.log_uniform(0.5, 4.0)})
        vector = graph.add("MixRGB", {"Fac": dice.uniform(0.02, 0.5), "Color1": vector, "Color2": wobble.outputs["Color"]},
                           blend_type="ADD").outputs["Color"]
    colour, value = dice.pick(PATTERNS)(graph, dice, vector)
    if colour is None:
        colour = _coloured(graph, dice, value)
    if dice.chance(0.3):  # dirt, or a second pattern
        other = dice.pick(PATTERNS)(graph, dice, graph.coordinates(dice, features_of(dice), extent))
        other_colour = other[0] or _coloured(graph, dice, other[1])
        colour = graph.add("MixRGB", {"Fac": dice.uniform(0.2, 0.9), "Color1": colour, "Color2": other_colour},
                           blend_type=dice.choice(("MIX", "MULTIPLY", "OVERLAY"))).outputs["Color"]
    return colour, value


def ranged(graph, dice, value, low, high):
    """The value mapped onto a random part of [low, high]."""
    a, b = dice.uniform(low, high), dice.uniform(low, high)
    return graph.add("MapRange", {"Value": value, "To Min": a, "To Max": b}).outputs["Result"]
