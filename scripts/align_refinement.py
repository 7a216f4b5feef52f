"""Subpixel refinement off, on every level, on the two finest: jitter of a slow disc (the paper's figure 15)."""

import numpy as np

import align_pictures as pictures
from align_report import figure, markdown
from align_synthetic import Disc, noisy
from demo_pictures import write_picture
from picture_panel import panel

SHAPE = (512, 512)
NOISE = 0.02
MOTION_PX = 0.3  # a frame
PAIRS = 8
REFINED_LEVELS = {"off": 0, "every level": 12, "two finest": 2}
# The paper's patches of 5x5 at its factor, and our default ones.
BASES = {"radius 2, factor 4": ["pyramid_factor=4", "pyramid_levels=4", "blur_radius=2"], "default": []}
EDGE_PX = 2.0  # on either side; what moves there can be seen


def jitter(found, disc):
    """Of the offsets of consecutive pairs: motion and its deviation from pair to pair.

    Inside the disc in whole, along its edge across it alone: nothing shows motion along an edge.
    """
    first, normal = disc.from_edge(0.0)
    last, _ = disc.from_edge(PAIRS * MOTION_PX)
    inside = found[:, (first < 0.0) & (last < 0.0)]
    edge = (np.abs(first) < EDGE_PX) & (np.abs(last) < EDGE_PX)
    across = (found[:, edge] * normal[edge]).sum(axis=-1)
    true_across = MOTION_PX * normal[edge][:, 0]
    return {"mean_px": float(inside[..., 0].mean()), "jitter_px": float(np.hypot(*inside.std(axis=0).T).mean()),
            "epe_px": float(np.hypot(inside[..., 0] - MOTION_PX, inside[..., 1]).mean()),
            "across_error_px": float(np.abs(across - true_across).mean()), "across_jitter_px": float(across.std(axis=0).mean())}


def run(aligners, report, folder):
    rows, images = [], []
    for textured in (False, True):
        disc = Disc(SHAPE, textured)
        frames = [noisy(disc.plane(MOTION_PX * i), NOISE, i) for i in range(PAIRS + 1)]
        for base, settings in BASES.items():
            for name, levels in REFINED_LEVELS.items():
                settings_of_run = [*settings, "match_downsample=1", f"refine_levels={levels}"]
                found = np.stack([aligners.align_planes(frames[i], frames[i + 1], settings_of_run)[0] for i in range(PAIRS)])
                texture = "textured" if textured else "flat"
                rows.append({"disc": texture, "base": base, "refined": name} | jitter(found, disc))
                images.append([(f"{texture}, {base}, refined: {name}, pair {i}", pictures.flow(found[i], 3 * MOTION_PX)) for i in (0, 1)])
    half = len(images) // 2
    write_picture(folder / "refinement.png", panel([a + b for a, b in zip(images[:half], images[half:])]))
    table = markdown(("disc", "settings", "refined", "mean motion px", "jitter px", "EPE px", "error across the edge px", "jitter across the edge px"),
                     [(r["disc"], r["base"], r["refined"], *(figure(r[k], 3) for k in (
                         "mean_px", "jitter_px", "epe_px", "across_error_px", "across_jitter_px"))) for r in rows])
    report.add("refinement", f"Figure 15: refinement, disc moving {MOTION_PX} px a frame, {100 * NOISE:g} % noise; "
               f"jitter: standard deviation over {PAIRS} pairs", table + "\n![](refinement.png)\n", rows)
