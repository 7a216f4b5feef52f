"""
Renders the animated Cycles shots that becalm is validated on: noisy frames DIR/SHOT/n8/f.####.exr and two references DIR/SHOT/a, b.

    blender -b --factory-startup --python scripts/benches/quality/cycles/render.py -- --out build/quality/cycles

No setting of the denoiser is chosen on these shots; its network was extended after looks at four (scripts/train/README.md). Frames that
exist are kept. Each noisy frame has its own seed and is a half-float multilayer file with Combined, Denoising Albedo, Denoising Normal
and Denoising Depth; references have only their beauty. The time of rendering is noted beside the frames, in seconds.json.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from benches.quality import render_time  # noqa: E402
from benches.quality.cycles import indoors, outdoors, studio  # noqa: E402
from benches.quality.options import words  # noqa: E402

SHOTS = {build.__name__: build for build in (indoors.window, studio.cloth, outdoors.foliage, outdoors.car, indoors.candles, studio.skin,
                                             studio.bottles, outdoors.crowd)}
EXPENSIVE = {"window", "cloth", "foliage", "candles", "skin", "crowd"}  # their references have half the samples
BOUNCES = 6
SEED_STEP = 1000  # a seed is the frame, plus once or twice this for the references


def _frames(text):
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def arguments():
    parser = argparse.ArgumentParser(prog="render.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--shots", type=words, default=list(SHOTS), metavar="LIST", help=f"default: {','.join(SHOTS)}")
    parser.add_argument("--size", default="480x270", metavar="WxH", help="default: 480x270")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="default: as many as the machine has")
    parser.add_argument("--spp", type=int, default=8, metavar="N", help="of the noisy frames, whose folder is nN (default: 8)")
    parser.add_argument("--frames", type=_frames, default=_frames("4-13"), metavar="RANGE", help="of the noisy frames (default: 4-13)")
    parser.add_argument("--measured", type=_frames, default=_frames("7-10"), metavar="RANGE", help="frames that have references (default: 7-10)")
    parser.add_argument("--reference-spp", type=int, default=256, metavar="N",
                        help=f"of each reference (default: 256); half of it for {','.join(sorted(EXPENSIVE))}")
    parser.add_argument("--preview", type=int, metavar="FRAME", help="render only this frame, as DIR/SHOT.png, with --spp samples")
    asked = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    for name in asked.shots:
        if name not in SHOTS:
            parser.error(f"no shot '{name}'; there are {', '.join(SHOTS)}")
    return asked


def prepare(asked):
    """Sets what all shots have in common; a shot may change it."""
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
    """Renders the current frame, unless the file exists: it is renamed from a partial file last, so it is complete.
    Returns wall and processor seconds of a frame that it rendered."""
    if path.exists():
        return None
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
    return wall, busy


def render_shot(scene, name, asked):
    """Renders noisy frames and references frame by frame, so that a frame's geometry is built once."""
    folder = asked.out / name
    reference_spp = asked.reference_spp // 2 if name in EXPENSIVE else asked.reference_spp
    for frame in sorted({*asked.frames, *asked.measured}):
        scene.frame_set(frame)
        if frame in asked.frames:
            noisy = folder / f"n{asked.spp}"
            seconds = write_frame(scene, noisy / f"f.{frame:04d}.exr", asked.spp, frame)
            if seconds:
                render_time.note(noisy, 1, *seconds)
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
