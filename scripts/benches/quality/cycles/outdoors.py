"""Cycles shots under the sky: foliage, a car, a crowd."""

import math

import bpy
import numpy as np

from benches.quality.cycles import kit


# ---- foliage

def _leaf(name, dark, light, slender):
    """A translucent leaf with a midrib; the quad around it is transparent."""
    shader = kit.Shader(name)
    split = shader.node("SeparateXYZ", {0: shader.coordinates("UV")})
    along, across = split.outputs["X"], shader.math("ABSOLUTE", shader.math("SUBTRACT", split.outputs["Y"], 0.5))
    width = shader.math("MULTIPLY", shader.math("POWER", shader.math("SINE", shader.math("MULTIPLY", along, math.pi)), 0.8), slender)
    inside = shader.math("LESS_THAN", across, width)
    rib = shader.math("LESS_THAN", across, 0.02)
    colour = shader.mix(rib, shader.ramp(shader.noise(3.5, 1.0), (0.35, dark), (0.65, light)), light)
    leaf = shader("MixShader", {0: 0.45, 1: shader.principled(Base_Color=colour, Roughness=0.4),
                                2: shader("BsdfTranslucent", {"Color": shader.mix(0.5, colour, (0.35, 0.4, 0.02))})})
    return shader.surface(shader("MixShader", {0: inside, 1: shader("BsdfTransparent"), 2: leaf}))


def _frames_of(random, directions, tilt):
    """Two orthogonal unit vectors in the plane of each leaf, whose normal is its direction with a random tilt."""
    normal = directions + tilt * random.standard_normal(directions.shape)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first = np.cross(normal, random.standard_normal(directions.shape))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normal, first)


def _leaves(name, random, centres, directions, length_m, material, tilt=0.6, sway_m=0.03):
    """A mesh of quads, one a leaf, that drift together and flutter independently."""
    count = len(centres)
    first, second = _frames_of(random, directions, tilt)
    size = length_m * random.uniform(0.6, 1.2, (count, 1))
    corners = np.stack([centres + size * (a * first + 0.45 * b * second) for a, b in ((0, -1), (1, -1), (1, 1), (0, 1))], axis=1)
    uvs = np.tile([(0, 0), (1, 0), (1, 1), (0, 1)], (count, 1))
    thing = kit.shape(name, corners.reshape(-1, 3), np.arange(4 * count).reshape(-1, 4), material, uvs=uvs)
    flutter = sway_m * random.standard_normal((count, 1, 3)) * np.array([0, 1, 1, 0])[None, :, None]
    drift = sway_m * np.stack([np.sin(2 * centres[:, 0] + centres[:, 2]), 0.3 * np.cos(3 * centres[:, 1]), 0 * centres[:, 2]], axis=-1)[:, None]
    kit.swayed(thing, (corners + flutter + drift).reshape(-1, 3), lambda f: math.sin(0.45 * f))
    return thing


def _bush(random, centre, radii, count, material, length_m, sway_m=0.03):
    directions = random.standard_normal((count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    lumps = 1.0 + 0.18 * np.sin(5 * directions[:, :1] + 1) * np.sin(4 * directions[:, 1:2]) + 0.1 * np.sin(9 * directions[:, 2:])
    centres = np.array(centre) + np.array(radii) * directions * lumps * random.uniform(0.75, 1.0, (count, 1))
    return _leaves("bush", random, centres[centres[:, 2] > 0.02], directions[centres[:, 2] > 0.02], length_m, material, sway_m=sway_m)


def _grass(random, count, spread, material):
    x, y = random.uniform(-spread[0], spread[0], count), random.uniform(spread[1], spread[2], count)
    height, turn = random.uniform(0.08, 0.24, count), random.uniform(0, 2 * math.pi, count)
    lean = 0.5 * height * random.uniform(-1, 1, count)
    side = 0.006 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=-1)
    root = np.stack([x, y, 0 * x], axis=-1)
    middle = root + np.stack([0.3 * lean, 0.2 * lean, 0.6 * height], axis=-1)
    tip = root + np.stack([lean, 0.6 * lean, height], axis=-1)
    blades = np.stack([root - side, root + side, middle + 0.7 * side, tip, middle - 0.7 * side], axis=1)
    thing = kit.shape("grass", blades.reshape(-1, 3), np.arange(5 * count).reshape(-1, 5), material)
    wind = np.zeros_like(blades)
    wind[:, 3, 0] = 0.3 * height * (1 + np.sin(3 * x + y))
    wind[:, (2, 4), 0] = 0.1 * (height * (1 + np.sin(3 * x + y)))[:, None]
    kit.swayed(thing, (blades + wind).reshape(-1, 3), lambda f: math.sin(0.4 * f))


def _blade_material():
    shader = kit.Shader("grass")
    colour = shader.ramp(shader.noise(1.5, 2.0), (0.35, (0.05, 0.12, 0.015)), (0.65, (0.22, 0.26, 0.04)))
    return shader.surface(shader("MixShader", {0: 0.4, 1: shader("BsdfDiffuse", {"Color": colour}), 2: shader("BsdfTranslucent", {"Color": colour})}))


def foliage():
    """A flowering bush and a sapling in high grass before a fence and trees, in the wind; leaves are quads with transparency."""
    random = np.random.default_rng(11)
    earth = kit.Shader("earth")
    soil = earth.ramp(earth.noise(2.0, 3.0), (0.4, (0.05, 0.06, 0.02)), (0.7, (0.14, 0.12, 0.05)))
    kit.sheet("ground", lambda u, v: (30 * (u - 0.5), -3 + 30 * v, 0 * u), 2, 2, earth.surface(earth.principled(Base_Color=soil, Roughness=0.95)))
    green = _leaf("leaf", (0.02, 0.09, 0.015), (0.13, 0.24, 0.03), 0.42)
    _bush(random, (-0.55, 0.9, 0.55), (0.75, 0.65, 0.6), 1500, green, 0.15)
    _bush(random, (-0.55, 0.9, 0.55), (0.8, 0.7, 0.66), 90, _leaf("petal", (0.65, 0.05, 0.12), (0.8, 0.25, 0.4), 0.48), 0.12)
    bark = kit.wood("bark", (0.05, 0.03, 0.02), (0.15, 0.1, 0.07), 2.0, (8, 8, 1), 0.9)
    kit.lathe("trunk", [(0.06, 0), (0.045, 0.5), (0.03, 1.6)], bark, (1.15, 1.7, 0), 14)
    _bush(random, (1.15, 1.7, 1.75), (0.7, 0.7, 0.55), 900, _leaf("yellow leaf", (0.16, 0.16, 0.01), (0.5, 0.33, 0.02), 0.34), 0.17, 0.05)
    _bush(random, (-4.0, 8.0, 1.7), (3.5, 1.0, 1.9), 1100, green, 0.6, 0.05)
    _bush(random, (4.5, 9.5, 1.9), (4.0, 1.0, 2.2), 1200, green, 0.65, 0.05)
    _grass(random, 5200, (3.0, -1.4, 3.6), _blade_material())
    post = kit.wood("post", (0.13, 0.11, 0.09), (0.34, 0.3, 0.26), 1.0, (8, 8, 1), 0.8)
    rail = kit.wood("rail", (0.13, 0.11, 0.09), (0.34, 0.3, 0.26), 1.0, (1, 8, 8), 0.8)
    for x in np.arange(-4.2, 4.3, 1.2):
        kit.box("post", (0.11, 0.11, 1.0), (x, 3.4, 0.5), post)
    for z in (0.45, 0.8):
        kit.box("rail", (9, 0.04, 0.12), (0, 3.33, z), rail)
    butterfly = _leaves("butterfly", random, np.zeros((2, 3)), np.array([(0, 0.3, 1.0), (0, -0.3, 1.0)]),
                        0.12, _leaf("wing", (0.8, 0.35, 0.02), (0.9, 0.6, 0.1), 0.48), 0.1, 0.03)
    kit.moved(butterfly, location=lambda f: (0.1 + 0.02 * f, 0.2, 0.75 + 0.05 * math.sin(0.5 * f)), rotation_euler=lambda f: (0, 0, 0.1 * f))
    kit.sky((0.80, 0.88, 1.0), (0.22, 0.42, 0.85), 0.75)
    kit.sun(38, -60, 3.2)
    kit.camera(lambda f: (0.34 - 0.012 * f, -2.5 + 0.005 * f, 0.85), lambda f: (0.34 - 0.03 * f, 1.5, 0.78), lens_mm=30)


# ---- car

def _loft(name, stations, material, exponent=4.0, steps=8, points=48, parent=None):
    """A body along x with sections that are rounded boxes. stations: (x, half width, bottom, top)."""
    s = np.array([stations[0], *stations, stations[-1]], float)
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    smooth = np.concatenate([0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
                             for a, b, c, d in zip(s, s[1:], s[2:], s[3:])] + [s[-1:]])
    angle = np.linspace(0, 2 * math.pi, points, endpoint=False)
    cos, sin = (np.sign(w) * np.abs(w) ** (2 / exponent) for w in (np.cos(angle), np.sin(angle)))
    rings = [np.stack([np.full(points, x), half * cos, (low + high) / 2 + (high - low) / 2 * sin], axis=-1) for x, half, low, high in smooth]
    rings = [rings[0].mean(axis=0) + 1e-3 * (rings[0] - rings[0].mean(axis=0)), *rings,
             rings[-1].mean(axis=0) + 1e-3 * (rings[-1] - rings[-1].mean(axis=0))]
    thing = kit.shape(name, np.reshape(rings, (-1, 3)), kit.grid_faces(len(rings), points, True), material, True)
    thing.parent = parent
    return thing


def _paint(shader):
    flakes = shader.node("TexVoronoi", {"Vector": shader.coordinates(), "Scale": 60.0}).outputs["Color"]
    return shader.principled(Base_Color=shader.mix(0.06, (0.42, 0.015, 0.012), flakes), Metallic=0.55, Roughness=0.32, Clearcoat=1.0,
                             Clearcoat_Roughness=0.02)


def _cabin_material():
    """Paint, with windows below the roof and between the pillars."""
    shader = kit.Shader("cabin")
    split = shader.node("SeparateXYZ", {0: shader.coordinates()})
    below_roof = shader.math("LESS_THAN", split.outputs["Z"], 1.27)
    pillars = [shader.math("GREATER_THAN", shader.math("ABSOLUTE", shader.math("SUBTRACT", split.outputs["X"], x)), 0.045) for x in (0.12, -0.78)]
    tinted = shader.math("MULTIPLY", below_roof, shader.math("MULTIPLY", *pillars))
    pane = shader.principled(Base_Color=(0.01, 0.014, 0.016), Roughness=0.02, Specular=0.8)
    return shader.surface(shader("MixShader", {0: tinted, 1: _paint(shader), 2: pane}))


def _wheel(x, y, parent):
    hub = kit.place("hub", None, (x, y, 0.33))
    hub.parent = parent
    tyre = [(0.22, -0.1), (0.31, -0.1), (0.33, -0.07), (0.33, 0.07), (0.31, 0.1), (0.22, 0.1), (0.2, 0.05)]
    metal = kit.plain("rim", (0.75, 0.76, 0.78), 0.2, Metallic=1.0)
    parts = [kit.lathe("tyre", tyre, kit.plain("rubber", (0.015, 0.015, 0.015), 0.6), smooth=False),
             kit.lathe("rim", [(0.21, -0.06), (0.225, 0.09), (0.205, 0.09), (0.195, -0.02), (0.001, -0.03)], metal, smooth=False),
             kit.lathe("nut", [(0.06, -0.02), (0.05, 0.08), (0.001, 0.085)], metal, segments=16)]
    parts += [kit.box("spoke", (0.19, 0.045, 0.03), (0.115 * math.cos(a), 0.115 * math.sin(a), 0.06), metal, (0, 0, a), 0.008)
              for a in np.arange(5) * 2 * math.pi / 5]
    for part in parts:
        part.parent = hub
    outwards = -1 if y < 0 else 1
    kit.moved(hub, rotation_euler=lambda f: (-outwards * math.pi / 2, 0.055 / 0.33 * f, 0))


def car():
    """A red car with clearcoat drives over a polished floor under strip lights at dusk; motion blur."""
    body = kit.place("body", None)
    kit.moved(body, location=lambda f: (-0.55 + 0.055 * f, 0, 0))
    paint = kit.Shader("paint")
    painted = paint.surface(_paint(paint))
    _loft("lower", [(-2.1, 0.62, 0.45, 0.75), (-2.0, 0.78, 0.32, 0.92), (-1.5, 0.88, 0.24, 0.97), (-0.6, 0.86, 0.2, 0.90), (0.5, 0.86, 0.2, 0.9),
                    (1.2, 0.88, 0.22, 0.86), (1.8, 0.82, 0.24, 0.74), (2.1, 0.66, 0.3, 0.58)], painted, parent=body)
    _loft("cabin", [(-1.75, 0.6, 0.8, 0.93), (-1.3, 0.68, 0.8, 1.16), (-0.75, 0.67, 0.8, 1.34), (-0.1, 0.67, 0.8, 1.35), (0.45, 0.68, 0.8, 1.12),
                    (0.95, 0.66, 0.78, 0.86)], _cabin_material(), parent=body)
    black = kit.plain("trim", (0.01, 0.01, 0.01), 0.4)
    for x in (-1.3, 1.3):
        for y in (-0.84, 0.84):
            arch = kit.lathe("arch", [(0.39, -0.07), (0.40, 0.055), (0.36, 0.06), (0.34, 0.045), (0.001, 0.045)], black, (x, y, 0.36))
            arch.rotation_euler = (math.pi / 2 if y < 0 else -math.pi / 2, 0, 0)
            arch.parent = body
            _wheel(x, math.copysign(0.82, y), body)
    lamp, tail = kit.emitter("headlight", (1.0, 0.93, 0.8), 9.0), kit.emitter("tail light", (1.0, 0.03, 0.02), 4.0)
    for y in (-0.56, 0.56):
        kit.ball("headlight", 0.12, (1.98, y, 0.60), lamp, 12, (1.0, 1.3, 0.6)).parent = body
        kit.ball("tail light", 0.1, (-2.05, y, 0.75), tail, 12, (0.5, 1.5, 0.5)).parent = body
    kit.box("sill", (2.0, 1.66, 0.1), (0, 0, 0.24), black, bevel=0.03).parent = body
    kit.box("grille", (0.1, 0.9, 0.12), (2.08, 0, 0.4), black, bevel=0.03).parent = body
    for y in (-0.87, 0.87):
        kit.ball("mirror", 0.09, (0.55, y, 0.98), painted, 12, (0.7, 1.0, 0.65)).parent = body
    floor = kit.Shader("floor")
    tiles = floor.node("TexBrick", {"Vector": floor.coordinates(), "Scale": 1.0, "Mortar Size": 0.012, "Brick Width": 1.2, "Row Height": 1.2,
                                    "Color1": (0.10, 0.10, 0.11), "Color2": (0.13, 0.13, 0.135), "Mortar": (0.03, 0.03, 0.03)}, offset=0.0)
    stains = floor.noise(1.3, 3.0)
    kit.sheet("floor", lambda u, v: (60 * (u - 0.5), -10 + 50 * v, 0 * u), 2, 2, floor.surface(floor.principled(
        Base_Color=tiles.outputs["Color"], Roughness=floor.math("MULTIPLY_ADD", stains, 0.3, 0.0), Specular=0.7,
        Normal=floor.bump(tiles.outputs["Fac"], -0.004))))
    pillar = kit.plain("pillar", (0.45, 0.44, 0.42), 0.8)
    for x in np.arange(-9, 10, 3.0):
        kit.box("pillar", (0.5, 0.5, 5), (x, 4.5, 2.5), pillar)
    kit.box("roof", (24, 1.2, 0.5), (0, 4.5, 5.1), pillar)
    for x in (-3.0, 0.0, 3.0):
        kit.area_light((x, -0.5, 4.2), (x, 0.1, 0), (0.35, 5.0), 130.0, (1.0, 0.95, 0.88))
    kit.sky((0.95, 0.55, 0.35), (0.10, 0.18, 0.40), 0.35)
    bpy.context.scene.render.use_motion_blur = True
    bpy.context.scene.render.motion_blur_shutter = 0.5
    kit.camera(kit.orbit((0.0, 0.0), 6.4, 1.25, -52, -0.22), lambda f: (0.0 + 0.02 * f, 0, 0.6), lens_mm=42)


# ---- crowd

def _mesh_of(thing):
    """The object's mesh, for other objects to share; the object is removed."""
    mesh = thing.data
    bpy.data.objects.remove(thing)
    return mesh


def _bodies():
    body = kit.rounded([(0.05, 0.0), (0.09, 0.02), (0.10, 0.35), (0.17, 0.75), (0.19, 1.2), (0.15, 1.38), (0.06, 1.43), (0.06, 1.5)], 4)
    robe = kit.rounded([(0.30, 0.0), (0.29, 0.02), (0.20, 0.7), (0.18, 1.15), (0.14, 1.36), (0.05, 1.43), (0.05, 1.5)], 4)
    grey = kit.plain("grey", (0.5, 0.5, 0.5))
    return [_mesh_of(kit.lathe("figure", profile, grey, segments=20)) for profile in (body, robe)]


def _cloth_of(random, i):
    shader = kit.Shader("clothes")
    hue, other = (random.uniform(0.02, 0.4) * (1.0 + random.uniform(-0.6, 0.6, 3)) for _ in range(2))
    kind = ("TexWave", "TexChecker", "TexVoronoi")[i % 3]
    pattern = shader(kind, {"Vector": shader.coordinates(), "Scale": (2.5, 8.0, 7.0)[i % 3]})
    return shader.surface(shader.principled(Base_Color=shader.mix(pattern, hue, other), Roughness=0.8, Sheen=0.3))


def crowd():
    """Three hundred figures walk on a paved square past stalls, seen by a camera that flies over; depth of field."""
    random = np.random.default_rng(5)
    paving = kit.Shader("paving")
    stones = paving.node("TexBrick", {"Vector": paving.coordinates(), "Scale": 1.6, "Mortar Size": 0.015, "Brick Width": 0.8, "Row Height": 0.4,
                                      "Color1": (0.36, 0.33, 0.29), "Color2": (0.24, 0.23, 0.22), "Mortar": (0.08, 0.08, 0.07)})
    kit.sheet("square", lambda u, v: (60 * (u - 0.5), -10 + 60 * v, 0 * u), 2, 2, paving.surface(paving.principled(
        Base_Color=stones.outputs["Color"], Roughness=0.6, Normal=paving.bump(stones.outputs["Fac"], -0.01))))
    wall = kit.Shader("wall")
    bricks = wall.node("TexBrick", {"Vector": wall.coordinates(rotation=(math.pi / 2, 0, 0)), "Scale": 0.5, "Mortar Size": 0.22, "Brick Width": 1.1,
                                    "Row Height": 1.5, "Color1": (0.04, 0.06, 0.08), "Color2": (0.10, 0.12, 0.15), "Mortar": (0.55, 0.42, 0.30)},
                       offset=0.0)
    facade = wall.surface(wall.principled(Base_Color=bricks.outputs["Color"], Roughness=0.5))
    for x, height in ((-14, 9), (-5, 12), (4, 8), (13, 11)):
        kit.box("house", (8.6, 4, height), (x, 22, height / 2), facade, bevel=0)
    grey = kit.plain("grey", (0.5, 0.5, 0.5))  # each object replaces it by its own material
    bodies = _bodies()
    head, balloon = (_mesh_of(kit.ball(name, radius, (0, 0, 0), grey, rows)) for name, radius, rows in (("head", 0.12, 10), ("balloon", 0.2, 12)))
    hat = _mesh_of(kit.lathe("hat", [(0.24, 0.02), (0.22, 0.03), (0.12, 0.05), (0.11, 0.18), (0.001, 0.19)], grey, segments=20))
    clothes = [_cloth_of(random, i) for i in range(18)]
    faces = [kit.plain("face", colour, 0.5) for colour in ((0.65, 0.42, 0.32), (0.25, 0.13, 0.08), (0.45, 0.28, 0.18))]
    balloons = [kit.plain("balloon", colour, 0.12, Clearcoat=1.0)
                for colour in ((0.7, 0.03, 0.03), (0.04, 0.2, 0.65), (0.8, 0.55, 0.03), (0.05, 0.4, 0.1))]

    def painted(data, material, scale, where, parent):
        thing = kit.place(data.name, data, where, scale=scale)
        thing.material_slots[0].link = "OBJECT"
        thing.material_slots[0].material = material
        thing.parent = parent
        return thing

    cells = [(x, y) for x in np.arange(-9, 9.1, 1.05) for y in np.arange(-2.5, 16.5, 1.05)]
    for index in random.permutation(len(cells))[:300]:
        x, y = np.array(cells[index]) + random.uniform(-0.25, 0.25, 2)
        walker = painted(bodies[index % 2], clothes[index % len(clothes)], (1, 1, 1), (0, 0, 0), None)
        speed, turn, phase = random.uniform(0.0, 0.05), random.uniform(0, 2 * math.pi), random.uniform(0, 6)
        walker.scale = (random.uniform(0.85, 1.25), random.uniform(0.85, 1.25), random.uniform(0.75, 1.1))
        kit.moved(walker, location=lambda f, x=x, y=y, s=speed, a=turn, p=phase: (x + s * f * math.cos(a), y + s * f * math.sin(a),
                                                                                 0.03 * abs(math.sin(0.5 * f + p))),
                  rotation_euler=lambda f, a=turn, p=phase: (0.04 * math.sin(0.5 * f + p), 0, a))
        painted(head, faces[index % 3], (1, 1, 1.15), (0, 0, 1.6), walker)
        if index % 3 == 0:
            painted(hat, clothes[(index * 7) % len(clothes)], (1, 1, 1), (0, 0, 1.66), walker)
        if index % 17 == 0:
            painted(balloon, balloons[index % 4], (1, 1, 1.2), (0.25, 0.1, 2.5), walker)
    for x, y, i in ((-6.5, 5.0, 0), (5.5, 8.0, 1), (-2.0, 13.5, 2), (7.0, 1.5, 3)):
        kit.box("stall", (1.8, 1.0, 0.9), (x, y, 0.45), kit.wood("stall"), bevel=0.03)
        kit.sheet("awning", lambda u, v: (2.3 * (u - 0.5), 1.6 * (v - 0.5), 2.5 - 0.6 * np.abs(v - 0.5) + 0.03 * np.sin(40 * u)), 12, 80,
                  _striped((0.65, 0.05, 0.04) if i % 2 else (0.04, 0.15, 0.4)), (x, y, 0))
    kit.sky((0.75, 0.82, 0.95), (0.25, 0.45, 0.85), 0.7)
    kit.sun(32, 50, 3.0)
    kit.camera(lambda f: (-1.2 + 0.06 * f, -6.0 + 0.05 * f, 4.4 + 0.01 * f), lambda f: (-0.2 + 0.07 * f, 4.5, 0.6), lens_mm=32, fstop=0.35,
               focus=(0, 2.5, 1))


def _striped(colour):
    shader = kit.Shader("awning")
    across = shader.node("SeparateXYZ", {0: shader.coordinates("UV")}).outputs["X"]
    stripe = shader.math("GREATER_THAN", shader.math("FRACT", shader.math("MULTIPLY", across, 8.0)), 0.5)
    return shader.surface(shader.principled(Base_Color=shader.mix(stripe, colour, (0.75, 0.73, 0.7)), Roughness=0.8))
