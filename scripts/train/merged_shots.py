"""Merges the noisy frames of shots by becalm's own filter, for the network that smooths merged frames to learn from.

    merged_shots.py DATA --becalm PROGRAM [--again]

For each complete shot of DATA the frame with a reference is merged four times: from the frames up to it, and from those after
it as well. The files say of the noise what chance decides: a variance, half-buffers or nothing. What the last smoothing would see is stored in
SHOT/merged.npz, in the form of PACKED (shots.py); shots that have it are left alone. With --again (for own_share.py) it goes into SHOT/remerged.npz, anew if
another program made that.
"""

import argparse
import hashlib
import json
import os
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

import shared_noise
import shots

CHANNELS = {"color": ["R", "G", "B"], **{name: shots.NAMES["becalm"][name] for name in
            ("albedo", "normal", "depth", "variance", "half_a", "half_b")}}
TOLD = [[], ["variance"], ["half_a", "half_b"]]
TOLD_SHARES = [0.5, 0.25, 0.25]
MATCHING = ["draft", "balanced", "final"]
PROGRAM = "program"  # array of the digest of the program that merged
MERGES = 4  # of each shot: forward and both ways, of all frames and of a part
SHARED_MERGES = 2  # more, of frames with noise that neighbours share


def write_layers(path, layers):
    """An EXR file of float channels from arrays of (channels, height, width)."""
    names = [channel for layer in layers for channel in CHANNELS[layer]]
    pixels = np.concatenate(list(layers.values())).transpose(1, 2, 0)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(names), oiio.FLOAT)
    spec.channelnames = names
    file = oiio.ImageOutput.create(path)
    if not file or not file.open(path, spec) or not file.write_image(np.ascontiguousarray(pixels)):
        raise IOError(f"{path}: {oiio.geterror()}")
    file.close()


def read_channels(path, names):
    image = oiio.ImageBuf(path)
    if image.has_error:
        raise IOError(f"{path}: {image.geterror()}")
    spec = image.spec()
    pixels = np.asarray(image.get_pixels(oiio.FLOAT)).reshape(spec.height, spec.width, spec.nchannels)
    return pixels[..., [spec.channelnames.index(name) for name in names]].transpose(2, 0, 1)


def merge(becalm, folder, frames, wanted, preset, directions):
    """The frame `wanted` merged from files of `frames`: radiance, its variance, and features of 7 channels."""
    subprocess.run([becalm, "denoise", f"{folder}/in.####.exr", "-o", f"{folder}/out.####.exr", "--frames", frames, "--quiet",
                    "--diagnostics", "--threads", "1", "--preset", preset, "--set", "smooth=merged", "--set", "smooth_albedo=1",
                    "--set", f"directions={directions}", "--cuts", "none"], check=True)
    channels = [f"accumulated.{c}" for c in "RGB"] + ["accumulated_variance.Y"] + [f"accumulated_albedo.{c}" for c in "RGB"]
    channels += [f"accumulated_normal.{c}" for c in "XYZ"] + ["accumulated_depth.Y"]
    layers = read_channels(f"{folder}/out.{wanted:04d}.exr", channels)
    return layers[:3], layers[3:4], layers[4:].astype(np.float16)


def merge_shot(becalm, folder, target):
    with open(f"{folder}/shot.json") as file:
        shot = json.load(file)
    rng = np.random.default_rng([shot["seed"], 77])
    if not shot["references"]:
        return
    spp, wanted = shot["spp"][0], shot["references"][0]
    a, b = (shots.read_layers(f"{folder}/{name}.{wanted:04d}.exr", shot["renderer"]) for name in ("r_a", "r_b"))
    frames = {frame: shots.noisy_layers(folder, shot, spp, frame) for frame in range(1, shot["frames"] + 1)}
    arrays = {}
    for number in range(MERGES + SHARED_MERGES):
        directions = ("forward", "both")[number % 2]
        told = TOLD[rng.choice(len(TOLD), p=TOLD_SHARES)]
        # The first two merges see all frames, the others a part.
        first = 1 if number < 2 else rng.integers(1, wanted + 1)
        last = wanted if directions == "forward" else shot["frames"] if number < 2 else rng.integers(wanted, shot["frames"] + 1)
        name, shown = f"{directions}{number}", lambda layers: layers
        if number >= MERGES:
            name = shots.SHARED + name
            kernel = shared_noise.random_kernel(rng)
            shown = lambda layers: shared_noise.convolved_layers(layers, kernel)
        with tempfile.TemporaryDirectory() as temporary:
            for frame in range(first, last + 1):
                layers = frames[frame]
                kept = ["color", "albedo", "normal", "depth"] + [name for name in told if name in layers]
                write_layers(f"{temporary}/in.{frame:04d}.exr", shown({name: layers[name] for name in kept}))
            color, variance, features = merge(becalm, temporary, f"{first}-{wanted}" if directions == "forward" else str(wanted),
                                              wanted, MATCHING[rng.integers(len(MATCHING))], directions)
        of_wanted, *references = (shown(layers) for layers in (frames[wanted], a, b))
        exposure = shots.exposure_of(of_wanted["color"])
        images = [color, variance, of_wanted["color"], *(r["color"] for r in references)]
        if exposure == 0.0 or not all(np.isfinite(image).all() for image in images):
            continue
        clean = shots.packed_features({name: 0.5 * (references[0][name] + references[1][name]) for name in ("albedo", "normal", "depth")})
        pair = shots.packed_pair(color * exposure, [np.sqrt(variance) * exposure],
                                 [features, clean, shots.packed_features(of_wanted)], [r["color"] * exposure for r in references],
                                 of_wanted["color"] * exposure)
        arrays.update({f"{name}.{wanted:04d}.{array_name}": array for array_name, array in pair.items()})
    arrays[PROGRAM] = np.array(digest_of(becalm))
    shots.save(f"{folder}/{target}", arrays)


def digest_of(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def is_merged(path, becalm):
    """Whether the file is there and of this program; of any, if that is None."""
    if not os.path.exists(path):
        return False
    with np.load(path) as arrays:
        return becalm is None or (PROGRAM in arrays and str(arrays[PROGRAM]) == digest_of(becalm))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("data")
    parser.add_argument("--becalm", required=True, help="the program")
    parser.add_argument("--again", action="store_true", help="for own_share.py: by the program with the trained network")
    args = parser.parse_args()
    target = shots.REMERGED if args.again else shots.MERGED
    for folder in shots.complete_shots(args.data):
        if not is_merged(f"{folder}/{target}", args.becalm if args.again else None):
            merge_shot(args.becalm, folder, target)
            print(folder, flush=True)


if __name__ == "__main__":
    main()
