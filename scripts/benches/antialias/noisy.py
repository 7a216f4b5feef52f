"""Noisy frames of half the size, made full-size and calm: the orders of `becalm antialias --scale 2` and `becalm denoise` beside full-size frames of a quarter of
the samples a pixel, so that all trace as many. Called by `scripts/bench antialias --noisy`."""

import sys

from benches.antialias.shots import read
from benches.antialias.upsample import per_frame
from benches.frame_errors import rel_mse, temporal_error
from benches.kept_frames import render_missing
from benches.markdown_report import markdown
from benches.scene_text import scene_text

CHOOSING = ("courtyard", "spheres")
REPORTED = ("fence", "classroom", "blocks")
REFERENCE_SPP, REFERENCE_SEEDS = 128, {"a": 1001, "b": 1002}
AOVS = "albedo,normal,depth,motion,variance"
EACH = ["--segment", "1", "--warmup", "0"]  # of denoise: every frame by itself
# The variance that scaled frames pass on is that of their samples, not their own.
SCALED = ["antialias", "--scale", "2"]
SCALED_DENOISED = ["denoise", *EACH, "--layers", "variance=none"]
RECIPES = {  # name: size over the output's, samples a pixel, commands
    "full size, denoised": (1, 1, [["denoise"]]),
    "full size, denoised by final": (1, 1, [["denoise", "--preset", "final"]]),
    "half, denoised, scaled": (1 / 2, 4, [["denoise"], SCALED]),
    "half, each frame denoised, scaled": (1 / 2, 4, [["denoise", *EACH], SCALED]),
    "the same, of twice the samples": (1 / 2, 8, [["denoise", *EACH], SCALED]),
    "half, scaled, each frame denoised": (1 / 2, 4, [SCALED, SCALED_DENOISED]),
    "half, scaled, each frame denoised, antialiased": (1 / 2, 4, [SCALED, SCALED_DENOISED, ["antialias"]]),
}


def render(becalm, scene, folder, frames, size, spp, cycle, aovs, seed):
    """Renders the frames that are not there yet into folder/f.####.exr, of the scene with its own light; returns the command and its options. `cycle` is the jitter's."""
    text = scene_text(scene)
    text["film"] |= {"width": size[0], "height": size[1], "jitter_cycle": cycle, "jitter_one_a_frame": cycle > 0}
    options = ["--spp", str(spp), "--seed", str(seed), "--aovs", aovs]
    return render_missing(becalm, text, folder, range(1, frames + 1), options)[0]


def measure(becalm, root, scenes, size, frames):
    """Yields (scene, recipe, seconds of render, seconds of filters, relMSE, temporal error)."""
    numbers = range(1, frames + 1)
    for scene in scenes:
        folder = root / scene
        references = []
        for name, seed in REFERENCE_SEEDS.items():
            render(becalm, scene, folder / name, frames, size, REFERENCE_SPP, 0, AOVS, seed)
            references.append([read(folder / name, frame) for frame in numbers])
        for number, (recipe, (share, spp, commands)) in enumerate(RECIPES.items()):
            source = folder / f"{spp}spp"
            small = tuple(round(share * side) for side in size)
            command = render(becalm, scene, source, frames, small, spp, 0 if share == 1 else 64, AOVS, spp)
            render_s = per_frame(command, frames)
            filter_s = 0.0
            for step, (name, *options) in enumerate(commands):
                target = folder / f"recipe{number}.{step}"
                filter_s += per_frame([becalm, name, source / "f.####.exr", "-o", target / "f.####.exr", *options], frames, "--context", "none")
                source = target
            test = [read(source, frame) for frame in numbers]
            yield scene, recipe, render_s, filter_s, rel_mse(*references, test), temporal_error(*references, test)


def table(becalm, root, scenes, size, frames):
    rows = []
    for scene, recipe, render_s, filter_s, error, change in measure(becalm, root, scenes, size, frames):
        rows.append([scene, recipe, f"{render_s:.3f}", f"{filter_s:.3f}", f"{error:.4f}", f"{change:.4f}"])
        print(*rows[-1], file=sys.stderr, flush=True)
    return markdown(["scene", "recipe", "render, s", "filters, s", "relMSE", "temporal error"], rows)
