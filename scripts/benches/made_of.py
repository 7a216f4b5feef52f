"""Frames and figures on disk that serve later runs for as long as they would be made the same again."""

import hashlib
import inspect
import json
import sys
from pathlib import Path

from whole_file import write_whole


def content_hash(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


def sources_of(function):
    """The files of all functions that the function's module has or imports."""
    return sorted({inspect.getsourcefile(value) for value in vars(inspect.getmodule(function)).values() if inspect.isfunction(value)})


def keep_if_recipe(folder, recipe, files="*.exr"):
    """Removes these files of the folder unless they were made of this recipe (anything that json writes), which is kept beside them."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    stamp, text = folder / "made_of.json", json.dumps(recipe)
    if stamp.exists() and stamp.read_text() == text:
        return
    outdated = list(folder.glob(files))
    if outdated:
        print(f"{folder}: {len(outdated)} files of another recipe are made anew", file=sys.stderr, flush=True)
    for path in outdated:
        path.unlink()
    write_whole(stamp, text)


def keep_if_same(folder, program, **recipe):
    """Removes the folder's EXR files unless they were made by this program of this recipe."""
    keep_if_recipe(folder, {"program": content_hash(program)} | recipe)
