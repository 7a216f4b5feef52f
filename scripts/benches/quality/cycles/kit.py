"""Materials, shapes, lights and motion of the Cycles shots, each from a few numbers. Runs inside Blender."""

import math

import bpy
import numpy as np
from mathutils import Vector

KEYED = range(0, 18)  # frames 1 to 16, and their neighbours, which an open shutter reaches


# ---- materials

class Shader:
    """A material of shader nodes. Calling it adds a node and returns its first output; `node` returns the node."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")

    def node(self, kind, inputs=None, **properties):
        node = self.tree.nodes.new("ShaderNode" + kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            self.set(node.inputs[name], value)
        return node

    def __call__(self, kind, inputs=None, **properties):
        return self.node(kind, inputs, **properties).outputs[0]

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA":
            socket.default_value = (*value, 1.0)[:4]
        else:
            socket.default_value = value

    def math(self, operation, *values):
        return self("Math", dict(enumerate(values)), operation=operation)

    def mix(self, factor, first, second):
        return self("MixRGB", {"Fac": factor, "Color1": first, "Color2": second})

    def ramp(self, factor, *stops):
        """stops: (position, colour), in order."""
        node = self.node("ValToRGB", {"Fac": factor})
        elements = node.color_ramp.elements
        while len(elements) < len(stops):
            elements.new(0.5)
        for element, (position, colour) in zip(elements, stops):
            element.position, element.color = position, (*colour, 1.0)
        return node.outputs[0]

    def coordinates(self, kind="Object", scale=(1, 1, 1), rotation=(0, 0, 0)):
        source = self.node("TexCoord").outputs[kind]
        return self("Mapping", {"Vector": source, "Scale": scale, "Rotation": rotation})

    def noise(self, scale, detail=3.0, where=None):
        """Noise between 0 and 1."""
        return self("TexNoise", {"Vector": where or self.coordinates(), "Scale": scale, "Detail": detail})

    def bump(self, height, distance, strength=1.0):
        return self("Bump", {"Height": height, "Distance": distance, "Strength": strength})

    def principled(self, **inputs):
        """Inputs by name, with `_` for blanks; values are numbers, colours or sockets."""
        return self("BsdfPrincipled", {name.replace("_", " "): value for name, value in inputs.items()})

    def surface(self, closure):
        self.set(self.output.inputs["Surface"], closure)
        return self.material

    def volume(self, closure):
        self.set(self.output.inputs["Volume"], closure)
        return self.material


def plain(name, colour, roughness=0.5, **inputs):
    shader = Shader(name)
    return shader.surface(shader.principled(Base_Color=colour, Roughness=roughness, **inputs))


def glass(name, colour=(1, 1, 1), ior=1.5, roughness=0.0):
    shader = Shader(name)
    return shader.surface(shader("BsdfGlass", {"Color": colour, "Roughness": roughness, "IOR": ior}))


def emitter(name, colour, strength):
    shader = Shader(name)
    return shader.surface(shader("Emission", {"Color": colour, "Strength": strength}))


def wood(name, dark=(0.12, 0.05, 0.02), light=(0.35, 0.18, 0.08), scale=1.0, stretch=(1, 8, 8), roughness=0.35):
    """Wood with its grain along the object's x axis."""
    shader = Shader(name)
    grain = shader.noise(2.5 * scale, 3.0, shader.coordinates(scale=stretch))
    rings = shader.math("FRACT", shader.math("MULTIPLY", grain, 6.0))
    colour = shader.mix(rings, dark, light)
    return shader.surface(shader.principled(Base_Color=colour, Roughness=roughness, Normal=shader.bump(rings, 0.002)))


# ---- shapes

def shape(name, vertices, faces, material, smooth=False, uvs=None, location=(0, 0, 0), rotation=(0, 0, 0)):
    """A mesh object. uvs: one for each vertex."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [tuple(int(i) for i in f) for f in faces])
    if uvs is not None:
        corners = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", corners)
        mesh.uv_layers.new().data.foreach_set("uv", np.asarray(uvs, np.float32)[corners].ravel())
    if smooth:
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.materials.append(material)
    mesh.update()
    return place(name, mesh, location, rotation)


def place(name, data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1)):
    """An object of mesh, light or camera data, which several objects may share."""
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler, thing.scale = location, rotation, scale
    bpy.context.scene.collection.objects.link(thing)
    return thing


def modified(thing, kind, **properties):
    modifier = thing.modifiers.new(kind.lower(), kind)
    for name, value in properties.items():
        setattr(modifier, name, value)
    return thing


def box(name, size, location, material, rotation=(0, 0, 0), bevel=0.01):
    """A box centred on its location."""
    vertices = [[(s - 0.5) * d for s, d in zip(((i >> 2) & 1, (i >> 1) & 1, i & 1), size)] for i in range(8)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    thing = shape(name, vertices, faces, material, location=location, rotation=rotation)
    return modified(thing, "BEVEL", width=bevel, segments=2) if bevel else thing


def grid_faces(rows, columns, closed=False):
    """Quads between rows x columns vertices; closed: the last column is joined to the first."""
    i, j = np.mgrid[0:rows - 1, 0:columns if closed else columns - 1].reshape(2, -1)
    k = (j + 1) % columns
    return np.stack([i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j], axis=1)


def sheet(name, surface, rows, columns, material, location=(0, 0, 0), rotation=(0, 0, 0), smooth=True):
    """A grid over a parametric surface: surface(u, v) takes arrays between 0 and 1 and returns x, y, z."""
    v, u = np.mgrid[0:1:rows * 1j, 0:1:columns * 1j]
    points = np.stack(np.broadcast_arrays(*surface(u, v)), axis=-1).reshape(-1, 3)
    uvs = np.stack([u, v], axis=-1).reshape(-1, 2)
    return shape(name, points, grid_faces(rows, columns), material, smooth, uvs, location, rotation)


def lathe(name, profile, material, location=(0, 0, 0), segments=40, smooth=True):
    """A surface of revolution. profile: (radius, height), outside from the bottom up, then inside, for outward normals."""
    angle = np.linspace(0, 2 * math.pi, segments, endpoint=False)
    points = [[(r * math.cos(a), r * math.sin(a), z) for a in angle] for r, z in profile]
    return shape(name, np.reshape(points, (-1, 3)), grid_faces(len(profile), segments, True), material, smooth, location=location)


def ball(name, radius, location, material, rows=24, scale=(1, 1, 1)):
    profile = [(max(1e-4, math.sin(t)) * radius, -math.cos(t) * radius) for t in np.linspace(0, math.pi, rows)]
    thing = lathe(name, profile, material, location, 2 * rows)
    thing.scale = scale
    return thing


def rounded(profile, steps=6):
    """A (radius, height) profile through these points, as a Catmull-Rom spline."""
    p = np.array([profile[0], *profile, profile[-1]], float)
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    parts = [0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3)
             for a, b, c, d in zip(p, p[1:], p[2:], p[3:])]
    return np.maximum(np.concatenate([*parts, p[-1:]]), (1e-4, -1e9))


# ---- light

def area_light(location, target, size, watts, colour=(1, 1, 1)):
    data = bpy.data.lights.new("area", "AREA")
    data.shape, (data.size, data.size_y), data.energy, data.color = "RECTANGLE", size, watts, colour
    thing = place("area", data, location)
    thing.rotation_euler = aim(location, target)
    return thing


def sun(elevation_deg, azimuth_deg, strength, colour=(1.0, 0.9, 0.75), angle_deg=0.6):
    data = bpy.data.lights.new("sun", "SUN")
    data.energy, data.color, data.angle = strength, colour, math.radians(angle_deg)
    return place("sun", data, rotation=(math.radians(90 - elevation_deg), 0, math.radians(azimuth_deg)))


def sky(horizon, zenith, strength):
    """A sky whose colour depends on elevation; equal colours make a uniform backdrop."""
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes["Background"].inputs["Strength"].default_value = strength
    nodes["Background"].inputs["Color"].default_value = (*horizon, 1.0)
    if horizon == zenith:
        return
    height, ramp = nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeValToRGB")
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], height.inputs[0])
    links.new(height.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Background"].inputs["Color"])
    for element, position, colour in zip(ramp.color_ramp.elements, (0.0, 0.7), (horizon, zenith)):
        element.position, element.color = position, (*colour, 1.0)


# ---- motion

def aim(location, target):
    return (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()


def moved(thing, **paths):
    """Sets keyframes of attributes (location, rotation_euler, scale, a number of a data block), each given as a function of the frame."""
    for attribute, path in paths.items():
        for frame in KEYED:
            setattr(thing, attribute, path(frame))
            thing.keyframe_insert(attribute, frame=frame)
    return thing


def camera(location, target, lens_mm=35.0, fstop=None, focus=None):
    """location, target: functions of the frame. fstop: depth of field, focused on the point `focus`."""
    data = bpy.data.cameras.new("camera")
    data.lens = lens_mm
    thing = place("camera", data)
    moved(thing, location=location, rotation_euler=lambda f: aim(location(f), target(f)))
    if fstop:
        data.dof.use_dof, data.dof.aperture_fstop = True, fstop
        data.dof.focus_object = place("focus", None, focus)
    bpy.context.scene.camera = thing
    return thing


def orbit(target, radius, height, first_deg, degrees_per_frame):
    """The location of a camera that circles a target, as a function of the frame."""
    def location(frame):
        angle = math.radians(first_deg + degrees_per_frame * (frame - 1))
        return (target[0] + radius * math.cos(angle), target[1] + radius * math.sin(angle), height)
    return location


def swayed(thing, points, weight):
    """Deforms the mesh: its vertices move towards `points` by weight(frame), 1 is all the way."""
    thing.shape_key_add(name="rest")
    key = thing.shape_key_add(name="swayed")
    key.slider_min = -10.0
    key.slider_max = 10.0
    key.data.foreach_set("co", np.asarray(points, np.float32).ravel())
    moved(key, value=weight)


def points_of(thing):
    points = np.empty(3 * len(thing.data.vertices), np.float32)
    thing.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)
