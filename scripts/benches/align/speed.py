"""Time and memory of the aligner beside OpenCV's optical flow, in alternating runs. Called by `scripts/bench align`."""

import argparse
import contextlib
import statistics
import sys

import numpy as np

from benches.align.peers import timed
from benches.align.service import AlignError, Aligner
from benches.align.stages import MIB, MODES, floor_bytes, stage_table
from benches.align.synthetic import shift_pair
from benches.markdown_report import figure, markdown

SIZE = (1920, 1080)
MEMORY_SIZE = (1024, 1024)
SETTINGS = ["blur_radius=2"]  # patches of 5x5 on every level
NOISE = 0.02
TIMED_PEERS = ("Farneback", "DIS medium", "DIS fast")
SOFTWARE_GOALS = {"full": ("Farneback", 1.5), "2x2": ("DIS medium", 1.0), "4x4": ("DIS fast", 1.0)}  # least ratio of the other's time to ours
HARDWARE_GOALS_MS = {"full": 0.5, "4x4": 0.1}
HARDWARE_RUNS = 15  # in each round, whose median is taken
MEMORY_GOAL_MB = 35.5


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/bench align", description=__doc__)
    parser.add_argument("--device", help="Vulkan device: its index or part of its name")
    parser.add_argument("--rounds", type=int, default=7, metavar="N", help="default: 7")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a setting in every mode")
    parser.add_argument("--bench-align", default="build/release/scripts/benches/bench_align", metavar="PATH")
    return parser.parse_args()


def build(asked, size, downsample, **options):
    """An aligner, as a context at whose end it is closed."""
    return contextlib.closing(Aligner(asked.bench_align, size, [*SETTINGS, f"match_downsample={downsample}", *asked.set], input="plane",
                                      device=asked.device, **options))


def take_turns(aligners, planes, rounds, is_software):
    """Milliseconds of each method in each round, and the passes of each mode in each round."""
    grey = [np.rint(255.0 * plane).astype(np.uint8) for plane in planes]
    times = {name: [] for name in (*aligners, *TIMED_PEERS)}
    passes = {mode: [] for mode in aligners}
    for round_ in range(-1, rounds):  # the first one warms up
        order = [*times] if round_ % 2 == 0 else [*reversed(times)]
        for name in order:
            if name in aligners:
                report = aligners[name].run(1 if is_software else HARDWARE_RUNS)
                milliseconds = report["wall_ms" if is_software else "device_ms"]
            else:
                milliseconds = timed(name, *grey)[1]
            if round_ < 0:
                continue
            times[name].append(milliseconds)
            if name in aligners:
                passes[name].append(report["passes"])
    return times, passes


def median_passes(rounds):
    return [row | {"ms": statistics.median(other[i]["ms"] for other in rounds)} for i, row in enumerate(rounds[0])]


def goal(mode, times, is_software):
    if is_software:
        peer, least = SOFTWARE_GOALS[mode]
        ratio = statistics.median(theirs / ours for theirs, ours in zip(times[peer], times[mode]))
        return f"{ratio:.2f}x as fast as {peer} (goal {least:g}x): {'met' if ratio >= least else 'MISSED'}"
    if mode not in HARDWARE_GOALS_MS:
        return ""
    limit = HARDWARE_GOALS_MS[mode]
    return f"goal {limit:g} ms: {'met' if statistics.median(times[mode]) < limit else 'MISSED'}"


def print_times(aligners, times, passes, is_software):
    rows = []
    for mode, aligner in aligners.items():
        bound = sum(row["image_bytes"] for row in passes[mode])
        floor = floor_bytes(*SIZE, MODES[mode])
        rows.append((f"ours, {mode}", figure(statistics.median(times[mode]), 2), figure(min(times[mode]), 2),
                     figure(sum(row["ms"] for row in passes[mode]), 2), figure(bound / MIB, 1), figure(floor / MIB, 1),
                     f"{bound / floor:.1f}x", goal(mode, times, is_software)))
    for peer in TIMED_PEERS:
        rows.append((peer, figure(statistics.median(times[peer]), 2), figure(min(times[peer]), 2), "", "", "", "", ""))
    print(markdown(("method", "median ms", "least ms", "passes ms", "MiB bound", "MiB floor", "of floor", "goal"), rows))


def print_memory(asked):
    held = {}
    for alias in (True, False):
        with build(asked, MEMORY_SIZE, 1, alias=alias) as aligner:
            held[alias] = aligner.built["device_bytes"] / 1e6
    print(f"device memory, {MEMORY_SIZE[0]}x{MEMORY_SIZE[1]} at full resolution: {held[True]:.1f} MB ({held[False]:.1f} MB if no images shared "
          f"memory); goal {MEMORY_GOAL_MB} MB: {'met' if held[True] <= MEMORY_GOAL_MB else 'MISSED'}")


def measure(asked, aligners):
    pair = shift_pair(SIZE[::-1], NOISE)
    planes = [side["beauty"][..., 0] for side in (pair.target, pair.source)]
    for aligner in aligners.values():
        aligner.load({"plane": planes[0]}, {"plane": planes[1]})
    device = aligners["full"].device
    is_software = device["type"] == "software"
    times, rounds = take_turns(aligners, planes, asked.rounds, is_software)
    passes = {mode: median_passes(of_mode) for mode, of_mode in rounds.items()}
    print(f"{device['name']} ({device['driver']}); {SIZE[0]}x{SIZE[1]}, one channel, 5x5 patches, "
          f"{len(aligners['full'].built['levels'])} levels; medians of {asked.rounds} rounds in which all take turns\n")
    print_times(aligners, times, passes, is_software)
    for mode in aligners:
        print(f"{mode}: milliseconds by level and stage\n\n{stage_table(passes[mode])}")
    print_memory(asked)


def main():
    asked = arguments()
    with contextlib.ExitStack() as stack:
        measure(asked, {mode: stack.enter_context(build(asked, SIZE, downsample)) for mode, downsample in MODES.items()})


if __name__ == "__main__":
    try:
        main()
    except AlignError as error:
        sys.exit(f"bench align: {error}")
