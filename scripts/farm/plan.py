"""The plan of a shot on a farm: its chunks of frames, the frames that each needs, and the files that tasks share."""

import json
import re
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from whole_file import write_whole  # noqa: E402, F401: for the tasks, too

SEGMENT = 32  # frames that becalm filters together; segments begin at multiples of it
WARMUP = 8  # further frames that it reads on either side of a segment


def parse_frames(text):
    """The first and the last frame of `1-96`, `-3-4` or `7`."""
    match = re.fullmatch(r"(-?\d+)(?:-(-?\d+))?", text)
    if not match:
        raise ValueError(f"--frames {text}: expected A-B")
    first = int(match[1])
    last = int(match[2]) if match[2] is not None else first
    if last < first:
        raise ValueError(f"--frames {text}: ends before it begins")
    return first, last


def chunks(first, last, size):
    """Ranges of at most `size` frames that begin at multiples of it, as segments do."""
    result = []
    at = first
    while at <= last:
        end = min((at // size + 1) * size - 1, last)
        result.append((at, end))
        at = end + 1
    return result


def context(chunk):
    """The range of all frames that denoising a chunk reads: whole segments and the warm-up."""
    begin = chunk[0] // SEGMENT * SEGMENT - WARMUP
    end = (chunk[1] // SEGMENT + 1) * SEGMENT - 1 + WARMUP
    return begin, end


def chunks_read(chunk, all_chunks):
    """Numbers of the chunks that contain a frame of the chunk's context."""
    begin, end = context(chunk)
    return [i for i, (first, last) in enumerate(all_chunks) if first <= end and last >= begin]


def has_eye_field(pattern):
    """Whether each eye has a file, `%V` or `%v` in the pattern."""
    return bool(re.search("%[Vv]", pattern))


def frame_paths(pattern, frame):
    """The file of a frame in a `####` pattern, or one for each eye. As in becalm, a minus sign counts as a digit of the padding."""
    path = re.sub(r"#+", lambda field: f"{frame:0{len(field[0])}d}", pattern, count=1)
    if not has_eye_field(path):
        return [path]
    return [path.replace("%V", eye).replace("%v", eye[0]) for eye in ("left", "right")]


def folder_of(output):
    """The folder of an output pattern's plan, logs and task states: above the eyes' own folders if there are any."""
    path = Path(output)
    parent = next((folder for folder in path.parents if not has_eye_field(str(folder))), Path())
    return parent / ("farm." + re.sub(r"[.#]+exr$", "", re.sub(r"[._-]?%[Vv]", "", path.name)))


def load(folder):
    return json.loads((Path(folder) / "plan.json").read_text())
