"""Pairs of consecutive frames of our scenes, rendered by becalm and kept between runs."""

import functools
import subprocess
from pathlib import Path

import numpy as np

from benches.align.pair import Pair
from benches.align.warp import nearest
from benches.made_of import keep_if_same
from pictures.files import read_layers

SCENES = Path(__file__).resolve().parents[3] / "scenes"
SOURCE, TARGET = 10, 11  # in the middle of the animations
AOVS = ["albedo", "normal", "depth", "motion", "object_id"]
MATCHED_AOVS = ["albedo", "normal"]
NOISY_SEED, OTHER_NOISY_SEED = 0, 1
REFERENCE_SEED = 101  # of the first batch; a reference is the mean of batches, so that a later run can add samples
BATCH_SPP = 64
SAME_DEPTH = 0.1      # largest relative difference between two depths of one surface


class Renders:
    def __init__(self, becalm, folder, size):
        self.becalm, self.size = becalm, size
        self.folder = Path(folder) / size

    def frames(self, scene, spp, seed):
        """Layers of source and target. Renders them unless this program has rendered them of this scene."""
        scene_file, folder = SCENES / f"{scene}.json", self.folder / scene
        name = f"{spp}spp.seed{seed}"
        paths = [folder / f"{name}.{number:04d}.exr" for number in (SOURCE, TARGET)]
        keep_if_same(folder, self.becalm, scene=scene_file.read_text(), aovs=AOVS)
        if not all(path.exists() for path in paths):
            print(f"render {scene} {self.size}, {spp} spp, seed {seed}", flush=True)
            subprocess.run([self.becalm, "render", scene_file, "-o", folder / f"{name}.####.exr",
                            "--frames", f"{SOURCE}-{TARGET}", "--size", self.size, "--spp", str(spp), "--seed", str(seed),
                            "--type=float", "--quiet", "--aovs", ",".join(AOVS)], check=True)
        return [_named(read_layers(path)) for path in paths]

    @functools.lru_cache(maxsize=1)  # callers take all pairs of one scene before the next scene
    def reference(self, scene, spp):
        """Layers of source and target, whose beauty is the mean of batches; then for both, two independent halves of the beauty."""
        batches = [self.frames(scene, BATCH_SPP, REFERENCE_SEED + i) for i in range(spp // BATCH_SPP)]
        halves = [[np.mean([frames[i]["beauty"] for frames in batches[first::2]], axis=0) for first in (0, 1)] for i in (0, 1)]
        for frame, (a, b) in zip(batches[0], halves):
            frame["beauty"] = 0.5 * (a + b)
        return (*batches[0], *halves)

    def pair(self, scene, spp, reference_spp):
        source, target = self.frames(scene, spp, NOISY_SEED)
        other_source, other_target = self.frames(scene, spp, OTHER_NOISY_SEED)
        clean_source, clean_target, halves_source, halves_target = self.reference(scene, reference_spp)
        return Pair(name=scene, noise=f"{spp} spp", target=target, source=source, other_target=other_target["beauty"],
                    other_source=other_source["beauty"], clean_target=clean_target["beauty"], clean_source=clean_source["beauty"],
                    halves_target=halves_target, halves_source=halves_source, visible=visible_pixels(clean_target, clean_source),
                    motion=clean_target["motion"], aovs=MATCHED_AOVS)


def _named(layers):
    layers["beauty"] = layers.pop("")[..., :3]
    return {name: np.ascontiguousarray(layer, np.float32) for name, layer in layers.items()}


def visible_pixels(target, source):
    """Pixels whose motion vector leads to the same object at about the same depth in the source."""
    object_there, inside = nearest(source["object_id"][..., 0], target["motion"])
    depth_there, _ = nearest(source["depth"][..., 0], target["motion"])
    depth = target["depth"][..., 0]
    with np.errstate(invalid="ignore"):
        same_depth = np.abs(depth_there - depth) <= SAME_DEPTH * depth
    both_miss = ~np.isfinite(depth) & ~np.isfinite(depth_there)
    return inside & (object_there == target["object_id"][..., 0]) & (same_depth | both_miss)
