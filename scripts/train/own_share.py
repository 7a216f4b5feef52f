"""Trains the frame's own share: own_share.py DATA NETWORK.weights ALBEDO.weights OUT.weights [--steps N]

The output of a pixel is a mean of the smoothed merged frame and of the frame itself. Two small hidden layers tell the frame's
share from the error that the network expects, the noise of the merged frame, and the difference of the two
(filter/smooth/own_share.h has the same in C++). The networks stay as they are; they must be those of the program that merged the
frames. Prints the error of the mean on the held-out shots, as a share of that of the smoothed merged frame.

OUT: the magic "becalmOS", then all parameters as half floats, layer by layer, as in export.py.
"""

import argparse
import math
import os

import numpy as np
import torch
import torch.nn as nn
import torch.nn.functional as F

import batches
import export
import losses
import shots
from network import FEATURES, LOSS_FLOOR, LOSS_SCALE, luminance, parameter_count

MAGIC = b"becalmOS"
INPUTS = 5
HIDDEN = 16
RADIUS = 3  # of the patches over which differences are averaged
LARGEST_INPUT = 1e6
LEAST_INPUT = 1e-6
LARGEST_HALF = 6e4
INPUT_SCALE = 1.0 / 3.0
OUTLIER = 4.0  # squared difference, over that of the patch, from which a pixel of the frame counts less
LARGEST_PATCH = 100.0  # that a patch counts for then
LEAST_OF_PATCH = 0.1  # of a patch's mean variance that a pixel has at least; this and the next as difference.comp has them
LARGEST_LEAST = 0.05  # what that is at most
LOST_RADIUS = 7  # of the patches over which a loss of detail is told; this and the next three as share.comp has them
UNSURE = 0.25  # what a patch's variance may be wrong by, over it
SIGNIFICANCE = 3.0  # of a loss of detail, in standard errors
CERTAIN = 16.0  # standard deviations by which a pixel's difference is no noise
FARTHEST_SURFACE = 1.99  # packed depth; as surface.glsl has it
FRAMES = 3  # a step
LEARNING_RATE = 5e-3


class OwnShare(nn.Module):
    """The logit of the frame's own share."""

    def __init__(self):
        super().__init__()
        self.layers = nn.ModuleList(nn.Conv2d(i, o, 1) for i, o in ((INPUTS, HIDDEN), (HIDDEN, HIDDEN), (HIDDEN, 1)))
        nn.init.zeros_(self.layers[-1].weight)
        with torch.no_grad():
            self.layers[-1].bias.fill_(-3.0)

    def forward(self, inputs):
        first, second, last = self.layers
        return last(F.relu(second(F.relu(first(inputs)))))


def total_of_neighbours(x, radius):
    side = 2 * radius + 1
    return F.avg_pool2d(x, side, 1, radius) * side * side - x


def mean_of_neighbours(x):
    """Over the patch around each pixel, as far as it is in the image, without the pixel."""
    count = total_of_neighbours(torch.ones_like(x[:1, :1]), RADIUS)
    return (total_of_neighbours(x, RADIUS) / count.clamp(min=1.0)).clamp(min=0.0)


def shows_surface(features):
    """As shaders/lib/surface.glsl, for features of 7 channels of which none is missing."""
    return (features[:, 6:7] < FARTHEST_SURFACE) & (features[:, 3:6] != 0).any(1, keepdim=True)


def sums_of_alike(x, surface):
    """Over the patch around each pixel, without the pixel, of the pixels that show surfaces or of those that do not, as it does."""
    of_kind = lambda kind: total_of_neighbours(torch.where(kind, x, torch.zeros_like(x)), LOST_RADIUS)
    return torch.where(surface, of_kind(surface), of_kind(~surface))


def with_detail(merged, error, noisy, variance, surface):
    """What the program does before (shaders/smooth/share.comp): detail that patches lost beyond their noise is put back. The
    merged frame, smoothed, the squared error that is then expected, and the mean relative variance around each pixel."""
    scale = 1.0 / (luminance(merged).clamp(min=0.0) + 0.1)
    square = ((noisy - merged) * scale).square().mean(1, keepdim=True)
    noise = variance.clamp(min=0.0) * scale**2
    excess = square - noise
    sums = sums_of_alike(torch.cat([excess, excess.square(), noise, torch.ones_like(noise)], 1), surface)
    count = sums[:, 3:].clamp(min=1.0)
    mean_excess, squared_excess, mean_noise = (sums[:, :3] / count).clamp(min=0.0).split(1, 1)
    sure = (mean_excess - UNSURE * mean_noise).clamp(min=0.0)
    uncertain = SIGNIFICANCE**2 * squared_excess / count
    detail = (sure - uncertain / sure.clamp(min=1e-20)).clamp(min=0.0)
    most = torch.maximum(noise, mean_noise)
    certain = square > CERTAIN**2 * most
    share = lambda excess, rest: torch.where(excess > 0, excess / (excess + rest).clamp(min=1e-30), torch.zeros_like(excess))
    put_back = torch.maximum(torch.where(certain, share(square, most), torch.zeros_like(square)), share(detail, mean_noise))
    left = (1.0 - put_back) ** 2 * error + put_back**2 * variance.clamp(min=0.0)
    return merged + put_back * (noisy - merged), left, mean_noise


def prepared(network, pair):
    """What training reads of a merged pair, as half floats."""
    with torch.no_grad():
        frame = batches.whole_frame(pair)
        colors, variance, features, references = frame
        merged, log_error = losses.smoothed(network, frame)
        own = colors[:, 3:]
        error = torch.exp(log_error) * ((LOSS_SCALE * merged).square().mean(1, keepdim=True) + LOSS_FLOOR) / LOSS_SCALE**2
        merged, error, patch_noise = with_detail(merged, error, colors[:, :3], variance, shows_surface(features[:, FEATURES:]))
        relative = lambda squared: squared / (luminance(merged).clamp(min=0.0) + 0.1) ** 2
        noise = torch.maximum(relative(variance.clamp(min=0.0)), (LEAST_OF_PATCH * patch_noise).clamp(max=LARGEST_LEAST))
        measured = torch.cat([relative((own - merged).square().mean(1, keepdim=True)), relative(error), noise], 1)
        of_patch = mean_of_neighbours(measured)
        inputs = torch.cat([of_patch, measured[:, 1:]], 1)
        inputs = INPUT_SCALE * torch.log(inputs.clamp(max=LARGEST_INPUT) + LEAST_INPUT)
        limit = (OUTLIER * of_patch[:, :1].clamp(max=LARGEST_PATCH) / measured[:, :1].clamp(min=1e-12)).clamp(max=1.0)
        images = inputs, limit, merged, own, references[0, :1], references[0, -1:]
        return [image.clamp(-LARGEST_HALF, LARGEST_HALF).half() for image in images]


def mixed(share, inputs, limit, merged, own):
    """The mean of the smoothed merged frame and the frame itself."""
    return merged + limit * torch.sigmoid(share(inputs)) * (own - merged)


def loss_of(share, frame, scale):
    """The relative squared error of the mean, without the references' noise, as a share of the smoothed merged frame's."""
    inputs, limit, merged, own, a, b = (image.float() for image in frame)
    reference = 0.5 * (a + b)
    noise = (scale * 0.5 * (a - b)).square()
    relative = lambda squared: (squared / ((scale * reference.clamp(min=0.0)).square() + LOSS_FLOOR)).clamp(max=losses.LARGEST_RELATIVE)
    error = lambda x: relative((scale * (x - reference)).square() - noise).mean()
    before = torch.maximum(error(merged), losses.LEAST_OWN_SHARE * relative(noise).mean()) + losses.LEAST_RELATIVE
    return error(mixed(share, inputs, limit, merged, own)) / before


def train(frames, steps, seed=1):
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    share = OwnShare()
    optimizer = torch.optim.Adam(share.parameters(), LEARNING_RATE)
    for step in range(steps):
        for group in optimizer.param_groups:
            group["lr"] = LEARNING_RATE * min(1.0, (step + 1) / 100) * (0.02 + 0.49 * (1.0 + math.cos(math.pi * step / steps)))
        chosen = [frames[i] for i in rng.integers(len(frames), size=FRAMES)]
        loss = sum(loss_of(share, frame, losses.random_scales(1)) for frame in chosen)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(share.parameters(), 1.0)
        optimizer.step()
    return share


@torch.no_grad()
def gain(share, frames):
    """Geometric mean over frames of the error, as a share of the smoothed merged frame's."""
    logs = []
    for frame in frames:
        inputs, limit, merged, own, a, b = (image.float() for image in frame)
        error = lambda x: max(losses.rel_mse(x, torch.stack([a, b], 1)), 1e-6)
        logs.append(math.log(error(mixed(share, inputs, limit, merged, own)) / error(merged)))
    return math.exp(np.mean(logs))


def to_bytes(share):
    return MAGIC + b"".join(map(export.halves_of, share.layers))


def from_bytes(data):
    if not data.startswith(MAGIC):
        raise ValueError(f"own share: expected the magic {MAGIC.decode()}")
    share = OwnShare()
    expected = len(MAGIC) + 2 * parameter_count(share)
    if len(data) != expected:
        raise ValueError(f"own share: {len(data)} bytes, expected {expected}")
    halves = torch.from_numpy(np.frombuffer(data, "<f2", offset=len(MAGIC)).astype(np.float32))
    with torch.no_grad():
        for layer in share.layers:
            for p in (layer.weight, layer.bias):
                p.copy_(halves[: p.numel()].view(p.shape))
                halves = halves[p.numel() :]
    return share


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("data")
    parser.add_argument("network")
    parser.add_argument("albedo")
    parser.add_argument("out")
    parser.add_argument("--steps", type=int, default=4000)
    args = parser.parse_args()
    torch.set_num_threads(1)
    network, albedo_network = export.read_weights(args.network), export.read_weights(args.albedo)
    learn, choose = [], []
    for folder in shots.complete_shots(args.data):
        if os.path.exists(f"{folder}/{shots.REMERGED}"):
            pairs = [pair for pair in shots.load_pairs(folder, shots.REMERGED) if not pair.of_shared_noise]
            batches.smooth_albedos(pairs, albedo_network)
            (choose if batches.is_held_out(folder) else learn).extend(prepared(network, pair) for pair in pairs)
    if not learn:
        raise SystemExit(f"{args.data}: expected shots with {shots.REMERGED}; merged_shots.py --again makes it")
    print(f"{len(learn)} frames to learn from, {len(choose)} to choose on", flush=True)
    share = train(learn, args.steps)
    export.write_weights(args.out, to_bytes(share))
    if choose:
        print(f"held-out shots: {gain(share, choose):.3f} of the error of the smoothed merged frame")


if __name__ == "__main__":
    main()
