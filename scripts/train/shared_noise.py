"""Noise that neighbouring pixels share, as renderers make it that add each sample to several pixels, weighed by the pixel filter, instead of
sampling the filter (Ernst et al. 2006, "Filter importance sampling"). It is made of independent noise: frames, features and references
are convolved alike. Depths stay, as they are not filtered."""

import dataclasses

import numpy as np

import shots

LEAST_NEIGHBOUR, LARGEST_NEIGHBOUR = 0.02, 0.2  # weight of the next pixel along an axis
SHARE = 1 / 3  # of the pairs that are convolved as well
SHARE_OF_MADE = 0.5  # of the crops that are made, which are convolved


def random_kernel(rng):
    """Weights of five pixels along an axis, which sum to 1: from hardly more than the pixel to a Gaussian of 0.75 pixels; some have the
    negative lobes of sharpening filters."""
    next_one = rng.uniform(LEAST_NEIGHBOUR, LARGEST_NEIGHBOUR)
    second = next_one**2 * rng.uniform(-1, 1)
    return np.array([second, next_one, 1 - 2 * next_one - 2 * second, next_one, second], np.float32)


def convolved(image, kernel):
    """(channels, height, width), along both axes, with the border's pixels repeated."""
    for axis in (1, 2):
        padding = [(0, 0)] * 3
        padding[axis] = (2, 2)
        padded = np.pad(image, padding, "edge")
        image = sum(weight * np.take(padded, range(tap, tap + image.shape[axis]), axis) for tap, weight in enumerate(kernel))
    return image


def convolved_layers(layers, kernel):
    """Of a noisy frame or a reference; a variance becomes that of the convolved radiance."""
    kernels = {"variance": kernel**2}
    return {name: image if name == "depth" else convolved(image, kernels.get(name, kernel)) for name, image in layers.items()}


def convolved_pair(pair, kernel):
    """Of a frame that is not merged, exposed anew."""
    whole = lambda image: convolved(image.astype(np.float32), kernel)
    color = whole(pair.color)
    exposure = shots.exposure_of(color)
    features = [np.concatenate([whole(f[:6]), f[6:]]).astype(np.float16) for f in pair.features]
    deviations = [exposure * np.sqrt(convolved(d.astype(np.float32) ** 2, kernel**2)) for d in pair.variances]
    shot, name = pair.name.split("/")
    return dataclasses.replace(pair, name=f"{shot}/{shots.SHARED}{name}", color=shots.half(exposure * color),
                               variances=[d.clip(0, shots.FIREFLY).astype(np.float16) for d in deviations], features=features,
                               references=[shots.half(exposure * whole(r)) for r in pair.references])


def convolved_crop(crop, kernel):
    """A crop as batches.crop has it."""
    colors, variance, features, references = crop
    whole = lambda image: convolved(image, kernel)
    surfaces = [image for own in np.split(features, 2) for image in (whole(own[:6]), own[6:])]
    variance = np.where(variance < 0, variance, convolved(variance, kernel**2))
    return whole(colors), variance, np.concatenate(surfaces), np.stack([whole(r) for r in references])


def some_convolved(pairs):
    """Copies of some of the pairs that are not merged, each convolved by a kernel of its own; always the same of a shot."""
    copies = []
    for pair in pairs:
        rng = np.random.default_rng(list(pair.name.encode()))
        if not pair.merged and rng.random() < SHARE:
            copies.append(convolved_pair(pair, random_kernel(rng)))
    return copies
