"""Scenes of scenes/ as benches change them."""

import json
from pathlib import Path

ROOT = Path("scenes").resolve()


def with_absolute_paths(node):
    """The scene, or a part of it, for a file in another folder."""
    if isinstance(node, dict):
        return {key: with_absolute_paths(value) for key, value in node.items()}
    if isinstance(node, list):
        return [with_absolute_paths(value) for value in node]
    return str(ROOT / node) if isinstance(node, str) and node.startswith(("textures/", "meshes/")) else node


def scene_text(name):
    return with_absolute_paths(json.loads((ROOT / f"{name}.json").read_text()))
