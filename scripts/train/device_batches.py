"""Batches as batches.py has them, of which the rendered crops are cut and varied on the device that trains. A processor makes some
hundred crops a second; a GPU learns from thousands. Crops that are made (backgrounds, textures) come from other processes."""

import functools

import numpy as np
import torch

import batches
import rare_crops
from network import FEATURES


def as_images(flags, x):
    """One value of each crop, in a shape that goes with the images `x`."""
    return flags.view(-1, *[1] * (x.dim() - 1))


def own_features(pair):
    return pair.features[2 if pair.merged else 0]


def smoothed_albedo(pair):
    return own_features(pair)[:3] if pair.smoothed_albedo is None else pair.smoothed_albedo


class RenderedCrops:
    """All pairs, which must be of one size, as half floats on the device."""

    def __init__(self, pairs, device):
        height, width = pairs[0].color.shape[1:]
        self.count, self.height, self.width, self.device = len(pairs), height, width, device
        self.told = torch.tensor([len(pair.variances) for pair in pairs], device=device)
        self.merged = torch.tensor([pair.merged for pair in pairs], device=device)
        self.colors = self.images(6, pairs, batches.colors_of)
        self.deviations = self.images(2, pairs, lambda pair: np.concatenate([*pair.variances, *[np.zeros((1, height, width))] * 2])[:2])
        self.merged_features = self.images(FEATURES, pairs, lambda pair: pair.features[0])
        self.own_features = self.images(FEATURES, pairs, own_features)
        self.clean_features = self.images(FEATURES, pairs, lambda pair: pair.features[1])
        self.albedo = self.images(3, pairs, smoothed_albedo)
        self.references = self.images(6, pairs, lambda pair: np.concatenate([pair.references[0], pair.references[-1]]))

    def images(self, channels, pairs, channels_of):
        images = torch.empty(self.count, channels, self.height, self.width, dtype=torch.float16, device=self.device)
        for image, pair in zip(images, pairs):
            image.copy_(torch.from_numpy(np.ascontiguousarray(channels_of(pair), np.float16)))
        return images

    def batch(self, count, size):
        """As batches.batch, without backgrounds and textures; all random numbers are the device's."""
        chosen = torch.randint(self.count, (count,), device=self.device)
        places = self.random_places(count, size)
        cut = lambda images: images[chosen].flatten(2).gather(2, places.expand(-1, images.shape[1], -1)).unflatten(2, (size, size)).float()
        colors, references = cut(self.colors), cut(self.references)
        told, merged = self.told[chosen], self.merged[chosen]
        of_file = (self.random(count) * told.clamp(min=1)).long()
        deviation = cut(self.deviations).gather(1, as_images(of_file, colors).expand(-1, 1, size, size))
        is_told = (told > 0) & (merged | (self.random(count) >= batches.WITHOUT_VARIANCE))
        variance = torch.where(as_images(is_told, deviation), deviation**2, -torch.ones_like(deviation))
        fireflies = as_images(merged & self.chance(count, batches.WITH_FIREFLIES), colors) & (
            self.random(count, 1, size, size) < rare_crops.FIREFLIES)
        own = torch.where(fireflies, 10 ** (1 + 5 * self.random(count, 1, 1, 1)), colors[:, 3:])
        features = self.features_of(cut, merged)
        return self.varied(torch.cat([colors[:, :3], own], 1), variance, features, references)

    def random(self, *shape):
        return torch.rand(*shape, device=self.device)

    def chance(self, count, share):
        return self.random(count) < share

    def random_places(self, count, size):
        """Indices of the pixels of random crops, mirrored and transposed: (count, 1, size * size)."""
        steps = torch.arange(size, device=self.device)
        maybe_mirrored = lambda: torch.where(self.random(count, 1) < 0.5, size - 1 - steps, steps.expand(count, -1))
        down, across = maybe_mirrored()[:, :, None], maybe_mirrored()[:, None, :]
        transposed = self.random(count, 1, 1) < 0.5
        rows = torch.where(transposed, down.transpose(1, 2), down)
        columns = torch.where(transposed, across.transpose(1, 2), across)
        corner = lambda room: (self.random(count, 1, 1) * (room + 1)).long()
        places = (rows + corner(self.height - size)) * self.width + columns + corner(self.width - size)
        return places.view(count, 1, size * size)

    def features_of(self, cut, merged):
        own, clean = cut(self.own_features), cut(self.clean_features)
        count = len(own)
        smoothed = as_images(self.chance(count, batches.SMOOTHED_ALBEDO), own)
        own = torch.cat([torch.where(smoothed, cut(self.albedo), own[:, :3]), own[:, 3:]], 1)
        first = torch.where(as_images(merged, own), cut(self.merged_features), own)
        is_clean = as_images(self.chance(count, batches.CLEAN_FEATURES), own)
        return torch.where(is_clean, torch.cat([clean, clean], 1), torch.cat([first, own], 1))

    def varied(self, colors, variance, features, references):
        """With random exposure, channels and axes, and without some features, as batches.crop has it."""
        count = len(colors)
        nothing = self.chance(count, batches.BEAUTY_ALONE)
        features = features.unflatten(1, (2, FEATURES))
        without = lambda share, part, value: torch.where(
            as_images(nothing | self.chance(count, share), part), torch.full_like(part, value), part)
        albedo = without(batches.WITHOUT_ALBEDO, features[:, :, :3], 1.0)
        normal = without(batches.WITHOUT_NORMAL, features[:, :, 3:6], 0.0)
        depth = without(batches.WITHOUT_DEPTH, features[:, :, 6:], 0.0)
        channels, axes = (torch.argsort(self.random(count, 3), 1) for _ in range(2))
        permuted = lambda order, x: x.gather(2, order.view(count, 1, 3, 1, 1).expand_as(x))
        signs = torch.where(self.random(count, 1, 3, 1, 1) < 0.5, -1.0, 1.0)
        features = torch.cat([permuted(channels, albedo), permuted(axes, normal) * signs, depth], 2).flatten(1, 2)
        gain = torch.exp(batches.EXPOSURE_SPREAD * torch.randn(count, 1, 1, 1, device=self.device))
        colors = permuted(channels, (gain * colors).unflatten(1, (2, 3))).flatten(1, 2)
        references = permuted(channels, (gain * references).unflatten(1, (2, 3)))
        return [colors, torch.where(variance < 0, variance, gain**2 * variance), features, references]


def stream(pairs, count, size, seed, workers, device, shared=False):
    """Batches without end, on the device."""
    torch.manual_seed(seed[0] + seed[1])
    rendered = RenderedCrops(pairs, device)
    made_count = round(count * (batches.WITH_BACKGROUND + (1 - batches.WITH_BACKGROUND) * batches.TEXTURED))
    unshared = [pair for pair in pairs if not pair.of_shared_noise]
    made = batches.stream(unshared, made_count, size, seed, workers, functools.partial(batches.made_crop, shared=shared))
    while True:
        columns = zip(rendered.batch(count - made_count, size), next(made))
        yield [torch.cat([a, b.to(device, non_blocking=True)]) for a, b in columns]
