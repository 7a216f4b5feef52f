"""The kernel-predicting network that smooths single frames, as PyTorch trains it.

A U-Net looks at a frame and its features and predicts, for each pixel of five scales, the weights of a 5x5 window and of the
four nearest pixels of the coarser scale's result (Bako et al. 2017; Vogels et al. 2018). All weights are positive and sum to
1: the network decides which pixels belong together, and never makes a colour. filter/network/ has the same in C++.
"""

import torch
import torch.nn as nn
import torch.nn.functional as F

CHANNELS = {"standard": (16, 24, 32, 48, 64), "small": (8, 16, 24, 32, 48)}
INPUTS = 20  # 19, and a channel of zeros: four to a plane
FEATURES = 7  # albedo, normal, depth
WINDOW = 5
TAPS = WINDOW * WINDOW
COARSE_TAPS = 4
LOGITS = TAPS + COARSE_TAPS
AFFINITIES = 4  # learned features of a pixel, by whose squared distances pixels of a window count less (Isik et al. 2021)
LEAST_CONFIDENCE = 1e-8
# Exposed radiance times this is what errors are measured on, with this added to their square's denominator.
LOSS_SCALE = 0.3
LOSS_FLOOR = 0.01
LARGEST_LOG_ERROR = 8.0
ALBEDO_CENTRE = 3.0  # added to the logit of the albedo window's own pixel
# Logits of a bilinear upsampling, from which the weights of the coarser scale's pixels start.
BILINEAR = (0.5625, 0.1875, 0.1875, 0.0625)


def divisor_of(albedo):
    """What radiance is divided by, as shaders/lib/reflectance.glsl."""
    return albedo.clamp(min=0.04)


def luminance(rgb):
    weights = rgb.new_tensor((0.2126, 0.7152, 0.0722)).view(1, 3, 1, 1)
    return (rgb * weights).sum(1, keepdim=True)


def replicate(x, pad):
    return F.pad(x, (pad, pad, pad, pad), mode="replicate")


def network_inputs(irradiance, variance, features, own):
    """All input channels, from exposed radiance without albedo, its variance (negative: unknown), and features.

    `features` were merged with the weights of the radiance, `own` are those of the frame itself; of a single frame both are
    the same.
    """
    t = 0.5 * torch.log1p(10.0 * irradiance.clamp(min=0.0))
    grey = t.mean(1, keepdim=True)
    padded = replicate(grey, 2)
    mean = F.avg_pool2d(padded, 5, 1)
    deviation = (F.avg_pool2d(padded * padded, 5, 1) - mean * mean).clamp(min=0.0).sqrt()
    light = luminance(irradiance).clamp(min=0.0)
    known = variance >= 0.0
    relative = torch.log1p(variance.clamp(min=0.0).sqrt() / (light + 0.1))
    noise = torch.where(known, relative, -torch.ones_like(relative))
    return torch.cat([t, features, noise, deviation, own, torch.zeros_like(noise)], 1)


class Convolution(nn.Module):
    """3x3, the border's pixels repeated, with bias and ReLU."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.conv = nn.Conv2d(inputs, outputs, 3)
        nn.init.kaiming_normal_(self.conv.weight, nonlinearity="relu")
        nn.init.zeros_(self.conv.bias)

    def forward(self, x):
        return F.relu(self.conv(replicate(x, 1)))


class Network(nn.Module):
    def __init__(self, channels=CHANNELS["standard"]):
        super().__init__()
        c = tuple(channels)
        self.channels = c
        self.encode = nn.ModuleList(Convolution(i, o) for i, o in zip((INPUTS,) + c[:-1], c))
        self.decode = nn.ModuleList(Convolution(c[i + 1] + c[i], c[i]) for i in range(len(c) - 1))
        self.finish = Convolution(c[0], c[0])
        self.window = nn.ModuleList(nn.Conv2d(k, LOGITS if i + 1 < len(c) else TAPS, 1) for i, k in enumerate(c))
        # The first output is the logit of the confidence, the others are affinities.
        self.confidence = nn.ModuleList(nn.Conv2d(k, 1 + AFFINITIES, 1) for k in c)
        self.albedo = nn.Conv2d(c[0], 2 * TAPS, 1)  # windows of the merged albedo and of the frame's own
        self.error = nn.Conv2d(c[0], 1, 1)
        for head in [*self.window, *self.confidence, self.albedo, self.error]:
            nn.init.normal_(head.weight, std=0.01)
            nn.init.zeros_(head.bias)
        with torch.no_grad():
            self.albedo.bias[TAPS // 2 :: TAPS] = ALBEDO_CENTRE
            for head in self.window[:-1]:
                head.bias[TAPS:] = torch.log(torch.tensor(BILINEAR)) + 1.0
            for head in self.confidence:
                nn.init.normal_(head.weight[1:], std=0.1)
                head.bias[0] = 2.0
            self.error.bias.fill_(-3.0)

    def features(self, x):
        skips = []
        for i, layer in enumerate(self.encode):
            x = layer(x if i == 0 else F.max_pool2d(x, 2))
            skips.append(x)
        out = [None] * len(skips)
        out[-1] = skips[-1]
        for i in reversed(range(len(skips) - 1)):
            coarse = F.interpolate(out[i + 1], scale_factor=2, mode="nearest")
            out[i] = self.decode[i](torch.cat([coarse, skips[i]], 1))
        out[0] = self.finish(out[0])
        return out

    def forward(self, inputs, irradiance, divisor, own_divisor, valid=None):
        """The smoothed radiance (exposed, with albedo again) and the log of its squared relative error.

        Width and height are multiples of 16. `valid` is 0 for pixels that do not count, else 1.
        """
        f = self.features(inputs)
        of_pixels = [head(x) for head, x in zip(self.confidence, f)]
        confidence = [torch.sigmoid(x[:, :1]).clamp(min=LEAST_CONFIDENCE) for x in of_pixels]
        distances = [squared_distances(x[:, 1:]) for x in of_pixels]
        if valid is not None:
            confidence[0] = torch.where(valid > 0, confidence[0], torch.full_like(confidence[0], 1e-20))
        values, counts = [irradiance], [confidence[0]]
        for c in confidence[1:]:
            count = F.avg_pool2d(counts[-1], 2)
            values.append(F.avg_pool2d(counts[-1] * values[-1], 2) / count)
            counts.append(count * c)
        result = None
        for value, count, x, head, distance in reversed(list(zip(values, counts, f, self.window, distances))):
            result = mixed(head(x), distance, value, count, result)
        of_albedo = torch.softmax(self.albedo(f[0]) - torch.cat([distances[0], distances[0]], 1), 1)
        smooth_divisor = window_mean(of_albedo[:, :TAPS], divisor) + window_mean(of_albedo[:, TAPS:], own_divisor)
        log_error = self.error(f[0]).clamp(-12.0, LARGEST_LOG_ERROR)
        return result * smooth_divisor, log_error


def windows(x):
    """All 5x5 windows: (batch, channels, 25, height, width), row by row."""
    b, c, h, w = x.shape
    return F.unfold(replicate(x, WINDOW // 2), WINDOW).view(b, c, TAPS, h, w)


def squared_distances(affinities):
    """Of each pixel's affinities to those of the 25 pixels around it."""
    return (windows(affinities) - affinities.unsqueeze(2)).square().sum(1)


def window_mean(weights, x):
    return (windows(x) * weights.unsqueeze(1)).sum(2)


def coarse_neighbours(x):
    """For each pixel of the finer scale the four nearest of the coarser: its own, that beside, above or below, diagonal."""
    b, c, h, w = x.shape
    p = replicate(x, 1)
    own = x
    left, right = p[..., 1:-1, :-2], p[..., 1:-1, 2:]
    above, below = p[..., :-2, 1:-1], p[..., 2:, 1:-1]
    corner = [p[..., :-2, :-2], p[..., :-2, 2:], p[..., 2:, :-2], p[..., 2:, 2:]]

    def interleave(top_left, top_right, bottom_left, bottom_right):
        top = torch.stack([top_left, top_right], -1).reshape(b, c, h, 2 * w)
        bottom = torch.stack([bottom_left, bottom_right], -1).reshape(b, c, h, 2 * w)
        return torch.stack([top, bottom], -2).reshape(b, c, 2 * h, 2 * w)

    return torch.stack([
        interleave(own, own, own, own),
        interleave(left, right, left, right),
        interleave(above, above, below, below),
        interleave(*corner),
    ], 2)


def mixed(logits, distance, value, count, coarse):
    """Each pixel's window of `value`, counted by `count`, and the coarser result around it, by the softmax of the logits.

    The logits of the window's pixels are less by their distance.
    """
    logits = torch.cat([logits[:, :TAPS] - distance, logits[:, TAPS:]], 1)
    weights = torch.exp(logits - logits.detach().amax(1, keepdim=True))
    of_window = weights[:, :TAPS] * windows(count)[:, 0]
    total = of_window.sum(1, keepdim=True)
    result = (windows(value) * of_window.unsqueeze(1)).sum(2)
    if coarse is not None:
        of_coarse = weights[:, TAPS:]
        total = total + of_coarse.sum(1, keepdim=True)
        result = result + (coarse_neighbours(coarse) * of_coarse.unsqueeze(1)).sum(2)
    return result / total.clamp(min=1e-30)


def parameter_count(network):
    return sum(p.numel() for p in network.parameters())
