"""Shots of one jittered sample a pixel and almost no noise, and references of many samples.

A scene is rendered by direct light of a sun without penumbra alone, and lit besides by an ambient term that is its albedo times a
constant: as a rasterizer would show it. What is left of a sample's error is aliasing."""

import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.kept_frames import render_missing
from benches.scene_text import scene_text

REPORTED = ("fence", "classroom", "blocks", "meadow")
CHOOSING = ("courtyard", "courtyard_sun", "spheres")  # what settings are chosen on; courtyard_sun: still, but for its shadows
AMBIENT = np.array([0.22, 0.26, 0.33], np.float32)
SUN = [2.4, 2.2, 1.9]
CYCLE = 16


def variant(scene, cycle, size):
    """The scene of this name with nothing in it that needs more than one sample but edges and textures."""
    name, moving_sun, _ = scene.partition("_sun")
    text = scene_text(name)
    text.pop("environment", None)
    text["integrator"] = text.get("integrator", {}) | {"max_depth": 1}
    text["film"] |= {"width": size[0], "height": size[1], "jitter_cycle": cycle}
    for key in ("shutter", "aperture_radius", "focus_distance", "blades", "blade_rotation_deg"):
        text["camera"].pop(key, None)
    suns = [light for light in text.get("lights", {}).values() if light["type"] == "sun"]
    sun = suns[0] if suns else {"type": "sun", "azimuth_deg": -50, "elevation_deg": 48}
    text["lights"] = {"sun": sun | {"diameter_deg": 0, "irradiance": SUN}}
    if moving_sun:
        keys = [{"frame": 1, "value": -75}, {"frame": 24, "value": -40}]
        text["lights"]["sun"] |= {"azimuth_deg": {"interpolation": "linear", "keys": keys}}
        look = text["camera"]["look_at"]
        text["camera"]["look_at"] = {key: value for key, value in look.get("keys", [look])[0].items() if key != "frame"}
    text["objects"] = [thing for thing in text["objects"] if "interior" not in thing]  # media are noise
    for thing in text["objects"]:
        thing.pop("emission", None)
    return text


def add_ambient(path):
    """Adds the albedo times the ambient light to the beauty of a file, and drops the albedo."""
    image = oiio.ImageBuf(str(path))
    names = list(image.spec().channelnames)
    pixels = image.get_pixels(oiio.FLOAT)
    albedo = [names.index(f"albedo.{c}") for c in "RGB"]
    for c, source in zip("RGB", albedo):
        pixels[..., names.index(c)] += AMBIENT["RGB".index(c)] * pixels[..., source]
    kept = [i for i in range(len(names)) if i not in albedo]
    spec = oiio.ImageSpec(image.spec())
    spec.nchannels = len(kept)
    spec.channelnames = tuple(names[i] for i in kept)
    spec.channelformats = ()
    spec.format = oiio.FLOAT
    lit = oiio.ImageBuf(spec)
    lit.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels[..., kept]))
    partial = Path(f"{path}.partial.exr")
    if not lit.write(str(partial), oiio.FLOAT):
        raise OSError(f"{partial}: {lit.geterror()}")
    partial.replace(path)


def render(becalm, scene, folder, frames, size, spp, cycle, options=()):
    """Renders the frames that are not there yet into folder/f.####.exr. `cycle` is the jitter's, 0 for none."""
    aovs = "albedo,depth,motion" if cycle else "albedo"
    options = ["--spp", str(spp), "--aov-spp", str(spp), "--aovs", aovs, *options]
    _, rendered = render_missing(becalm, variant(scene, cycle, size), folder, frames, options, "made")
    for frame in rendered:
        made = folder / f"made.{frame:04}.exr"
        add_ambient(made)
        made.replace(folder / f"f.{frame:04}.exr")


def antialias(becalm, source, target, options):
    subprocess.run([becalm, "antialias", source / "f.####.exr", "-o", target / "f.####.exr", *options, "--overwrite", "--quiet"], check=True)


def read(folder, frame):
    """The beauty's colours."""
    image = oiio.ImageBuf(str(folder / f"f.{frame:04}.exr"))
    names = list(image.spec().channelnames)
    return image.get_pixels(oiio.FLOAT)[..., [names.index(c) for c in "RGB"]]
