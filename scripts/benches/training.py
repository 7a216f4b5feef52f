"""What the smoother's training depends on: from scratch on the shots of both renderers, on those of each alone, with the
smaller network, and over time. The network of the program had more shots and ten times the steps. Called by
`scripts/bench report training`; scripts/train/run renders the shots."""

import argparse
import csv
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, "scripts/train")

import torch  # noqa: E402

import batches  # noqa: E402
import network  # noqa: E402
import train  # noqa: E402
from benches.markdown_report import markdown  # noqa: E402

VARIANTS = {
    "both renderers": [],
    "becalm's shots alone": ["--renderer", "becalm"],
    "Cycles' shots alone": ["--renderer", "cycles"],
    "both, small network": ["--size", "small"],
}
# Else the allocator takes memory anew for every step, which takes longer than the step.
ALLOCATOR = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_MAX_": "0", "MALLOC_TRIM_THRESHOLD_": "100000000000",
             "MALLOC_TOP_PAD_": "268435456", "OMP_NUM_THREADS": "1"}


def trained(data, folder, steps, options):
    """The averaged network after `steps`, and the seconds that a step took."""
    subprocess.run([sys.executable, "scripts/train/train.py", data, str(folder), "--steps", str(steps), "--threads", "1", *options],
                   check=True, env=os.environ | ALLOCATOR)
    state = torch.load(folder / "checkpoint.pt", map_location="cpu")
    made = network.Network(state["channels"])
    made.load_state_dict(state["average"])
    return made, state["spent_s"] / state["step"]


def error(made, pairs):
    return f"1/{1.0 / train.held_out_error(made, pairs)[0]:.3g}"


def curve(folder):
    """Rows of (steps, share of the held-out error), every second evaluation."""
    rows = list(csv.reader((folder / "curve.csv").open()))
    return [(row[1], f"1/{1.0 / float(row[3]):.3g}") for row in rows[::max(len(rows) // 6, 1)]]


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench report training", description=__doc__)
    parser.add_argument("--data", default="build/train/shots")
    parser.add_argument("--out", default="build/train/ablations")
    parser.add_argument("--steps", type=int, default=3000)
    asked = parser.parse_args()
    torch.set_num_threads(1)
    _, held_out = batches.load(asked.data)
    rows = []
    for name, options in VARIANTS.items():
        folder = Path(asked.out) / name.replace(" ", "_").replace("'", "").replace(",", "")
        made, step_s = trained(asked.data, folder, asked.steps, options)
        errors = [error(made, [p for p in held_out if p.name.startswith(renderer) and p.merged == merged])
                  for merged in (False, True) for renderer in ("becalm", "cycles")]
        rows.append((name, network.parameter_count(made), f"{step_s:.2f}", *errors))
    shots = len({pair.name.split("/")[0] for pair in held_out})
    print(f"{asked.steps} steps each; {shots} held-out shots.\n")
    print(markdown(("learns from", "parameters", "s a step", "single frames: becalm's", "Cycles'", "merged frames: becalm's", "Cycles'"), rows))
    print(markdown(("steps", "both renderers"), curve(Path(asked.out) / "both_renderers")))


if __name__ == "__main__":
    main()
