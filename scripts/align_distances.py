"""The four distances on fast spheres with depth of field, motion blur and soft shadows (the paper's figure 5)."""

import cv2
import numpy as np

import align_pictures as pictures
from align_measure import measure
from align_report import figure, markdown
from align_warp import warp
from demo_pictures import write_picture
from picture_panel import panel

SCENE, SPP = "spheres", 4
DISTANCES = ("l2", "l1", "log_l1", "log_l1_centered")
ALPHA = 0.9
# The mask is 0 up to the typical patch distance and 1 at a high one: each distance has its own scale.
ETA_PERCENTILE, FULL_PERCENTILE = 50, 95
BOX_SIGMAS = 1.0  # of variance clipping


def mask_of(residual, size):
    """m = kappa eps - eta, clamped, at full resolution."""
    low, high = np.percentile(residual, [ETA_PERCENTILE, FULL_PERCENTILE])
    mask = np.clip((residual - low) / max(high - low, 1e-9), 0.0, 1.0)
    return cv2.resize(mask.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)


def detection(mask, disoccluded):
    """Chance that a disoccluded pixel has a higher mask than a visible one (area under the ROC curve)."""
    order = np.concatenate([mask[disoccluded], mask[~disoccluded]])
    _, inverse, counts = np.unique(order, return_inverse=True, return_counts=True)
    rank = (np.cumsum(counts) - (counts - 1) / 2.0)[inverse]  # ties share the mean of their ranks
    n = int(disoccluded.sum())
    return float((rank[:n].sum() - n * (n + 1) / 2) / (n * (order.size - n)))


def unsteadiness(offset):
    """Mean length of the offset's differences between neighbours, in pixels."""
    return float(np.mean([np.hypot(*np.moveaxis(np.diff(offset, axis=axis), -1, 0)).mean() for axis in (0, 1)]))


def variance_clipped(history, frame):
    """The usual rejection of temporal antialiasing: history clamped to the neighbourhood's mean and deviation."""
    mean = cv2.blur(frame, (3, 3))
    deviation = np.sqrt(np.maximum(cv2.blur(frame * frame, (3, 3)) - mean * mean, 0.0))
    return np.clip(history, mean - BOX_SIGMAS * deviation, mean + BOX_SIGMAS * deviation)


def blend(frame, history, mask):
    alpha = np.clip(ALPHA * (1.0 - mask), 0.0, 1.0)[..., None]
    return (1.0 - alpha) * frame + alpha * history


def run(aligners, renders, report, folder, reference_spp):
    pair = renders.pair(SCENE, SPP, reference_spp)
    frame = pair.target["beauty"]
    rows, blends, masks, flows = [], [], [], []
    scale_px = float(np.percentile(np.hypot(*np.moveaxis(pair.motion, -1, 0)), 95))
    for distance in DISTANCES:
        # 2x2 matching: its finest level is the first downsampled one, whose mask the paper takes under noise.
        offset, residual, _ = aligners.align_pair(pair, [f"distance={distance}", "match_downsample=2"], preset="final")
        mask = mask_of(residual, pair.size)
        history = warp(pair.source["beauty"], offset)
        measured = measure(pair, offset)
        rows.append({"distance": distance, "clean": measured["clean"], "clean_visible": measured["clean_visible"],
                     "rejected": float(mask.mean()), "detection": detection(mask, ~pair.visible),
                     "unsteadiness_px": unsteadiness(offset)})
        blends.append((f"blended, {distance}", pictures.shown(blend(frame, history, mask), frame)))
        masks.append((f"mask, {distance}", pictures.mask(mask)))
        flows.append((f"offsets, {distance}", pictures.flow(offset, scale_px)))
    all_accepted = blend(frame, history, np.zeros(mask.shape))
    box = blend(frame, variance_clipped(history, frame), np.zeros(mask.shape))
    shown = [("noisy frame", frame), ("blended, nothing rejected", all_accepted), ("blended, variance clipping", box)]
    write_picture(folder / "distances.png", panel([
        [(text, pictures.shown(image, frame)) for text, image in shown] + [("disoccluded", pictures.mask(~pair.visible * 1.0))],
        blends, masks, flows]))
    table = markdown(("distance", "clean diff.", "not disoccluded", "mean mask", "finds disocclusion (ROC area)", "offset unsteadiness px"),
                     [(r["distance"], figure(r["clean"], 5), figure(r["clean_visible"], 5), figure(r["rejected"], 3),
                       figure(r["detection"], 3), figure(r["unsteadiness_px"], 3)) for r in rows])
    report.add("distances", f"Figure 5: distances on `{SCENE}`, {SPP} spp", table + "\n![](distances.png)\n", rows)
