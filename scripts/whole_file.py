"""Files that readers see whole. Blender's Python reads this too: it needs no packages."""

import os
from pathlib import Path


def write_whole(path, text):
    """Replaces a file atomically: readers see the old text or all of the new one, and so does a later run after an interrupted one."""
    partial = Path(f"{path}.{os.uname().nodename}.{os.getpid()}")  # other machines may write it, too
    try:
        partial.write_text(text, encoding="utf-8")
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
