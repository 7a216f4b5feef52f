"""Random crops of training pairs, varied so that a network serves every kind of sequence."""

import os

import numpy as np
import torch

import albedo_noise
import backgrounds
import losses
import rare_crops
import shared_noise
import shots

CROP = 80
EXPOSURE_SPREAD = 0.7  # standard deviation of the log of the random exposure
# Shares of crops that lack a feature, or have it clean.
WITHOUT_ALBEDO = 0.15
WITHOUT_NORMAL = 0.2
WITHOUT_DEPTH = 0.2
WITHOUT_VARIANCE = 0.4
BEAUTY_ALONE = 0.07
CLEAN_FEATURES = 0.35
SMOOTHED_ALBEDO = 0.4  # of the others; as all presets do but `draft`, whose input must not be forgotten
WITH_BACKGROUND = 0.12
TEXTURED = 0.1  # of the crops without such a background
WITH_FIREFLIES = 0.2  # of the crops of merged frames


def with_features_dropped(rng, features):
    """Features (2 x 7 channels) with some taken away, as the filter packs a frame that lacks them."""
    features = features.copy().reshape(2, 7, *features.shape[1:])
    nothing = rng.random() < BEAUTY_ALONE
    if nothing or rng.random() < WITHOUT_ALBEDO:
        features[:, :3] = 1.0
    if nothing or rng.random() < WITHOUT_NORMAL:
        features[:, 3:6] = 0.0
    if nothing or rng.random() < WITHOUT_DEPTH:
        features[:, 6] = 0.0
    return features.reshape(14, *features.shape[2:])


def features_of(pair, clean, smoothed):
    """The merged features, then the frame's own: 2 x 7 channels; of the references, or with the albedo smoothed."""
    if clean:
        return np.concatenate([pair.features[1]] * 2)
    own = pair.features[2 if pair.merged else 0]
    if smoothed and pair.smoothed_albedo is not None:
        own = np.concatenate([pair.smoothed_albedo, own[3:]])
    return np.concatenate([pair.features[0] if pair.merged else own, own])


def colors_of(pair):
    """The radiance to smooth, then the frame's own: 6 channels."""
    return np.concatenate([pair.color, pair.own if pair.merged else pair.color])


def crop(rng, pair, size, shared=False):
    """One crop as float32 arrays: radiance, variance, features, references. `shared`: some of those that are made get noise that
    neighbours share."""
    if pair.of_albedo or pair.of_shared_noise or rng.random() >= WITH_BACKGROUND + (1 - WITH_BACKGROUND) * TEXTURED:
        return varied(rng, pair, *cut_out(rng, pair, size))
    return made_crop(rng, pair, size, shared)


def made_crop(rng, pair, size, shared=False):
    """One of those crops that are made, in part or all."""
    of_background = WITH_BACKGROUND / (WITH_BACKGROUND + (1 - WITH_BACKGROUND) * TEXTURED)
    if rng.random() < of_background:
        made = with_background(rng, pair, size)
    else:
        made = rare_crops.textured_crop(rng, size, random_history(rng, pair))
    if shared and rng.random() < shared_noise.SHARE_OF_MADE:
        made = shared_noise.convolved_crop(made, shared_noise.random_kernel(rng))
    return varied(rng, pair, *made)


def random_history(rng, pair):
    return rng.integers(2, 13) if pair.merged else 1


def with_background(rng, pair, size):
    colors, variance, features, references = cut_out(rng, pair, size)
    background = backgrounds.random_background(rng, size)
    colors, variance, features, references = backgrounds.put_behind(
        rng, background, colors, variance, features, references, random_history(rng, pair))
    if not pair.independent:
        references[1] = references[0]
    return colors, variance, features, references


def cut_out(rng, pair, size):
    """A random place of the pair: radiance, variance, features, references."""
    height, width = pair.color.shape[1:]
    y = rng.integers(height - size + 1)
    x = rng.integers(width - size + 1)
    cut = lambda a: a[..., y : y + size, x : x + size].astype(np.float32)
    colors = cut(colors_of(pair))
    features = cut(features_of(pair, rng.random() < CLEAN_FEATURES, rng.random() < SMOOTHED_ALBEDO))
    variance = np.full((1, size, size), -1.0, np.float32)
    if pair.variances and (pair.merged or rng.random() >= WITHOUT_VARIANCE):
        variance = cut(pair.variances[rng.integers(len(pair.variances))]) ** 2
    references = np.stack([cut(r) for r in (pair.references[0], pair.references[-1])])
    if pair.of_albedo and rng.random() < albedo_noise.SHARE:
        noisy, truth = albedo_noise.with_noise(rng, references[0])
        colors, references = np.concatenate([noisy, noisy]), np.stack([truth, truth])
    return colors, variance, features, references


def varied(rng, pair, colors, variance, features, references):
    """With random exposure, channels, axes and orientation, fireflies, and without some features."""
    if pair.merged and rng.random() < WITH_FIREFLIES:
        colors[3:] = rare_crops.with_fireflies(rng, colors[3:])
    features = with_features_dropped(rng, features)
    gain = np.exp(rng.normal() * EXPOSURE_SPREAD)
    variance = np.where(variance < 0, variance, variance * gain**2)

    channels = rng.permutation(3)
    colors = colors[[*channels, *(3 + channels)]] * gain
    references = references[:, channels] * gain
    axes = rng.permutation(3)
    signs = rng.choice([-1.0, 1.0], (3, 1, 1)).astype(np.float32)
    albedos, normals = [0, 7], [3, 10]
    for first in albedos:
        features[first : first + 3] = features[first : first + 3][channels]
    for first in normals:
        features[first : first + 3] = features[first : first + 3][axes] * signs
    arrays = [colors, variance, features, references]
    if rng.random() < 0.5:
        arrays = [a[..., ::-1] for a in arrays]
    if rng.random() < 0.5:
        arrays = [a[..., ::-1, :] for a in arrays]
    if rng.random() < 0.5:
        arrays = [np.swapaxes(a, -1, -2) for a in arrays]
    return [np.ascontiguousarray(a, np.float32) for a in arrays]


def batch(rng, pairs, count, size=CROP, make=crop):
    crops = [make(rng, pairs[rng.integers(len(pairs))], size) for _ in range(count)]
    return [torch.from_numpy(np.stack(column)) for column in zip(*crops)]


class Stream(torch.utils.data.IterableDataset):
    """Batches without end. Each process that makes some has its own random numbers."""

    def __init__(self, pairs, count, size, seed, make):
        self.pairs, self.count, self.size, self.seed, self.make = pairs, count, size, seed, make

    def __iter__(self):
        worker = torch.utils.data.get_worker_info()
        rng = np.random.default_rng([*self.seed, worker.id if worker else 0])
        while True:
            yield batch(rng, self.pairs, self.count, self.size, self.make)


def stream(pairs, count, size, seed, workers, make=crop):
    """An iterator over batches of `count` crops, made by `workers` processes, or by this one if there are none."""
    return iter(torch.utils.data.DataLoader(Stream(pairs, count, size, seed, make), batch_size=None, num_workers=workers))


def whole_frame(pair):
    """A whole pair as a batch of one, cut to multiples of 16."""
    height, width = (n // 16 * 16 for n in pair.color.shape[1:])
    cut = lambda a: torch.from_numpy(np.asarray(a)[..., :height, :width].astype(np.float32))[None]
    variance = cut(pair.variances[0]) ** 2 if pair.variances else -torch.ones(1, 1, height, width)
    return [cut(colors_of(pair)), variance, cut(features_of(pair, clean=False, smoothed=True)), cut(np.stack(pair.references))]


@torch.no_grad()
def smooth_albedos(pairs, network):
    """Adds to each pair its frame's albedo as `network` smooths it. Width and height are multiples of 16."""
    for pair in pairs:
        features = pair.features[2 if pair.merged else 0]
        surface = np.concatenate([np.ones_like(features[:3]), features[3:]])
        albedo = shots.Pair(pair.name, features[:3], [], [surface], [features[:3]], of_albedo=True)
        smoothed, _ = losses.smoothed(network, whole_frame(albedo))
        pair.smoothed_albedo = smoothed[0].clamp(0, 1).numpy().astype(np.float16)


def is_held_out(folder):
    """Every tenth seed of each renderer is what checkpoints are chosen on."""
    return int(folder.rsplit("-", 1)[1]) % 10 == 9


def load(data, renderer="", albedo=False, shared=False):
    """Pairs to learn from, of one renderer's shots or of all, and pairs of all to choose on; of radiance or of albedo.
    `shared`: also with noise that neighbours share."""
    learn, choose = [], []
    for folder in shots.complete_shots(data):
        pairs = shots.load_shot(folder)
        if is_held_out(folder):
            pairs = [pair for pair in pairs if pair.independent]
        if albedo:
            pairs = shots.of_albedo(pairs)
        elif shared:
            pairs += shared_noise.some_convolved(pairs)
        else:
            pairs = [pair for pair in pairs if not pair.of_shared_noise]
        if is_held_out(folder):
            choose.extend(pairs)
        elif os.path.basename(folder).startswith(renderer):
            learn.extend(pairs)
    return learn, choose
