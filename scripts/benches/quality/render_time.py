"""What rendering a folder's frames cost, kept beside them as seconds.json. Blender's Python reads this too: it needs no packages."""

import json

from whole_file import write_whole

CLOCKS = ("wall", "processor")


def _file(folder):
    return folder / "seconds.json"


def _kept(folder, program):
    """What is noted of this program's frames, or of those of any if it is None."""
    nothing = {"program": program, "frames": 0, "wall": 0.0, "processor": 0.0}
    kept = json.loads(_file(folder).read_text()) if _file(folder).exists() else nothing
    return kept if program is None or kept.get("program", "") == program else nothing


def note(folder, frames, wall, processor, program=""):
    """Adds so many frames, rendered in these seconds, to those of the same program that were noted before. `program` tells one from another."""
    kept = _kept(folder, program)
    total = {"program": program, "frames": kept["frames"] + frames, "wall": kept["wall"] + wall, "processor": kept["processor"] + processor}
    write_whole(_file(folder), json.dumps(total))


def seconds_a_frame(folder, clock, program=""):
    """The mean over the program's noted frames (any program's if it is None) by one of CLOCKS; None if none is noted."""
    kept = _kept(folder, program)
    return kept[clock] / kept["frames"] if kept["frames"] else None
