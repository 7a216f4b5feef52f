#!/usr/bin/env python3
"""Renders random animated shots with becalm as training data for a denoiser: noisy frames with features, and references.

A shot is a pure function of its seed. Its folder, OUT/becalm-SEED6, holds scene.json, noisy frames at two sample counts
(nSPP.FRAME.exr), two independent references a frame (r_a and r_b) and, last of all, shot.json: a run skips the shots
that have one. Meshes and textures are shared, in OUT/assets.
"""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

import becalm_meshes
import becalm_textures
from becalm_scene import LAST_FRAME, make_scene, scale_light
from noise_levels import MOST_FAILED, evenly_spread, noise_levels, reference_samples

MOST_ATTEMPTS = 20
PROBE_SIZE, PROBE_SPP = "64x36", 16
# The relative variance of one sample predicts that of the references within a factor of 2.
MOST_NOISE = 6.0  # more, and references of any affordable sample count are noise themselves
REFERENCE_SPP_PER_NOISE, FEWEST_REFERENCE_SPP = 20, 16
LEAST_DETAIL = 0.06  # mean step of normals and albedo between pixels of a probe


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="folder of the shots and of their assets")
    parser.add_argument("--seeds", required=True, help="such as 0-149 or 7")
    parser.add_argument("--frames", type=int, default=4, help="frames of each shot to render, from its first")
    parser.add_argument("--references", type=int, default=4,
                        help="how many of those frames, evenly spread, get references and a second level of noise")
    parser.add_argument("--reference-spp", type=int, default=64,
                        help="most samples per pixel of each of the two references; calm shots take fewer, down to 16, "
                             "those with clean noisy frames more, up to 128")
    parser.add_argument("--size", default="256x144")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--becalm", type=Path, default=Path("build/release/becalm"))
    arguments = parser.parse_args()
    if not 1 <= arguments.frames <= LAST_FRAME:
        parser.error(f"--frames: 1 to {LAST_FRAME}, not {arguments.frames}")
    if not 0 <= arguments.references <= arguments.frames:
        parser.error(f"--references: 0 to {arguments.frames}, not {arguments.references}")
    arguments.numbers = range(1, arguments.frames + 1)
    return arguments


def frame_list(numbers):
    return ",".join(map(str, numbers))


def make_assets(folder):
    """The shared library; made once, renamed into place when whole."""
    if not folder.is_dir():
        partial = folder.with_name(folder.name + ".partial")
        becalm_meshes.make_library(partial / "meshes", 60)
        becalm_textures.make_library(partial / "textures", colors=42, grays=16, masks=6, normals=6, environments=16)
        partial.rename(folder)
    return {"meshes": json.loads((folder / "meshes/meshes.json").read_text()),
            "textures": json.loads((folder / "textures/textures.json").read_text())}


def render(arguments, scene, pattern, frames, spp, seed, aovs, size, *more):
    command = [arguments.becalm, "render", scene, "-o", pattern, "--frames", frames, "--spp", spp, "--seed", seed,
               "--aovs", aovs, "--size", size, "--threads", arguments.threads, "--quiet", *more]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit status {done.returncode}")


def read_layers(path):
    file = oiio.ImageInput.open(str(path))
    if not file:
        raise RuntimeError(f"{path}: {oiio.geterror()}")
    names = file.spec().channelnames
    pixels = file.read_image(0, 0, 0, len(names), "float")
    file.close()
    if pixels is None:
        raise RuntimeError(f"{path}: unreadable")
    return dict(zip(names, np.moveaxis(pixels, -1, 0)))


def typical_level(luminance):
    """The mean without the brightest hundredth."""
    return np.minimum(luminance, np.percentile(luminance, 99)).mean()


def sample_noise(layers):
    """Mean relative variance of one sample of a probe."""
    luminance = (layers["R"] + layers["G"] + layers["B"]) / 3
    variance = (layers["variance.R"] + layers["variance.G"] + layers["variance.B"]) / 3
    return float((PROBE_SPP * variance / (luminance**2 + (0.1 * typical_level(luminance)) ** 2)).mean())


def fault(layers, scene):
    """Why a probe frame is no use, or None."""
    luminance = (layers["R"] + layers["G"] + layers["B"]) / 3
    depth = layers["depth.Z"]
    hit = np.isfinite(depth)
    if not np.isfinite(luminance).all() or luminance.max() <= 0:
        return "black"
    # In units of what a lit part of the frame has; few samples of narrow light are mostly black, and useful.
    if (luminance > 0.02 * np.percentile(luminance, 97)).mean() < 0.3:
        return "mostly black"
    if hit.mean() < 0.25:
        return "mostly empty"
    keys = scene["camera"]["look_at"]["keys"]
    distance = np.linalg.norm(np.subtract(keys[0]["eye"], keys[0]["target"]))
    if (depth < 0.06 * distance).mean() > 0.1 or np.median(depth[hit]) < 0.12 * distance:
        return "the camera is inside or too close to something"
    features = np.stack([layers[f"normal.{c}"] for c in "XYZ"] + [layers[f"albedo.{c}"] for c in "RGB"])
    if np.abs(np.diff(features, axis=1)).mean() + np.abs(np.diff(features, axis=2)).mean() < LEAST_DETAIL:
        return "too plain"
    if sample_noise(layers) > MOST_NOISE:
        return "too noisy"
    return None


def choose_scene(arguments, folder, seed, assets, exposure):
    """Writes the first scene of the seed whose first and last frames are of use, its light scaled to that exposure
    (the typical luminance), and returns the facts of it."""
    width, height = map(int, arguments.size.split("x"))
    path = folder / "scene.json"
    why = None
    for attempt in range(MOST_ATTEMPTS):
        scene, facts = make_scene(seed, attempt, assets, width, height)
        path.write_text(json.dumps(scene))
        frames = sorted({1, arguments.numbers[-1]})
        render(arguments, path, folder / "probe.####.exr", frame_list(frames), PROBE_SPP, 1, "albedo,normal,depth,variance",
               PROBE_SIZE, "--type=float")
        probes = [read_layers(folder / f"probe.{frame:04d}.exr") for frame in frames]
        for frame in frames:
            (folder / f"probe.{frame:04d}.exr").unlink()
        why = next(filter(None, (fault(probe, scene) for probe in probes)), None)
        if why is None:
            scale_light(scene, exposure / typical_level((probes[0]["R"] + probes[0]["G"] + probes[0]["B"]) / 3))
            path.write_text(json.dumps(scene, indent=1))
            return {**facts, "attempt": attempt, "sample_noise": round(max(map(sample_noise, probes)), 3)}
    raise RuntimeError(f"no scene of use in {MOST_ATTEMPTS} attempts, the last was {why}")


def make_shot(arguments, seed, assets):
    folder = arguments.out / f"becalm-{seed:06d}"
    if (folder / "shot.json").exists():
        return None
    folder.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    rng = np.random.default_rng([seed, 0x4C564C53])
    aov_style = [None, 16, 64][seed % 3]
    exposure = 0.2 * 10 ** rng.uniform(-2, 2)
    facts = choose_scene(arguments, folder, seed, assets, exposure)
    wanted = 8 * int(np.ceil(REFERENCE_SPP_PER_NOISE * facts["sample_noise"] / 8))
    spp = noise_levels(facts["sample_noise"], rng.random)
    reference_spp = reference_samples(spp, min(max(wanted, FEWEST_REFERENCE_SPP), arguments.reference_spp))
    scene = folder / "scene.json"
    referenced = evenly_spread(arguments.numbers, arguments.references)
    for level, samples in enumerate(spp):
        aovs = "albedo,normal,depth,variance" + (",half_a,half_b" if samples >= 2 else "")
        frames = referenced if level > 0 else arguments.numbers
        render(arguments, scene, folder / f"n{samples:03d}.####.exr", frame_list(frames), samples, 1000 * seed + level + 1, aovs,
               arguments.size, "--aov-spp", aov_style or samples, "--type=float")
    if referenced:
        for level, name in enumerate(("r_a", "r_b")):
            render(arguments, scene, folder / f"{name}.####.exr", frame_list(referenced), reference_spp,
                   1000 * seed + 500 + level, "albedo,normal,depth", arguments.size)
    width, height = map(int, arguments.size.split("x"))
    shot = {"renderer": "becalm", "seed": seed, "width": width, "height": height, "frames": arguments.frames,
            "references": referenced, "reference_spp": reference_spp, "spp": spp,
            "aov_spp": [max(aov_style or samples, samples) for samples in spp], "exposure": round(float(exposure), 6), **facts,
            "seconds": round(time.monotonic() - start, 1)}
    partial = folder / "shot.json.partial"
    partial.write_text(json.dumps(shot, indent=1))
    partial.rename(folder / "shot.json")
    return shot


def main():
    arguments = read_arguments()
    first, _, last = arguments.seeds.partition("-")
    assets = make_assets(arguments.out / "assets")
    failed = 0
    for seed in range(int(first), int(last or first) + 1):
        try:
            shot = make_shot(arguments, seed, assets)
        except Exception as error:  # one bad shot must not end a run of hours
            print(f"seed {seed}: failed: {error}", file=sys.stderr, flush=True)
            failed += 1
            continue
        if shot:
            print(f"seed {seed}: {shot['layout']}, spp {shot['spp']}, attempt {shot['attempt']}, {shot['seconds']} s", flush=True)
    if failed > MOST_FAILED * (int(last or first) + 1 - int(first)):
        sys.exit(f"{failed} shots failed")


if __name__ == "__main__":
    main()
