"""Small against large patches under noise, on a moving disc (the paper's figure 6)."""

import numpy as np

import align_pictures as pictures
from align_report import figure, markdown
from align_synthetic import Disc, noisy
from demo_pictures import write_picture
from picture_panel import panel

SHAPE = (512, 512)
MOTION_PX = 20.0
RADII = {"small": "2,2,2,2", "large": "32,16,8,8"}
SETTINGS = ["match_downsample=1", "pyramid_factor=4", "pyramid_levels=4", "refine_levels=2"]


def run(aligners, report, folder):
    disc = Disc(SHAPE)
    truth = disc.truth(0.0, MOTION_PX)
    on_disc = truth[..., 0] > 0.0
    rows, images = [], []
    for sigma in (0.02, 0.1):
        target, source = (noisy(disc.plane(x), sigma, seed) for x, seed in ((0.0, 1), (MOTION_PX, 2)))
        images.append((f"frame, {100 * sigma:g} % noise", pictures.plane(target)))
        for name, radii in RADII.items():
            offset, _ = aligners.align_planes(target, source, [*SETTINGS, f"blur_radius={radii}"])
            error = np.hypot(*np.moveaxis(offset - truth, -1, 0))
            rows.append({"noise": sigma, "radii": radii, "disc": float(error[on_disc].mean()), "ground": float(error[~on_disc].mean())})
            images.append((f"{100 * sigma:g} %, radii {radii}", pictures.flow(offset, MOTION_PX)))
    write_picture(folder / "radii.png", panel([[*images[:3], ("truth", pictures.flow(truth, MOTION_PX))], images[3:]]))
    table = markdown(("noise", "radii, finest first", "EPE on the disc px", "EPE on the ground px"),
                     [(f"{100 * r['noise']:g} %", r["radii"], figure(r["disc"], 2), figure(r["ground"], 2)) for r in rows])
    report.add("radii", f"Figure 6: patch radii, disc moving {MOTION_PX:g} px, factor 4, 4 levels", table + "\n![](radii.png)\n", rows)
