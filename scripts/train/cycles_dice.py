"""Random choices of a generated shot: a pure function of the shot's seed."""

import colorsys
import math
import random

PALETTES = ("free", "natural", "natural", "muted", "clay", "warm", "cold", "dark", "two")


class Dice(random.Random):
    """A generator seeded by a text, with the draws that scenes need."""

    def __init__(self, *key):
        super().__init__("/".join(str(part) for part in key))
        self.palette = self.choice(PALETTES)
        self.base_hue = self.random()

    def chance(self, probability):
        return self.random() < probability

    def log_uniform(self, low, high):
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def pick(self, weights):
        """A key of a table of weights."""
        return self.choices(list(weights), list(weights.values()))[0]

    def direction(self):
        z, turn = self.uniform(-1.0, 1.0), self.uniform(0.0, math.tau)
        r = math.sqrt(1.0 - z * z)
        return (r * math.cos(turn), r * math.sin(turn), z)

    def turn(self):
        """Euler angles of any orientation."""
        return tuple(self.uniform(0.0, math.tau) for _ in range(3))

    def colour(self):
        """A linear RGBA reflectance in the shot's palette."""
        hue, saturation, value = self.random(), self.random() ** 0.7, self.uniform(0.05, 0.95)
        if self.palette in ("natural", "muted"):
            saturation *= 0.7 if self.palette == "natural" else 0.4
        elif self.palette == "clay":
            saturation, value = saturation * 0.1, self.uniform(0.4, 0.85)
        elif self.palette == "warm":
            hue = self.gauss(0.07, 0.05) % 1.0
        elif self.palette == "cold":
            hue = self.gauss(0.58, 0.07) % 1.0
        elif self.palette == "dark":
            value *= 0.3
        elif self.palette == "two":
            hue = (self.base_hue + (0.5 if self.chance(0.3) else 0.0) + self.gauss(0.0, 0.03)) % 1.0
        return (*colorsys.hsv_to_rgb(hue, saturation, value), 1.0)

    def light_colour(self):
        """White mostly, tinted or saturated at times; the largest channel is 1."""
        saturation = self.pick({0.0: 3, 0.2: 3, 0.5: 2, 0.95: 1})
        hue = self.choice((0.08, 0.1, 0.6, self.random()))
        return colorsys.hsv_to_rgb(hue, saturation, 1.0)
