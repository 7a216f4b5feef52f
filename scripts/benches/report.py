"""Writes RESULTS.md: the quality of each preset on the Cycles shots and on our scenes, the trade of speed for accuracy, what
adaptive sampling gains, temporal antialiasing and upsampling, pairs of eyes, bursts, what training depends on, time and memory at 1920x1080, and both against pixels and frames.
Called by `scripts/bench report`."""

import argparse
import datetime
import functools
import os
import platform
import re
import statistics
import subprocess
import sys
from pathlib import Path

from benches.at_a_glance import at_a_glance
from benches.markdown_report import within_columns, wrapped
from benches.quality import reference_noise
from benches.timed import timed
from whole_file import write_whole

PRESETS = ("draft", "balanced", "final")
SCENE, FRAMES, SPP = "scenes/crossing.json", "5-10", 4
RUNS = 3  # of each preset, alternating
VARIANTS = ("noisy", *PRESETS, "paper", "single", "frames", "forward_smooth", "beauty_alone", "noisy_albedo")


def said(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()


def processor():
    names = re.findall(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} processors"


def measured(becalm, folder, preset):
    """Wall and processor seconds per frame, and peak memory in MiB, of one run."""
    command = [becalm, "denoise", f"{folder}/in.####.exr", "-o", f"{folder}/out.####.exr", "--preset", preset, "--overwrite", "--quiet"]
    _, cost = timed(command, capture_output=True)
    frames = len(list(Path(folder).glob("in.*.exr")))
    return cost.wall_s / frames, cost.processor_s / frames, cost.peak_mib


def time_table(becalm, folder):
    """Yields the rows of the table of times: medians of alternating runs."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    subprocess.run([becalm, "render", SCENE, "-o", f"{folder}/in.####.exr", "--frames", FRAMES, "--spp", str(SPP), "--size", "1920x1080",
                    "--aovs", "albedo,normal,depth,variance", "--resume", "--quiet"], check=True)
    runs = {preset: [] for preset in PRESETS}
    for _ in range(RUNS):
        for preset in PRESETS:
            runs[preset].append(measured(becalm, folder, preset))
    for preset in PRESETS:
        wall, spent, mib = (statistics.median(column) for column in zip(*runs[preset]))
        yield f"| {preset} | {wall:.1f} | {spent:.1f} | {mib:.0f} |"


def section(folder, title):
    text = (folder / "report.md").read_text()
    found = re.search(rf"## {title}\n(.*?)\n## ", text, re.DOTALL)
    return found[1].strip() if found else sys.exit(f"report: {folder}/report.md: no section '{title}'")


def preset_means(overview):
    """A sentence of the means that a table of all variants begins with."""
    means = []
    for preset in PRESETS[::-1]:
        cells = re.search(rf"^\| preset {preset} +\|(.*)\|$", overview, re.MULTILINE)[1].split("|")
        means.append(f"`{preset}` leaves {cells[2].strip()} of noisy's relMSE and {cells[4].strip()} of its temporal error")
    return wrapped("Geometric means: " + "; ".join(means) + ".").strip()


def run_quality(becalm, folder, *options):
    subprocess.run([sys.executable, "-m", "benches.quality.run", "--becalm", becalm, "--variants", ",".join(VARIANTS), "--ablation-spp", "8",
                    "--pictured", "final", "--pictured-spp", "8", "-o", str(folder), "--resume", *options], check=True)


def quality_part(becalm, *comparison):
    folder = Path("out/report")
    run_quality(becalm, folder, "--shots", "cycles", *comparison)
    text = section(folder, "8 samples per pixel")
    return f"""## Cycles shots, 8 samples a pixel

{measured_at()}

{preset_means(text)}

480x270, with albedo, normal and depth, without variance;
`scripts/benches/quality/cycles/render.py` renders them, two references each. relMSE and temporal
error are those of `becalm compare`; 1/15 of noisy's is an error 15 times smaller. `paper` is the
method as published, which smooths nothing. Five rows change one thing of `final`. OIDN: the networks
of Open Image Denoise 2 with their published weights, evaluated by `scripts/benches/quality/oidn.py`.

The network did not learn from these shots, but they are not fully held out: it was extended after
looks at `cloth`, `foliage`, `car` and `bottles`; how light is restored, after a look at `candles`;
and that `draft` takes all of a difference for bias, after looks at all (`scripts/train/README.md`).

{text}

### Other sample counts

Geometric means over the shots.

{section(folder, "All sample counts")}

### 64 samples a pixel, by shot

{section(folder, "64 samples per pixel").split(chr(10) * 2)[1]}
"""


def scenes_part(becalm, *comparison):
    folder = Path("out/report_scenes")
    run_quality(becalm, folder, "--spp", "8", "--frames", "4-13", "--measured", "7-9", "--reference-spp", "64", *comparison)
    overview, relmse, temporal, energy = section(folder, "8 samples per pixel").split("\n\n")[:4]
    return f"""## Our scenes, 8 samples a pixel

{measured_at()}

{preset_means(overview)}

384x216, with every feature, variance and half-buffers; two references of 64 samples, of which
products are taken. The network did not learn from these scenes, but two things were decided after looks at
`penumbra`: affinities, and that single pixels are restored from 16 deviations on; and one after a
look at `crossing`: that lost light returns to bright pixels.

{reference_noise.note("build/quality", folder, PRESETS[::-1])}

{overview}

{relmse}

{temporal}

{energy}
"""


def trade_part(becalm):
    # Processor time: frames were rendered on other days, beside other work, by as many threads as there were.
    subprocess.run([sys.executable, "-m", "benches.front.run", "--becalm", becalm, "--clock", "processor", "--resume"], check=True)
    title, text = Path("out/front/trade.md").read_text().split("\n", 1)
    return f"{title}\n\n{measured_at()}\n{text}"


def adaptive_part(becalm):
    subprocess.run([sys.executable, "-m", "benches.front.run", "--becalm", becalm, "--adaptive"], check=True)
    title, text = Path("out/front/adaptive.md").read_text().split("\n", 1)
    return f"{title}\n\n{measured_at()}\n{text}"


def antialias_part(becalm):
    return f"""## Temporal antialiasing

{measured_at()}

One jittered sample a pixel at 320x180, 24 frames, direct light of a sun without penumbra and an
ambient term (`scripts/benches/antialias/shots.py`), against 128 samples. `clamping`, `gain` and
`paper` are the methods as published; `forward` and `best` are presets of `becalm antialias`. RMSE of
changes: that of the differences between successive frames, which shows flicker. Published: the table
of Philippi et al. 2022, on scenes of their own with the same names.

{said(sys.executable, "-m", "benches.antialias.run", "--becalm", becalm)}

### Stutter of slow motion

`scenes/mountains.json` without its clouds, 32 samples, whose motion is 0.1 px a frame here (Hanika et
al. 2021, figure 1): RMS difference between the motion from frame to frame, by Farneback's optical flow,
and that of the source, once averaged over time by the search.

{said(sys.executable, "-m", "benches.antialias.run", "--stutter", "--becalm", becalm)}
"""


def stereo_part(becalm):
    return f"""## Stereo

{measured_at()}

Eight frames of both eyes at 320x180; errors of three of them against 256 samples, whose noise is
taken out (`scripts/benches/stereo/`). The stereo difference is the root mean square difference
between an eye and the other one reprojected by depth. Constants were chosen on `courtyard` and
`dining`. Published: Philippi et al. 2022, section 5.3, on scenes of their own; `temporal` is as
theirs, without smoothing.

{said(sys.executable, "-m", "benches.stereo.run", "--becalm", becalm)}
"""


def burst_part(becalm):
    return f"""## Bursts

{measured_at()}

Frames of our scenes through a camera model (`scripts/benches/burst/camera.py`): hand shake, a disc
that moves, a mosaic, shot and read noise, 14 bits, 720x462 px; geometric means of three scenes. The
noise model is fitted to the files. Constants were chosen on courtyard and spheres.

{said(sys.executable, "-m", "benches.burst.run", "--becalm", becalm)}

Hanika et al. 2021, section 4: six shots of 16 megapixels (X-Trans) in 34 ms on an RTX 2080 Ti.
"""


def upsample_part(becalm):
    return f"""## Temporal upsampling and checkerboards

{measured_at()}

The same kind of frames at 192x108, 16 frames, rendered at full size, as a checkerboard, at 2/3 and at
half of the sides, and brought to full size by `becalm antialias`. Processor seconds a frame without
starting up. Smaller frames have one sample a pixel: without noise, more samples of the same place
would change nothing.

{said(sys.executable, "-m", "benches.antialias.run", "--becalm", becalm, "--upsample")}

The same scenes in their own light, with noise, 12 frames at 192x108: 4 samples a pixel at half size
(`jitter_one_a_frame`) beside 1 at full size, which are as many. Errors are against two references of
128 samples, whose noise is taken out; 16 samples of albedo, normal and depth are in full size's time,
as by default.
The order was chosen on courtyard and spheres.

{said(sys.executable, "-m", "benches.antialias.run", "--becalm", becalm, "--noisy")}

A zone plate of 192x192, panned at constant speeds (pixels a frame), one sample a pixel: what is left of
its contrast by frequency (cycles a pixel), beside the pixel filter, which is the limit.

{said(sys.executable, "-m", "benches.antialias.run", "--becalm", becalm, "--zone-plate")}
"""


def training_part(_):
    return f"""## Training

{measured_at()}

What the network depends on: trained from scratch, for far fewer steps than the program's. Errors are
those on held-out shots as shares of the input's, noisy or merged frames; geometric means.

{said(sys.executable, "-m", "benches.training")}
"""


def time_part(becalm):
    rows = "\n".join(time_table(becalm, "build/report"))
    return f"""## Time

{measured_at()}

`becalm denoise` of frames {FRAMES} of `{SCENE}`, 1920x1080, with albedo, normal, depth and
variance; medians of {RUNS} runs that alternate between the presets, files included.

| preset | seconds a frame | processor seconds a frame | peak memory, MiB |
| --- | --- | --- | --- |
{rows}
"""


def scaling_part(becalm):
    # Processor time: it depends less on what else the machine does in an hour.
    subprocess.run([sys.executable, "-m", "benches.front.run", "--becalm", becalm, "--scaling", "--clock", "processor", "--resume"], check=True)
    title, text = Path("out/front/scaling.md").read_text().split("\n", 1)
    return f"{title}\n\n{measured_at()}\n{text}"


# By name, in RESULTS.md's order.
PARTS = {"quality": quality_part, "scenes": scenes_part, "trade": trade_part, "adaptive": adaptive_part, "antialias": antialias_part,
         "upsample": upsample_part, "stereo": stereo_part, "burst": burst_part, "training": training_part, "time": time_part, "scaling": scaling_part}
TITLES = {"quality": "## Cycles shots, 8 samples a pixel", "scenes": "## Our scenes, 8 samples a pixel", "trade": "## The trade",
          "adaptive": "## Adaptive sampling", "antialias": "## Temporal antialiasing", "upsample": "## Temporal upsampling",
          "stereo": "## Stereo", "burst": "## Bursts", "training": "## Training", "time": "## Time\n", "scaling": "## Time and memory against pixels and frames\n"}
COMPARED = ("quality", "scenes")


@functools.cache
def commit():
    """Of the sources, asked before the first part; RESULTS.md, which changes with each, does not count."""
    changed = said("git", "status", "--porcelain", "--untracked-files=no", "--", ":!RESULTS.md")
    return said("git", "describe", "--always") + ("-dirty" if changed else "")


def measured_at():
    return f"Measured at {commit()}, {datetime.date.today()}, on {processor()}."


def parts_of(text):
    """The parts of RESULTS.md that are there, by name."""
    sections = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    return {name: part for part in sections for name, title in TITLES.items() if part.startswith(title)}


def contents(text):
    """Links to the sections, as GitHub and others name their anchors."""
    titles = re.findall(r"^## (.*)$", text, re.MULTILINE)
    return "".join(f"- [{title}](#{re.sub(r'[^a-z0-9 -]', '', title.lower()).replace(' ', '-')})\n" for title in titles)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench report", description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], metavar="PART", help=f"{', '.join(PARTS)}: the others are kept (default: all but training, which wants its shots)")
    parser.add_argument("--becalm", default="build/release/becalm")
    parser.add_argument("--oidn", metavar="DIR", help="weights of Open Image Denoise (github.com/RenderKit/oidn-weights), which quality and scenes are compared with")
    asked = parser.parse_args()
    results = Path("RESULTS.md")
    comparison = ("--oidn", asked.oidn) if asked.oidn else ()
    commit()
    failed = []
    for name in asked.parts or [name for name in PARTS if name != "training"]:
        try:
            part = PARTS[name](asked.becalm, *(comparison if name in COMPARED else ()))  # takes minutes: the file is read anew after it
        except (subprocess.CalledProcessError, OSError, SystemExit) as error:
            print(f"report: {name}: {error}", file=sys.stderr, flush=True)
            failed.append(name)
            continue
        parts = parts_of(results.read_text() if results.exists() else "") | {name: part}
        text = "".join(within_columns(parts[name].strip()) + "\n\n" for name in PARTS if name in parts)
        write_whole(results, f"# Results\n\nWritten by `scripts/bench report`.\n\n{at_a_glance(parts)}\n{contents(text)}\n{text.strip()}\n")
        print(f"RESULTS.md: {name}")
    if failed:
        sys.exit(f"report: not measured, and kept as they were: {', '.join(failed)}")


if __name__ == "__main__":
    main()
