"""Random meshes of about unit size around the origin, and the objects made of them."""

import math

import bmesh
import bpy
from mathutils import Matrix, Vector, noise

LETTERS = "ABCDEFGHKMNPRSTXYZ0123456789&?%#@"


def add(data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1), material=None):
    """An object of mesh, curve or light data in the scene."""
    made = bpy.data.objects.new(data.name, data)
    made.location, made.rotation_euler, made.scale = location, rotation, scale
    bpy.context.scene.collection.objects.link(made)
    if material:
        if not data.materials:
            data.materials.append(material)
        else:
            made.material_slots[0].link = "OBJECT"
            made.material_slots[0].material = material
    return made


def mesh(name, vertices, faces, is_smooth=False):
    made = bpy.data.meshes.new(name)
    made.from_pydata(vertices, [], faces)
    if is_smooth:
        made.polygons.foreach_set("use_smooth", [True] * len(made.polygons))
    return made


def _from_bmesh(name, build, is_smooth=False):
    shape = bmesh.new()
    build(shape)
    made = bpy.data.meshes.new(name)
    shape.to_mesh(made)
    shape.free()
    if is_smooth:
        made.polygons.foreach_set("use_smooth", [True] * len(made.polygons))
    return made


def _surface(name, f, columns, rows, is_closed_u=False, is_closed_v=False):
    """A smooth mesh of the points f(u, v), with u and v over [0, 1]."""
    last_u, last_v = columns - (not is_closed_u), rows - (not is_closed_v)
    vertices = [f(i / last_u, j / last_v) for j in range(rows) for i in range(columns)]
    faces = [(j * columns + i, j * columns + (i + 1) % columns, (j + 1) % rows * columns + (i + 1) % columns,
              (j + 1) % rows * columns + i) for j in range(last_v) for i in range(last_u)]
    return mesh(name, vertices, faces, True)


def box_mesh():
    return _from_bmesh("box", lambda shape: bmesh.ops.create_cube(shape, size=2.0))


def plane_mesh():
    return mesh("plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])


def box(dice):
    made = box_mesh()
    if dice.chance(0.7):
        shape = bmesh.new()
        shape.from_mesh(made)
        bmesh.ops.bevel(shape, geom=shape.edges[:], offset=dice.log_uniform(0.02, 0.4), segments=dice.randint(1, 3),
                        affect="EDGES", profile=0.5)
        shape.to_mesh(made)
        shape.free()
    return made


def sphere(dice):
    return _from_bmesh("sphere", lambda shape: bmesh.ops.create_uvsphere(shape, u_segments=48, v_segments=24, radius=1.0), True)


def crystal(dice):
    made = _from_bmesh("crystal", lambda shape: bmesh.ops.create_icosphere(shape, subdivisions=dice.randint(1, 2), radius=1.0))
    amount = dice.uniform(0.0, 0.4)
    for vertex in made.vertices:
        vertex.co *= 1.0 + dice.uniform(-amount, amount)
    return made


def rock(dice):
    made = _from_bmesh("rock", lambda shape: bmesh.ops.create_icosphere(shape, subdivisions=5, radius=1.0), dice.chance(0.8))
    offset, frequency = Vector(dice.direction()) * 40.0, dice.log_uniform(0.6, 3.0)
    amount, octaves = dice.uniform(0.1, 0.7), dice.randint(1, 6)
    for vertex in made.vertices:
        vertex.co *= 1.0 + amount * noise.fractal(vertex.co * frequency + offset, 1.0, 2.0, octaves)
    return made


def cylinder(dice):
    segments, top = dice.choice((3, 4, 5, 6, 8, 40, 40)), dice.choice((1.0, 1.0, 0.0, dice.random()))
    return _from_bmesh("cylinder", lambda shape: bmesh.ops.create_cone(
        shape, cap_ends=True, segments=segments, radius1=1.0, radius2=top, depth=2.0))


def torus(dice):
    thickness = dice.uniform(0.08, 0.45)

    def f(u, v):
        a, b = u * math.tau, v * math.tau
        r = 1.0 - thickness + thickness * math.cos(b)
        return (r * math.cos(a), r * math.sin(a), thickness * math.sin(b))
    return _surface("torus", f, 56, 20, True, True)


def knot(dice):
    p, q = dice.choice(((2, 3), (3, 2), (2, 5), (3, 4), (5, 3)))
    thickness, depth = dice.uniform(0.06, 0.18), dice.uniform(0.2, 0.45)

    def centre(t):
        r = 0.7 + 0.3 * math.cos(q * t)
        return Vector((r * math.cos(p * t), r * math.sin(p * t), depth * math.sin(q * t)))

    def f(u, v):
        t, a = u * math.tau, v * math.tau
        along = (centre(t + 0.01) - centre(t - 0.01)).normalized()
        side = along.cross(Vector((0, 0, 1))).normalized()
        return centre(t) + thickness * (math.cos(a) * side + math.sin(a) * along.cross(side))
    return _surface("knot", f, 220, 12, True, True)


def lathe(dice):
    """A turned shape: baluster, bowl, spinning top, bead chain."""
    amplitudes = [(dice.uniform(-0.35, 0.35), dice.choice((1, 2, 3, 5, 8)), dice.uniform(0.0, 6.3)) for _ in range(3)]
    flutes, depth = dice.choice((0, 0, 0, 8, 14)), dice.uniform(0.03, 0.12)

    def f(u, v):
        r = max(0.06, 0.5 + sum(a * math.sin(k * 2.0 * v + s) for a, k, s in amplitudes))
        r *= 1.0 + depth * math.cos(flutes * u * math.tau) if flutes else 1.0
        r *= min(1.0, 0.02 + 20.0 * v, 0.02 + 20.0 * (1.0 - v))
        return (r * math.cos(u * math.tau), r * math.sin(u * math.tau), 2.0 * v - 1.0)
    return _surface("lathe", f, 64, 44, True)


def twisted(dice):
    """A prism turned and tapered along its axis."""
    sides, turns, taper = dice.randint(3, 7), dice.uniform(-4.0, 4.0), dice.uniform(-0.6, 0.3)
    waviness, waves = dice.uniform(0.0, 0.3), dice.randint(1, 4)

    def f(u, v):
        corner = u * sides
        a, b = (math.floor(corner) * math.tau / sides, (math.floor(corner) + 1) * math.tau / sides)
        t = corner - math.floor(corner)
        x, y = (math.cos(a) * (1 - t) + math.cos(b) * t, math.sin(a) * (1 - t) + math.sin(b) * t)
        r = 0.6 * (1.0 + taper * v + waviness * math.sin(waves * math.tau * v)) * min(1.0, 40.0 * v + 0.01, 40.01 - 40.0 * v)
        s, c = math.sin(turns * v), math.cos(turns * v)
        return (r * (c * x - s * y), r * (s * x + c * y), 2.0 * v - 1.0)
    made = _surface("twisted", f, sides * 6, 60, True)
    made.use_auto_smooth = True
    return made


def supershape(dice):
    """Gielis' superformula in two angles."""
    def radius(m, n1, n2, n3):
        return lambda a: (abs(math.cos(m * a / 4)) ** n2 + abs(math.sin(m * a / 4)) ** n3) ** (-1.0 / n1)
    across, along = (radius(dice.randint(0, 10), dice.uniform(0.6, 8.0), dice.uniform(0.8, 6.0), dice.uniform(0.8, 6.0))
                     for _ in range(2))

    def f(u, v):
        a, b = (u - 0.5) * math.tau, (v - 0.5) * math.pi
        r1, r2 = min(across(a), 1.5), min(along(b), 1.5)
        return (0.8 * r1 * math.cos(a) * r2 * math.cos(b), 0.8 * r1 * math.sin(a) * r2 * math.cos(b), 0.8 * r2 * math.sin(b))
    return _surface("supershape", f, 80, 50, True)


def sheet(dice, columns=70):
    """A wavy sheet in the xy plane, as of cloth."""
    waves = [(dice.uniform(-6.0, 6.0), dice.uniform(-6.0, 6.0), dice.uniform(0.0, 6.3)) for _ in range(4)]
    height, offset, rough = dice.uniform(0.03, 0.2), dice.uniform(-40.0, 40.0), dice.uniform(0.0, 0.15)

    def f(u, v):
        x, y = 2.0 * u - 1.0, 2.0 * v - 1.0
        z = height * sum(math.sin(a * x + b * y + s) for a, b, s in waves) / 2.0
        return (x, y, z + rough * noise.noise(Vector((3.0 * x, 3.0 * y, offset))))
    return _surface("sheet", f, columns, columns)


def tuft(dice, blades=50):
    """Thin bent blades or hairs from a disc on the ground."""
    width, bend = dice.log_uniform(0.01, 0.08), dice.uniform(0.1, 0.8)
    vertices, faces = [], []
    for _ in range(blades):
        turn, lean, reach = dice.uniform(0.0, math.tau), dice.uniform(0.0, math.tau), bend * dice.random()
        r, height = 0.6 * math.sqrt(dice.random()), dice.uniform(0.5, 1.6)
        side = Vector((math.cos(turn), math.sin(turn), 0.0)) * width
        root = Vector((r * math.cos(lean), r * math.sin(lean), -0.02))
        first = len(vertices)
        for step in range(4):
            t = step / 3.0
            middle = root + Vector((reach * t * t * math.cos(lean), reach * t * t * math.sin(lean), height * t))
            vertices += [middle - side * (1.02 - t), middle + side * (1.02 - t)]
        faces += [(first + 2 * k, first + 2 * k + 1, first + 2 * k + 3, first + 2 * k + 2) for k in range(3)]
    return mesh("tuft", vertices, faces, True)


def stairs(dice):
    steps = dice.randint(4, 10)
    profile = [(-1.0, -1.0)]
    for k in range(steps):
        x, z = 2.0 * k / steps - 1.0, 2.0 * (k + 1) / steps - 1.0
        profile += [(x, z), (x + 2.0 / steps, z)]
    profile.append((1.0, -1.0))
    n = len(profile)
    vertices = [(x, y, z) for y in (-1.0, 1.0) for x, z in profile]
    faces = [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)]
    made = mesh("stairs", vertices, faces)
    shape = bmesh.new()
    shape.from_mesh(made)
    bmesh.ops.holes_fill(shape, edges=shape.edges[:], sides=0)
    bmesh.ops.recalc_face_normals(shape, faces=shape.faces[:])
    shape.to_mesh(made)
    shape.free()
    return made


def frame_of_bars(dice):
    """A cage: the edges of a polyhedron as bars."""

    def build(shape):
        if dice.chance(0.5):
            bmesh.ops.create_icosphere(shape, subdivisions=1, radius=1.0)
        else:
            bmesh.ops.create_cube(shape, size=1.6)
        bmesh.ops.wireframe(shape, faces=shape.faces[:], thickness=dice.uniform(0.05, 0.2), use_replace=True,
                            use_even_offset=True)
    return _from_bmesh("cage", build)


def letters(dice):
    curve = bpy.data.curves.new("letters", "FONT")
    curve.body = "".join(dice.choice(LETTERS) for _ in range(dice.choice((1, 1, 2, 4))))
    curve.extrude, curve.bevel_depth = dice.uniform(0.02, 0.25), dice.choice((0.0, 0.02))
    curve.align_x, curve.align_y = "CENTER", "CENTER"
    curve.size = 2.6 / len(curve.body) ** 0.7
    return curve


def spring(dice):
    turns, thickness = dice.randint(2, 7), dice.uniform(0.04, 0.12)

    def f(u, v):
        a, b = u * turns * math.tau, v * math.tau
        r = 0.7 + thickness * math.cos(b)
        return (r * math.cos(a), r * math.sin(a), 2.0 * u - 1.0 + thickness * math.sin(b))
    return _surface("spring", f, 24 * turns, 10, False, True)


SOLIDS = {box: 2.5, sphere: 1, crystal: 1, rock: 1.5, cylinder: 1.5, torus: 1, knot: 1, lathe: 1.5, twisted: 1, supershape: 1,
          frame_of_bars: 0.7, letters: 1, spring: 0.7, stairs: 0.3}


def solid(dice):
    return dice.pick(SOLIDS)(dice)


def heightfield(dice, extent, height, columns=90):
    """Terrain over [-extent, extent]^2, and the function that gives its height."""
    offset, frequency, octaves = Vector(dice.direction()) * 60.0, dice.uniform(1.0, 4.0) / extent, dice.randint(2, 7)
    steps = dice.choice((0, 0, 0, 5))

    def z(x, y):
        raised = noise.fractal(Vector((x * frequency, y * frequency, 0.0)) + offset, 1.0, 2.0, octaves)
        return height * (math.floor(raised * steps) / steps if steps else raised)

    def f(u, v):
        x, y = extent * (2.0 * u - 1.0), extent * (2.0 * v - 1.0)
        return (x, y, z(x, y))
    return _surface("terrain", f, columns, columns), z


def pierced_wall(dice, width, height, columns, rows, holes):
    """A wall in the xy plane from (0, 0) to (width, height), `holes` of whose cells are open."""
    def cuts(length, count):
        inner = sorted(dice.uniform(0.1, 0.9) * length for _ in range(count - 1))
        return [0.0, *inner, length]
    xs, ys = cuts(width, columns), cuts(height, rows)
    cells = [(i, j) for i in range(columns) for j in range(rows)]
    opened = set(dice.sample(cells, min(holes, len(cells) - 1)))
    vertices = [(x, y, 0.0) for y in ys for x in xs]
    n = columns + 1
    faces = [(j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i) for i, j in cells if (i, j) not in opened]
    return mesh("wall", vertices, faces)


def between(a, b, radius, data, material):
    """An object of unit radius and half length 1 stretched from point a to point b."""
    a, b = Vector(a), Vector(b)
    axis = b - a
    made = add(data, material=material)
    turn = axis.to_track_quat("Z", "Y").to_matrix().to_4x4()
    made.matrix_world = Matrix.Translation((a + b) / 2) @ turn @ Matrix.Diagonal((radius, radius, axis.length / 2, 1.0))
    return made
