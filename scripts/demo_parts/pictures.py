"""The demo's pictures: PNG files beside the page, and JPEG inside it."""

import numpy as np

from pictures.colours import display, map_colours, map_ramp, offset_colours, offset_wheel
from pictures.files import jpeg_uri, read_layers, write_picture

FLOW_PERCENTILE = 99.0  # of the flow's lengths: full colour, so that a few stray vectors do not dim the others


def strip(noisy, denoised, reference, gap_px=4):
    """One picture of the frame in three bands, each from its own version, with light lines between."""
    width = noisy.shape[1]
    picture = np.concatenate([noisy[:, : width // 3], denoised[:, width // 3 : 2 * width // 3],
                              reference[:, 2 * width // 3 :]], axis=1)
    for edge in (width // 3, 2 * width // 3):
        picture[:, edge - gap_px // 2 : edge + gap_px // 2] = 0.9
    return picture


def make_pictures(path_of, out, frames, measured):
    """Writes out/pictures/*.png; returns them as data URIs by kind and frame, with the legends and the flow's scale."""
    folder = out / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    noisy = {f: read_layers(path_of("noisy", f)) for f in frames}
    denoised = {f: read_layers(path_of("denoised", f)) for f in frames}
    lengths = np.concatenate([np.hypot(*np.moveaxis(denoised[f]["flow"], -1, 0)).ravel() for f in frames])
    scale_px = max(1.0, float(np.ceil(np.percentile(lengths, FLOW_PERCENTILE))))

    kinds = {"noisy": {}, "denoised": {}, "reference": {}, "flow": {}, "error_mask": {}}
    for f in frames:
        kinds["noisy"][f] = display(noisy[f][""])
        kinds["denoised"][f] = display(denoised[f][""])
        kinds["flow"][f] = offset_colours(denoised[f]["flow"], scale_px)
        kinds["error_mask"][f] = map_colours(denoised[f]["error_mask"][..., 0])
    for f in measured:
        halves = [read_layers(path_of(f"reference_{half}", f))[""] for half in "ab"]
        kinds["reference"][f] = display((halves[0] + halves[1]) / 2)

    last = measured[-1]
    write_picture(folder / "strip.jpg", strip(*(kinds[kind][last] for kind in ("noisy", "denoised", "reference"))))

    uris = {}
    for kind, pictures in kinds.items():
        for f, colours in pictures.items():
            write_picture(folder / f"{kind}.{f:04d}.png", colours)
        uris[kind] = {f: jpeg_uri(colours) for f, colours in pictures.items()}
    return {"kinds": uris, "wheel": jpeg_uri(offset_wheel()), "ramp": jpeg_uri(map_ramp()), "flow_scale_px": scale_px}
