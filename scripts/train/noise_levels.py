"""How many samples the noisy frames of a shot get: by the shot's own noise, so that shots of all renderers and lights spread
from frames that are nearly clean to frames that show hardly anything, as far as 1 to 64 samples reach. Which of its
frames get references, and how many shots may fail."""

import math

FEWEST, MOST = 1, 64
CLEANEST, NOISIEST = 0.003, 3.0  # relative squared error of a noisy frame
MOST_FAILED = 0.5  # of the seeds, before making shots counts as failed


def sample_count(sample_noise, relative_error):
    """The power of two nearest to what gives frames that error, if one sample of a pixel has `sample_noise`."""
    wanted = max(sample_noise, 1e-9) / relative_error
    return min(max(2 ** round(math.log2(wanted)), FEWEST), MOST)


def noise_levels(sample_noise, random):
    """Two different sample counts: that of all frames, and a second one of those with references. `random` draws uniformly from
    [0, 1)."""
    first, second = (sample_count(sample_noise, CLEANEST * (NOISIEST / CLEANEST) ** random()) for _ in range(2))
    if first == second:
        second = first // 2 if first == MOST else 2 * first
    return [first, second]


def reference_samples(levels, least):
    """Of each of two references: twice the samples of the cleanest noisy frame, and no fewer than `least`."""
    return max(least, 2 * max(levels))


def evenly_spread(frames, count):
    """`count` of the frames, with as many before the first as after the last: 5 of 1 to 8 for one."""
    return [frames[(2 * place + 1) * len(frames) // (2 * count)] for place in range(count)]
