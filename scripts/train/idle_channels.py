"""Starts channels anew that are zero wherever one looks: a ReLU that has died learns nothing more.

Their weights are drawn again, and what reads them begins with the weight 0, so the network's results do not change.
"""

import torch
import torch.nn as nn

import batches
import losses


@torch.no_grad()
def largest_outputs(network, pairs):
    """By layer, the largest output of each channel on the pairs' frames."""
    largest = {}

    def note(layer, _, output):
        found = output.amax((0, 2, 3))
        largest[layer] = torch.maximum(largest[layer], found) if layer in largest else found

    layers = [*network.encode, *network.decode, network.finish]
    hooks = [layer.register_forward_hook(note) for layer in layers]
    device = next(network.parameters()).device
    for pair in pairs:
        losses.smoothed(network, [t.to(device) for t in batches.whole_frame(pair)])
    for hook in hooks:
        hook.remove()
    return largest


def readers(network, layer):
    """The convolutions that read a layer's output, each with the number of its first input that does."""
    last = len(network.channels) - 1
    of_scale = lambda i: [(network.window[i], 0), (network.confidence[i], 0)]
    if layer is network.finish:
        return [*of_scale(0), (network.albedo, 0), (network.error, 0)]
    if layer in list(network.encode):
        i = list(network.encode).index(layer)
        if i == last:
            return [*of_scale(i), (network.decode[i - 1].conv, 0)]
        return [(network.encode[i + 1].conv, 0), (network.decode[i].conv, network.channels[i + 1])]
    i = list(network.decode).index(layer)
    return [(network.finish.conv, 0)] if i == 0 else [*of_scale(i), (network.decode[i - 1].conv, 0)]


@torch.no_grad()
def restart(network, pairs):
    """Starts the channels anew that are zero on all frames of `pairs`; returns how many there were."""
    count = 0
    for layer, largest in largest_outputs(network, pairs).items():
        idle = torch.nonzero(largest <= 0)[:, 0]
        count += len(idle)
        fresh = torch.empty_like(layer.conv.weight)
        nn.init.kaiming_normal_(fresh, nonlinearity="relu")
        layer.conv.weight[idle] = fresh[idle]
        layer.conv.bias[idle] = 0.0
        for reader, first in readers(network, layer):
            reader.weight[:, first + idle] = 0.0
    return count
