"""Channels that are zero in every pixel: training cannot reach them, since a rectification that never lets anything pass has
no gradient. `revive` gives them random inputs and takes their outputs away, so that the network's results stay as they are."""

import torch

import losses


def convolutions(network):
    """The rectified convolutions in the order of evaluation, each with the layers that read it: (layer, first channel)."""
    c = network.channels
    last = len(c) - 1
    made = []
    for i, layer in enumerate(network.encode):
        if i < last:
            readers = [(network.encode[i + 1].conv, 0), (network.decode[i].conv, c[i + 1])]
        else:
            readers = [(network.decode[i - 1].conv, 0), (network.window[i], 0), (network.confidence[i], 0)]
        made.append((layer.conv, readers))
    for i in reversed(range(last)):
        if i > 0:
            readers = [(network.decode[i - 1].conv, 0), (network.window[i], 0), (network.confidence[i], 0)]
        else:
            readers = [(network.finish.conv, 0)]
        made.append((network.decode[i].conv, readers))
    heads = (network.window[0], network.confidence[0], network.albedo, network.error)
    made.append((network.finish.conv, [(head, 0) for head in heads]))
    return made


def outputs_of(network, conv, frames):
    """What `conv` reads and writes, before the rectification, of each frame: lists of (channels, height, width)."""
    seen = []
    hook = conv.register_forward_hook(lambda _, inputs, output: seen.append((inputs[0][0], output[0])))
    for frame in frames:
        losses.smoothed(network, frame)
    hook.remove()
    return zip(*seen)


def mean_over(images, measure):
    return torch.stack([measure(image) for image in images]).mean(0)


def deviation(image):
    return image.std((1, 2))


@torch.no_grad()
def revive(network, frames):
    """Revives what is dead on `frames` (batches of one, as batches.whole_frame makes them); returns how many channels were."""
    revived = 0
    for conv, readers in convolutions(network):
        inputs, outputs = outputs_of(network, conv, frames)
        alive = torch.stack([image.amax((1, 2)) for image in outputs]).amax(0) > 0
        dead = (~alive).nonzero().flatten().tolist()
        if not dead:
            continue
        typical = mean_over(outputs, deviation)[alive].median() if alive.any() else torch.tensor(1.0)
        scale = mean_over(inputs, deviation).clamp(min=1e-3).view(-1, 1, 1)
        for channel in dead:
            conv.weight[channel] = torch.randn_like(conv.weight[channel]) / scale
            conv.bias[channel] = 0
            for reader, first in readers:
                reader.weight[:, first + channel] = 0
        _, outputs = outputs_of(network, conv, frames)
        spread = mean_over(outputs, deviation)
        middle = mean_over(outputs, lambda image: image.mean((1, 2)))
        for channel in dead:
            gain = typical / spread[channel].clamp(min=1e-6)
            conv.weight[channel] *= gain
            conv.bias[channel] = -gain * middle[channel]
        revived += len(dead)
    return revived
