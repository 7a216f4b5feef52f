"""becalm's tracer beside Cycles, or beside another becalm: noise, time, and time to equal error. Called by `scripts/bench peer`."""

import argparse
import json
import math
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np

from benches.geometric_mean import geometric_mean
from benches.markdown_report import figure, markdown
from benches.peer.becalm_scene import write_scene
from benches.peer.scenes import SCENES
from benches.quality.cells import radiance
from benches.quality.options import words
from benches.timed import timed
from whole_file import write_whole

WORST = 0.01  # the share of pixels that is left out of the second ratio


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/bench peer", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/peer"), metavar="DIR", help="report.md and frames (default: out/peer)")
    parser.add_argument("--scenes", type=words, default=list(SCENES), metavar="LIST",
                        help=f"default: {','.join(SCENES)}; with --other also scene files, such as scenes/slab.json")
    parser.add_argument("--frame", type=int, default=5, metavar="N", help="of scene files (default: 5)")
    parser.add_argument("--size", default="480x270", metavar="WxH", help="default: 480x270")
    parser.add_argument("--spp", type=int, default=64, metavar="N", help="at least 2 (default: 64)")
    parser.add_argument("--seeds", type=int, default=4, metavar="N", help="frames of each, at least 2 (default: 4)")
    parser.add_argument("--becalm", type=Path, default=Path("build/release/becalm"), metavar="PATH")
    parser.add_argument("--other", type=Path, metavar="PATH", help="another becalm in place of Cycles")
    asked = parser.parse_args()
    if unknown := [name for name in asked.scenes if name not in SCENES and not (asked.other and Path(name).is_file())]:
        parser.error(f"no scene '{unknown[0]}'; there are {', '.join(SCENES)}{' and files' if asked.other else ''}")
    for option in ("spp", "seeds"):
        if getattr(asked, option) < 2:
            parser.error(f"--{option}: expected at least 2")
    return asked


def render_becalms(programs, scene_file, folder, frame, asked):
    """Of each program: frames of all seeds, and the median of the processor seconds of one. The programs alternate; frames of one sample
    tell what the start takes."""
    seconds, frames = [[] for _ in programs], [[] for _ in programs]
    for seed in range(1, asked.seeds + 1):
        for number, program in enumerate(programs):
            cost, path = {}, folder / f"becalm{number}.{seed}.exr"
            for spp in (1, asked.spp):
                _, cost[spp] = timed([program, "render", scene_file, "-o", path, "--frames", frame, "--size", asked.size, "--spp", spp,
                                      "--seed", seed, "--type=float", "--quiet", "--overwrite"])
            seconds[number].append((cost[asked.spp].processor_s - cost[1].processor_s) * asked.spp / (asked.spp - 1))
            frames[number].append(radiance(path))
    return [(np.stack(of_program), statistics.median(spent)) for of_program, spent in zip(frames, seconds)]


def render_cycles(name, folder, asked):
    subprocess.run(["blender", "-b", "--factory-startup", "--python", str(Path(__file__).with_name("cycles.py")), "--", name, str(folder),
                    asked.size, str(asked.spp), str(asked.seeds)], check=True, stdout=subprocess.DEVNULL)
    frames = [radiance(folder / f"cycles.{seed}.exr") for seed in range(1, asked.seeds + 1)]
    return np.stack(frames), statistics.median(json.loads((folder / "cycles.json").read_text()))


def variances(frames):
    """Of each pixel between seeds, relative to the picture's mean square."""
    return frames.var(axis=0, ddof=1).mean(axis=-1) / np.square(frames.mean())


def row(name, ours, theirs):
    """Ratios are those of the peer over becalm: above 1, becalm is ahead."""
    (our_frames, our_s), (their_frames, their_s) = ours, theirs
    our, their = variances(our_frames), variances(their_frames)
    kept = [np.sort(v, axis=None)[:math.ceil((1.0 - WORST) * v.size)].mean() for v in (our, their)]
    return {"scene": name, "mean": float(our_frames.mean() / their_frames.mean()), "variance": float(their.mean() / our.mean()),
            "seconds": their_s / our_s, "equal": float(their.mean() * their_s / (our.mean() * our_s)),
            "equal_kept": float(kept[1] * their_s / (kept[0] * our_s))}


def main():
    asked = arguments()
    rows = []
    for name in asked.scenes:
        is_file = name not in SCENES
        folder = asked.output / Path(name).stem
        folder.mkdir(parents=True, exist_ok=True)
        scene_file, frame = (Path(name), asked.frame) if is_file else (write_scene(SCENES[name], folder, asked.size), 1)
        ours, *others = render_becalms([asked.becalm, *([asked.other] if asked.other else [])], scene_file, folder, frame, asked)
        rows.append(row(Path(name).stem, ours, others[0] if others else render_cycles(name, folder, asked)))
        print(rows[-1], flush=True)
    columns = ("mean", "variance", "seconds", "equal", "equal_kept")
    lines = [[r["scene"], *(f"{r[c]:.4f}" if c == "mean" else f"{r[c]:.2f}" for c in columns)] for r in rows]
    lines.append(["geometric mean", "", *(figure(geometric_mean([r[c] for r in rows]), 2) for c in columns[1:])])
    peer = asked.other or "Cycles"
    text = markdown(("scene", f"mean radiance, becalm / {peer}", f"variance, {peer} / becalm", "processor time of a frame", "time to equal variance",
                     "the same without the worst 1 % of pixels"), lines)
    write_whole(asked.output / "report.md", text)
    print(text)


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        sys.exit(f"bench peer: {error}")
