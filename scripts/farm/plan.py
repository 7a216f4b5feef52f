"""The plan of a shot on a farm: its chunks of frames, the frames that each needs, and the files that tasks share."""

import argparse
import json
import os
import re
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from whole_file import write_whole  # noqa: E402, F401: for the tasks, too

SEGMENT = 32  # frames that becalm filters together by default; segments begin at multiples of it
WARMUP = 8  # further frames that it reads by default on either side of a segment
FORWARD_PRESETS = ("draft", "paper")  # whose history begins with the shot, unless --segment bounds it


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


def segments(denoise_options):
    """The frames of a segment and of its warm-up under these words of `becalm denoise`. Raises ValueError where a chunk would
    depend on all frames before it."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    parser.add_argument("--preset", default="balanced")
    parser.add_argument("--segment", type=int)
    parser.add_argument("--warmup", type=int, default=WARMUP)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--time")
    try:
        asked = parser.parse_known_args(denoise_options)[0]
    except argparse.ArgumentError as error:
        raise ValueError(f"--denoise-options: {error}") from None
    if asked.time is not None:
        raise ValueError(f"--denoise-options: --time {asked.time}: every chunk would choose a preset of its own; expected --preset NAME")
    directions = [text.removeprefix("directions=") for text in asked.set if text.startswith("directions=")]
    forward = directions[-1] == "forward" if directions else asked.preset in FORWARD_PRESETS
    if asked.segment == 0 or (forward and asked.segment is None):
        raise ValueError(f"--denoise-options: {' '.join(denoise_options)}: a chunk depends on all frames before it; expected --segment N")
    return asked.segment or SEGMENT, asked.warmup


def context(chunk, segment=SEGMENT, warmup=WARMUP):
    """The range of all frames that denoising a chunk reads: whole segments and the warm-up."""
    begin = chunk[0] // segment * segment - warmup
    end = (chunk[1] // segment + 1) * segment - 1 + warmup
    return begin, end


def chunks_read(chunk, all_chunks, segment=SEGMENT, warmup=WARMUP):
    """Numbers of the chunks that contain a frame of the chunk's context."""
    begin, end = context(chunk, segment, warmup)
    return [i for i, (first, last) in enumerate(all_chunks) if first <= end and last >= begin]


def has_eye_field(pattern):
    """Whether each eye has a file, `%V` or `%v` in the pattern."""
    return bool(re.search("%[Vv]", pattern))


def frame_paths(pattern, frame):
    """The file of a frame in a `####` pattern, or one for each eye. As in becalm, a minus sign counts as a digit of the padding."""
    folder, name = os.path.split(pattern)  # folders hold no field
    path = os.path.join(folder, re.sub(r"#+", lambda field: f"{frame:0{len(field[0])}d}", name, count=1))
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
