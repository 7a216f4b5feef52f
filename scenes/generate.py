#!/usr/bin/python3
"""Writes scenes/meshes, scenes/textures, and the scenes blocks, classroom and spheres. The same bytes come out every time; they are
committed, so that rendering needs no Python."""

from pathlib import Path

from generator import blocks, classroom, courtyard, crossing, dining, fence, meadow, ocean, penumbra, sky, slab, spheres, texture
from generator.files import write_exr, write_indexed_png, write_obj

HERE = Path(__file__).resolve().parent
TEXTURES = {
    "parquet": texture.parquet, "plaster": texture.plaster, "bricks": texture.bricks, "cobbles": texture.cobbles,
    "rug": texture.rug, "painting": texture.painting, "mosaic": texture.mosaic,
    "gingham": texture.gingham, "truchet": texture.truchet, "twig": texture.twig, "twig_mask": texture.twig_mask,
    **fence.TEXTURES, **blocks.TEXTURES,
}
SCENES = (penumbra, blocks, classroom, crossing, courtyard, dining, fence, meadow, ocean, slab, spheres)


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
    for scene in (blocks, classroom, spheres):
        scene.write_scene(HERE / f"{scene.__name__.rpartition('.')[2]}.json")


if __name__ == "__main__":
    main()
