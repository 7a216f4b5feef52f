#!/usr/bin/python3
"""Renders a few frames with Debian's Blender and checks what becalm reads from its files and writes. Run by `scripts/test blender`.

Two shots of a sliding box: multilayer files with the passes that users write for compositing, and the same in stereo. Checked:
the use of each channel, that light passes are denoised with the beauty, that motion vectors agree with the pictures, and that
all other channels are passed on bit for bit. Exit status 1 if a check fails.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

try:
    import bpy  # exists only inside Blender, which runs this file too
except ImportError:
    bpy = None

FRAMES = (3, 4, 5)
TAKEN = {"Combined.R": "beauty.R", "Denoising Albedo.G": "albedo.G", "Denoising Normal.X": "normal.X", "Vector.X": "motion.X"}
ADDITIVE = ("DiffDir", "DiffInd", "GlossDir", "GlossInd", "Emit", "Env")


def render(folder, stereo):
    """Renders FRAMES. Runs inside Blender."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 16, False, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 90, 100
    layer.cycles.denoising_store_passes = True
    for name in ("z", "vector", "diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct", "glossy_indirect",
                 "glossy_color", "emit", "environment"):
        setattr(layer, f"use_pass_{name}", True)
    box = bpy.data.objects["Cube"]
    texture = box.active_material.node_tree.nodes.new("ShaderNodeTexChecker")
    texture.inputs["Scale"].default_value = 7
    box.active_material.node_tree.links.new(texture.outputs["Color"], box.active_material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    for frame in (1, 8):
        box.location = (0.25 * frame - 1, 0.25 * frame - 1, 0)
        box.keyframe_insert("location", frame=frame)
    for curve in box.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    scene.render.use_multiview = stereo
    image = scene.render.image_settings
    image.file_format = "OPEN_EXR_MULTILAYER"
    if stereo:
        image.views_format = "MULTIVIEW"
    for frame in FRAMES:
        scene.frame_set(frame)
        scene.cycles.seed = frame
        scene.render.filepath = f"{folder}/{'stereo' if stereo else 'mono'}.{frame:04d}.exr"
        bpy.ops.render.render(write_still=True)


class Checker:
    def __init__(self, becalm, folder):
        self.becalm, self.folder, self.failed = becalm, folder, 0

    def run(self, *words):
        done = subprocess.run([self.becalm, *words], capture_output=True, text=True)
        self.expect(done.returncode == 0, f"becalm {' '.join(words)}: exit status {done.returncode} {done.stderr.strip()}")
        return done.stdout

    def expect(self, is_so, what):
        print(("ok      " if is_so else "FAILED  ") + what)
        self.failed += not is_so

    def uses(self, name):
        told = json.loads(self.run("info", "--json", f"{self.folder}/{name}.{FRAMES[0]:04d}.exr"))
        return {channel["name"]: channel.get("use", "") for part in told["parts"] for channel in part["channels"]}, told

    def check_shot(self, name, views):
        uses, told = self.uses(name)
        for end, use in TAKEN.items():
            found = [u for channel, u in uses.items() if end.split(".")[0] in channel and channel.endswith("." + end.split(".")[1])]
            self.expect(sum(u.endswith(use) for u in found) == views, f"{name}: {end} is {use}, {views} times: {found}")
        for light in ADDITIVE:
            self.expect(any(light in str(entry) for entry in told["additive"]), f"{name}: {light} is denoised with the beauty")
        pattern = f"{self.folder}/{name}.####.exr"
        audit = self.run("info", "--audit", pattern)
        self.expect("vectors" not in audit, f"{name}: the vectors are as the pictures move: {audit.strip().splitlines()[-1]}")
        self.run("denoise", pattern, "-o", f"{self.folder}/calm.{name}.####.exr", "--quiet")
        self.check_passed_on(name, uses)

    def check_passed_on(self, name, uses):
        import numpy as np
        import OpenImageIO as oiio
        before, after = (oiio.ImageBuf(f"{self.folder}/{prefix}{name}.{FRAMES[1]:04d}.exr") for prefix in ("", "calm."))
        changed = set()
        for part in range(max(before.nsubimages, 1)):
            before.reset(before.name, part, 0)
            after.reset(after.name, part, 0)
            a, b = (np.asarray(image.get_pixels(oiio.FLOAT)) for image in (before, after))
            changed |= {c for i, c in enumerate(before.spec().channelnames) if not np.array_equal(a[..., i], b[..., i])}
        lights = {channel for channel in uses if any(light in channel for light in ADDITIVE)}
        beauty = {channel for channel, use in uses.items() if "beauty" in use}
        self.expect(bool(changed & beauty), f"{name}: the beauty is denoised")
        self.expect(changed <= beauty | lights, f"{name}: nothing else changes: {sorted(changed - beauty - lights)}")


def main():
    if bpy:
        folder, kind = sys.argv[sys.argv.index("--") + 1:]
        render(folder, kind == "stereo")
        return
    parser = argparse.ArgumentParser(prog="blender.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--becalm", default="build/release/becalm")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        checker = Checker(os.path.abspath(asked.becalm), folder)
        for kind, views in (("mono", 1), ("stereo", 2)):
            subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python", os.path.abspath(__file__), "--",
                            folder, kind], check=True, stdout=subprocess.DEVNULL)
            checker.check_shot(kind, views)
    sys.exit(1 if checker.failed else 0)


main()
