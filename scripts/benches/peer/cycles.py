"""
Renders a scene of scenes.py with Cycles, once for each seed, and notes the processor seconds of each frame in FOLDER/cycles.json.

    blender -b --factory-startup --python scripts/benches/peer/cycles.py -- SCENE FOLDER WxH SPP SEEDS
"""

import json
import math
import sys
import time
from pathlib import Path

import bpy
from mathutils import Vector

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benches.peer.scenes import MAX_DEPTH, SCENES  # noqa: E402


def z_up(v):
    return Vector((v[0], -v[2], v[1]))


def add_material(name, material, checker):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    shader = nodes.new({"diffuse": "ShaderNodeBsdfDiffuse", "metal": "ShaderNodeBsdfGlossy", "glass": "ShaderNodeBsdfGlass"}[material.kind])
    shader.inputs["Color"].default_value = (1, 1, 1, 1) if material.kind == "glass" else (*material.color, 1)
    shader.inputs["Roughness"].default_value = material.roughness
    if material.kind == "metal":
        shader.distribution = "GGX"
    if material.kind == "glass":
        shader.distribution, shader.inputs["IOR"].default_value = "SHARP", 1.5
    if material.checker:
        image = nodes.new("ShaderNodeTexImage")
        image.image = bpy.data.images.load(str(checker))
        image.image.colorspace_settings.name = "Non-Color"
        place = nodes.new("ShaderNodeMapping")
        place.inputs["Scale"].default_value = (material.checker / 2,) * 3
        tint = nodes.new("ShaderNodeVectorMath")
        tint.operation = "MULTIPLY"
        tint.inputs[1].default_value = material.color
        links.new(nodes.new("ShaderNodeTexCoord").outputs["UV"], place.inputs["Vector"])
        links.new(place.outputs["Vector"], image.inputs["Vector"])
        links.new(image.outputs["Color"], tint.inputs[0])
        links.new(tint.outputs["Vector"], shader.inputs["Color"])
    links.new(shader.outputs["BSDF"], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def add_thing(thing, materials):
    if thing.shape == "rectangle":
        bpy.ops.mesh.primitive_plane_add(size=2)
    elif thing.shape == "cube":
        bpy.ops.mesh.primitive_cube_add(size=2)
    else:
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1)
        bpy.ops.object.shade_smooth()
    made = bpy.context.object
    made.scale = (thing.scale[0], thing.scale[2], thing.scale[1])
    made.rotation_euler = (0, 0, math.radians(thing.turn_deg))
    made.location = z_up(thing.at)
    made.data.materials.append(materials[thing.material])


def add_lamp(lamp):
    data = bpy.data.lights.new("lamp", "AREA")
    data.shape, data.size, data.size_y = "RECTANGLE", 2 * lamp.half_width, 2 * lamp.half_depth
    data.energy = lamp.radiance * 4 * data.size * data.size_y  # radiance is P / (4 A)
    made = bpy.data.objects.new("lamp", data)
    made.location = z_up(lamp.at)
    bpy.context.collection.objects.link(made)


def build(scene, folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    materials = {name: add_material(name, material, folder / "checker.exr") for name, material in scene.materials.items()}
    for thing in scene.things:
        add_thing(thing, materials)
    for lamp in scene.lamps:
        add_lamp(lamp)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*(scene.sky or (0, 0, 0)), 1)
    bpy.context.scene.world = world
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "VERTICAL", math.radians(scene.fov_y_deg)
    made = bpy.data.objects.new("camera", camera)
    made.location = z_up(scene.eye)
    made.rotation_euler = (z_up(scene.target) - z_up(scene.eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(made)
    bpy.context.scene.camera = made


def set_up(size, spp):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    cycles = scene.cycles
    cycles.device, cycles.samples = "CPU", spp
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
    cycles.pixel_filter_type, cycles.blur_glossy = "BOX", 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    for bounces in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"):
        setattr(cycles, bounces, MAX_DEPTH - 1)
    return scene


def main():
    name, folder, size, spp, seeds = sys.argv[sys.argv.index("--") + 1:]
    folder = Path(folder).resolve()
    build(SCENES[name], folder)
    scene = set_up(tuple(map(int, size.split("x"))), int(spp))
    seconds = []
    for seed in range(int(seeds) + 1):  # the first one builds the scene and is not measured
        scene.cycles.seed = seed
        scene.render.filepath = str(folder / f"cycles.{seed}.exr")
        started = time.process_time()
        bpy.ops.render.render(write_still=True)
        seconds.append(time.process_time() - started)
    (folder / "cycles.json").write_text(json.dumps(seconds[1:]))


main()
