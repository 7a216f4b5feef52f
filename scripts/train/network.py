"""The kernel-predicting network that smooths frames and merged frames, as PyTorch trains it.

A U-Net looks at a frame and its features and predicts, for each pixel of five scales, the weights of a 5x5 window and of the
four nearest pixels of the coarser scale's result (Bako et al. 2017; Vogels et al. 2018). All weights are positive and sum to
1: the network decides which pixels belong together, and never makes a colour. At the finest scale the 3x3 pixels of the frame
itself are in the same sum: what it shows sharp, merging has blurred. filter/smooth/ has the same in C++.
"""

import torch
import torch.nn as nn
import torch.nn.functional as F

CHANNELS = {"standard": (16, 24, 32, 48, 64), "small": (8, 16, 24, 32, 48), "albedo": (8, 16, 24, 24, 16)}
INPUTS = 20
FEATURES = 7  # albedo, normal, depth
WINDOW = 5
TAPS = WINDOW * WINDOW
COARSE_TAPS = 4
LOGITS = TAPS + COARSE_TAPS
OWN_WINDOW = 3
OWN_TAPS = OWN_WINDOW * OWN_WINDOW  # of the frame's own radiance, at the finest scale
OWN_BIAS = -3.0  # of their logits, before training
AFFINITIES = 4  # learned features of a pixel, by whose squared distances pixels of a window count less (Isik et al. 2021)
LEAST_CONFIDENCE = 1e-8
# Exposed radiance times this is what errors are measured on, with this added to their square's denominator.
LOSS_SCALE = 0.3
LOSS_FLOOR = 0.01
LARGEST_LOG_ERROR = 8.0
LARGEST_NOISE = 10.0  # as an input
IDENTITY = 5.0  # added to the logit of a window's own pixel
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


def compressed(irradiance):
    return 0.5 * torch.log1p(10.0 * irradiance.clamp(min=0.0))


def network_inputs(irradiance, variance, features, own_irradiance, own_features):
    """All input channels, from exposed radiance without albedo, its variance (negative: unknown), and features.

    `features` were merged with the weights of the radiance, `own_...` are those of the frame itself; of a single frame both
    are the same.
    """
    t = compressed(irradiance)
    grey = t.mean(1, keepdim=True)
    padded = replicate(grey, 2)
    mean = F.avg_pool2d(padded, 5, 1)
    deviation = (F.avg_pool2d(padded * padded, 5, 1) - mean * mean).clamp(min=0.0).sqrt()
    light = luminance(irradiance).clamp(min=0.0)
    known = variance >= 0.0
    relative = torch.log1p(variance.clamp(min=0.0).sqrt() / (light + 0.1)).clamp(max=LARGEST_NOISE)
    noise = torch.where(known, relative, -torch.ones_like(relative))
    own_grey = compressed(own_irradiance).mean(1, keepdim=True)
    return torch.cat([t, features, noise, deviation, own_features, own_grey], 1)


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
        self.window = nn.ModuleList(nn.Conv2d(k, count, 1) for k, count in zip(c, logit_counts(len(c))))
        # The first output is the logit of the confidence, the next are affinities; at the finest scale the last one is the
        # logit of the confidence in the frame's own radiance.
        self.confidence = nn.ModuleList(nn.Conv2d(k, 1 + AFFINITIES + (i == 0), 1) for i, k in enumerate(c))
        self.albedo = nn.Conv2d(c[0], 2 * TAPS, 1)  # windows of the merged albedo and of the frame's own
        self.error = nn.Conv2d(c[0], 1, 1)
        for head in [*self.window, *self.confidence, self.albedo, self.error]:
            nn.init.normal_(head.weight, std=0.01)
            nn.init.zeros_(head.bias)
        with torch.no_grad():
            self.albedo.bias[TAPS // 2 :: TAPS] = ALBEDO_CENTRE
            for head in self.window[:-1]:
                head.bias[TAPS:LOGITS] = torch.log(torch.tensor(BILINEAR)) + 1.0
            self.window[0].bias[LOGITS:] = OWN_BIAS
            for head in self.confidence:
                nn.init.normal_(head.weight[1:], std=0.1)
                head.bias[0] = 2.0
            self.error.bias.fill_(-3.0)

    def start_from_identity(self):
        """Lets the finest window begin with its own pixel: what is hardly noisy comes out as it is."""
        with torch.no_grad():
            self.window[0].bias[TAPS // 2] += IDENTITY

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

    def forward(self, inputs, irradiance, own_irradiance, divisor, own_divisor):
        """The smoothed radiance (exposed, with albedo again) and the log of its squared relative error.

        Width and height are multiples of 16.
        """
        f = self.features(inputs)
        of_pixels = [head(x) for head, x in zip(self.confidence, f)]
        of_scales = [torch.sigmoid(x[:, :1]).clamp(min=LEAST_CONFIDENCE) for x in of_pixels]
        own_confidence = torch.sigmoid(of_pixels[0][:, 1 + AFFINITIES :]).clamp(min=LEAST_CONFIDENCE)
        distances = [squared_distances(x[:, 1 : 1 + AFFINITIES]) for x in of_pixels]
        values, confidences = [irradiance], [of_scales[0]]
        for of_scale in of_scales[1:]:
            mean = F.avg_pool2d(confidences[-1], 2)
            values.append(F.avg_pool2d(confidences[-1] * values[-1], 2) / mean)
            confidences.append(mean * of_scale)
        result = None
        for scale in reversed(range(len(f))):
            own = (own_irradiance, own_confidence) if scale == 0 else None
            logits = self.window[scale](f[scale])
            result = mixed(logits, distances[scale], values[scale], confidences[scale], result, own)
        of_albedo = torch.softmax(self.albedo(f[0]) - torch.cat([distances[0], distances[0]], 1), 1)
        smooth_divisor = window_mean(of_albedo[:, :TAPS], divisor) + window_mean(of_albedo[:, TAPS:], own_divisor)
        log_error = self.error(f[0]).clamp(-12.0, LARGEST_LOG_ERROR)
        return result * smooth_divisor, log_error


def logit_counts(scales):
    """Logits of each scale: the window's, the coarser scale's but at the coarsest, the frame's own at the finest."""
    return [LOGITS + OWN_TAPS] + [LOGITS] * (scales - 2) + [TAPS]


def windows(x, side=WINDOW):
    """All windows: (batch, channels, side * side, height, width), row by row."""
    b, c, h, w = x.shape
    return F.unfold(replicate(x, side // 2), side).view(b, c, side * side, h, w)


def innermost(x):
    """Of 5x5 windows (batch, 25, height, width), the 3x3 in their middle."""
    b, _, h, w = x.shape
    return x.view(b, WINDOW, WINDOW, h, w)[:, 1:-1, 1:-1].reshape(b, OWN_TAPS, h, w)


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


def mixed(logits, distance, value, confidence, coarse, own):
    """Each pixel's window of `value`, by `confidence`, and the coarser result around it, by the softmax of the logits.

    `own` are value and confidence of the frame itself, or None. The logits of a window's pixels are less by their distance.
    """
    of_own = [logits[:, LOGITS:] - innermost(distance)] if own else []
    logits = torch.cat([logits[:, :TAPS] - distance, logits[:, TAPS:LOGITS], *of_own], 1)
    weights = torch.exp(logits - logits.detach().amax(1, keepdim=True))
    of_window = weights[:, :TAPS] * windows(confidence)[:, 0]
    total = of_window.sum(1, keepdim=True)
    result = (windows(value) * of_window.unsqueeze(1)).sum(2)
    if coarse is not None:
        of_coarse = weights[:, TAPS:LOGITS]
        total = total + of_coarse.sum(1, keepdim=True)
        result = result + (coarse_neighbours(coarse) * of_coarse.unsqueeze(1)).sum(2)
    if own:
        own_value, own_confidence = own
        of_own = weights[:, LOGITS:] * windows(own_confidence, OWN_WINDOW)[:, 0]
        total = total + of_own.sum(1, keepdim=True)
        result = result + (windows(own_value, OWN_WINDOW) * of_own.unsqueeze(1)).sum(2)
    return result / total.clamp(min=1e-30)


def parameter_count(network):
    return sum(p.numel() for p in network.parameters())
