"""Training pairs for a denoiser: random animated shots, rendered by Cycles.

    blender -b --factory-startup --python scripts/train/cycles_shots.py -- --out DIR --seeds 0-149

A shot is a pure function of its seed and the size. Its folder DIR/cycles-SEED6 gets multilayer EXRs with the passes Combined,
Denoising Albedo, Denoising Normal (of the camera's space) and Denoising Depth:

    n004_a.0001.exr, n004_b.0001.exr   the frame at 4 samples a pixel, in halves of 2 with other seeds (n001: n001_a only)
    r_a.0001.exr, r_b.0001.exr         references of 64 samples each, or 128 for the cleanest frames
    shot.json                          what was rendered; written last, so a shot that has it is complete and is skipped
"""

import argparse
import json
import os
import sys
import tempfile
import time
import traceback

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True

import cycles_lights as lights
import cycles_motion as motion
from cycles_dice import Dice
from cycles_layouts import LAYOUTS, Stage
from noise_levels import MOST_FAILED, evenly_spread, noise_levels, reference_samples

LEAST_REFERENCE_SPP = 64
ATTEMPTS = 12  # scenes tried for a seed
PILOT_SIZE, PILOT_SPP = (64, 36), 8


def arguments():
    parser = argparse.ArgumentParser(prog="cycles_shots.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, metavar="DIR")
    parser.add_argument("--seeds", required=True, metavar="FIRST-LAST")
    parser.add_argument("--frames", type=int, default=4, help="noisy frames of a shot, of 8 at most (default: 4)")
    parser.add_argument("--references", type=int, default=4,
                        help="how many of them, evenly spread, get references and a second level of noise (default: 4)")
    parser.add_argument("--size", default="256x144", metavar="WxH")
    parser.add_argument("--threads", type=int, default=1)
    asked = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    first, _, last = asked.seeds.partition("-")
    asked.seeds = range(int(first), int(last or first) + 1)
    asked.size = tuple(int(side) for side in asked.size.split("x"))
    return asked


def set_up(dice, threads):
    """The render settings of a shot: bounces, caustics, pixel filter."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.threads_mode, render.threads = "FIXED", threads
    render.use_persistent_data = True
    render.resolution_percentage = 100
    cycles.use_denoising, cycles.use_adaptive_sampling = False, False
    cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = 10.0 if dice.chance(0.05) else 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.max_bounces = dice.pick({4: 4, 5: 3, 6: 2, 8: 1})
    cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.max_bounces
    cycles.volume_bounces = dice.randint(0, 2)
    cycles.transparent_max_bounces = 12
    cycles.blur_glossy = dice.choice((0.0, 0.0, 1.0))
    cycles.caustics_reflective = cycles.caustics_refractive = dice.chance(0.4)
    cycles.pixel_filter_type = dice.pick({"BLACKMAN_HARRIS": 8, "BOX": 1, "GAUSSIAN": 1})
    cycles.filter_width = 1.0 if cycles.pixel_filter_type == "BOX" else 1.5
    scene.frame_start, scene.frame_end = 1, motion.SHOT_FRAMES
    bpy.context.view_layer.cycles.denoising_store_passes = True


def pilot(scene, size, seed):
    """Luminance of a small quick render of the shot."""
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.samples, scene.cycles.seed = PILOT_SPP, seed
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "pilot.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(size[0] * size[1] * 4, np.float32)
        image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(-1, 4)[:, :3] @ np.float32([0.2126, 0.7152, 0.0722])


def noise_of_sample(one, other):
    """Mean relative variance of one sample, from two renders of PILOT_SPP samples."""
    level = np.minimum(one, np.percentile(one, 99)).mean()
    squared = 0.5 * (one - other) ** 2 / ((0.5 * (one + other)) ** 2 + (0.1 * level) ** 2 + 1e-12)
    return PILOT_SPP * float(squared.mean())


def build(seed, size, threads):
    """The scene of a seed, and what is known about it; None where no attempt gave a view worth rendering."""
    aspect = size[0] / size[1]
    for attempt in range(ATTEMPTS):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        dice = Dice("cycles", seed, attempt)
        set_up(dice, threads)
        stage = Stage(dice, textured=dice.choice((0.95, 0.8, 0.8, 0.6, 0.3)))
        layout = dice.pick(LAYOUTS)
        view = layout(stage)
        camera, distance = motion.add_camera(dice, view, aspect)
        if camera is None:
            continue
        scene = bpy.context.scene
        rig = lights.Lights(dice, view.centre, view.radius, view.inside if view.has_walls else None)
        has_volume = dice.chance(0.1)
        environment = lights.set_environment(dice, dice.log_uniform(0.05, 2.0) * (4.0 if view.has_walls else 1.0),
                                             "none" if has_volume and dice.chance(0.6) else None)
        rig.add_any(environment != "none" and not view.has_walls)
        if view.has_walls and dice.chance(0.4):
            rig.rig("sun", dice.log_uniform(2.0, 60.0))
        motion.move_things(dice, stage.movable, rig.made)
        if has_volume:
            lights.add_medium(dice, view.centre, max(view.radius, distance))
        has_depth_of_field, has_motion_blur = dice.chance(0.2), dice.chance(0.2)
        if has_depth_of_field:
            aperture_radius = distance * dice.log_uniform(0.004, 0.04)
            camera.data.dof.use_dof = True
            camera.data.dof.focus_distance = distance * dice.uniform(0.8, 1.3)
            camera.data.dof.aperture_fstop = camera.data.lens * 1e-3 / (2.0 * aperture_radius)
        scene.render.use_motion_blur = has_motion_blur
        scene.render.motion_blur_shutter = dice.uniform(0.3, 1.0)
        scene.frame_set(1)
        luminance = pilot(scene, PILOT_SIZE, 1)
        mean = float(np.mean(np.minimum(luminance, 50.0 * np.median(luminance) + 1e-6)))
        lit = float(np.mean(luminance > 0.02 * mean))
        if mean < 1e-5 or lit < 0.25 or np.std(luminance) < 0.08 * mean:
            continue
        noise = noise_of_sample(luminance, pilot(scene, PILOT_SIZE, 2))
        brightness = 10.0 ** (dice.uniform(-2.0, 2.0) if dice.chance(0.6) else dice.gauss(0.0, 0.3))
        lights.scale_lights(0.25 * brightness / mean)
        return {"layout": layout.__name__, "environment": environment, "brightness": round(brightness, 4), "sample_noise": noise,
                "has_depth_of_field": has_depth_of_field, "has_motion_blur": has_motion_blur, "has_volume": has_volume}, dice
    return None, None


def render_shot(folder, seed, asked):
    facts, dice = build(seed, asked.size, asked.threads)
    if facts is None:
        raise RuntimeError(f"no view worth rendering in {ATTEMPTS} attempts")
    os.makedirs(folder, exist_ok=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = asked.size
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "16", "ZIP"
    levels = noise_levels(facts["sample_noise"], dice.random)
    reference_spp = reference_samples(levels, LEAST_REFERENCE_SPP)
    cycles_seeds = iter(dice.sample(range(1, 2**30), 6 * motion.SHOT_FRAMES))

    def write(name, samples, frame):
        scene.cycles.samples, scene.cycles.seed = samples, next(cycles_seeds)
        scene.render.filepath = os.path.join(folder, f"{name}.{frame:04d}.exr")
        bpy.ops.render.render(write_still=True)

    frames = range(1, asked.frames + 1)
    referenced = evenly_spread(frames, asked.references)
    for frame in frames:
        scene.frame_set(frame)
        for spp in levels if frame in referenced else levels[:1]:
            for half in "ab" if spp > 1 else "a":
                write(f"n{spp:03d}_{half}", max(spp // 2, 1), frame)
        if frame in referenced:
            for half in "ab":
                write(f"r_{half}", reference_spp, frame)
    shot = {"renderer": "cycles", "version": bpy.app.version_string, "seed": seed,
            "width": asked.size[0], "height": asked.size[1], "frames": asked.frames,
            "references": referenced, "reference_spp": reference_spp, "spp": levels, **facts}
    partial = os.path.join(folder, f"shot.json.partial.{os.getpid()}")
    with open(partial, "w") as file:
        json.dump(shot, file, indent=1)
    os.replace(partial, os.path.join(folder, "shot.json"))
    return shot


def main():
    asked = arguments()
    if not 1 <= asked.frames <= motion.SHOT_FRAMES:
        sys.exit(f"--frames: 1 to {motion.SHOT_FRAMES}, not {asked.frames}")
    if not 0 <= asked.references <= asked.frames:
        sys.exit(f"--references: 0 to {asked.frames}, not {asked.references}")
    failed = 0
    for seed in asked.seeds:
        folder = os.path.join(asked.out, f"cycles-{seed:06d}")
        if os.path.exists(os.path.join(folder, "shot.json")):
            continue
        start = time.monotonic()
        try:
            shot = render_shot(folder, seed, asked)
        except Exception:  # a shot that fails must not end the run
            print(f"cycles-{seed:06d} failed:\n{traceback.format_exc()}", flush=True)
            failed += 1
            continue
        words = [shot["layout"], shot["environment"], *(key[4:] for key in shot if key.startswith("has_") and shot[key])]
        print(f"cycles-{seed:06d} {time.monotonic() - start:.1f} s, spp {shot['spp']}: {', '.join(words)}", flush=True)
    if failed > MOST_FAILED * len(asked.seeds):
        sys.exit(f"{failed} shots failed")


main()
