"""Accuracy of the aligner's offsets beside OpenCV's optical flow, on rendered and synthetic pairs of frames, as in figures 13 and 14
of Hanika et al. 2021. Called by `scripts/bench align_accuracy`."""

import argparse
import contextlib
import subprocess
import sys
from pathlib import Path

from benches.align import comparison
from benches.align.peers import PEERS
from benches.align.renders import BATCH_SPP, Renders
from benches.align.service import AlignError, Aligners
from benches.align.synthetic import shift_pair, zoom_pair
from benches.markdown_report import Report
from benches.quality.options import words

SCENES = ["spheres", "ocean", "penumbra", "crossing", "dining", "fence"]
PICTURED_SPP = 4
SECTIONS = ["rendered", "synthetic"]  # of the report
SLOW_PEER = "Dual TV-L1"
SYNTHETIC_NOISE = (0.02, 0.1)  # standard deviation; the brightest value is 1


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
    parser = argparse.ArgumentParser(prog="scripts/bench align_accuracy", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/align"), metavar="DIR",
                        help="report.md, *.json, pictures, and the renders, which later runs reuse (default: out/align)")
    parser.add_argument("--quick", action="store_true", help="for tuning: at 1 and 4 spp, without Dual TV-L1, written to DIR/quick")
    parser.add_argument("--scenes", type=words, metavar="LIST", default=SCENES, help=f"default: {','.join(SCENES)}")
    parser.add_argument("--spp", type=words, metavar="LIST", help="of the noisy frames (default: 1,2,4,8,16; --quick: 1,4)")
    parser.add_argument("--reference-spp", type=_reference_spp, metavar="N", default=256,
                        help="of the clean frames, a multiple of 128 (default: 256)")
    parser.add_argument("--size", default="640x360", metavar="WxH", help="of rendered and synthetic pairs (default: 640x360)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change this setting in all of our variants")
    parser.add_argument("--variant", action="append", default=[], type=_variant, metavar="'NAME KEY=VALUE ...'",
                        help="also compare the default preset with these settings")
    parser.add_argument("--only-ours", action="store_true", help="of our variants compare only 'ours' and those of --variant")
    parser.add_argument("--device", help="Vulkan device: its index or part of its name")
    parser.add_argument("--becalm", default="build/release/becalm", metavar="PATH", help="renders the frames")
    parser.add_argument("--bench-align", default="build/release/scripts/benches/bench_align", metavar="PATH", help="aligns them")
    asked = parser.parse_args()
    asked.folder = asked.output / "quick" if asked.quick else asked.output
    asked.spp = [int(n) for n in asked.spp or (["1", "4"] if asked.quick else ["1", "2", "4", "8", "16"])]
    return asked


def compare(asked, aligners, renders, report):
    variants = {name: entry for name, entry in comparison.VARIANTS.items() if name == comparison.OURS or not asked.only_ours}
    variants |= {name: (settings, True) for name, settings in asked.variant}
    variants = {name: ([*settings, *asked.set], guides) for name, (settings, guides) in variants.items()}
    peers = [name for name in PEERS if not (asked.quick and name == SLOW_PEER)]
    width, height = map(int, asked.size.split("x"))
    rows, synthetic = [], []
    for scene in asked.scenes:
        for spp in asked.spp:
            pair = renders.pair(scene, spp, asked.reference_spp)
            measured, offsets = comparison.compare(aligners, pair, variants, peers)
            rows += measured
            if spp == PICTURED_SPP:
                comparison.write_panel(asked.folder / f"compare.{scene}.png", pair, offsets)
    for make in (shift_pair, zoom_pair):
        for sigma in SYNTHETIC_NOISE:
            synthetic += comparison.compare(aligners, make((height, width), sigma), variants, peers)[0]
    for key, title, of in (("rendered", "Rendered pairs", rows), ("synthetic", "Synthetic pairs", synthetic)):
        found = comparison.verdicts(of)
        tables = [comparison.row_table(of), comparison.overview_table(of, "clean"),
                  comparison.overview_table(of, "rms_visible"), comparison.verdict_table(found)]
        report.add(key, title, "\n".join([*tables, comparison.goal_line(found)]) + "\n", {"rows": of, "verdicts": found})


def main():
    asked = arguments()
    renders = Renders(asked.becalm, asked.output / "renders", asked.size)
    with contextlib.closing(Aligners(asked.bench_align, asked.device)) as aligners:
        compare(asked, aligners, renders, Report(asked.folder, SECTIONS, "Accuracy of the aligner"))
    print(asked.folder / "report.md")


if __name__ == "__main__":
    try:
        main()
    except (AlignError, OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"bench align_accuracy: {error}")
