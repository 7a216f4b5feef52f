"""The experiments of Hanika et al. 2021, figures 5, 6, 13-16 and tables 1-2, on our own scenes. Called by scripts/align_experiments."""

import argparse
import subprocess
import sys
from pathlib import Path

import align_compare
import align_distances
import align_downsampling
import align_radii
import align_refinement
from align_peers import PEERS
from align_renders import BATCH_SPP, Renders
from align_report import Report
from align_service import AlignError, Aligners
from align_synthetic import shift_pair, zoom_pair

SCENES = ["spheres", "ocean", "penumbra", "crossing", "dining", "fence"]
PICTURED_SPP = 4
LARGE = "1920x1080"
EXPERIMENTS = ["compare", "distances", "radii", "refinement", "downsampling"]
SECTIONS = ["rendered", "synthetic", *EXPERIMENTS[1:]]  # of the report
SLOW_PEER = "Dual TV-L1"
SYNTHETIC_NOISE = (0.02, 0.1)


def _words(text):
    return text.split(",")


def _experiments(text):
    names = text.split(",")
    for name in names:
        if name not in EXPERIMENTS:
            raise argparse.ArgumentTypeError(f"no experiment '{name}'; expected some of {','.join(EXPERIMENTS)}")
    return names


def _reference_spp(text):
    if not text.isdigit() or int(text) < 2 * BATCH_SPP or int(text) % (2 * BATCH_SPP) != 0:
        raise argparse.ArgumentTypeError(f"'{text}': expected a multiple of {2 * BATCH_SPP}")
    return int(text)


def _variant(text):
    name, *settings = text.split()
    if not settings or not all("=" in setting for setting in settings):
        raise argparse.ArgumentTypeError(f"'{text}': expected NAME KEY=VALUE ..., with no blank in the name")
    return name, settings


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/align_experiments", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/align"), metavar="DIR",
                        help="report.md, report.json, pictures, and the renders, which later runs take up (default: out/align)")
    parser.add_argument("--quick", action="store_true",
                        help="for tuning: the comparison with the peers alone, at 1 and 4 spp, without Dual TV-L1")
    parser.add_argument("--only", type=_experiments, metavar="LIST", help=f"some of {','.join(EXPERIMENTS)} (default: all)")
    parser.add_argument("--scenes", type=_words, metavar="LIST", default=SCENES, help=f"default: {','.join(SCENES)}")
    parser.add_argument("--spp", type=_words, metavar="LIST", help="of the noisy frames (default: 1,2,4,8,16; --quick: 1,4)")
    parser.add_argument("--reference-spp", type=_reference_spp, metavar="N", default=256,
                        help="of the clean frames, a multiple of 128 (default: 256)")
    parser.add_argument("--size", default="640x360", metavar="WxH", help="of rendered and synthetic pairs (default: 640x360)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change this setting in all of our variants")
    parser.add_argument("--variant", action="append", default=[], type=_variant, metavar="'NAME KEY=VALUE ...'",
                        help="compare with these settings over the default preset, too")
    parser.add_argument("--only-ours", action="store_true", help="of our variants compare only 'ours' and those of --variant")
    parser.add_argument("--device", help="Vulkan device: its index or part of its name")
    parser.add_argument("--becalm", default="build/release/becalm", metavar="PATH", help="renders the frames")
    parser.add_argument("--bench-align", default="build/release/tests/bench/bench_align", metavar="PATH", help="aligns them")
    asked = parser.parse_args()
    asked.only = asked.only or (["compare"] if asked.quick else EXPERIMENTS)
    asked.folder = asked.output / "quick" if asked.quick else asked.output
    asked.spp = [int(n) for n in asked.spp or (["1", "4"] if asked.quick else ["1", "2", "4", "8", "16"])]
    return asked


def comparison(asked, aligners, renders, report):
    variants = {name: entry for name, entry in align_compare.VARIANTS.items() if name == align_compare.OURS or not asked.only_ours}
    variants |= {name: (settings, True) for name, settings in asked.variant}
    variants = {name: ([*settings, *asked.set], guides) for name, (settings, guides) in variants.items()}
    peers = [name for name in PEERS if not (asked.quick and name == SLOW_PEER)]
    width, height = map(int, asked.size.split("x"))
    rows, synthetic = [], []
    for scene in asked.scenes:
        for spp in asked.spp:
            pair = renders.pair(scene, spp, asked.reference_spp)
            measured, offsets = align_compare.compare(aligners, pair, variants, peers)
            rows += measured
            if spp == PICTURED_SPP:
                align_compare.write_panel(asked.folder / f"compare.{scene}.png", pair, offsets)
    for make in (shift_pair, zoom_pair):
        for sigma in SYNTHETIC_NOISE:
            synthetic += align_compare.compare(aligners, make((height, width), sigma), variants, peers)[0]
    for key, title, of in (("rendered", "Rendered pairs", rows), ("synthetic", "Synthetic pairs", synthetic)):
        found = align_compare.verdicts(of)
        tables = [align_compare.row_table(of), align_compare.overview_table(of, "clean"),
                  align_compare.overview_table(of, "rms_visible"), align_compare.verdict_table(found)]
        report.add(key, title, "\n".join([*tables, align_compare.goal_line(found)]) + "\n", {"rows": of, "verdicts": found})


def main():
    asked = arguments()
    aligners = Aligners(asked.bench_align, asked.device)
    folder = asked.output / "renders"
    renders = Renders(asked.becalm, folder, asked.size)
    report = Report(asked.folder, SECTIONS, "Alignment experiments")
    experiments = {
        "compare": lambda: comparison(asked, aligners, renders, report),
        "distances": lambda: align_distances.run(aligners, renders, report, asked.folder, asked.reference_spp),
        "radii": lambda: align_radii.run(aligners, report, asked.folder),
        "refinement": lambda: align_refinement.run(aligners, report, asked.folder),
        "downsampling": lambda: align_downsampling.run(aligners, Renders(asked.becalm, folder, LARGE), report, asked.folder),
    }
    for name in asked.only:
        experiments[name]()
        aligners.close()
    print(asked.folder / "report.md")


if __name__ == "__main__":
    try:
        main()
    except (AlignError, OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"align_experiments: {error}")
