"""Quality of `becalm denoise` on animated scenes, measured against two references of each. Called by `scripts/bench quality`."""

import argparse
import shlex
import subprocess
import sys
from pathlib import Path

from benches.markdown_report import Report, items
from benches.quality import tables
from benches.quality.cells import Cells
from benches.quality.data import Data, MissingFrames, Renderer
from benches.quality.goals import ENERGY, goal_table, goals
from benches.quality.options import counts, frames, words
from benches.quality.page import write_quality_page
from benches.quality.plots import write_plots
from benches.quality.shots import KNOWN, Shots
from benches.quality.variants import NOISY, VARIANTS, Program, Variant, oidn

SCENES = ["penumbra", "crossing", "spheres", "fence", "courtyard", "dining", "ocean", "meadow", "mountains", "slab"]
PICTURED = ["noisy", "paper", "draft", "balanced", "final"]


def _variant(text):
    name, *options = text.split()
    if not options:
        raise argparse.ArgumentTypeError(f"'{text}': expected NAME OPTION ..., with no blank in the name")
    return Variant(name, name, tuple(options))


def _other(text):
    name, *command = shlex.split(text)
    if not any("{denoised}" in word for word in command):
        raise argparse.ArgumentTypeError(f"'{text}': expected NAME COMMAND ..., with a word that has {{denoised}}")
    return Variant(name, name, command=tuple(command))


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/bench quality", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, metavar="DIR",
                        help="index.html, report.md, *.json, plots and pictures (default: out/quality, or out/quality_NAME of --shots NAME)")
    parser.add_argument("--data", type=Path, metavar="DIR",
                        help="existing frames, as DIR/SCENE/n4/f.####.exr and DIR/SCENE/a, b: nothing is rendered, missing frames are reported "
                             "(default: build/quality, where missing frames are rendered)")
    parser.add_argument("--shots", metavar="NAME",
                        help=f"frames of another renderer in place of our scenes: {', '.join(KNOWN)}, or a folder with n8/, a/ and b/, or a folder "
                             "of such folders; scenes, sample counts and frames are those that exist, unless given")
    parser.add_argument("--scenes", type=words, metavar="LIST", help=f"default: {','.join(SCENES)}")
    parser.add_argument("--spp", type=counts, metavar="LIST", help="of the noisy frames (default: 1,4,8,16,64)")
    parser.add_argument("--ablation-spp", type=counts, metavar="LIST",
                        help="the part of them at which ablations are measured (default: 4, or all if 4 is none of them; with --shots and --variants: all)")
    parser.add_argument("--variants", type=words, metavar="LIST", help="names of variants (default: all)")
    parser.add_argument("--variant", action="append", default=[], type=_variant, metavar="'NAME OPTION ...'",
                        help="also measure becalm denoise with these options")
    parser.add_argument("--other", action="append", default=[], type=_other, metavar="'NAME COMMAND ...'",
                        help="also measure another denoiser; of the command's words {noisy} and {denoised} become patterns of EXR files, {frames} "
                             "a range such as 4-13")
    parser.add_argument("--oidn", metavar="DIR", help="also evaluate Open Image Denoise's networks (oidn.py), whose weights are in this folder")
    parser.add_argument("--pictured", type=words, metavar="LIST", default=PICTURED, help=f"variants on the page (default: {','.join(PICTURED)})")
    parser.add_argument("--pictured-spp", type=counts, metavar="LIST", help="sample counts on the page (default: 4, with --shots: all)")
    parser.add_argument("--frames", type=frames, metavar="RANGE", help="of the noisy sequences (default: 1-16)")
    parser.add_argument("--measured", type=frames, metavar="RANGE", help="frames that have references (default: 7-10)")
    parser.add_argument("--reference-spp", type=int, metavar="N", help="of each of the two references (default: 64)")
    parser.add_argument("--size", default="384x216", metavar="WxH", help="of rendered frames (default: 384x216)")
    parser.add_argument("--resume", action="store_true", help="reuse figures of an earlier run that had the same program and frames")
    parser.add_argument("--becalm", type=Path, default=Path("build/release/becalm"), metavar="PATH")
    asked = parser.parse_args()
    if asked.shots and asked.data:
        parser.error("--shots and --data exclude each other")
    added = asked.variant + asked.other + (oidn(asked.oidn) if asked.oidn else [])
    names = [variant.name for variant in VARIANTS]
    for name in (asked.variants or []) + asked.pictured:
        if name not in names + [variant.name for variant in added]:
            parser.error(f"no variant '{name}'; there are {', '.join(names)}")
    asked.named = asked.variants is not None
    asked.variants = [v for v in VARIANTS if asked.variants is None or v is NOISY or v.name in asked.variants] + added
    return asked


def _or_default(asked, **defaults):
    for name, value in defaults.items():
        if getattr(asked, name) is None:
            setattr(asked, name, value)


def find_data(asked):
    """The frames to measure on. Sets the options in `asked` that were not given to their defaults."""
    if asked.shots:
        data = Shots(asked.shots, asked.frames, asked.measured, asked.spp)
        _or_default(asked, scenes=list(data.roots), spp=data.spps, frames=data.frames, measured=data.measured, pictured_spp=data.spps,
                    output=Path(f"out/quality_{Path(asked.shots).name}"))
        for scene in set(asked.scenes) - data.roots.keys():
            raise OSError(f"no shot '{scene}'; there are {', '.join(data.roots)}")
    else:
        _or_default(asked, scenes=SCENES, spp=[1, 4, 8, 16, 64], frames=frames("1-16"), measured=frames("7-10"), reference_spp=64,
                    pictured_spp=[4], output=Path("out/quality"))
        data = Data(asked.data or Path("build/quality"), asked.frames, asked.measured, asked.spp,
                    None if asked.data else Renderer(asked.becalm, asked.size))
    _or_default(asked, ablation_spp=data.spps if 4 not in data.spps or (asked.shots and asked.named) else [4])
    if not asked.measured or not set(asked.measured) <= set(asked.frames):
        raise OSError("the measured frames are not all among the noisy ones")
    return data


def measure(asked, cells, results):
    """Measures all cells. Returns a line for each scene and sample count that lacks frames."""
    missing = []
    for scene in asked.scenes:
        for spp in asked.spp:
            for variant in asked.variants:
                if variant.name in results.refusals or (variant.ablation and spp not in asked.ablation_spp):
                    continue
                try:
                    cell = cells.measure(scene, spp, variant, variant.name in asked.pictured and spp in asked.pictured_spp)
                except MissingFrames as error:
                    missing.append(f"{scene} at {spp} spp: {error}")
                    break
                results.add(cell)
                print(f"{scene:>10} {spp:>3} spp  {variant.name:<16} relMSE {cell['mean']['relmse']:.5f}  temporal "
                      f"{cell['mean']['temporal']:.5f}  energy {100 * cell['mean']['energy']:+.3f} %", flush=True)
    return missing


def print_means(asked, results):
    """Prints the geometric means over the scenes, as the last lines of a run."""
    print()
    for spp in results.spps():
        for variant in asked.variants:
            cells = results.of(spp, variant.name)
            if variant is not NOISY and cells:
                relmse, temporal = (tables.geometric_share(results, spp, variant.name, metric) for metric in ("relmse", "temporal"))
                print(f"geometric mean of {len(cells)} scenes, {spp} spp  {variant.name:<16} relMSE {relmse}  temporal {temporal}  of noisy")


def write_report(asked, results, missing):
    """Prints and writes all tables. Returns the sections of the page."""
    spps = results.spps()
    report = Report(asked.output, ["goals", *(f"{spp}spp" for spp in spps), "samples", "variants"], "Quality of the denoised sequences")
    report.clear()
    found = goals(results, ours=not asked.shots)
    sections = []

    def add(key, title, text, data):
        report.add(key, title, text, data)
        sections.append({"key": key, "title": title, "text": text})

    for spp in spps:
        parts = [tables.overview_table(results, spp), *(tables.scene_table(results, spp, metric) for metric in tables.METRICS),
                 tables.kept_table(results, spp), tables.still_table(results, spp)]
        add(f"{spp}spp", f"{spp} samples per pixel", "\n".join(parts), [c for c in results.cells.values() if c["spp"] == spp])
    if len(spps) > 1:
        add("samples", "All sample counts", "\n".join(tables.samples_table(results, metric) for metric in ("relmse", "temporal")), spps)
    add("variants", "Variants", tables.variant_table(results), results.refusals)
    lines = goal_table(found) + ("\nNot measured, since frames are missing:\n\n" + items(missing) if missing else "")
    add("goals", "Goals", lines, [vars(goal) | {"verdict": goal.verdict} for goal in found])
    return sections


def main():
    asked = arguments()
    data = find_data(asked)
    asked.output.mkdir(parents=True, exist_ok=True)
    program = Program(asked.becalm)
    results = tables.Results(asked.variants, {v.name: why for v in asked.variants if (why := program.refusal(v))})
    missing = measure(asked, Cells(program, data, asked.output, asked.reference_spp, asked.resume), results)
    if not results.cells:
        sys.exit("bench quality: nothing to measure: " + "; ".join(missing))
    sections = write_report(asked, results, missing)
    judged = asked.ablation_spp[0] if asked.ablation_spp[0] in results.spps() else results.spps()[0]
    plots = write_plots(asked.output / "plots", results, ENERGY, judged)
    write_quality_page(asked, results, sections, plots)
    print_means(asked, results)
    print(asked.output / "index.html")


if __name__ == "__main__":
    try:
        main()
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"bench quality: {error}")
