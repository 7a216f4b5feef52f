"""Cycles shots lit through a window and by candles. Units are metres; the camera looks along +y unless stated."""

import math

import bpy
import numpy as np

from benches.quality.cycles import kit


def _line(start, step):
    """A path of constant velocity: `step` per frame."""
    return lambda frame: tuple(s + d * (frame - 1) for s, d in zip(start, step))


# ---- window

def _planks(name):
    shader = kit.Shader(name)
    where = shader.coordinates(rotation=(0, 0, math.pi / 2))
    brick = shader.node("TexBrick", {"Vector": where, "Scale": 1.0, "Mortar Size": 0.004, "Brick Width": 1.4, "Row Height": 0.14,
                                     "Color1": (0.30, 0.14, 0.06), "Color2": (0.42, 0.23, 0.11), "Mortar": (0.03, 0.015, 0.01)})
    grain = shader.noise(3.0, 3.0, shader.coordinates(scale=(14, 1, 1)))
    colour = shader.node("MixRGB", {"Fac": 0.55, "Color1": brick.outputs["Color"], "Color2": shader.ramp(
        grain, (0.35, (0.35, 0.25, 0.2)), (0.65, (1, 1, 1)))}, blend_type="MULTIPLY").outputs[0]
    roughness = shader.math("MULTIPLY_ADD", grain, 0.3, 0.15)
    return shader.surface(shader.principled(Base_Color=colour, Roughness=roughness,
                                            Normal=shader.bump(brick.outputs["Fac"], -0.004)))


def _woven(name, first, second, stripes=9.0):
    """A striped rug, whose threads are bumps."""
    shader = kit.Shader(name)
    where = shader.coordinates("Generated")
    bands = shader("TexWave", {"Vector": where, "Scale": stripes, "Distortion": 3.0, "Detail": 2.0})
    threads = shader("TexChecker", {"Vector": where, "Scale": 90.0})
    colour = shader.mix(shader.ramp(bands, (0.45, (0, 0, 0)), (0.55, (1, 1, 1))), first, second)
    return shader.surface(shader.principled(Base_Color=colour, Roughness=0.9, Sheen=0.5, Normal=shader.bump(threads, 0.004)))


def _painting(name):
    shader = kit.Shader(name)
    cells = shader.node("TexVoronoi", {"Vector": shader.coordinates("Generated"), "Scale": 5.0})
    return shader.surface(shader.principled(Base_Color=cells.outputs["Color"], Roughness=0.3))


def _room():
    wall = kit.plain("wall", (0.72, 0.68, 0.60), 0.8)
    kit.box("floor", (5, 6, 0.1), (0, 0, -0.05), _planks("planks"), bevel=0)
    kit.box("ceiling", (5.4, 6.4, 0.1), (0, 0, 2.65), kit.plain("ceiling", (0.8, 0.8, 0.78)), bevel=0)
    for name, size, where in (("back", (5.2, 0.1, 2.6), (0, 3.05, 1.3)), ("front", (5.2, 0.1, 2.6), (0, -3.05, 1.3)),
                              ("right", (0.1, 6, 2.6), (2.55, 0, 1.3)), ("below", (0.2, 6, 0.7), (-2.6, 0, 0.35)),
                              ("above", (0.2, 6, 0.4), (-2.6, 0, 2.4)), ("near", (0.2, 3.1, 1.5), (-2.6, -1.45, 1.45)),
                              ("far", (0.2, 1.2, 1.5), (-2.6, 2.4, 1.45))):
        kit.box(name, size, where, wall, bevel=0)
    frame = kit.plain("frame", (0.85, 0.85, 0.82), 0.3)
    for y in (0.1, 0.95, 1.8):
        kit.box("mullion", (0.08, 0.06, 1.5), (-2.6, y, 1.45), frame)
    for z in (0.72, 1.5, 2.2):
        kit.box("transom", (0.1, 1.75, 0.05), (-2.6, 0.95, z), frame)
    kit.box("skirting", (5, 0.03, 0.12), (0, 2.985, 0.06), frame)
    kit.box("sill", (0.3, 1.9, 0.04), (-2.42, 0.95, 0.7), frame)


def _curtain(y, phase):
    cloth = kit.Shader("curtain")
    linen = cloth("AddShader", {0: cloth("BsdfDiffuse", {"Color": (0.45, 0.36, 0.26)}),
                                1: cloth("BsdfTranslucent", {"Color": (0.35, 0.28, 0.2)})})

    def folds(u, v, sway=0.0):
        depth = 0.05 * np.sin(2 * math.pi * 5 * u + phase + 2.0 * sway * (1 - v)) * (0.5 + 0.5 * (1 - v)) + 0.12 * sway * (1 - v) ** 2
        return depth, 0.5 * (u - 0.5), 2.25 * v

    thing = kit.sheet("curtain", folds, 40, 80, cloth.surface(linen), (-2.38, y, 0.1))
    v, u = np.mgrid[0:1:40j, 0:1:80j]
    kit.swayed(thing, np.stack(folds(u, v, 1.0), axis=-1), lambda f: math.sin(0.35 * f + phase))


def _furniture():
    oak, dark = kit.wood("oak"), kit.wood("walnut", (0.03, 0.015, 0.01), (0.12, 0.06, 0.03))
    kit.box("table", (1.5, 0.85, 0.05), (0.2, 0.9, 0.74), oak, bevel=0.015)
    for x in (-0.45, 0.85):
        for y in (0.55, 1.25):
            kit.box("leg", (0.06, 0.06, 0.72), (x, y, 0.36), oak)
    for x, turn in ((-0.2, 0.2), (0.6, -0.15)):
        seat = kit.box("seat", (0.42, 0.42, 0.04), (x, 0.25, 0.45), dark, (0, 0, turn))
        for dx, dy, height in ((-0.18, 0.18, 0.45), (0.18, 0.18, 0.45), (-0.18, -0.18, 0.95), (0.18, -0.18, 0.95)):
            kit.box("chair leg", (0.04, 0.04, height), (dx, dy, height / 2 - 0.45), dark).parent = seat
        for z in (0.3, 0.42):
            kit.box("back", (0.36, 0.025, 0.08), (0, -0.18, z), dark).parent = seat
    sofa = _woven("sofa", (0.05, 0.13, 0.20), (0.06, 0.16, 0.24), 30.0)
    for size, where in (((1.0, 2.0, 0.4), (1.95, 1.5, 0.25)), ((0.25, 2.0, 0.85), (2.35, 1.5, 0.45)), ((1.0, 0.22, 0.6), (1.95, 2.5, 0.35)),
                        ((1.0, 0.22, 0.6), (1.95, 0.5, 0.35))):
        kit.box("sofa", size, where, sofa, bevel=0.07)
    kit.box("cushion", (0.18, 0.5, 0.5), (2.1, 1.9, 0.68), _woven("cushion", (0.6, 0.2, 0.04), (0.7, 0.5, 0.1)), (0, -0.3, 0.2), 0.08)
    kit.box("rug", (2.6, 1.9, 0.015), (0.2, 0.7, 0.01), _woven("rug", (0.45, 0.06, 0.05), (0.55, 0.45, 0.3)))
    kit.box("shelves", (1.3, 0.3, 0.04), (-1.4, 2.85, 0.9), dark)
    kit.box("shelves", (1.3, 0.3, 0.04), (-1.4, 2.85, 0.45), dark)
    random = np.random.default_rng(3)
    for z in (0.47, 0.92):
        x = -2.0
        while x < -0.85:
            width, height = random.uniform(0.025, 0.06), random.uniform(0.2, 0.32)
            kit.box("book", (width, 0.2, height), (x, 2.84, z + height / 2), kit.plain("book", random.uniform(0.02, 0.5, 3), 0.4), bevel=0.004)
            x += width + 0.004
    kit.box("picture frame", (1.2, 0.05, 0.8), (0.6, 2.98, 1.65), dark)
    kit.box("picture", (1.08, 0.06, 0.68), (0.6, 2.97, 1.65), _painting("painting"))


def _on_the_table():
    kit.lathe("vase", kit.rounded([(0.02, 0), (0.07, 0.02), (0.09, 0.12), (0.035, 0.24), (0.05, 0.3)]),
              kit.plain("glaze", (0.02, 0.15, 0.3), 0.08, Clearcoat=1.0), (0.0, 1.05, 0.765))
    kit.lathe("bowl", kit.rounded([(0.01, 0), (0.08, 0.01), (0.16, 0.09), (0.155, 0.09), (0.07, 0.02), (0.001, 0.015)]),
              kit.plain("bowl", (0.75, 0.72, 0.65), 0.25), (0.55, 0.85, 0.765))
    for x, y, colour in ((0.5, 0.83, (0.6, 0.05, 0.02)), (0.6, 0.83, (0.7, 0.35, 0.02)), (0.55, 0.92, (0.25, 0.45, 0.03))):
        kit.ball("fruit", 0.05, (x, y, 0.835), kit.plain("fruit", colour, 0.3), 12)
    orange = kit.ball("rolling", 0.055, (0, 0, 0), kit.plain("orange", (0.8, 0.28, 0.02), 0.4), 16)
    kit.moved(orange, location=_line((-0.4, 0.7, 0.82), (0.025, 0.004, 0)), rotation_euler=lambda f: (0, 0.45 * f, 0))
    kit.lathe("shade", [(0.24, 0), (0.08, 0.18), (0.07, 0.18), (0.23, 0.0)], kit.plain("copper", (0.75, 0.32, 0.18), 0.2, Metallic=1.0))
    lamp = bpy.context.scene.objects["shade"]
    kit.moved(lamp, location=lambda f: (0.2 + 0.08 * math.sin(0.3 * f), 0.9, 1.55), rotation_euler=lambda f: (0, -0.09 * math.sin(0.3 * f), 0))
    cord = kit.lathe("cord", [(0.006, 0.18), (0.006, 1.1)], kit.plain("cord", (0.02, 0.02, 0.02)), segments=6)
    cord.parent = lamp


def window():
    """An interior that sun and sky light through one window; curtains in the wind, a swinging lamp, a rolling orange."""
    _room()
    _curtain(-0.15, 0.0)
    _curtain(2.05, 1.3)
    _furniture()
    _on_the_table()
    kit.sky((0.75, 0.85, 1.0), (0.35, 0.55, 1.0), 4.5)
    kit.sun(33, -102, 18.0)
    portal = kit.area_light((-2.55, 0.95, 1.45), (0, 0.95, 1.45), (1.75, 1.5), 1.0)
    portal.data.cycles.is_portal = True
    kit.camera(_line((1.5, -2.7, 1.45), (-0.035, 0.02, 0.002)), _line((0.05, 1.4, 0.95), (-0.06, 0, 0)), lens_mm=24)


# ---- candles

FLAME = 90.0       # radiance that lights the scene
FLAME_SEEN = 10.0  # radiance that the camera sees: the edges of brighter flames would dominate the shot's error


def _flame(strength):
    """strength: a function of the frame."""
    shader = kit.Shader("flame")
    scale = shader.node("MapRange", {"Value": shader.node("LightPath").outputs["Is Camera Ray"], "To Min": 1.0, "To Max": FLAME_SEEN / FLAME})
    flicker = shader.node("Value")
    kit.moved(flicker.outputs[0], default_value=strength)
    return shader.surface(shader("Emission", {"Color": (1.0, 0.45, 0.12),
                                              "Strength": shader.math("MULTIPLY", flicker.outputs[0], scale.outputs[0])}))

def _stones():
    shader = kit.Shader("stones")
    brick = shader.node("TexBrick", {"Vector": shader.coordinates(rotation=(math.pi / 2, 0, 0)), "Scale": 3.0, "Mortar Size": 0.02,
                                     "Color1": (0.30, 0.27, 0.24), "Color2": (0.20, 0.19, 0.18), "Mortar": (0.08, 0.07, 0.06)})
    rough = shader.noise(12.0, 3.0)
    height = shader.math("SUBTRACT", rough, brick.outputs["Fac"])
    return shader.surface(shader.principled(Base_Color=brick.outputs["Color"], Roughness=0.85, Normal=shader.bump(height, 0.03)))


def _candle(x, y, height, phase, wax):
    radius = 0.035
    kit.lathe("wax", [(radius, 0), (radius, height - 0.006), (radius * 0.9, height), (radius * 0.6, height - 0.008), (0.001, height - 0.01)],
              wax, (x, y, 0), 24)
    light = _flame(lambda f: FLAME * (1.0 + 0.15 * math.sin(0.7 * f + phase) + 0.1 * math.sin(0.31 * f + 2 * phase)))
    flame = kit.lathe("flame", kit.rounded([(0.003, 0), (0.017, 0.022), (0.012, 0.052), (0.001, 0.09)], 3), light, (x, y, height + 0.008), 10)
    kit.moved(flame, rotation_euler=lambda f: (0.15 * math.sin(0.4 * f + phase), 0.2 * math.sin(0.5 * f + 3 * phase), 0),
              scale=lambda f: (1, 1, 1.0 + 0.15 * math.sin(0.7 * f + phase)))


def candles():
    """Candles in fog, with a brass goblet, books and a spinning ring; the only other light is a faint moon."""
    kit.box("table", (3, 1.6, 0.06), (0, 0.3, -0.03), kit.wood("table", (0.04, 0.02, 0.012), (0.16, 0.08, 0.04), 1.2))
    kit.box("wall", (6, 0.1, 3), (0, 1.6, 0.8), _stones(), bevel=0)
    wax = kit.plain("wax", (0.80, 0.68, 0.48), 0.4)
    for i, (x, y, height) in enumerate([(-0.55, 0.25, 0.30), (-0.42, 0.05, 0.16), (-0.28, 0.4, 0.38), (0.05, 0.62, 0.24), (0.3, 0.42, 0.34),
                                        (0.42, 0.1, 0.12), (0.62, 0.35, 0.22)]):
        _candle(x, y, height, 1.7 * i, wax)
    brass = kit.plain("brass", (0.78, 0.53, 0.20), 0.18, Metallic=1.0)
    kit.lathe("goblet", kit.rounded([(0.08, 0), (0.075, 0.01), (0.014, 0.03), (0.014, 0.12), (0.07, 0.17), (0.085, 0.27), (0.08, 0.27),
                                     (0.06, 0.18), (0.001, 0.15)]), brass, (0.12, 0.12, 0))
    for i, (colour, turn) in enumerate((((0.25, 0.03, 0.02), 0.2), ((0.03, 0.1, 0.05), -0.1), ((0.06, 0.05, 0.2), 0.35))):
        kit.box("book", (0.3, 0.22, 0.045), (-0.1, -0.08 + 0.01 * i, 0.0235 + 0.047 * i), kit.plain("cover", colour, 0.45), (0, 0, turn), 0.006)
    ring = kit.lathe("ring", [(0.05 + 0.006 * math.cos(a), 0.006 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 12)], brass, segments=40)
    kit.moved(ring, location=_line((0.25, -0.1, 0.055), (0.004, -0.002, 0)), rotation_euler=lambda f: (math.pi / 2, 0, 0.22 * f))
    fog = kit.Shader("fog")
    kit.box("fog", (7, 5, 4), (0, -0.2, 1.2), fog.volume(fog("VolumeScatter", {"Color": (0.9, 0.92, 1.0), "Density": 0.3, "Anisotropy": 0.3})),
            bevel=0)
    kit.area_light((-2.2, -0.6, 2.4), (0, 0.8, 0.3), (0.8, 0.8), 40.0, (0.4, 0.6, 1.0))
    kit.sky((0, 0, 0), (0, 0, 0), 0.0)
    kit.camera(_line((0.22, -1.45, 0.5), (-0.012, 0.004, 0.001)), _line((0.1, 0.3, 0.24), (-0.011, 0, 0)), lens_mm=38, fstop=2.8,
               focus=(-0.1, 0.1, 0.2))
