"""The compared variants: ways to run `becalm denoise`, and commands of other denoisers. A new variant needs only a new row here."""

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Variant:
    name: str               # in file names and on the command line
    title: str
    options: tuple = ()     # of `becalm denoise`
    without: tuple = ()     # layers that are removed from the input
    ablation: bool = False  # one idea changed; measured only at the sample counts of --ablation-spp
    history: str = ""       # frames that an ideal merge of still pixels has: "before", up to the current one, or "all"
    segment: int = 0        # frames per segment, if temporal error at seams is measured
    command: tuple = ()     # of another denoiser, in place of becalm; its words may name {noisy}, {denoised} and {frames}
    sources: tuple = ()     # files that the command's result depends on besides those among its words
    timed: bool = True      # False: the command's time is not that of the denoiser


def settings(*assignments, preset="final"):
    return ("--preset", preset, *(word for assignment in assignments for word in ("--set", assignment)))


WARMUP = ("--warmup", "8")

NOISY = Variant("noisy", "noisy")
VARIANTS = [
    NOISY,
    Variant("paper", "preset paper", settings(preset="paper"), history="before"),
    Variant("final", "preset final", settings(), history="all"),
    Variant("balanced", "preset balanced", settings(preset="balanced"), history="all"),
    Variant("draft", "preset draft", settings(preset="draft"), history="before"),
    Variant("single", "final, each frame alone", ("--preset", "final", "--segment", "1", "--warmup", "0"), ablation=True),
    Variant("segment_8", "final, segments of 8", (*settings(), "--segment", "8", *WARMUP), ablation=True, segment=8),
    Variant("segment_5", "final, segments of 5", (*settings(), "--segment", "5", *WARMUP), ablation=True, segment=5),
] + [Variant(name, title, settings(*changed), without, ablation=True) for name, title, changed, without in [
    ("forward_smooth", "final, forward", ("directions=forward",), ()),
    ("half_buffers", "final, variance from half-buffers", (), ("variance",)),
    ("variance_alone", "final without half-buffers", (), ("half_a", "half_b")),
    ("estimated", "final, variance estimated", (), ("variance", "half_a", "half_b")),
    ("beauty_alone", "final, of the beauty alone", (), ("variance", "half_a", "half_b", "albedo", "normal", "depth", "motion", "object_id")),
    ("noisy_albedo", "final, albedo not smoothed", ("smooth_albedo=0",), ()),
    ("large_patch", "final, weights from 7x7 patches", ("patch_radius=3",), ()),
    ("frames", "final, merging smoothed frames", ("smooth=frames",), ()),
    ("radiance_alone", "final, matching radiance alone", ("guides=0",), ()),
    ("motion_none", "final, without motion vectors", ("motion=none",), ()),
    ("motion_vectors", "final, motion vectors in place of the search", ("motion=override",), ()),
    ("bilinear", "final, bilinear resampling", ("resample=bilinear",), ()),
]]


def oidn(folder):
    """Open Image Denoise's networks of a folder of weights: the usual one, and the best that is published."""
    def evaluated(weights, *prefilters):
        options = ("--prefilter", *(f"{folder}/{name}" for name in prefilters)) if prefilters else ()
        return (sys.executable, "-m", "benches.quality.oidn", f"{folder}/{weights}", "{noisy}", "{denoised}", "{frames}", *options)

    evaluation = (str(Path(__file__).with_name("oidn.py")),)
    return [Variant("oidn", "OIDN, each frame alone", ablation=True, sources=evaluation, timed=False, command=evaluated("rt_hdr_alb_nrm.tza")),
            Variant("oidn_large", "OIDN, large, features prefiltered", ablation=True, sources=evaluation, timed=False,
                    command=evaluated("rt_hdr_calb_cnrm_large.tza", "rt_alb_large.tza", "rt_nrm_large.tza"))]


# A program that does not have one of these settings behaves as with this value.
PLAIN = {"directions": "forward", "smooth": "none", "smooth_albedo": "0", "resample": "catmull_rom"}


class Program:
    """A becalm executable, and the settings that it has."""

    def __init__(self, path):
        self.path = path
        text = subprocess.run([path, "denoise", "--help-settings"], check=True, capture_output=True, text=True).stdout
        self.settings = set(re.findall(r"^  (\w+) {2,}", text.partition("Settings that --set changes")[2], re.MULTILINE))

    def options(self, variant):
        """The options for `denoise`, without settings that this program lacks and whose value is its fixed behaviour."""
        words = list(variant.options)
        for key, value in PLAIN.items():
            if key not in self.settings and f"{key}={value}" in words:
                place = words.index(f"{key}={value}")
                del words[place - 1:place + 1]
        return words

    def refusal(self, variant):
        """The program's reason to refuse the variant's options, or "". It checks options before it looks for files."""
        if variant is NOISY or variant.command:
            return ""
        run = subprocess.run([self.path, "denoise", "none.####.exr", "-o", "never.####.exr", *self.options(variant)],
                             capture_output=True, text=True)
        wrong_usage = 2
        return run.stderr.strip().splitlines()[0].partition("; there are")[0] if run.returncode == wrong_usage else ""
