"""Reads the shots that cycles_shots.py and becalm_shots.py rendered: pairs of noisy frames and references.

A pair is what the network may be shown of one frame: radiance, variance, features, noisy or clean, and two independent
references, or one where the frame is the other. Pairs are packed once a shot into a file beside the frames, since reading EXR
files takes longer than training on them.
"""

import json
import os
from dataclasses import dataclass

import numpy as np
import OpenImageIO as oiio

PACKED = "pairs.npz"
MERGED = "merged.npz"  # what merged_shots.py writes
REMERGED = "remerged.npz"  # the same by the program with the network that MERGED has trained
SHARED = "shared_"  # begins the name of a pair whose noise neighbouring pixels share (shared_noise.py)
NOTHING_HIT = 1e9  # depths from this on mean that, as in filter/input/host_images.cpp
FIREFLY = 1e4  # largest radiance over the frame's typical one that a reference may have: half-float range

NAMES = {
    "cycles": {
        "color": ["Combined.R", "Combined.G", "Combined.B"],
        "albedo": ["Denoising Albedo.R", "Denoising Albedo.G", "Denoising Albedo.B"],
        "normal": ["Denoising Normal.X", "Denoising Normal.Y", "Denoising Normal.Z"],
        "depth": ["Denoising Depth.Z"],
    },
    "becalm": {
        "color": ["R", "G", "B"],
        "albedo": ["albedo.R", "albedo.G", "albedo.B"],
        "normal": ["normal.X", "normal.Y", "normal.Z"],
        "depth": ["depth.Z"],
        "variance": ["variance.R", "variance.G", "variance.B"],
        "half_a": ["half_a.R", "half_a.G", "half_a.B"],
        "half_b": ["half_b.R", "half_b.G", "half_b.B"],
    },
}


@dataclass
class Pair:
    """One noisy frame: arrays of (channels, height, width). Radiance is exposed: its geometric mean is 1."""

    name: str
    color: np.ndarray
    variances: list  # what the renderer tells of the noise: its own variance, that of the halves; may be empty
    # (albedo, normal, depth) as 7 channels: as the radiance, of the references, and of a merged frame its own.
    features: list
    references: list  # two, or one
    own: np.ndarray = None  # of a merged frame, what it was before; its variance is always known
    of_albedo: bool = False  # its radiance is an albedo
    smoothed_albedo: np.ndarray = None  # of the frame itself, as smooth_albedos made it; 3 channels

    @property
    def independent(self):
        """Whether the squared error can be told from the references' noise."""
        return len(self.references) == 2

    @property
    def merged(self):
        return self.own is not None

    @property
    def of_shared_noise(self):
        return f"/{SHARED}" in self.name


def read_layers(path, renderer):
    """The known layers of an EXR file as float32 arrays of (channels, height, width)."""
    image = oiio.ImageBuf(path)
    if image.has_error:
        raise IOError(f"{path}: {image.geterror()}")
    spec = image.spec()
    pixels = np.asarray(image.get_pixels(oiio.FLOAT)).reshape(spec.height, spec.width, spec.nchannels)
    channels = {}
    for index, name in enumerate(spec.channelnames):
        channels[name.removeprefix("ViewLayer.")] = index
    layers = {}
    for layer, names in NAMES[renderer].items():
        if all(name in channels for name in names):
            layers[layer] = np.ascontiguousarray(pixels[..., [channels[n] for n in names]].transpose(2, 0, 1))
    return layers


def exposure_of(color):
    """1 over the geometric mean of the luminance (filter/input/host_images.cpp, without fireflies); 0 where all is black."""
    light = np.tensordot(np.array([0.2126, 0.7152, 0.0722]), color.astype(np.float64), 1)
    lit = light[np.isfinite(light) & (light > 0)]
    if lit.size == 0:
        return 0.0
    lit = lit[lit >= 1e-6 * light.clip(0).mean()]
    return float(np.exp(-np.log(lit).mean()))


def packed_features(layers):
    """Albedo, normal and depth as the filter packs them (pack_features), where they are finite: 7 channels."""
    albedo = np.nan_to_num(layers["albedo"], nan=1.0).clip(0, 1)
    normal = np.nan_to_num(layers["normal"]).clip(-1, 1)
    depth = layers["depth"].astype(np.float64)
    hit = (depth > 0) & (depth < NOTHING_HIT)
    usual = np.exp(np.log(depth[hit]).mean()) if hit.any() else 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(depth > 0, 2.0 / (1.0 + usual / depth), 0.0)
    return np.concatenate([albedo, normal, relative]).astype(np.float16)


def noisy_layers(folder, shot, spp, frame):
    """The layers of a noisy frame, with what its files tell of the noise."""
    if shot["renderer"] == "becalm":
        return read_layers(f"{folder}/n{spp:03d}.{frame:04d}.exr", "becalm")
    a = read_layers(f"{folder}/n{spp:03d}_a.{frame:04d}.exr", "cycles")
    if spp == 1:
        return a
    b = read_layers(f"{folder}/n{spp:03d}_b.{frame:04d}.exr", "cycles")
    layers = {}
    for name in a:
        layers[name] = 0.5 * (a[name] + b[name])
    layers["half_a"], layers["half_b"] = a["color"], b["color"]
    return layers


def variances_of(layers):
    """What the frame tells of the variance of its mean, one channel each, averaged over colours."""
    told = []
    if "variance" in layers:
        told.append(layers["variance"].mean(0, keepdims=True))
    if "half_a" in layers and "half_b" in layers:
        told.append((0.25 * (layers["half_a"] - layers["half_b"]) ** 2).mean(0, keepdims=True))
    return told


def pack_shot(folder):
    """Reads all frames of a shot that have references into PACKED; a list of arrays by name."""
    with open(f"{folder}/shot.json") as file:
        shot = json.load(file)
    arrays = {}
    for frame in shot["references"]:
        a = read_layers(f"{folder}/r_a.{frame:04d}.exr", shot["renderer"])
        b = read_layers(f"{folder}/r_b.{frame:04d}.exr", shot["renderer"])
        clean = packed_features({name: 0.5 * (a[name] + b[name]) for name in ("albedo", "normal", "depth")})
        for spp in shot["spp"]:
            layers = noisy_layers(folder, shot, spp, frame)
            exposure = exposure_of(layers["color"])
            finite = np.isfinite(layers["color"]).all() and np.isfinite(a["color"]).all() and np.isfinite(b["color"]).all()
            if exposure == 0.0 or not finite:
                continue
            pair = packed_pair(layers["color"] * exposure, [np.sqrt(np.maximum(v, 0.0)) * exposure for v in variances_of(layers)],
                               [packed_features(layers), clean], [r["color"] * exposure for r in (a, b)])
            arrays.update({f"{spp:03d}.{frame:04d}.{name}": array for name, array in pair.items()})
        arrays.update(pairs_of_references(a, b, frame))
    save(f"{folder}/{PACKED}", arrays)


def pairs_of_references(a, b, frame):
    """Each reference as a frame with little noise, whose only reference is the other (Lehtinen et al. 2018)."""
    arrays = {}
    if not (np.isfinite(a["color"]).all() and np.isfinite(b["color"]).all()):
        return arrays
    for name, noisy, other in (("a", a, b), ("b", b, a)):
        exposure = exposure_of(noisy["color"])
        if exposure == 0.0:
            continue
        pair = packed_pair(noisy["color"] * exposure, [], [packed_features(noisy), packed_features(other)],
                           [other["color"] * exposure])
        arrays.update({f"r_{name}.{frame:04d}.{array_name}": array for array_name, array in pair.items()})
    return arrays


def half(radiance):
    return radiance.clip(-FIREFLY, FIREFLY).astype(np.float16)


def packed_pair(color, deviations, features, references, own=None):
    """The arrays of a pair by name, of exposed radiance."""
    arrays = {"color": half(color), "features": np.stack(features), "references": half(np.stack(references))}
    if own is not None:
        arrays["own"] = half(own)
    if deviations:
        arrays["deviations"] = np.stack(deviations).clip(0, FIREFLY).astype(np.float16)
    return arrays


def save(path, arrays):
    partial = f"{path}.partial.npz"
    np.savez(partial, **arrays)
    os.replace(partial, path)


def load_pairs(folder, file):
    pairs = []
    with np.load(f"{folder}/{file}") as packed:
        for key in sorted(name.removesuffix(".color") for name in packed.files if name.endswith(".color")):
            deviations = packed[f"{key}.deviations"] if f"{key}.deviations" in packed.files else []
            pairs.append(
                Pair(
                    name=f"{os.path.basename(folder)}/{key}",
                    color=packed[f"{key}.color"],
                    variances=list(deviations),
                    features=list(packed[f"{key}.features"]),
                    references=list(packed[f"{key}.references"]),
                    own=packed[f"{key}.own"] if f"{key}.own" in packed.files else None,
                )
            )
    return pairs


def pair_files(folder):
    """The files of a shot's pairs: of its frames, packed before if need be, and of what merged_shots.py made of them."""
    if not os.path.exists(f"{folder}/{PACKED}"):
        pack_shot(folder)
    return [file for file in (PACKED, MERGED) if os.path.exists(f"{folder}/{file}")]


def load_shot(folder):
    """The pairs of a shot."""
    return [pair for file in pair_files(folder) for pair in load_pairs(folder, file)]


def of_albedo(pairs):
    """What a network learns from to smooth the albedo: it stands for the radiance, the references' for the references."""
    made = []
    for pair in pairs:
        if pair.merged or not pair.independent:
            continue
        features = [np.concatenate([np.ones_like(f[:3]), f[3:]]) for f in pair.features]
        clean = pair.features[1][:3]
        made.append(Pair(pair.name, pair.features[0][:3], [], features, [clean, clean], of_albedo=True))
    return made


def complete_shots(data):
    """Folders of all shots that are rendered whole, sorted."""
    return sorted(entry.path for entry in os.scandir(data) if os.path.exists(f"{entry.path}/shot.json"))
