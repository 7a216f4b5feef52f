"""Full against 2x2 and 4x4 matching: differences, time and memory by level and stage (the paper's figure 16, tables 1-2)."""

import numpy as np

import align_pictures as pictures
from align_report import figure, markdown
from align_renders import NOISY_SEED
from align_space import compressed, exposure, luminance
from align_stages import MIB, MODES, floor_bytes, stage_table
from align_warp import warp
from demo_pictures import write_picture
from picture_panel import panel

SCENE, SPP = "mountains", 4
RUNS = 5
SETTINGS = ["blur_radius=2"]  # 5x5 patches, as the paper's figure 1 and its tables
CROP = (slice(300, 660), slice(640, 1280))  # of the pictures


def run(aligners, renders, report, folder):
    source, frame = (layers["beauty"] for layers in renders.frames(SCENE, SPP, NOISY_SEED))
    height, width = frame.shape[:2]
    scale = exposure(frame)
    target_plane, source_plane = (compressed(luminance(image), scale) for image in (frame, source))
    rows, blends, tables = [], {}, []
    for mode, downsample in MODES.items():
        aligner = aligners.get((width, height), [*SETTINGS, f"match_downsample={downsample}"], input="plane")
        aligner.load({"plane": target_plane}, {"plane": source_plane})
        report_of_run = aligner.run(RUNS)
        offset, _ = aligner.result()
        blends[mode] = 0.5 * (frame + warp(source, offset))
        of_full = float(np.abs(compressed(blends[mode], scale) - compressed(blends["full"], scale)).mean())
        rows.append({"mode": mode, "device_ms": report_of_run["device_ms"], "average_from_full": of_full,
                     "device_mib": aligner.built["device_bytes"] / MIB,
                     "unaliased_mib": aligner.built["device_bytes_unaliased"] / MIB,
                     "moved_mib": sum(p["image_bytes"] for p in report_of_run["passes"]) / MIB,
                     "floor_mib": floor_bytes(width, height, downsample) / MIB, "passes": report_of_run["passes"]})
        tables.append(f"### {mode}: milliseconds by level and stage\n\n" + stage_table(report_of_run["passes"])
                      + f"\n### {mode}: MiB of the images that each stage binds\n\n"
                      + stage_table(report_of_run["passes"], "image_bytes", 1 / MIB))
    difference = pictures.difference(blends["full"], blends["2x2"], frame)
    write_picture(folder / "downsampling.png", panel([
        [("50/50 average, full", pictures.shown(blends["full"], frame)[CROP]), ("2x2", pictures.shown(blends["2x2"], frame)[CROP]),
         (f"difference x{pictures.DIFFERENCE_GAIN:g}", difference[CROP])]]))
    table = markdown(("matching", "device ms", "50/50 average, diff. from full", "MiB held", "unaliased", "bound by passes", "floor"),
                     [(r["mode"], figure(r["device_ms"], 1), figure(r["average_from_full"], 5),
                       *(figure(r[k], 1) for k in ("device_mib", "unaliased_mib", "moved_mib", "floor_mib"))) for r in rows])
    report.add("downsampling", f"Figure 16, tables 1 and 2: `{SCENE}` at {width}x{height}, {SPP} spp, luminance, 5x5 patches, "
               f"medians of {RUNS} runs on {aligner.device['name']}", table + "\n![](downsampling.png)\n\n" + "\n".join(tables), rows)
