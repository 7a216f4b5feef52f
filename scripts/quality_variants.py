"""What is compared: ways to run `becalm denoise`. A new row here is all that a new variant takes."""

import re
import subprocess
from dataclasses import dataclass


@dataclass(frozen=True)
class Variant:
    name: str              # of files, and on the command line
    title: str
    options: tuple = ()    # of `becalm denoise`
    without: tuple = ()    # layers of the input that it is not given
    ablation: bool = False  # one idea changed: measured at the samples of --ablation-spp alone
    history: str = ""      # of an ideal merge of still pixels: "before" has the frames up to this one, "all" every frame
    segment: int = 0       # frames of a segment, where seams are looked for


def settings(*assignments, preset="final"):
    return ("--preset", preset, *(word for assignment in assignments for word in ("--set", assignment)))


FORWARD = ("directions=forward", "smooth=none")
SMOOTHER = ("directions=both", "smooth=none")
WARMUP = ("--warmup", "8")

NOISY = Variant("noisy", "noisy")
VARIANTS = [
    NOISY,
    Variant("mask", "paper's mask mode", settings("merge=mask", *FORWARD), history="before"),
    Variant("forward", "variance, forward", settings(*FORWARD), history="before"),
    Variant("smoother", "smoother", settings(*SMOOTHER), history="all"),
    Variant("final", "smoother + smooth", settings("directions=both", "smooth=atrous")),
    Variant("balanced", "preset balanced", settings(preset="balanced")),
    Variant("draft", "preset draft", settings(preset="draft")),
    Variant("spatial", "spatial stage alone", settings("merge=none", "directions=forward", "smooth=atrous")),
    Variant("segment_8", "smoother, segments of 8", (*settings(*SMOOTHER), "--segment", "8", *WARMUP), ablation=True, segment=8),
    Variant("segment_5", "smoother, segments of 5", (*settings(*SMOOTHER), "--segment", "5", *WARMUP), ablation=True, segment=5),
] + [Variant(name, title, settings(*FORWARD, *changed), without, ablation=True) for name, title, changed, without in [
    ("half_buffers", "forward, variance from half-buffers", (), ("variance",)),
    ("estimated", "forward, variance estimated", (), ("variance", "half_a", "half_b")),
    ("no_bias", "forward, no bias estimate", ("significance=20",), ()),
    ("all_bias", "forward, bias without significance", ("significance=0",), ()),
    ("small_patch", "forward, weights from 3x3 patches", ("patch_radius=1",), ()),
    ("short_history", "forward, history of 8 frames at most", ("max_history=8",), ()),
    ("radiance_alone", "forward, matching radiance alone", ("weight_albedo=0", "weight_normal=0"), ()),
    ("guides_alone", "forward, matching albedo and normal alone", ("weight_radiance=0",), ()),
    ("demodulated", "forward, matching demodulated radiance", ("demodulate=1",), ()),
    ("unfiltered", "forward, matching without prefilter", ("prefilter=0",), ()),
    ("motion_guides", "forward, motion vectors as candidates", ("motion=guide",), ()),
    ("motion_vectors", "forward, motion vectors in place of the search", ("motion=override",), ()),
    ("bilinear", "forward, bilinear resampling", ("resample=bilinear",), ()),
    ("catmull_rom", "forward, Catmull-Rom resampling", ("resample=catmull_rom",), ()),
    ("validate_guides", "forward, rejection by depth, normal and id", ("validate=guides",), ()),
    ("clamp", "forward, colour-box clamp", ("validate=clamp",), ()),
    ("variance_clip", "forward, variance clipping", ("validate=variance_clip",), ()),
]] + [Variant(name, title, settings(*changed), ablation=True) for name, title, changed in [
    ("forward_smooth", "forward + smooth", ("directions=forward",)),
    ("atrous", "smoother + a-trous", ("directions=both", "smooth=atrous")),
    ("regression", "smoother + regression", ("directions=both", "smooth=regression")),
]]

# A program that does not know these settings does what these values say.
PLAIN = {"directions": "forward", "smooth": "none", "resample": "catmull_rom"}


class Program:
    """A becalm executable, and which variants it knows."""

    def __init__(self, path):
        self.path = path
        text = subprocess.run([path, "denoise", "--help"], check=True, capture_output=True, text=True).stdout
        self.settings = set(re.findall(r"^  (\w+) {2,}", text.partition("Settings that --set changes")[2], re.MULTILINE))

    def options(self, variant):
        """Those of `denoise`, without settings that only say what this program does anyway."""
        words = list(variant.options)
        for key, value in PLAIN.items():
            if key not in self.settings and f"{key}={value}" in words:
                place = words.index(f"{key}={value}")
                del words[place - 1:place + 1]
        return words

    def refusal(self, variant):
        """Why the program does not take the variant; empty if it does. Options are checked before any file is looked for."""
        if variant is NOISY:
            return ""
        run = subprocess.run([self.path, "denoise", "none.####.exr", "-o", "never.####.exr", *self.options(variant)],
                             capture_output=True, text=True)
        wrong_usage = 2
        return run.stderr.strip().splitlines()[0].partition("; there are")[0] if run.returncode == wrong_usage else ""
