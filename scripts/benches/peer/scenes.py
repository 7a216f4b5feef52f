"""Three scenes in terms that becalm and Blender share: boxes, spheres and lying rectangles, turned about the vertical, y up. No lamp is in
view: Cycles shows the camera none."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Material:
    kind: str                       # "diffuse", "metal" (GGX, constant reflectance) or "glass" (smooth)
    color: tuple = (0.8, 0.8, 0.8)
    roughness: float = 0.0          # becalm's: the square of it is GGX's alpha, as in Blender
    checker: float = 0.0            # repeats of a checkerboard of `color` and a quarter of it; 0: none


@dataclass(frozen=True)
class Thing:
    shape: str                      # "rectangle" (facing up), "cube" or "sphere", within [-1, 1]
    material: str
    scale: tuple
    at: tuple
    turn_deg: float = 0.0


@dataclass(frozen=True)
class Lamp:
    """A rectangle that emits downward. becalm's hides what is behind it and is white, Cycles' is not there for light that it does not emit."""
    radiance: float
    half_width: float
    half_depth: float
    at: tuple


@dataclass(frozen=True)
class Scene:
    eye: tuple
    target: tuple
    fov_y_deg: float
    materials: dict
    things: list
    lamps: list = field(default_factory=list)
    sky: tuple | None = None


def _room():
    """Diffuse things in a closed room, and a lamp below its ceiling."""
    wall, red, green, wood = (Material("diffuse", color) for color in ((0.75,) * 3, (0.6, 0.1, 0.08), (0.12, 0.45, 0.1), (0.4, 0.25, 0.12)))
    walls = [Thing("cube", "wall", (3, 0.1, 3), (0, -0.1, 0)), Thing("cube", "wall", (3, 0.1, 3), (0, 2.9, 0)),
             Thing("cube", "wall", (3, 1.6, 0.1), (0, 1.4, -3)), Thing("cube", "wall", (3, 1.6, 0.1), (0, 1.4, 3.1)),
             Thing("cube", "red", (0.1, 1.6, 3), (-3, 1.4, 0)), Thing("cube", "green", (0.1, 1.6, 3), (3, 1.4, 0))]
    things = [Thing("cube", "wood", (0.9, 0.05, 0.5), (0.2, 0.8, -0.8), 12), Thing("cube", "wood", (0.05, 0.4, 0.05), (-0.6, 0.4, -0.9)),
              Thing("cube", "wood", (0.05, 0.4, 0.05), (0.95, 0.4, -0.6)), Thing("sphere", "wall", (0.3, 0.3, 0.3), (0.1, 1.15, -0.8)),
              Thing("cube", "wall", (0.4, 0.7, 0.4), (-1.6, 0.7, -1.6), 30), Thing("sphere", "green", (0.45, 0.45, 0.45), (1.7, 0.45, 0.2))]
    return Scene((0, 1.4, 2.8), (0, 0.8, -1), 44, {"wall": wall, "red": red, "green": green, "wood": wood}, walls + things,
                 [Lamp(9.0, 0.75, 0.75, (0, 2.795, -0.5))])


def _metal():
    """Metal on a large floor under a sky, and a lamp."""
    materials = {"clay": Material("diffuse", (0.6, 0.35, 0.25)), "rough": Material("metal", (0.95, 0.75, 0.4), 0.4),
                 "smooth": Material("metal", (0.9, 0.9, 0.92), 0.15), "white": Material("diffuse", (0.8, 0.8, 0.8))}
    things = [Thing("rectangle", "clay", (12, 1, 12), (0, 0, 0)), Thing("sphere", "rough", (0.8, 0.8, 0.8), (-1.3, 0.8, 0)),
              Thing("sphere", "smooth", (0.6, 0.6, 0.6), (0.6, 0.6, 0.6)), Thing("cube", "rough", (0.4, 0.9, 0.4), (1.9, 0.9, -0.8), 35),
              Thing("cube", "white", (0.3, 0.3, 0.3), (-0.2, 0.3, 1.5), 20)]
    return Scene((0, 2.2, 6.5), (0, 0.7, 0), 38, materials, things, [Lamp(12.0, 0.8, 0.8, (1, 4, 1))], (0.3, 0.35, 0.45))


def _glass():
    """Textures and glass in a half-open box with two lamps."""
    materials = {"tiles": Material("diffuse", (0.75, 0.72, 0.65), checker=12), "cloth": Material("diffuse", (0.2, 0.3, 0.6), checker=6),
                 "glass": Material("glass"), "metal": Material("metal", (0.9, 0.6, 0.5), 0.3), "white": Material("diffuse", (0.7, 0.7, 0.7))}
    things = [Thing("rectangle", "tiles", (4, 1, 4), (0, 0, 0)), Thing("cube", "white", (4, 2, 0.1), (0, 2, -3)),
              Thing("cube", "white", (0.1, 2, 3), (-3.2, 2, 0)), Thing("sphere", "glass", (0.7, 0.7, 0.7), (-0.9, 0.7, 0.3)),
              Thing("sphere", "glass", (0.45, 0.45, 0.45), (0.7, 0.45, 1.1)), Thing("sphere", "metal", (0.6, 0.6, 0.6), (1.4, 0.6, -0.7)),
              Thing("rectangle", "cloth", (0.8, 1, 0.8), (0.2, 0.02, 1.6), 25)]
    return Scene((0, 1.9, 5.2), (0, 0.55, 0), 36, materials, things, [Lamp(14.0, 0.6, 0.6, (-0.8, 3.2, 0.6)), Lamp(8.0, 0.3, 1.0, (2.2, 2.6, 0))],
                 (0.05, 0.06, 0.08))


SCENES = {"room": _room(), "metal": _metal(), "glass": _glass()}
MAX_DEPTH = 6  # becalm's: Cycles' bounces and one more
