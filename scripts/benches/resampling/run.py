"""Repeated resampling of the history by each filter (figure 8 of the survey by Yang et al.): error / sharpness after 1, 10, 30 and
100 steps by half a pixel, by random offsets, and by random offsets with exponential smoothing. Called by `scripts/bench resampling`."""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import cv2
import numpy as np

SIZE = 192
BORDER = 24  # px that are not measured, since the offsets bring in what lies outside the image
STEPS = (1, 10, 30, 100)
SMOOTHING = 0.1  # weight of the new frame with exponential smoothing, as in the survey
FILTERS = ("bilinear", "catmull_rom", "spline")


def scene(x, y):
    """Radiance at positions in pixels: a zone plate up to two thirds of the Nyquist frequency, stripes, and a star."""
    u, v = x - SIZE / 2, y - SIZE / 2
    radius2 = u * u + v * v
    zone = 0.5 + 0.5 * np.cos(np.pi * (2 / 3) / (SIZE / 2) * radius2 / 2)
    star = (np.arctan2(v + 40.3, u - 40.7) * 24 / (2 * np.pi)) % 1 < 0.5
    near_star = (u - 40.7) ** 2 + (v + 40.3) ** 2 < 28**2
    stripes = (x + 0.3 * y) % 5 < 2
    return np.where(near_star, star, np.where((u < -20) & (v > 30), stripes, zone)).astype(np.float32)


def render(displacement, samples=8):
    """The scene displaced by so many pixels, averaged over the square of each pixel."""
    at = np.arange(SIZE, dtype=np.float32)
    image = np.zeros((SIZE, SIZE), np.float32)
    for j in range(samples):
        for i in range(samples):
            x = at[None, :] + (i + 0.5) / samples - 0.5 + displacement[0]
            y = at[:, None] + (j + 0.5) / samples - 0.5 + displacement[1]
            image += scene(x, y)
    return image / samples**2


def inner(image):
    return image[BORDER:-BORDER, BORDER:-BORDER]


def sharpness(image):
    """Mean square of the gradient."""
    dy, dx = np.gradient(inner(image))
    return float(np.mean(dx * dx + dy * dy))


class Warp:
    """A bench_resampling process for one filter."""

    def __init__(self, program, name):
        self.folder = tempfile.TemporaryDirectory()
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.command(do="build", width=SIZE, height=SIZE, resample=name)

    def command(self, **command):
        self.process.stdin.write(json.dumps(command) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            raise SystemExit(f"bench resampling: {answer['error']}")

    def __call__(self, image, offset):
        source, result = (str(Path(self.folder.name) / name) for name in ("from", "to"))
        np.repeat(image[..., None], 4, axis=2).astype("<f4").tofile(source)
        self.command(do="warp", offset=[float(o) for o in offset], **{"from": source, "to": result})
        return np.fromfile(result, "<f4").reshape(SIZE, SIZE, 4)[..., 0]

    def close(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.folder.cleanup()


def walks():
    """For each experiment its name, the offset of each step, and the weight of the new frame."""
    half = [(0.5, 0.5) if i % 2 == 0 else (-0.5, -0.5) for i in range(max(STEPS))]
    random = np.random.default_rng(1).uniform(-1, 1, (max(STEPS), 2))
    random -= random.mean(axis=0)  # the image ends where it began
    return (("half pixel", half, 0.0), ("random", random, 0.0), ("random, smoothed", random, SMOOTHING))


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench resampling", description=__doc__)
    parser.add_argument("--bench-resampling", default="build/release/scripts/benches/bench_resampling", metavar="PATH")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="write the resampled images here")
    arguments = parser.parse_args()
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    warps = {name: Warp(arguments.bench_resampling, name) for name in FILTERS}
    print("| steps by | filter | " + " | ".join(f"after {step}" for step in STEPS) + " |")
    print("| --- | --- |" + " --- |" * len(STEPS))
    for walk, offsets, smoothing in walks():
        position = np.zeros(2)
        images = dict.fromkeys(FILTERS, render(position))
        cells = {name: [] for name in FILTERS}
        for step, offset in enumerate(offsets, 1):
            position = position + offset
            truth = render(position) if smoothing or step in STEPS else None
            for name, warp in warps.items():
                image = warp(images[name], offset)
                if smoothing:
                    image += smoothing * (truth - image)
                images[name] = image
                if step in STEPS:
                    error = np.sqrt(np.mean(inner(image - truth) ** 2))
                    cells[name].append(f"{error:.4f} / {100 * sharpness(image) / sharpness(truth):.0f} %")
        for name in FILTERS:
            print(f"| {walk} | `{name}` | " + " | ".join(cells[name]) + " |", flush=True)
            if arguments.pictures:
                path = arguments.pictures / f"{walk.replace(', ', '_').replace(' ', '_')}_{name}.png"
                cv2.imwrite(str(path), np.clip(255 * images[name], 0, 255).astype(np.uint8))
    for warp in warps.values():
        warp.close()


if __name__ == "__main__":
    main()
