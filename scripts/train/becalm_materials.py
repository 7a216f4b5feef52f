"""Random materials in the format of becalm's scene files."""

import numpy as np

METALS = [([0.143, 0.375, 1.442], [3.983, 2.386, 1.603]), ([0.2, 0.924, 1.102], [3.912, 2.452, 2.142]),
          ([1.657, 0.88, 0.521], [9.224, 6.27, 4.837]), ([2.9, 2.9, 2.6], [3.1, 3.0, 2.8])]


class Materials:
    """Collects the materials of one shot; each method adds one and returns its name."""

    def __init__(self, rng, textures, textured_share):
        self.rng = rng
        self.textures = textures
        self.textured_share = textured_share
        self.entries = {}
        # A shot has a palette: hues near one or two centres, and a general brightness.
        self.hues = rng.random(2)
        self.spread = rng.choice([0.03, 0.1, 0.5])
        self.saturation = rng.uniform(0, 1)
        self.brightness = rng.choice([0.15, 0.5, 0.5, 0.8])

    def add(self, entry):
        name = f"{entry['type']} {len(self.entries)}"
        self.entries[name] = entry
        return name

    def color(self):
        hue = (self.rng.choice(self.hues) + self.rng.normal() * self.spread) % 1
        value = float(np.clip(self.rng.normal(self.brightness, 0.2), 0.02, 0.95))
        saturation = float(np.clip(self.saturation + self.rng.normal() * 0.25, 0, 0.95))
        k = (np.array([5, 3, 1]) + hue * 6) % 6
        return (value * (1 - saturation * np.clip(np.minimum(k, 4 - k), 0, 1))).round(4).tolist()

    def image(self, use):
        return "../assets/textures/" + str(self.rng.choice(self.textures[use]))

    def repeat(self, coarse):
        """Repeats over a surface: from one coarse picture to patterns finer than a pixel."""
        n = float(coarse * 2 ** self.rng.uniform(-0.5, 3))
        return [round(n, 2), round(n * float(self.rng.choice([1, 1, 1, 0.5, 2])), 2)]

    def surface_color(self, coarse):
        if self.rng.random() >= self.textured_share:
            return self.color()
        texture = {"image": self.image("color"), "space": "srgb", "repeat": self.repeat(coarse)}
        if self.rng.random() < 0.4:
            tint = np.array(self.color())
            texture["scale"] = (tint / max(tint.max(), 1e-3)).round(4).tolist()
        return texture

    def roughness(self, coarse):
        value = float(self.rng.choice([0.0, 0.03, 0.1, 0.2, 0.3, 0.5, 0.8]) + self.rng.uniform(0, 0.1))
        if self.rng.random() < 0.25:
            return {"image": self.image("gray"), "repeat": self.repeat(coarse), "scale": round(min(1.0, value + 0.3), 3)}
        return round(value, 3)

    def relief(self, entry, coarse):
        """Bumps or a normal map on a fifth of the surfaces each."""
        draw = self.rng.random()
        if draw < 0.2:
            repeat = self.repeat(coarse)
            scale = self.rng.uniform(0.005, 0.05) / repeat[0] * coarse
            entry["bump"] = {"image": self.image("gray"), "repeat": repeat, "scale": round(float(scale), 5)}
        elif draw < 0.4:
            entry["normal_map"] = {"image": self.image("normal"), "repeat": self.repeat(coarse),
                                   "strength": round(float(self.rng.uniform(0.3, 1.5)), 3)}
        return entry

    def diffuse(self, coarse=1.0):
        return self.add(self.relief({"type": "diffuse", "reflectance": self.surface_color(coarse)}, coarse))

    def conductor(self, coarse=1.0):
        entry = {"type": "conductor", "roughness": self.roughness(coarse)}
        if self.rng.random() < 0.5:
            eta, k = METALS[self.rng.integers(len(METALS))]
            entry.update(eta=eta, k=k)
        else:
            entry["reflectance"] = self.surface_color(coarse)
        return self.add(self.relief(entry, coarse))

    def dielectric(self):
        tint = [1.0, 1.0, 1.0] if self.rng.random() < 0.4 else self.rng.uniform(0.4, 1, 3).round(3).tolist()
        rough = 0 if self.rng.random() < 0.6 else round(float(self.rng.uniform(0.03, 0.5)), 3)
        return self.add({"type": "dielectric", "ior": round(float(self.rng.uniform(1.2, 1.9)), 3), "roughness": rough,
                         "transmittance": tint})

    def principled(self, coarse=1.0):
        rng = self.rng
        entry = {"type": "principled", "base_color": self.surface_color(coarse), "roughness": self.roughness(coarse),
                 "ior": round(float(rng.uniform(1.2, 1.8)), 3)}
        for key, share in (("metallic", 0.3), ("anisotropy", 0.2), ("sheen", 0.2), ("clearcoat", 0.35), ("transmission", 0.1)):
            if rng.random() < share:
                entry[key] = round(float(rng.choice([rng.random(), 1.0])), 3)
        if "anisotropy" in entry:
            entry["anisotropy_rotation"] = round(float(rng.random()), 3)
        if "sheen" in entry:
            entry["sheen_tint"] = round(float(rng.random()), 3)
        if "clearcoat" in entry:
            entry["clearcoat_roughness"] = round(float(rng.uniform(0, 0.4)), 3)
        if "metallic" in entry and rng.random() < 0.3:
            entry["metallic"] = {"image": self.image("gray"), "repeat": self.repeat(coarse)}
        return self.add(self.relief(entry, coarse))

    def mix(self, coarse=1.0):
        factor = {"image": self.image("gray"), "repeat": self.repeat(coarse)} if self.rng.random() < 0.6 else 0.5
        parts = [self.opaque(coarse, allow_mix=False), self.opaque(coarse, allow_mix=False)]
        return self.add({"type": "mix", "materials": parts, "factor": factor})

    def opaque(self, coarse=1.0, allow_mix=True):
        """For floors, walls and most objects."""
        kinds, weights = ["diffuse", "principled", "conductor", "mix"], [0.42, 0.36, 0.12, 0.1]
        kind = self.rng.choice(kinds if allow_mix else kinds[:3], p=weights if allow_mix else np.array(weights[:3]) / 0.9)
        return getattr(self, kind)(coarse)

    def without_relief(self, name):
        """Takes its bumps and normal maps from a material, for surfaces without texture coordinates. Returns the name."""
        entry = self.entries[name]
        for key in ("bump", "normal_map"):
            entry.pop(key, None)
        for part in entry.get("materials", []):
            self.without_relief(part)
        return name

    def any(self, coarse=1.0, glass_share=0.1):
        if self.rng.random() < glass_share:
            return self.dielectric()
        return self.opaque(coarse)

    def masked(self):
        """Leaf-like cut-outs; the image's alpha is the mask."""
        image = self.image("mask")
        entry = {"type": "diffuse", "reflectance": {"image": image, "space": "srgb"},
                 "opacity": {"image": image, "channel": "a"}}
        if self.rng.random() < 0.3:
            entry = {"type": "principled", "base_color": {"image": image, "space": "srgb"}, "roughness": 0.4,
                     "opacity": {"image": image, "channel": "a"}}
        return self.add(entry)

    def black(self):
        self.entries.setdefault("black", {"type": "diffuse", "reflectance": [0, 0, 0]})
        return "black"

    def interface(self):
        self.entries.setdefault("interface", {"type": "interface"})
        return "interface"
