"""What is compared: plain rendering, the presets, the presets with one setting changed, and the recipes that renderers commonly use."""

import re
import subprocess
from collections.abc import Callable
from dataclasses import dataclass

from benches.front.joint_bilateral import joint_bilateral
from benches.front.motion_average import motion_average
from benches.front.non_local_means import non_local_means
from benches.quality.variants import NOISY, Variant, settings

PLAIN = NOISY
PRESETS = [Variant(name, name, settings(preset=name)) for name in ("draft", "balanced", "final")]
PAPER = Variant("paper", "preset paper", settings(preset="paper"))


@dataclass(frozen=True)
class Recipe(Variant):
    filter: Callable = None  # of an iterable of (radiance, layers by plain name), in the order of frames: yields radiance
    needs: tuple = ()        # layers


RECIPES = [
    Recipe("non_local_means", "non-local means (OpenCV)", filter=non_local_means),
    Recipe("joint_bilateral", "joint bilateral of albedo and normal", filter=joint_bilateral, needs=("albedo", "normal")),
    Recipe("motion_average", "mean along motion vectors", filter=motion_average, needs=("motion",)),
]


def kind(method):
    """"plain", "preset", "setting" or "recipe"; the preset `paper` is a recipe."""
    if method is PLAIN:
        return "plain"
    if method in PRESETS:
        return "preset"
    return "recipe" if method is PAPER or isinstance(method, Recipe) else "setting"


def changed_presets(help_settings):
    """Each preset with one setting changed to the value that another preset has, by the text of `becalm denoise --help-settings`."""
    names = [preset.name for preset in PRESETS]
    found = []
    values_of = re.compile(rf"^  (\w+) {{2,}}\S.*\n(?: {{25}}.*\n)*? {{25}}({names[0]}: .*)$", re.MULTILINE)
    for key, values in values_of.findall(help_settings):
        value = dict(part.split(": ") for part in values.split("; "))
        for name in names:
            others = dict.fromkeys(value[other] for other in names if value[other] != value[name])
            found += [Variant(f"{name}.{key}={other}", f"{name}, {key}={other}", settings(f"{key}={other}", preset=name)) for other in others]
    return found


def settings_of(program):
    text = subprocess.run([program, "denoise", "--help-settings"], check=True, capture_output=True, text=True).stdout
    return changed_presets(text)
