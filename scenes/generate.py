#!/usr/bin/python3
"""Writes scenes/meshes, scenes/textures and scenes/spheres.json. The same bytes come out every time; they are
committed, so that rendering needs no Python."""

from pathlib import Path

from generator import courtyard, crossing, dining, fence, meadow, ocean, penumbra, sky, slab, spheres, texture
from generator.files import write_exr, write_indexed_png, write_obj

HERE = Path(__file__).resolve().parent
TEXTURES = {
    "parquet": texture.parquet, "plaster": texture.plaster, "bricks": texture.bricks, "cobbles": texture.cobbles,
    "rug": texture.rug, "painting": texture.painting, "mosaic": texture.mosaic,
    "gingham": texture.gingham, "truchet": texture.truchet, "twig": texture.twig, "twig_mask": texture.twig_mask,
    **fence.TEXTURES,
}
SCENES = (penumbra, crossing, courtyard, dining, fence, meadow, ocean, slab, spheres)


def main():
    for folder in ("meshes", "textures"):
        (HERE / folder).mkdir(exist_ok=True)
    for scene in SCENES:
        for name, make in scene.MESHES.items():
            write_obj(HERE / "meshes" / f"{name}.obj", make())
    for name, make in TEXTURES.items():
        write_indexed_png(HERE / "textures" / f"{name}.png", *make())
    write_exr(HERE / "textures" / "sky.exr", courtyard.sky())
    for name, make in sky.SKIES.items():
        write_exr(HERE / "textures" / f"{name}.exr", make())
    spheres.write_scene(HERE / "spheres.json")


if __name__ == "__main__":
    main()
