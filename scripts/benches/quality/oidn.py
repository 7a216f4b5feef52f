"""
Denoises a sequence with the published networks of Open Image Denoise 2, each frame by itself, evaluated in PyTorch: what
`scripts/bench quality --oidn DIR` compares with. Debian 12 does not have the library.

    python3 -m benches.quality.oidn WEIGHTS NOISY DENOISED FRAMES [--prefilter ALBEDO NORMAL]

WEIGHTS, ALBEDO and NORMAL are files of https://github.com/RenderKit/oidn-weights: rt_hdr_alb_nrm.tza for features as they come,
rt_hdr_calb_cnrm.tza for features that rt_alb.tza and rt_nrm.tza have prefiltered; those of ..._large.tza have more channels.
NOISY and DENOISED are patterns of EXR files. Exposure and transfer functions are the library's (its autoexposure and color files).
"""

import argparse
import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import torch
import torch.nn.functional as functional

from benches.quality.options import frames

ALIGNMENT = 16
LARGEST_HALF = 65504.0
LUMINANCE = np.array([0.212671, 0.715160, 0.072169], np.float32)


def read_weights(path):
    """The tensors of a TZA archive by name."""
    data = Path(path).read_bytes()
    magic, _, _, at = struct.unpack_from("<HBBQ", data)
    if magic != 0x41D7:
        raise SystemExit(f"{path}: expected a TZA archive")
    tensors = {}
    count, = struct.unpack_from("<I", data, at)
    at += 4
    for _ in range(count):
        length, = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        rank = data[at]
        shape = struct.unpack_from(f"<{rank}I", data, at + 1)
        at += 1 + 4 * rank + rank  # the layout, a letter each dimension, is always OIHW or X
        kind, offset = struct.unpack_from("<cQ", data, at)
        at += 9
        values = np.frombuffer(data, {b"f": "<f4", b"h": "<f2"}[kind], int(np.prod(shape)), offset)
        tensors[name] = torch.from_numpy(values.astype(np.float32).reshape(shape))
    return tensors


class Network:
    """The U-Net: five scales, two convolutions each, whose inputs on the way up are the coarser scale and what went down."""

    def __init__(self, path):
        self.tensors = read_weights(path)

    def _convolve(self, name, x):
        x = functional.conv2d(x, self.tensors[f"{name}.weight"], self.tensors[f"{name}.bias"], padding=1)
        return functional.relu(x)

    def _convolve_all(self, prefix, x):
        for name in sorted(name.removesuffix(".weight") for name in self.tensors if name.startswith(prefix) and name.endswith(".weight")):
            x = self._convolve(name, x)
        return x

    def __call__(self, image):
        """The network's result on an array of height x width x channels, of three channels."""
        height, width = image.shape[:2]
        x = torch.from_numpy(image.astype(np.float32)).permute(2, 0, 1)[None]
        x = functional.pad(x, (0, -width % ALIGNMENT, 0, -height % ALIGNMENT))
        kept = [x]
        if "enc_conv0.weight" in self.tensors:
            x = self._convolve("enc_conv0", x)
        for level in range(1, 5):
            x = functional.max_pool2d(self._convolve_all(f"enc_conv{level}", x), 2)
            kept.append(x)
        x = self._convolve_all("enc_conv5", x)
        for level in range(4, 0, -1):
            x = functional.interpolate(x, scale_factor=2, mode="nearest")
            x = self._convolve_all(f"dec_conv{level}", torch.cat([x, kept[level - 1]], 1))
        if "dec_conv0.weight" in self.tensors:
            x = self._convolve("dec_conv0", x)
        return x[0].permute(1, 2, 0)[:height, :width].numpy()


class PerceptualRange:
    """The transfer function of high dynamic range, which comes near perceptual uniformity, from [0, 65504] to [0, 1]."""

    A, B, C, D, E, F, G = 1.41283765e+03, 1.64593172e+00, 4.31384981e-01, -2.94139609e-03, 1.92653254e-01, 6.26026094e-03, 9.98620152e-01
    Y0, Y1, X0, X1 = 1.57945760e-06, 3.22087631e-02, 2.23151711e-03, 3.70974749e-01

    def __init__(self):
        self.largest = self._forward(np.float64(LARGEST_HALF))

    def _forward(self, y):
        return np.where(y <= self.Y0, self.A * y, np.where(y <= self.Y1, self.B * np.power(y, self.C) + self.D, self.E * np.log(y + self.F) + self.G))

    def forward(self, y):
        return self._forward(y.astype(np.float64)) / self.largest

    def inverse(self, x):
        x = x.astype(np.float64) * self.largest
        middle = np.power(np.maximum(x - self.D, 0) / self.B, 1 / self.C)
        return np.where(x <= self.X0, x / self.A, np.where(x <= self.X1, middle, np.exp((x - self.G) / self.E) - self.F))


def exposure(color):
    """What brings the mean logarithm of the luminance of blocks of about 16x16 pixels to 0.18."""
    height, width = color.shape[:2]
    luminance = color @ LUMINANCE
    rows = np.linspace(0, height, -(-height // 16) + 1).astype(int)
    columns = np.linspace(0, width, -(-width // 16) + 1).astype(int)
    means = np.add.reduceat(np.add.reduceat(luminance, rows[:-1], 0), columns[:-1], 1) / np.outer(np.diff(rows), np.diff(columns))
    means = means[means > 1e-8]
    return 0.18 / np.exp2(np.log2(means).mean()) if means.size else 1.0


def to_srgb(y):
    return np.where(y <= 0.0031308, 12.92 * y, 1.055 * np.power(y, 1 / 2.4) - 0.055)


def from_srgb(x):
    return np.where(x <= 0.04045, x / 12.92, np.power((x + 0.055) / 1.055, 2.4))


def layer(image, *names):
    """The three channels, such as `albedo.rgb`, of the first of these names that there is, as an array; NaN is black."""
    channels = [channel.lower() for channel in image.spec().channelnames]
    for name in names:
        # What another renderer writes before the layer's name does not matter.
        found = [i for component in name[-3:] for i, channel in enumerate(channels)
                 if (channel.endswith(name[:-3] + component) if "." in name else channel == component)]
        if len(found) == 3:
            return np.nan_to_num(image.get_pixels(oiio.FLOAT)[..., found], posinf=LARGEST_HALF, neginf=0.0)
    raise SystemExit(f"{image.name}: no channels {' or '.join(names)}, there are {', '.join(channels)}")


def denoise(noisy, network, prefilters):
    """The radiance of one frame, of height x width x 3. `prefilters`: the networks of albedo and normal, if any."""
    image = oiio.ImageBuf(noisy)
    color = np.clip(layer(image, "combined.rgb", "rgb"), 0, None)
    albedo = np.clip(layer(image, "albedo.rgb"), 0, 1)
    normal = np.clip(layer(image, "normal.xyz"), -1, 1) * 0.5 + 0.5
    if prefilters:
        albedo = np.clip(from_srgb(np.clip(prefilters[0](to_srgb(albedo)), 0, 1)), 0, 1)
        normal = np.clip(prefilters[1](normal), 0, 1)
    scale, transfer = exposure(color), PerceptualRange()
    result = network(np.concatenate([transfer.forward(color * scale), albedo, normal], 2))
    return transfer.inverse(np.clip(result, 0, 1)) / scale


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("noisy")
    parser.add_argument("denoised")
    parser.add_argument("frames", type=frames)
    parser.add_argument("--prefilter", nargs=2, metavar=("ALBEDO", "NORMAL"))
    asked = parser.parse_args()
    network = Network(asked.weights)
    prefilters = [Network(path) for path in asked.prefilter or ()]
    for frame in asked.frames:
        result = denoise(asked.noisy.replace("####", f"{frame:04d}"), network, prefilters)
        height, width = result.shape[:2]
        output = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, oiio.FLOAT))
        output.set_pixels(oiio.ROI(), np.ascontiguousarray(result, np.float32))
        path = asked.denoised.replace("####", f"{frame:04d}")
        if not output.write(path):
            raise SystemExit(f"{path}: {output.geterror()}")


if __name__ == "__main__":
    main()
