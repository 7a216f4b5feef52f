"""Frames of a changed scene that a bench renders once and later runs use."""

import json
import subprocess

from benches.made_of import keep_if_same


def render_missing(becalm, scene, folder, frames, options, stem="f"):
    """Renders those of the frames that are not there as folder/f.####.exr into folder/STEM.####.exr. Returns the command, without
    its frames, and the frames rendered."""
    keep_if_same(folder, becalm, scene=scene, options=options)
    path = folder / "scene.json"
    path.write_text(json.dumps(scene))
    command = [becalm, "render", path, "-o", folder / f"{stem}.####.exr", "--type=float", *options]
    missing = [frame for frame in frames if not (folder / f"f.{frame:04}.exr").exists()]
    if missing:
        subprocess.run([*command, "--frames", ",".join(map(str, missing)), "--overwrite", "--quiet"], check=True)
    return command, missing
