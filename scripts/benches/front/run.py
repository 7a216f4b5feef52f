"""The trade of speed for accuracy: time against error of the presets, of their settings and of the recipes that renderers commonly use,
over sample counts, and what plain rendering needs for the same error. Called by `scripts/bench front`."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from benches.front import adaptive, page, scaling
from benches.front.cells import FrontCells, MissingLayer
from benches.front.gaps import Gap, told
from benches.front.methods import PAPER, PLAIN, PRESETS, RECIPES, kind, settings_of
from benches.front.points import METRICS, Point, Trade, mean_trade, positive_errors
from benches.quality import options
from benches.quality.data import SCENES, Data, MissingFrames, Renderer, noisy_aovs
from benches.quality.render_time import CLOCKS, seconds_a_frame
from benches.quality.shots import KNOWN, Shots
from benches.quality.variants import Program
from whole_file import write_whole

DEFAULT_SCENES = ["penumbra", "crossing", "spheres", "dining"]
NONE = ["none"]
TIMED_FRAMES = 2  # rendered again where the time of frames is not noted
PROCESS_TIME = {"wall": "process", "processor": "processor"}  # the name in a cell's times, by clock


def arguments():
    methods = [method.name for method in (*PRESETS, PAPER, *RECIPES)]
    parser = argparse.ArgumentParser(prog="scripts/bench front", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/front"), metavar="DIR",
                        help="index.html, report.md, *.json and plots (default: out/front)")
    parser.add_argument("--scenes", type=options.words, default=DEFAULT_SCENES, metavar="LIST",
                        help=f"of scenes/, or none (default: {','.join(DEFAULT_SCENES)})")
    parser.add_argument("--data", type=Path, metavar="DIR",
                        help="existing frames of the scenes, as DIR/SCENE/n4/f.####.exr and DIR/SCENE/a, b: nothing is rendered, missing frames "
                             "are reported (default: build/quality, where missing frames are rendered)")
    parser.add_argument("--shots", metavar="NAME",
                        help=f"also frames of another renderer: {', '.join(KNOWN)}, a folder with n8/, a/ and b/, or a folder of such folders; "
                             "or none (default: cycles, if they are there)")
    parser.add_argument("--spp", type=options.counts, default=[1, 4, 16, 64], metavar="LIST", help="of the scenes' noisy frames (default: 1,4,16,64)")
    parser.add_argument("--methods", type=options.words, default=methods + ["settings"], metavar="LIST",
                        help=f"some of {','.join(methods)} and settings, the presets with one setting changed (default: all)")
    parser.add_argument("--settings-spp", type=options.counts, default=[4], metavar="LIST",
                        help="the sample counts at which changed settings are measured, on our scenes only (default: 4)")
    parser.add_argument("--frames", type=options.frames, default=options.frames("4-13"), metavar="RANGE", help="of the scenes (default: 4-13)")
    parser.add_argument("--measured", type=options.frames, default=options.frames("7-10"), metavar="RANGE",
                        help="frames that have references (default: 7-10)")
    parser.add_argument("--reference-spp", type=int, default=64, metavar="N", help="of each of the two references (default: 64)")
    parser.add_argument("--size", default="384x216", metavar="WxH", help="of rendered frames (default: 384x216)")
    parser.add_argument("--clock", choices=CLOCKS, default="wall", help="time that passes, or that of all processors (default: wall)")
    parser.add_argument("--resume", action="store_true", help="reuse figures of an earlier run that had the same program and frames")
    parser.add_argument("--becalm", type=Path, default=Path("build/release/becalm"), metavar="PATH")
    parser.add_argument("--adaptive", action="store_true", help="in place of all that, what adaptive sampling gains on the scenes")
    long = parser.add_argument_group("time and memory against pixels and frames, in place of all of the above")
    long.add_argument("--scaling", action="store_true", help="measure this; a size that would need more memory than is free is left out")
    long.add_argument("--preset", default="draft", metavar="NAME", help="default: draft")
    long.add_argument("--sizes", type=options.words, metavar="LIST", default=["480x270", "960x540", "1920x1080", "3840x2160", "7680x4320"],
                      help="default: 480x270 to 7680x4320, each twice as wide as the one before")
    long.add_argument("--counts", type=options.counts, default=[10, 30, 100, 300, 1000], metavar="LIST",
                      help="of frames (default: 10,30,100,300,1000)")
    asked = parser.parse_args()
    for name in asked.methods:
        if name not in [*methods, "settings"]:
            parser.error(f"no method '{name}'; there are {', '.join(methods)} and settings")
    for scene in asked.scenes:
        if [scene] != NONE and not (SCENES / f"{scene}.json").exists():
            parser.error(f"no scene '{scene}' in scenes/")
    if min(asked.counts) <= scaling.START:
        parser.error(f"--counts: expected more than {scaling.START} frames, which stand for the start of the program")
    if not set(asked.measured) <= set(asked.frames):
        parser.error("the measured frames are not all among those of --frames")
    return asked


class Set:
    """Scenes or shots that are measured together."""

    def __init__(self, key, title, data, scenes, methods, settings_spp=()):
        self.key, self.title, self.data, self.scenes, self.methods, self.settings_spp = key, title, data, scenes, methods, settings_spp
        self.trades, self.missing = [], []

    def measure(self, cells, clock):
        """Measures every point. What lacks frames or layers is a Gap in `missing`."""
        for scene in self.scenes:
            points = [point for spp in self.data.spps for point in self._points(cells, scene, spp, clock)]
            if any(point.kind != "plain" for point in points):
                self.trades.append(Trade(scene, points))

    def _points(self, cells, scene, spp, clock):
        try:
            render_s = self._render_seconds(scene, spp, clock)
        except MissingFrames as error:
            self.missing.append(Gap("", scene, spp, str(error)))
            return
        for method in self.methods:
            if kind(method) == "setting" and spp not in self.settings_spp:
                continue
            try:
                cell = cells.measure(scene, spp, method, False)
            except MissingFrames as error:
                self.missing.append(Gap("", scene, spp, str(error)))
                return
            except MissingLayer as error:
                self.missing.append(Gap(method.title, scene, spp, str(error)))
                continue
            error = positive_errors(cell["mean"])
            point = Point(spp, method.name, method.title, kind(method), render_s, cell["times"].get(PROCESS_TIME[clock], 0.0), **error)
            print(f"{scene:>10} {spp:>3} spp  {method.name:<28} {point.seconds:8.3f} s  " +
                  "  ".join(f"{title} {error[metric] or float('nan'):.5f}" for metric, title in METRICS.items()), flush=True)
            yield point

    def _render_seconds(self, scene, spp, clock):
        """Of a frame; None if nothing tells it."""
        pattern = self.data.noisy(scene, spp)
        made_by = self.data.render.made_by if self.data.render else None
        if self.data.render and seconds_a_frame(pattern.parent, clock, made_by) is None:
            self.data.render.note_time(SCENES / f"{scene}.json", pattern, self.data.measured[:TIMED_FRAMES], spp, spp, noisy_aovs(spp))
        return seconds_a_frame(pattern.parent, clock, made_by)


def find_sets(asked, program):
    """The sets to measure, and a line for each that is not there."""
    methods = [PLAIN, *(method for method in (*PRESETS, PAPER, *RECIPES) if method.name in asked.methods)]
    changed = [v for v in settings_of(asked.becalm) if not program.refusal(v)] if "settings" in asked.methods else []
    sets, missing = [], []
    if asked.scenes != NONE:
        render = None if asked.data else Renderer(asked.becalm, asked.size)
        data = Data(asked.data or Path("build/quality"), asked.frames, asked.measured, asked.spp, render)
        sets.append(Set("scenes", "Our scenes", data, asked.scenes, methods + changed, asked.settings_spp))
    if asked.shots != "none":
        try:
            data = Shots(asked.shots or "cycles")
            title = "Cycles shots" if asked.shots in (None, "cycles") else f"Shots {Path(asked.shots).name}"
            sets.append(Set("shots", title, data, list(data.roots), methods))
        except OSError as error:
            if asked.shots:
                raise
            missing.append(str(error))
    return sets, missing


def measure(asked):
    program = Program(asked.becalm)
    sets, missing = find_sets(asked, program)
    for one in sets:
        one.measure(FrontCells(program, one.data, asked.output / one.key, asked.reference_spp, asked.resume), asked.clock)
        missing += told(one.missing)
    measured = [one for one in sets if one.trades]
    if not measured:
        sys.exit("bench front: nothing to measure:\n" + "\n".join(missing or ["neither scenes nor shots"]))
    figures = {one.key: [trade.figures() for trade in (*one.trades, mean_trade(one.trades))] for one in measured}
    write_whole(asked.output / "figures.json", json.dumps({"clock": asked.clock, "missing": missing} | figures, indent=1))
    page.write(asked.output, measured, missing, asked.clock)


def measure_adaptive(asked):
    data = Data(asked.data or Path("build/quality"), asked.frames, asked.measured, asked.spp, None if asked.data else Renderer(asked.becalm, asked.size))
    adaptive.write(adaptive.Runs(asked.becalm, data, asked.size, asked.output, asked.reference_spp), asked.scenes, asked.output)


def measure_scaling(asked):
    runs = scaling.Scaling(asked.becalm, "build/front", asked.output, asked.preset, asked.resume)
    by_pixels = runs.sizes(sorted(asked.sizes, key=scaling.pixels_of))
    page.write_scaling(asked.output, asked.preset, by_pixels, runs.frames(sorted(asked.counts)), asked.clock)


def main():
    asked = arguments()
    asked.output.mkdir(parents=True, exist_ok=True)
    (measure_scaling if asked.scaling else measure_adaptive if asked.adaptive else measure)(asked)
    print(asked.output / "index.html")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        sys.exit(f"bench front: {error}")
    except KeyboardInterrupt:
        sys.exit("bench front: interrupted; --resume goes on")
