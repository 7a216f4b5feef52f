"""Scenes of scenes.py as becalm's JSON."""

import json

import numpy as np
import OpenImageIO as oiio

from benches.peer.scenes import MAX_DEPTH

CHECKER_PX = 64


def write_checker(path):
    """A board of two by two squares, of one and of a quarter, in linear values."""
    square = np.kron([[1.0, 0.25], [0.25, 1.0]], np.ones((CHECKER_PX // 2, CHECKER_PX // 2)))
    image = oiio.ImageBuf(oiio.ImageSpec(CHECKER_PX, CHECKER_PX, 3, oiio.FLOAT))
    image.set_pixels(oiio.ROI(), np.repeat(square[..., None], 3, axis=2).astype(np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def _material(material):
    if material.kind == "glass":
        return {"type": "dielectric", "ior": 1.5}
    color = list(material.color)
    if material.checker:
        color = {"image": "checker.exr", "space": "linear", "repeat": [material.checker / 2] * 2, "scale": color}
    if material.kind == "diffuse":
        return {"type": "diffuse", "reflectance": color}
    return {"type": "conductor", "reflectance": color, "roughness": material.roughness}


def write_scene(scene, folder, size):
    """Writes FOLDER/scene.json and what it needs. Returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    write_checker(folder / "checker.exr")
    width, height = map(int, size.split("x"))
    objects = [{"mesh": thing.shape, "material": thing.material,
                "transform": {"scale": list(thing.scale), "rotate_deg": [0, thing.turn_deg, 0], "translate": list(thing.at)}}
               for thing in scene.things]
    objects += [{"mesh": "rectangle", "material": "lamp", "emission": lamp.radiance,
                 "transform": {"scale": [lamp.half_width, 1, lamp.half_depth], "rotate_deg": [180, 0, 0], "translate": list(lamp.at)}}
                for lamp in scene.lamps]
    for i, item in enumerate(objects):
        item["name"] = f"{item['mesh']} {i}"
    text = {"frames": {"first": 1, "last": 1}, "film": {"width": width, "height": height, "filter": {"type": "box", "radius_px": 0.5}},
            "integrator": {"max_depth": MAX_DEPTH},
            "camera": {"fov_y_deg": scene.fov_y_deg, "look_at": {"eye": list(scene.eye), "target": list(scene.target)}},
            "materials": {name: _material(material) for name, material in scene.materials.items()} | {"lamp": {"type": "diffuse", "reflectance": 0.75}},
            "meshes": {"rectangle": {"shape": "rectangle"}, "cube": {"shape": "cube"}, "sphere": {"shape": "sphere", "segments": 64}},
            "objects": objects}
    if scene.sky:
        text["environment"] = {"radiance": list(scene.sky)}
    path = folder / "scene.json"
    path.write_text(json.dumps(text, indent=1))
    return path
