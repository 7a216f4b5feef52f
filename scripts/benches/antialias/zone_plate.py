"""A zone plate, cos(pi r^2 / side), panned at constant subpixel speeds: what of its contrast is left after temporal upsampling, by frequency, beside the
pixel filter, which is the limit of infinitely many samples. Frames of one sample a pixel at known places, without noise.
Called by `scripts/bench antialias --zone-plate`."""

import subprocess

import numpy as np
import OpenImageIO as oiio

from benches.markdown_report import markdown

SIDE = 192  # of the output in pixels
FRAMES = 24
SPEEDS = (0.0, 0.25, 1 / 3, 0.5, 0.7)  # output pixels a frame, horizontally; half of it vertically
BANDS = (0.0625, 0.125, 0.1875, 0.25, 0.3125, 0.375, 0.4375, 0.5)  # upper ends, in cycles a pixel of the output
MODES = {  # name: size over the output's, jitter cycle, options
    "1x": (1, 16, []),
    "checkerboard": (1, 16, ["--checkerboard=even"]),
    "1.5x": (2 / 3, 36, ["--scale", "3/2"]),
    "2x": (1 / 2, 64, ["--scale", "2"]),
}


def radical_inverse(index, base):
    value, digit = 0.0, 1.0
    while index:
        digit /= base
        value += digit * (index % base)
        index //= base
    return value


def plate(x, y):
    """In output pixels from the middle; half a cycle a pixel at the middle of each edge."""
    return 0.5 + 0.45 * np.cos(np.pi / SIDE * (x * x + y * y))


def frequency():
    """Of the plate at each pixel of the output, in cycles a pixel."""
    at = np.arange(SIDE) + 0.5 - SIDE / 2
    return np.hypot(*np.meshgrid(at, at)) / SIDE


def window(t):
    return np.where(np.abs(t) <= 1, 0.35875 + 0.48829 * np.cos(np.pi * t) + 0.14128 * np.cos(2 * np.pi * t) + 0.01168 * np.cos(3 * np.pi * t), 0)


def write(path, pixels, motion, jitter):
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 6, oiio.FLOAT)
    spec.channelnames = ("R", "G", "B", "depth.Z", "motion.X", "motion.Y")
    spec["becalm:jitter"] = f"blackman_harris 1.5: {jitter[0]} {jitter[1]}"
    layers = [pixels] * 3 + [np.ones_like(pixels)] + [np.full_like(pixels, m) for m in motion]
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.ROI(), np.ascontiguousarray(np.stack(layers, axis=-1), np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def inverse_filter():
    """The positions under the pixel filter at a share of its density."""
    at = np.linspace(-1.5, 1.5, 3001)
    density = np.cumsum(window(at / 1.5))
    return lambda u: float(np.interp(u, density / density[-1], at))


def generate(folder, share, cycle, speed, checkerboard):
    """Frames of a plate that moves by (speed, speed / 2) output pixels a frame."""
    folder.mkdir(parents=True, exist_ok=True)
    side, position = round(share * SIDE), inverse_filter()
    for frame in range(FRAMES):
        index = (frame // 2 if checkerboard else frame) % cycle + 1
        jitter = position(radical_inverse(index, 2)), position(radical_inverse(index, 3))
        x, y = np.meshgrid(*((np.arange(side) + 0.5 + j) / share - SIDE / 2 for j in jitter))
        pixels = plate(x - speed * frame, y - 0.5 * speed * frame)
        if checkerboard:
            rows, columns = np.indices(pixels.shape)
            pixels[(rows + columns + frame) % 2 == 1] = 0
        write(folder / f"f.{frame:04}.exr", pixels, (-speed * share, -0.5 * speed * share), jitter)


def filtered_plate(speed, frame):
    """The plate under the pixel filter, by 15x15 samples."""
    at = np.arange(SIDE) + 0.5 - SIDE / 2
    steps = (np.arange(15) + 0.5) / 5 - 1.5
    weights = window(steps / 1.5)
    total = sum(weights) ** 2
    return sum(wx * wy / total * plate(*np.meshgrid(at + dx - speed * frame, at + dy - 0.5 * speed * frame))
               for dx, wx in zip(steps, weights) for dy, wy in zip(steps, weights))


def transfer(image, speed, frame):
    """By band of frequencies, the share of the plate's contrast that an image has in phase with it."""
    at = np.arange(SIDE) + 0.5 - SIDE / 2
    x, y = np.meshgrid(at - speed * frame, at - 0.5 * speed * frame)
    wave = plate(x, y) - 0.5
    bands = np.hypot(x, y) / SIDE
    inside = frequency() < 0.5
    shares = []
    for low, high in zip((0, *BANDS), BANDS):
        chosen = inside & (bands >= low) & (bands < high)
        shares.append(float(np.sum((image[chosen] - 0.5) * wave[chosen]) / np.sum(wave[chosen] ** 2)))
    return shares


def table(becalm, root, preset="best"):
    """Rows by mode and speed: the transfer by band, in the middle of the sequence, and the RMSE to the plate under the pixel filter."""
    rows = []
    frame = FRAMES // 2
    for speed in SPEEDS:
        truth = filtered_plate(speed, frame)
        if not rows:
            rows.append(["pixel filter", "any", *(f"{share:.2f}" for share in transfer(truth, speed, frame)), "-"])
        for mode, (share, cycle, options) in MODES.items():
            folder = root / f"{mode}_{speed:.2f}"
            generate(folder, share, cycle, speed, bool(options) and "checkerboard" in options[0])
            subprocess.run([becalm, "antialias", folder / "f.####.exr", "-o", folder / "result.####.exr", "--preset", preset, *options, "--overwrite", "--quiet"],
                           check=True)
            result = oiio.ImageBuf(str(folder / f"result.{frame:04}.exr")).get_pixels(oiio.FLOAT)[..., 0]
            error = np.sqrt(np.mean((result - truth)[frequency() < 0.5] ** 2))
            rows.append([mode, f"{speed:.2f}", *(f"{share:.2f}" for share in transfer(result, speed, frame)), f"{error:.4f}"])
    return markdown(["mode", "speed", *(f"to {band:.3f}" for band in BANDS), "RMSE"], rows)
