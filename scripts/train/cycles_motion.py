"""Cameras that see something, and smooth motion of cameras, things and lights."""

import math
from collections import Counter

import bpy
from mathutils import Euler, Vector

SHOT_FRAMES = 8
GRID = (12, 7)  # rays that probe a view
TRIES = 40


def _key(owner, path, values):
    """Keyframes at the first, middle and last frame."""
    for frame, value in zip((1, (1 + SHOT_FRAMES) / 2, SHOT_FRAMES), values):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)


def _looking(position, target, roll):
    turn = (target - position).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    return (turn @ Euler((0, 0, roll)).to_matrix().to_4x4()).to_euler()


def probe(position, rotation, lens, aspect):
    """Over a grid of rays: part that hits, part that hits from behind, sorted distances, rays by object."""
    scene = bpy.context.scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    turn = rotation.to_matrix()
    half_width = 18.0 / lens
    distances, backs, objects = [], 0, Counter()
    for j in range(GRID[1]):
        for i in range(GRID[0]):
            x, y = 2.0 * (i + 0.5) / GRID[0] - 1.0, 2.0 * (j + 0.5) / GRID[1] - 1.0
            direction = turn @ Vector((x * half_width, y * half_width / aspect, -1.0)).normalized()
            is_hit, point, normal, _, thing, _ = scene.ray_cast(depsgraph, position, direction)
            if is_hit:
                distances.append((point - position).length)
                backs += normal.dot(direction) > 0.0
                objects[thing.name] += 1
    rays = GRID[0] * GRID[1]
    return len(distances) / rays, backs / rays, sorted(distances), objects


def _is_good(view, position, rotation, lens, aspect, distance):
    hits, backs, distances, objects = probe(position, rotation, lens, aspect)
    if hits < view.least_hits or (backs > 0.35 and not view.has_walls):
        return False
    # One thing that hides the rest.
    if sum(rays > 1 for rays in objects.values()) < view.least_objects:
        return False
    if view.least_objects > 1 and max(objects.values()) > 0.8 * objects.total():
        return False
    near = sum(d < 0.25 * distance for d in distances) / len(distances)
    # All at one depth and across the frame: a bare wall straight ahead.
    return near < 0.25 and distances[0] > 0.04 * distance and distances[-1] > 1.15 * distances[0]


def add_camera(dice, view, aspect):
    """A moving camera, or None where no try saw enough. Returns (camera object, distance of its target)."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    data = bpy.data.cameras.new("camera")
    made = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(made)
    scene.camera = made
    data.clip_start, data.clip_end = 0.005, 300.0
    for _ in range(TRIES):
        lens = dice.log_uniform(20.0, 70.0)
        target = Vector(dice.choice(view.targets))
        azimuth, elevation, distance = dice.uniform(*view.azimuth), dice.uniform(*view.elevation), dice.uniform(*view.distance)
        offset = Vector((math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation)))
        speed = dice.log_uniform(0.01, 0.5) if dice.chance(0.85) else 0.0
        pan = dice.log_uniform(0.005, 0.2) if dice.chance(0.6) else 0.0
        drift, turn = Vector(dice.direction()) * speed * distance, Vector(dice.direction()) * pan * distance
        sway = Vector(dice.direction()) * 0.2 * speed * distance
        starts = [target + offset * distance + drift * t + sway * (1.0 - t * t) for t in (-0.5, 0.0, 0.5)]
        if view.inside:
            starts = [Vector([min(max(c, low), high) for c, low, high in zip(p, *view.inside)]) for p in starts]
        roll = dice.gauss(0.0, 0.15) if dice.chance(0.3) else 0.0
        spin = dice.gauss(0.0, 0.1) if dice.chance(0.15) else 0.0
        poses = [(p, _looking(p, target + turn * t, roll + spin * t)) for p, t in zip(starts, (-0.5, 0.0, 0.5))]
        distance = (starts[1] - target).length
        if distance > 0.5 * view.distance[0] and all(_is_good(view, *pose, lens, aspect, distance) for pose in poses):
            for pose in poses[1:]:
                pose[1].make_compatible(poses[0][1])
            data.lens = lens
            _key(made, "location", [pose[0] for pose in poses])
            _key(made, "rotation_euler", [pose[1] for pose in poses])
            return made, distance
    return None, 0.0


def move_things(dice, movable, lights):
    """Moves and spins some of the things and lights."""
    share = dice.choice((0.0, 0.2, 0.5, 1.0))
    pace = dice.log_uniform(0.05, 2.0)
    for thing in movable:
        if not dice.chance(share):
            continue
        size = sum(thing.scale) / 3.0
        path = Vector(dice.direction()) * size * pace * dice.random()
        path.z *= 0.3
        start = thing.location.copy()
        _key(thing, "location", [start - 0.5 * path, start + Vector(dice.direction()) * 0.1 * path.length, start + 0.5 * path])
        if dice.chance(0.6):
            turn, angles = Vector(dice.direction()) * pace * dice.random(), Vector(thing.rotation_euler)
            _key(thing, "rotation_euler", [angles - 0.5 * turn, angles, angles + 0.5 * turn])
    for light in lights:
        if dice.chance(0.35):
            start, path = light.location.copy(), Vector(dice.direction()) * dice.uniform(0.05, 0.6)
            _key(light, "location", [start - 0.5 * path, start, start + 0.5 * path])
        if light.type == "LIGHT" and dice.chance(0.12):  # flicker
            energy = light.data.energy
            _key(light.data, "energy", [energy * dice.log_uniform(0.3, 1.5) for _ in range(3)])
