"""What rendering a folder's frames cost, kept beside them as seconds.json. Blender's Python reads this too: it needs no packages."""

import json
import os

CLOCKS = ("wall", "processor")


def _file(folder):
    return folder / "seconds.json"


def note(folder, frames, wall, processor):
    """Adds so many frames, rendered in these seconds, to those that were noted before."""
    kept = json.loads(_file(folder).read_text()) if _file(folder).exists() else {"frames": 0, "wall": 0.0, "processor": 0.0}
    total = {"frames": kept["frames"] + frames, "wall": kept["wall"] + wall, "processor": kept["processor"] + processor}
    partial = _file(folder).with_suffix(".partial")
    partial.write_text(json.dumps(total))
    os.replace(partial, _file(folder))


def seconds_a_frame(folder, clock):
    """The mean over the noted frames by one of CLOCKS; None if none is noted."""
    if not _file(folder).exists():
        return None
    kept = json.loads(_file(folder).read_text())
    return kept[clock] / kept["frames"]
