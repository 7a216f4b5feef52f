"""Stutter of slow motion (Hanika, Tessari and Dachsbacher 2021, section 4 and figure 1): `mountains`, whose camera moves by parts of a
pixel a frame, averaged over time by the search with and without its subpixel refinement. Without its clouds, whose noise would count as
motion. Called by `scripts/bench antialias --stutter`."""

import cv2
import numpy as np

from benches.antialias.shots import antialias, read, render
from pictures.exposure import luminance

SPP = 32  # no aliasing, as little noise as the paper's frames: what is left is what averaging does
WARM_UP = 8  # frames until the history has its length
VARIANTS = {  # the options of becalm antialias
    "paper, without refinement": ["--preset", "paper", "--set", "refine_levels=0"],
    "paper, two levels refined": ["--preset", "paper"],
    "forward, without refinement": ["--preset", "forward", "--set", "refine_levels=0"],
    "forward": ["--preset", "forward"],
    "best": ["--preset", "best"],
}


def grey(image):
    """8 bits, as the optical flow takes them; the root spends them on the dark."""
    return (255 * np.sqrt(np.clip(luminance(image), 0, 1)) + 0.5).astype(np.uint8)


def flow(a, b):
    """Farneback's motion between two frames, in pixels, of 21x21 px windows."""
    return cv2.calcOpticalFlowFarneback(grey(a), grey(b), None, 0.5, 3, 21, 5, 7, 1.5, 0)


def stutter(source, made):
    """RMS over pixels and frames of the difference between the motion from frame to frame and the source's; and the source's RMS."""
    true = [flow(a, b) for a, b in zip(source, source[1:])][WARM_UP:]
    seen = [flow(a, b) for a, b in zip(made, made[1:])][WARM_UP:]
    mean_square = lambda flows: np.mean([np.mean(np.sum(of_pixels**2, axis=-1)) for of_pixels in flows])
    return np.sqrt(mean_square([s - t for s, t in zip(seen, true)])), np.sqrt(mean_square(true))


def table(becalm, output, size, frames):
    """Yields the lines of the table."""
    shot = output / f"{size[0]}x{size[1]}" / "mountains"
    render(becalm, "mountains", shot / "source", frames, size, SPP, 0)
    source = [read(shot / "source", frame) for frame in frames]
    yield "| method | stutter, px a frame | of the motion |"
    yield "| --- | --- | --- |"
    for name, options in VARIANTS.items():
        folder = shot / name.replace(", ", "_").replace(" ", "_")
        antialias(becalm, shot / "source", folder, options)
        off, motion = stutter(source, [read(folder, frame) for frame in frames])
        yield f"| {name} | {off:.4f} | {100 * off / motion:.1f} % |"
