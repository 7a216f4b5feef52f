"""Stereo shots: scenes of scenes/ with an eye separation, few samples, and references of many."""

import numpy as np
import OpenImageIO as oiio

from benches.kept_frames import render_missing
from benches.scene_text import scene_text, with_absolute_paths

REPORTED = ("spheres", "statue")
CHOOSING = ("courtyard", "dining")  # what constants are chosen on
SEPARATION = {"spheres": 0.13, "statue": 0.065, "courtyard": 0.065, "dining": 0.065}  # of the eyes; spheres are twice as large
EYES = ("left", "right")


def statue():
    """A bronze on a pedestal above a glossy ground, under a lamp and a sky."""
    return {
        "frames": {"first": 1, "last": 24, "rate": 24},
        "film": {"width": 640, "height": 360},
        "integrator": {"max_depth": 5},
        "camera": {"fov_y_deg": 34, "look_at": {"interpolation": "smooth", "keys": [
            {"frame": 1, "eye": [-0.7, 1.0, 2.3], "target": [0, 0.55, 0]}, {"frame": 24, "eye": [-0.25, 1.05, 2.4], "target": [0, 0.55, 0]}]}},
        "environment": {"radiance": [0.22, 0.27, 0.36]},
        "materials": {
            "ground": {"type": "principled", "base_color": {"image": "textures/paving.png", "repeat": [3, 3]}, "roughness": 0.12, "ior": 1.5},
            "marble": {"type": "principled", "base_color": [0.75, 0.71, 0.66], "roughness": 0.35},
            "bronze": {"type": "conductor", "reflectance": [0.72, 0.5, 0.28], "roughness": 0.18},
            "lamp": {"type": "diffuse", "reflectance": 0}},
        "meshes": {
            "plane": {"shape": "rectangle"}, "cube": {"shape": "cube"},
            "bust": {"procedural": "blobs", "count": 14, "extent": 0.3, "radius": 0.12, "blend": 0.05, "seed": 5, "speed": 0}},
        "objects": [
            {"name": "ground", "mesh": "plane", "material": "ground", "transform": {"scale": 6}},
            {"name": "lamp", "mesh": "plane", "material": "lamp", "emission": [22, 19, 15],
             "transform": {"scale": 0.4, "rotate_deg": [180, 0, 0], "translate": [1.1, 2.6, 0.9]}},
            {"name": "pedestal", "mesh": "cube", "material": "marble", "transform": {"scale": [0.22, 0.2, 0.22], "translate": [0, 0.2, 0]}},
            {"name": "bust", "mesh": "bust", "material": "bronze", "transform": {"translate": [0, 0.75, 0]}}]}


def scene_of(name, size):
    text = with_absolute_paths(statue()) if name == "statue" else scene_text(name)
    text["film"] |= {"width": size[0], "height": size[1]}
    text["camera"]["eye_separation"] = SEPARATION[name]
    return text


def render(becalm, scene, folder, frames, size, options):
    """Renders the frames that are not there yet into folder/f.####.exr, both eyes as views."""
    render_missing(becalm, scene_of(scene, size), folder, frames, options)


def read(folder, frame, layer=""):
    """Both eyes' images of a layer, as {eye: pixels}."""
    path = str(folder / f"f.{frame:04}.exr")
    images = {}
    for part in range(2):
        image = oiio.ImageBuf(path, part, 0)
        names = list(image.spec().channelnames)
        wanted = [i for i, name in enumerate(names) if name.startswith(layer + ".")] if layer else [names.index(c) for c in "RGB"]
        images[image.spec().getattribute("view")] = np.ascontiguousarray(image.get_pixels(oiio.FLOAT)[..., wanted])
    return images


def attribute(folder, frame):
    """The camera as frames record it: focal length in pixels, separation, convergence."""
    text = oiio.ImageBuf(str(folder / f"f.{frame:04}.exr"), 0, 0).spec().getattribute("becalm:stereo")
    return {key: float(value) for key, value in (word.split("=") for word in text.split()[1:])}
