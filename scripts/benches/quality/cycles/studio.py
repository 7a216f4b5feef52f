"""Cycles shots under area lights: cloth and leather, skin, glass."""

import math

import bpy
import numpy as np

from benches.quality.cycles import kit


# ---- cloth

def _leather():
    shader = kit.Shader("leather")
    cells = shader.node("TexVoronoi", {"Vector": shader.coordinates(), "Scale": 90.0})
    worn = shader.noise(4.0, 2.0)
    colour = shader.ramp(worn, (0.35, (0.10, 0.028, 0.012)), (0.7, (0.24, 0.085, 0.035)))
    return shader.surface(shader.principled(Base_Color=colour, Roughness=shader.math("MULTIPLY_ADD", worn, 0.35, 0.15), Specular=0.6,
                                            Normal=shader.bump(cells.outputs["Distance"], -0.008, 0.5)))


def _weave(name, first, second, checks, threads, sheen=1.0, roughness=0.9):
    """A plaid with `checks` repeats, whose threads are bumps that go over and under each other."""
    shader = kit.Shader(name)
    where = shader.coordinates("UV")
    split = shader.node("SeparateXYZ", {0: where})
    lines = []
    for axis in "XY":
        phase = shader.math("FRACT", shader.math("MULTIPLY", split.outputs[axis], checks))
        lines.append(shader.ramp(phase, (0.0, (0, 0, 0)), (0.40, (0, 0, 0)), (0.42, (1, 1, 1)), (0.8, (1, 1, 1)), (0.82, (0.3, 0.3, 0.3))))
    both = shader.mix(0.5, *lines)
    waves = [shader.math("SINE", shader.math("MULTIPLY", split.outputs[axis], 2 * math.pi * threads)) for axis in "XY"]
    height = shader.math("MULTIPLY", *waves)
    return shader.surface(shader.principled(Base_Color=shader.mix(both, first, second), Roughness=roughness, Sheen=sheen, Sheen_Tint=0.7,
                                            Specular=0.2, Normal=shader.bump(height, 0.004, 0.7)))


def _velvet(name, colour, rim):
    shader = kit.Shader(name)
    nap = shader.noise(7.0, 2.0)
    base = shader("BsdfDiffuse", {"Color": shader.mix(nap, [0.6 * c for c in colour], colour)})
    return shader.surface(shader("AddShader", {0: base, 1: shader("BsdfVelvet", {"Color": rim, "Sigma": 0.35})}))


def _pillow(name, size, thickness, material, location, rotation):
    def side(sign):
        def surface(u, v):
            x, y = 2 * u - 1, 2 * v - 1
            fat = np.sqrt(np.maximum((1 - x**2) * (1 - y**2), 0))
            wrinkles = 0.03 * np.sin(9 * x + 7 * y) * (1 - fat) * fat
            pinch = 0.07
            return (size * x * (1 - pinch * (1 - y**2)), sign * size * y * (1 - pinch * (1 - x**2)), sign * thickness * (fat**0.8 + wrinkles))
        return surface
    for sign in (1, -1):
        kit.sheet(name, side(sign), 48, 48, material, location, rotation)


def _throw(material):
    """A blanket over the sofa's arm, which is a cylinder along y; it sways where it hangs."""
    radius, rows, columns = 0.205, 90, 80

    def surface(u, v, sway=0.0):
        along = 1.75 * v - 0.62                      # metres from the top of the arm, positive outside
        angle = np.clip(along / radius, -math.pi / 2, math.pi / 2)
        beyond = along - radius * angle              # hanging down
        folds = np.minimum(np.abs(beyond) / 0.3, 1.0)
        out = radius + 0.012 + folds * (0.03 + 0.03 * np.sin(2 * math.pi * 4.2 * u + 1.1 * np.sin(5 * beyond) + 0.8 * sway)) + \
            0.08 * sway * np.maximum(beyond, 0) ** 2
        return out * np.sin(angle), 0.75 * (u - 0.5) + 0.015 * np.sin(9 * v), out * np.cos(angle) - np.abs(beyond)

    thing = kit.sheet("throw", surface, rows, columns, material, (1.0, -0.12, 0.66))
    v, u = np.mgrid[0:1:rows * 1j, 0:1:columns * 1j]
    kit.swayed(thing, np.stack(surface(u, v, 1.0), axis=-1), lambda f: math.sin(0.4 * f))


def cloth():
    """A leather sofa with a tufted back, a plaid blanket over its arm, cushions of velvet and linen; a moving lamp."""
    leather = _leather()
    kit.box("floor", (8, 8, 0.1), (0, 0, -0.05), kit.wood("floor", (0.10, 0.05, 0.025), (0.2, 0.11, 0.06), 0.6), bevel=0)
    kit.sheet("curtain", lambda u, v: (5 * (u - 0.5), 0.9 + 0.09 * np.sin(90 * u + np.sin(4 * v)), 2.6 * v), 20, 400,
              _velvet("green velvet", (0.01, 0.05, 0.035), (0.05, 0.25, 0.18)), rotation=(0, 0, 0))

    def tufted(u, v):
        x, z = 2.0 * u - 1.0, 0.62 * v
        tuft = np.abs(np.sin(math.pi * (3.2 * x + 5 * z)) * np.sin(math.pi * (3.2 * x - 5 * z))) ** 0.4
        return x, -0.1 * tuft - 0.12 * np.sin(math.pi * np.minimum(1.0, 1.15 * v)), z

    kit.sheet("back", tufted, 120, 300, leather, (0, 0.35, 0.42))
    kit.box("back core", (2.2, 0.2, 0.7), (0, 0.5, 0.62), leather, bevel=0.09)
    for x in (-0.5, 0.5):
        kit.modified(kit.box("seat", (1.0, 0.85, 0.2), (x, -0.12, 0.36), leather, bevel=0), "SUBSURF", levels=4, render_levels=4).scale = \
            (1.12, 1.12, 1.25)
    kit.box("base", (2.1, 0.8, 0.2), (0, -0.05, 0.15), leather, bevel=0.05)
    for x in (-1.1, 1.0):
        arm = kit.lathe("arm", [(0.001, 0), (0.16, 0), (0.2, 0.03), (0.2, 0.95), (0.001, 1.0)], leather, (x, 0.38, 0.66), 48)
        arm.rotation_euler = (math.pi / 2, 0, 0)
        kit.box("arm side", (0.22, 0.9, 0.6), (x, -0.05, 0.32), leather, bevel=0.05)
    _throw(_weave("wool", (0.35, 0.04, 0.03), (0.55, 0.45, 0.3), 5.0, 90.0))
    _pillow("velvet", 0.25, 0.11, _velvet("blue velvet", (0.015, 0.03, 0.16), (0.15, 0.2, 0.5)), (-0.45, 0.08, 0.72), (1.15, 0.1, 0.15))
    _pillow("linen", 0.22, 0.1, _weave("linen", (0.55, 0.48, 0.36), (0.62, 0.57, 0.46), 60.0, 70.0), (0.05, 0.0, 0.69), (1.05, -0.12, -0.2))
    kit.sky((0.5, 0.6, 0.7), (0.5, 0.6, 0.7), 0.15)
    lamp = kit.area_light((0.5, -1.6, 2.3), (0, 0, 0.5), (0.7, 0.7), 75.0, (1.0, 0.86, 0.68))
    kit.moved(lamp, location=lambda f: (0.2 + 0.06 * f, -1.6, 2.3))
    kit.area_light((-2.4, -1.2, 1.6), (0, 0.2, 0.6), (0.6, 1.6), 45.0, (0.75, 0.85, 1.0))
    kit.camera(kit.orbit((0.2, 0.0), 2.1, 1.2, -80, 0.6), lambda f: (0.22 + 0.012 * (f - 8), 0.0, 0.58), lens_mm=38, fstop=4.0, focus=(0.5, -0.3, 0.65))


# ---- skin

def _head():
    """Vertices and faces of a head that looks along -y, about 2 high: an ellipsoid with bumps in given directions."""
    rows, columns = 160, 240
    elevation, azimuth = np.meshgrid(np.linspace(-89.9, 89.9, rows), np.linspace(-180, 180, columns, endpoint=False), indexing="ij")

    def bump(at_azimuth, at_elevation, width, height):
        return np.exp(-((azimuth - at_azimuth) / width) ** 2 - ((elevation - at_elevation) / height) ** 2)

    swell = 0.28 * bump(0, -9, 9, 8) + 0.15 * bump(0, 4, 6, 12)                                # nose
    swell += 0.10 * bump(0, -29, 15, 4) + 0.09 * bump(0, -37, 13, 4) - 0.05 * bump(0, -33, 16, 1.5)  # lips
    swell += 0.16 * bump(0, -56, 28, 11) + 0.05 * bump(0, 20, 45, 6)                           # chin, brow
    for side in (-1, 1):
        swell += -0.15 * bump(22 * side, 5, 11, 7) + 0.06 * bump(35 * side, -14, 16, 12)       # eye, cheek
        swell += 0.22 * bump(98 * side, -2, 6, 13) - 0.10 * bump(93 * side, -2, 3.5, 7) - 0.08 * bump(62 * side, -45, 22, 20)  # ear, jaw
    a, e = np.radians(azimuth), np.radians(elevation)
    radius = 1.0 + swell
    points = np.stack([0.78 * radius * np.cos(e) * np.sin(a), -0.92 * radius * np.cos(e) * np.cos(a), 1.08 * radius * np.sin(e)], axis=-1)
    return points.reshape(-1, 3), kit.grid_faces(rows, columns, True)


def _skin(name, base, scatter, amount=0.8):
    shader = kit.Shader(name)
    blotches = shader.noise(2.5, 2.0)
    pores = shader.node("TexVoronoi", {"Vector": shader.coordinates(), "Scale": 45.0}).outputs["Distance"]
    colour = shader.mix(blotches, base, [c * s for c, s in zip(base, (0.92, 0.62, 0.55))])
    return shader.surface(shader.principled(Base_Color=colour, Subsurface=amount, Subsurface_Radius=scatter, Subsurface_Color=colour,
                                            Roughness=shader.math("MULTIPLY_ADD", blotches, 0.25, 0.28), Specular=0.4,
                                            Normal=shader.bump(pores, 0.012, 0.35)))


def skin():
    """A turning bust with subsurface scattering, wet eyes, an earring and beads."""
    material = _skin("skin", (0.80, 0.50, 0.36), (0.22, 0.08, 0.045))
    head = kit.shape("head", *_head(), material, smooth=True)
    kit.moved(head, location=lambda f: (0, 0, 1.55), rotation_euler=lambda f: (0.05 * math.sin(0.2 * f), 0.0, -0.46 + 0.025 * f))
    kit.lathe("bust", kit.rounded([(1.2, -1.6), (1.75, -0.9), (1.7, -0.35), (1.15, -0.02), (0.55, 0.18), (0.44, 0.5), (0.46, 1.3)], 8), material,
              segments=96).scale = (1.15, 0.62, 1)
    eye = kit.plain("eye", (0.85, 0.83, 0.80), 0.04, Clearcoat=1.0)
    iris = kit.plain("iris", (0.03, 0.08, 0.06), 0.05, Clearcoat=1.0)
    for side in (-1, 1):
        kit.ball("eye", 0.155, (0.285 * side, -0.645, 0.08), eye, 16).parent = head
        kit.ball("iris", 0.07, (0.282 * side, -0.742, 0.08), iris, 12).parent = head
    gold = kit.plain("gold", (0.9, 0.6, 0.2), 0.15, Metallic=1.0)
    ring = kit.lathe("earring", [(0.13 + 0.02 * math.cos(a), 0.02 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 12)], gold, (0.93, 0.1, -0.55))
    ring.rotation_euler, ring.parent = (math.pi / 2, 0, 0.7), head
    beads = kit.plain("beads", (0.02, 0.12, 0.12), 0.1, Clearcoat=1.0)
    for i in range(34):
        a = 2 * math.pi * i / 34
        kit.ball("bead", 0.062, (1.1 * math.sin(a), -0.8 * math.cos(a), 0.06 - 0.16 * math.cos(a)), beads, 8)
    cap = kit.Shader("hair")
    strands = cap("TexWave", {"Vector": cap.coordinates("Object", rotation=(0, 0, 0.3)), "Scale": 5.0, "Distortion": 6.0, "Detail": 3.0})
    hair = cap.surface(cap.principled(Base_Color=cap.mix(strands, (0.012, 0.006, 0.004), (0.08, 0.035, 0.015)), Roughness=0.35,
                                      Normal=cap.bump(strands, 0.06)))
    kit.ball("hair", 1.0, (0, 0.24, 0.26), hair, 32, (0.86, 0.9, 0.98)).parent = head
    kit.ball("bun", 0.4, (0, 1.02, 0.85), hair, 20).parent = head
    kit.sheet("backdrop", lambda u, v: (16 * (u - 0.5), 5.0, 10 * v - 3), 2, 2, kit.plain("backdrop", (0.10, 0.13, 0.16), 0.9))
    kit.sky((0.3, 0.35, 0.45), (0.3, 0.35, 0.45), 0.12)
    key = kit.area_light((-3.2, -3.4, 3.6), (0, 0, 1.4), (1.6, 1.6), 420.0, (1.0, 0.9, 0.78))
    kit.moved(key, location=lambda f: (-3.2 + 0.09 * f, -3.4, 3.6))
    kit.area_light((3.4, 2.0, 2.4), (0, 0, 1.5), (0.6, 2.4), 420.0, (0.65, 0.8, 1.0))
    kit.area_light((3.0, -3.5, 0.5), (0, 0, 1.2), (2.0, 2.0), 60.0, (1.0, 0.75, 0.6))
    kit.camera(kit.orbit((0, 0), 6.4, 1.7, -82, 0.28), lambda f: (0.05 + 0.03 * (f - 8), 0, 1.05), lens_mm=42)


# ---- bottles

def _wrapped_text(words, radius, size, height, angle, material, parent):
    """Text on the side of a cylinder around z."""
    curve = bpy.data.curves.new("text", "FONT")
    curve.body, curve.size, curve.align_x = words, size, "CENTER"
    flat = bpy.data.objects.new("text", curve)
    mesh = bpy.data.meshes.new_from_object(flat)
    flat_points = np.array([v.co[:] for v in mesh.vertices])
    turn = angle + flat_points[:, 0] / radius
    points = np.stack([radius * np.cos(turn), radius * np.sin(turn), height + flat_points[:, 1]], axis=-1)
    kit.shape("letters", points, [list(p.vertices) for p in mesh.polygons], material).parent = parent


def _label(colour, band):
    shader = kit.Shader("label")
    height = shader.node("SeparateXYZ", {0: shader.coordinates("UV")}).outputs["Y"]
    stripes = shader.ramp(height, (0.0, band), (0.10, colour), (0.13, band), (0.15, colour), (0.84, colour), (0.86, band))
    stripes.node.color_ramp.interpolation = "CONSTANT"
    return shader.surface(shader.principled(Base_Color=stripes, Roughness=0.55, Normal=shader.bump(shader.noise(200.0), 0.0005)))


def _bottle(x, y, profile, thickness, glass, liquid, fill, label, words, ink, cap, spin):
    """A bottle that turns by `spin` radians per frame. profile: outer (radius, height), from the bottom's edge to the lip."""
    outer = kit.rounded(profile)
    inner = [(max(r - thickness, 1e-4), max(z, thickness * 1.5)) for r, z in outer]
    bottle = kit.lathe("bottle", [(1e-4, outer[0][1] + 0.004), *outer, *inner[::-1], (1e-4, thickness * 1.5)], glass, (x, y, 0.001), 64)
    wet = [(r + 0.0004, z) for r, z in inner if z <= fill]
    kit.lathe("liquid", [(1e-4, wet[0][1] - 0.0004), *wet, (1e-4, wet[-1][1])], liquid, segments=64).parent = bottle
    radius = max(r for r, _ in profile) + 0.0006
    low, high = 0.055, 0.155
    kit.sheet("label", lambda u, v: (radius * np.cos(2.3 * (u - 0.5)), radius * np.sin(2.3 * (u - 0.5)), low + (high - low) * v), 2, 60,
              label).parent = bottle
    _wrapped_text(words, radius + 0.0004, 0.03, 0.098, 0.0, ink, bottle)
    _wrapped_text("distilled & bottled", radius + 0.0004, 0.0085, 0.082, 0.0, ink, bottle)
    lip_radius, lip = profile[-1]
    kit.lathe("cap", [(lip_radius + 0.002, lip - 0.025), (lip_radius + 0.002, lip + 0.006), (lip_radius, lip + 0.009), (1e-4, lip + 0.009)], cap,
              segments=32).parent = bottle
    kit.moved(bottle, rotation_euler=lambda f: (0, 0, math.radians(-97) + spin * (f - 8)))


def bottles():
    """Product glass on a white sweep: bottles with liquids and printed labels that turn slowly, a tumbler, an ice cube."""
    def sweep(u, v):
        bend = np.clip((v - 0.55) / 0.25, 0, 1) * math.pi / 2
        y = -1.5 + 2.2 * np.minimum(v / 0.55, 1) + 0.4 * np.sin(bend)
        return 4 * (u - 0.5), y, 0.4 * (1 - np.cos(bend)) + 1.5 * np.maximum(v - 0.8, 0) / 0.2

    kit.sheet("sweep", sweep, 60, 2, kit.plain("sweep", (0.62, 0.62, 0.64), 0.45))
    clear, green = kit.glass("clear", (0.97, 0.99, 0.98)), kit.glass("green", (0.45, 0.72, 0.42))
    black, ink = kit.plain("black", (0.02, 0.02, 0.02), 0.3), kit.plain("ink", (0.02, 0.015, 0.03))
    gold = kit.plain("gold", (0.85, 0.6, 0.25), 0.2, Metallic=1)
    tall = [(0.036, 0.002), (0.041, 0.012), (0.041, 0.17), (0.034, 0.205), (0.016, 0.235), (0.0145, 0.30), (0.0165, 0.305), (0.0165, 0.318)]
    squat = [(0.050, 0.002), (0.056, 0.012), (0.056, 0.165), (0.046, 0.19), (0.02, 0.205), (0.0185, 0.235), (0.021, 0.24), (0.021, 0.252)]
    cream, navy = _label((0.75, 0.70, 0.58), (0.35, 0.05, 0.04)), _label((0.72, 0.74, 0.76), (0.04, 0.08, 0.25))
    _bottle(-0.13, 0.03, tall, 0.003, green, kit.glass("wine", (0.55, 0.75, 0.45), 1.34), 0.215, cream, "Verde", ink, gold, 0.06)
    _bottle(0.0, -0.02, squat, 0.004, clear, kit.glass("whisky", (0.92, 0.55, 0.14), 1.36), 0.178, navy, "Calm 12", ink, black, -0.045)
    _bottle(0.135, 0.04, tall, 0.003, clear, kit.glass("bitter", (0.85, 0.12, 0.06), 1.35), 0.19, cream, "Rosso", ink, black, 0.05)
    tumbler = kit.rounded([(0.034, 0), (0.036, 0.004), (0.038, 0.08), (0.0365, 0.081), (0.034, 0.078), (0.032, 0.012)], 4)
    kit.lathe("tumbler", [(1e-4, 0.001), *tumbler, (1e-4, 0.011)], clear, (0.075, -0.13, 0.0005), 56)
    ice = kit.modified(kit.box("ice", (0.026, 0.026, 0.026), (0.075, -0.13, 0.03), kit.glass("ice", (0.98, 0.99, 1), 1.31, 0.05), bevel=0.004),
                       "SUBSURF", levels=1, render_levels=1)
    kit.moved(ice, rotation_euler=lambda f: (0.3, 0.4, 0.06 * f))
    for x, y in ((-0.07, -0.12), (-0.095, -0.145)):
        kit.ball("olive", 0.012, (x, y, 0.012), kit.plain("olive", (0.18, 0.22, 0.03), 0.2), 12, (1, 1.3, 1))
    kit.sky((1, 1, 1), (1, 1, 1), 0.10)
    bpy.context.scene.cycles.max_bounces = bpy.context.scene.cycles.transmission_bounces = 8
    lamp = kit.area_light((-0.7, -0.3, 0.6), (0, 0, 0.15), (0.25, 0.9), 6.0, (1.0, 0.95, 0.9))
    kit.moved(lamp, location=lambda f: (-0.7, -0.34 + 0.01 * f, 0.6))
    kit.area_light((0.8, 0.1, 0.5), (0, 0, 0.15), (0.2, 0.8), 5.0, (0.9, 0.95, 1.0))
    kit.area_light((0, 0.35, 1.0), (0, 0.2, 0), (0.9, 0.5), 5.0)
    kit.camera(kit.orbit((0, 0), 0.78, 0.27, -84, -0.3), lambda f: (0.005 - 0.0045 * (f - 8), 0, 0.137), lens_mm=38, fstop=8.0, focus=(0.0, -0.06, 0.12))
