"""What the network is trained by, and the figures that training is followed by."""

import torch

from network import FEATURES, LOSS_FLOOR, LOSS_SCALE, divisor_of, network_inputs

# A pixel counts for at most this: else fireflies of the references rule the gradient.
LARGEST_RELATIVE = 16.0
LEAST_RELATIVE = 1e-4
LEAST_OF_ALBEDO = 2e-4  # with less the network learns to do nothing
LEAST_OWN_SHARE = 0.25  # of a crop's error against noisy references that is taken to be the result's own, at least
SHARE_OF_PROPORTION = 0.15
SHARE_OF_SMAPE = 0.3
SCALE_SPREAD = 1.2  # standard deviation of the logarithm
SHARE_OF_ERROR = 0.05


def smoothed(network, batch, layout=torch.channels_last):
    """The network's result for a batch, and the log of its relative squared error."""
    colors, variance, features, _ = batch
    features, own_features = features[:, :FEATURES], features[:, FEATURES:]
    divisor, own_divisor = divisor_of(features[:, :3]), divisor_of(own_features[:, :3])
    of_divisor = (divisor * divisor).mean(1, keepdim=True)
    known = variance >= 0
    irradiance_variance = torch.where(known, variance / of_divisor, variance)
    irradiance, own_irradiance = colors[:, :3] / divisor, colors[:, 3:] / own_divisor
    inputs = network_inputs(irradiance, irradiance_variance, features, own_irradiance, own_features)
    return network(inputs.contiguous(memory_format=layout), irradiance, own_irradiance, divisor, own_divisor)


def random_scales(count, generator=None):
    """How bright each crop of a batch is shown to the loss: what is dark in one shot counts fully in another."""
    return LOSS_SCALE * torch.exp(SCALE_SPREAD * torch.randn(count, 1, 1, 1, generator=generator))


def training_loss(result, log_error, references, scales, least=LEAST_RELATIVE):
    """A clamped relative squared error as a share of its size, SMAPE of the result, and the likelihood of its error.

    The gradient of the first is that of the error's logarithm; where references are two, their noise is not counted as error. The error is
    learned from (x-a)(x-b), whose mean is that of the squared error whatever the references' noise; not where both are one.
    """
    x = scales * result
    reference = 0.5 * scales * (references[:, 0] + references[:, 1])
    middle = 0.5 * (x.detach().clamp(min=0.0) + reference)
    relative_mean = lambda squared: (squared / (middle**2 + LOSS_FLOOR)).clamp(max=LARGEST_RELATIVE).mean((1, 2, 3))
    relative = relative_mean((x - reference) ** 2)
    smape = ((x - reference).abs() / (x.detach().abs() + reference.abs() + 0.02)).mean()
    own = LOSS_SCALE * result.detach()
    a, b = LOSS_SCALE * references[:, 0], LOSS_SCALE * references[:, 1]
    squared = ((own - a) * (own - b)).mean(1, keepdim=True) / ((own**2).mean(1, keepdim=True) + LOSS_FLOOR)
    squared = squared.clamp(-LARGEST_RELATIVE, LARGEST_RELATIVE)
    independent = (a != b).flatten(1).any(1).view(-1, 1, 1, 1)
    likelihood = torch.where(independent, log_error + squared * torch.exp(-log_error), torch.zeros_like(log_error)).mean()
    # Each crop counts by its own size of error, or the noisiest alone would be learned and detail of clean ones lost.
    with torch.no_grad():
        of_references = relative_mean((0.5 * scales * (references[:, 0] - references[:, 1])) ** 2)
        own_error = torch.maximum(relative - of_references, LEAST_OWN_SHARE * relative) + least
    proportion = (relative / own_error).mean()
    return SHARE_OF_PROPORTION * proportion + SHARE_OF_SMAPE * smape + SHARE_OF_ERROR * likelihood, relative.mean()


def rel_mse(x, references):
    """relMSE by the product of two references, on exposed radiance: frame/metrics.h has the definition."""
    x = LOSS_SCALE * x
    a, b = LOSS_SCALE * references[:, 0], LOSS_SCALE * references[:, 1]
    return ((x - a) * (x - b) / ((0.5 * (a + b)) ** 2 + LOSS_FLOOR)).mean().item()
