"""Writes a trained network as the program embeds it: export.py TRAINED.pt OUT.weights

The file: the magic "becalmNW", then as little-endian 32-bit numbers the number of inputs and the channels of the five scales,
then all parameters as half floats, layer by layer: weights as [output][input][row][column], biases behind them. The order of
the layers is that of `layers` here and of filter/smooth/weights.cpp.
"""

import os
import struct
import sys

import numpy as np
import torch

from network import INPUTS, Network

MAGIC = b"becalmNW"


def layers(network):
    """All layers in the order of the file."""
    convolutions = [*network.encode, *network.decode, network.finish]
    return [layer.conv for layer in convolutions] + [*network.window, *network.confidence, network.albedo, network.error]


def halves_of(layer):
    """The weights and biases of a layer as the bytes of half floats."""
    parts = []
    for tensor in (layer.weight, layer.bias):
        halves = tensor.detach().cpu().numpy().astype("<f2")
        if not np.isfinite(halves).all():
            raise ValueError("a parameter is not a finite half float")
        parts.append(halves.tobytes())
    return b"".join(parts)


def to_bytes(network):
    return b"".join([MAGIC, struct.pack("<6I", INPUTS, *network.channels), *map(halves_of, layers(network))])


def write_weights(path, data):
    """Replaces the file by a whole one."""
    partial = f"{path}.partial"
    with open(partial, "wb") as file:
        file.write(data)
    os.replace(partial, path)


def from_bytes(data):
    """The network that a file holds."""
    if not data.startswith(MAGIC):
        raise ValueError(f"network weights: expected the magic {MAGIC.decode()}")
    sizes = struct.unpack_from("<6I", data, len(MAGIC))
    if sizes[0] != INPUTS:
        raise ValueError(f"network weights: {sizes[0]} inputs, expected {INPUTS}")
    network = Network(channels=sizes[1:])
    expected = len(MAGIC) + 24 + 2 * sum(parameter.numel() for parameter in network.parameters())
    if len(data) != expected:
        raise ValueError(f"network weights: {len(data)} bytes, expected {expected}")
    offset = len(MAGIC) + 24
    with torch.no_grad():
        for layer in layers(network):
            for tensor in (layer.weight, layer.bias):
                halves = np.frombuffer(data, "<f2", tensor.numel(), offset)
                tensor.copy_(torch.from_numpy(halves.astype(np.float32)).view(tensor.shape))
                offset += 2 * tensor.numel()
    return network


def read_weights(path):
    with open(path, "rb") as file:
        return from_bytes(file.read())


def load_trained(path):
    state = torch.load(path, map_location="cpu")
    network = Network(channels=state["channels"])
    network.load_state_dict(state["network"])
    return network


def main():
    trained, out = sys.argv[1:]
    write_weights(out, to_bytes(load_trained(trained)))


if __name__ == "__main__":
    main()
