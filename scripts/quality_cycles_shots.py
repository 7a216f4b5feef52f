"""
Animated Cycles shots that becalm is validated on: DIR/SHOT/n8/f.####.exr, noisy, and DIR/SHOT/a, b, two references.

    blender -b --factory-startup --python scripts/quality_cycles_shots.py -- --out DIR

No setting of the denoiser is ever chosen on them. Frames that exist are kept. Noisy frames are half-float multilayer files with
Combined, Denoising Albedo, Denoising Normal and Denoising Depth, each of a seed of its own; references have their beauty alone.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import cycles_indoors as indoors  # noqa: E402
import cycles_outdoors as outdoors  # noqa: E402
import cycles_studio as studio  # noqa: E402

SHOTS = {build.__name__: build for build in (indoors.window, studio.cloth, outdoors.foliage, outdoors.car, indoors.candles, studio.skin,
                                             studio.bottles, outdoors.crowd)}
EXPENSIVE = {"window", "cloth", "foliage", "candles", "skin", "crowd"}  # their references have half the samples
BOUNCES = 6
SEED_STEP = 1000  # between sequences: seeds are this plus the frame


def _frames(text):
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def arguments():
    parser = argparse.ArgumentParser(prog="quality_cycles_shots.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--shots", type=lambda text: text.split(","), default=list(SHOTS), metavar="LIST", help=f"default: {','.join(SHOTS)}")
    parser.add_argument("--size", default="480x270", metavar="WxH", help="default: 480x270")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="default: as many as the machine has")
    parser.add_argument("--spp", type=int, default=8, metavar="N", help="of the noisy frames, whose folder is nN (default: 8)")
    parser.add_argument("--frames", type=_frames, default=_frames("4-13"), metavar="RANGE", help="of the noisy frames (default: 4-13)")
    parser.add_argument("--measured", type=_frames, default=_frames("7-10"), metavar="RANGE", help="that have references (default: 7-10)")
    parser.add_argument("--reference-spp", type=int, default=256, metavar="N",
                        help=f"of each reference (default: 256); half of it for {','.join(sorted(EXPENSIVE))}")
    parser.add_argument("--preview", type=int, metavar="FRAME", help="only this frame, as DIR/SHOT.png, of --spp samples")
    asked = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    for name in asked.shots:
        if name not in SHOTS:
            parser.error(f"no shot '{name}'; there are {', '.join(SHOTS)}")
    return asked


def prepare(asked):
    """The scene's settings that all shots share; a shot may change them."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.preferences.edit.keyframe_new_interpolation_type = "LINEAR"
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = map(int, asked.size.split("x"))
    render.resolution_percentage = 100
    render.use_persistent_data = True
    scene.view_settings.view_transform = "Standard"  # of previews
    if asked.threads:
        render.threads_mode, render.threads = "FIXED", asked.threads
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = cycles.transmission_bounces = BOUNCES
    cycles.diffuse_bounces = cycles.glossy_bounces = BOUNCES - 2
    cycles.transparent_max_bounces = 2 * BOUNCES
    cycles.use_auto_tile = False
    bpy.context.view_layer.cycles.denoising_store_passes = True
    return scene


def write_frame(scene, path, spp, seed, file_format="OPEN_EXR_MULTILAYER"):
    """The current frame. A file that exists is complete, as it gets its name last."""
    if path.exists():
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.stem}.partial{path.suffix}")
    settings = scene.render.image_settings
    settings.file_format = file_format
    if file_format.startswith("OPEN_EXR"):
        settings.color_depth, settings.exr_codec = "16", "ZIP"
    if file_format != "OPEN_EXR_MULTILAYER":
        settings.color_mode = "RGB"
    scene.cycles.samples, scene.cycles.seed = spp, seed
    scene.render.filepath = str(partial.resolve())
    started = time.monotonic(), time.process_time()
    bpy.ops.render.render(write_still=True)
    os.replace(partial, path)
    wall, busy = time.monotonic() - started[0], time.process_time() - started[1]
    print(f"{path}: {spp} spp, {wall:.1f} s, {busy:.1f} CPU s", flush=True)


def render_shot(scene, name, asked):
    """All of a frame at once, as its geometry then stays in memory."""
    folder = asked.out / name
    reference_spp = asked.reference_spp // 2 if name in EXPENSIVE else asked.reference_spp
    for frame in sorted({*asked.frames, *asked.measured}):
        scene.frame_set(frame)
        if frame in asked.frames:
            write_frame(scene, folder / f"n{asked.spp}" / f"f.{frame:04d}.exr", asked.spp, frame)
        if frame in asked.measured:
            for i, half in enumerate("ab", 1):
                write_frame(scene, folder / half / f"f.{frame:04d}.exr", reference_spp, i * SEED_STEP + frame, "OPEN_EXR")


def main():
    asked = arguments()
    for name in asked.shots:
        scene = prepare(asked)
        SHOTS[name]()
        if asked.preview is None:
            render_shot(scene, name, asked)
        else:
            scene.frame_set(asked.preview)
            write_frame(scene, asked.out / f"{name}.png", asked.spp, asked.preview, "PNG")
    print(f"CPU {time.process_time():.0f} s", flush=True)


main()
