"""What could not be measured, and why."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Gap:
    method: str  # its title; empty if nothing of the scene could be measured
    scene: str
    spp: int
    why: str


def told(gaps):
    """One line for each method and reason, with the scenes and sample counts that they concern."""
    places = {}
    for gap in gaps:
        places.setdefault((gap.method, gap.why), {}).setdefault(gap.scene, []).append(gap.spp)
    lines = []
    for (method, why), spps in places.items():
        scenes = {}
        for scene, counts in spps.items():
            scenes.setdefault(tuple(counts), []).append(scene)
        where = "; ".join(f"{', '.join(names)} at {', '.join(map(str, counts))} spp" for counts, names in scenes.items())
        lines.append(f"{method + ' of ' if method else ''}{where}: {why}")
    return lines
