"""What the smoother's training depends on: from scratch on the shots of both renderers, on those of each alone, with the
smaller network, and over time. Called by `scripts/bench report training`; goes on where an earlier run of the same code, options and
shots was stopped."""

import csv
import os
import subprocess
import sys
import zipfile
from pathlib import Path

sys.path.insert(0, "scripts/train")

import torch  # noqa: E402

import batches  # noqa: E402
import network  # noqa: E402
import shots  # noqa: E402
import train  # noqa: E402
from benches.made_of import content_hash, keep_if_recipe  # noqa: E402
from benches.markdown_report import markdown  # noqa: E402

DATA = "build/train/shots"  # of scripts/train/run
OUT = Path("build/train/ablations")
STEPS = 3000  # from scratch; the program's network has had 118,000 (filter/smooth/weights/README.md)
VARIANTS = {
    "both renderers": ("both", []),
    "becalm's shots alone": ("becalm", ["--renderer", "becalm"]),
    "Cycles' shots alone": ("cycles", ["--renderer", "cycles"]),
    "both, small network": ("small", ["--size", "small"]),
}
# As in scripts/train/run, which says why.
ENVIRONMENT = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_MAX_": "0", "MALLOC_TRIM_THRESHOLD_": "100000000000",
               "MALLOC_TOP_PAD_": "268435456", "OMP_NUM_THREADS": "1"}


def checkpoint(folder):
    path = folder / "checkpoint.pt"
    return torch.load(path, map_location="cpu") if path.exists() else None


def learned():
    """The names of what the shots' pairs hold, with the checksums that are in their files."""
    for folder in shots.complete_shots(DATA):
        for file in shots.pair_files(folder):
            with zipfile.ZipFile(f"{folder}/{file}") as arrays:
                yield [os.path.basename(folder), file, *((array.filename, array.CRC) for array in arrays.infolist())]


def trained(folder, options):
    """The checkpoint after STEPS steps. Other code, options or shots train from the start."""
    code = [*map(content_hash, sorted(Path("scripts/train").glob("*.py")))]
    keep_if_recipe(folder, {"code": code, "options": options, "steps": STEPS, "learned": list(learned())}, "*")
    state = checkpoint(folder)
    if state is None or state["step"] < STEPS:
        subprocess.run([sys.executable, "scripts/train/train.py", DATA, str(folder), "--steps", str(STEPS), "--threads", "1", *options],
                       check=True, env=os.environ | ENVIRONMENT, stdout=sys.stderr)
        state = checkpoint(folder)
    return state


def averaged_network(state):
    made = network.Network(state["channels"])
    made.load_state_dict(state["average"])
    return made


def error(made, pairs):
    return f"1/{1.0 / train.held_out_error(made, pairs)[0]:.3g}"


def curve(folder):
    """Rows of (minutes, steps, held-out error)."""
    with (folder / "curve.csv").open() as file:
        return [(f"{float(minutes):.0f}", steps, f"1/{1.0 / float(held_out):.3g}") for minutes, steps, _, held_out, *_ in csv.reader(file)]


def held_out_pairs():
    """Of the held-out shots, by kind of frame and renderer."""
    _, pairs = batches.load(DATA, "none") if os.path.isdir(DATA) else ([], [])
    kinds = {(merged, renderer): [p for p in pairs if p.merged == merged and p.name.startswith(renderer)]
             for merged in (False, True) for renderer in ("becalm", "cycles")}
    if not all(kinds.values()):
        sys.exit(f"{DATA}: expected held-out shots of both renderers with merged frames; scripts/train/run shots merged makes them")
    return kinds


def main():
    torch.set_num_threads(1)
    kinds = held_out_pairs()
    rows = []
    for name, (folder, options) in VARIANTS.items():
        state = trained(OUT / folder, options)
        made = averaged_network(state)
        rows.append((name, network.parameter_count(made), f"{state['spent_s'] / state['step']:.2f}", *(error(made, pairs) for pairs in kinds.values())))
    held_out = {pair.name.split("/")[0] for pairs in kinds.values() for pair in pairs}
    crops = train.parse([str(DATA), str(OUT)]).batch
    print(f"{STEPS} steps of {crops} crops, on one core; {len(held_out)} held-out shots.\n")
    print(markdown(("learns from", "parameters", "s a step", "becalm's frames", "Cycles' frames", "becalm's, merged", "Cycles', merged"), rows))
    print(markdown(("minutes", "steps", "both renderers, all held-out pairs"), curve(OUT / "both")))


if __name__ == "__main__":
    main()
