"""Pictures of the demo: EXR layers as PNG files beside the page, and as JPEG inside it."""

import base64
import os
import tempfile

import numpy as np
import OpenImageIO as oiio
from matplotlib import colormaps

FLOW_PERCENTILE = 99.0  # the flow's colour scale ends here, so that a few stray vectors do not dim the rest


def read_layers(path):
    """A dictionary of the file's layers, the beauty under ''; each (h, w, channels) in the file's channel order."""
    image = oiio.ImageBuf(str(path))
    if image.has_error:
        raise OSError(f"{path}: {image.geterror()}")
    pixels = image.get_pixels(oiio.FLOAT)
    layers = {}
    for index, name in enumerate(image.spec().channelnames):
        layers.setdefault(name.rpartition(".")[0], []).append(pixels[..., index])
    return {name: np.stack(channels, axis=-1) for name, channels in layers.items()}


def display(radiance):
    """Linear radiance for the screen: the sRGB curve, with a shoulder above 0.6 that ends at white."""
    x = np.maximum(np.nan_to_num(radiance[..., :3]), 0.0)
    x = np.where(x < 0.6, x, 0.6 + 0.4 * (1.0 - np.exp(-(x - 0.6) / 0.4)))
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def flow_colours(flow, scale_px):
    """Direction as hue, length as brightness: black is still, full colour is scale_px or more."""
    hue = (np.arctan2(flow[..., 1], flow[..., 0]) / (2 * np.pi)) % 1.0
    length = np.clip(np.hypot(flow[..., 0], flow[..., 1]) / scale_px, 0.0, 1.0)
    sectors = (hue[..., None] * 6.0 + np.array([0.0, 4.0, 2.0])) % 6.0
    pure = np.clip(np.abs(sectors - 3.0) - 1.0, 0.0, 1.0)
    return (0.25 + 0.75 * pure) * length[..., None] ** 0.7


def flow_wheel(size=160):
    """The legend: the colour of every direction and length in a disc; transparent would need PNG, so black outside."""
    y, x = np.mgrid[0:size, 0:size] / (size - 1) * 2.0 - 1.0
    inside = np.hypot(x, y) <= 1.0
    return flow_colours(np.stack([x, y], axis=-1), 1.0) * inside[..., None]


def mask_colours(mask):
    return colormaps["inferno"](np.clip(mask[..., 0], 0.0, 1.0))[..., :3]


def strip(noisy, denoised, reference, gap_px=4):
    """One picture of the frame in three bands, each from its own version, with light lines between."""
    width = noisy.shape[1]
    picture = np.concatenate([noisy[:, : width // 3], denoised[:, width // 3 : 2 * width // 3],
                              reference[:, 2 * width // 3 :]], axis=1)
    for edge in (width // 3, 2 * width // 3):
        picture[:, edge - gap_px // 2 : edge + gap_px // 2] = 0.9
    return picture


def write_picture(path, colours, jpeg_quality=90):
    height, width, _ = colours.shape
    spec = oiio.ImageSpec(width, height, 3, "uint8")
    spec["CompressionQuality"] = jpeg_quality
    spec["jpeg:subsampling"] = "4:4:4"
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), np.ascontiguousarray(colours, np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def jpeg_uri(colours):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.jpg")
        write_picture(path, colours)
        with open(path, "rb") as file:
            return "data:image/jpeg;base64," + base64.b64encode(file.read()).decode("ascii")


def make_pictures(path_of, out, frames, measured):
    """Writes out/pictures/*.png, and returns them as data URIs by kind and frame, with the flow's scale."""
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
        kinds["flow"][f] = flow_colours(denoised[f]["flow"], scale_px)
        kinds["error_mask"][f] = mask_colours(denoised[f]["error_mask"])
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
    return {"kinds": uris, "wheel": jpeg_uri(flow_wheel()), "flow_scale_px": scale_px}
