"""Time and memory of `becalm denoise` against the number of pixels and of frames, with fitted exponents."""

import json
import os
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from benches.front.exponent import exponent, local_exponents
from benches.markdown_report import figure, markdown, wrapped
from benches.plotting import label_log_axis, plot_panels, save
from benches.made_of import content_hash
from benches.quality.data import SCENES, frame_path, frame_range
from benches.timed import timed
from whole_file import write_whole

SCENE = "crossing"
SPP = 1
PIXEL_FRAMES = list(range(9, 13))  # of each size
SMALL = "96x54"                    # size of the frames that are counted
CYCLE = list(range(1, 25))         # frames of the scene, which are shown forwards and backwards in turn
START = 2                          # frames of the run that stands for the start of the program: the second is the first that is aligned
TAIL = 100                         # frames from which on memory and the time of a frame are expected to be constant: segments are filled by then
AOVS = "albedo,normal,depth,variance"


@dataclass(frozen=True)
class Measured:
    """One run. A run that would need more memory than there is has a reason instead of figures."""
    what: str
    size: int  # pixels or frames
    wall_s: float | None = None       # of a frame, less the start of the program
    processor_s: float | None = None  # likewise
    peak_mib: float | None = None
    refused: str = ""


def pixels_of(size):
    width, height = map(int, size.split("x"))
    return width * height


def _available_mib():
    line = next(line for line in Path("/proc/meminfo").read_text().splitlines() if line.startswith("MemAvailable"))
    return int(line.split()[1]) / 1024


def _less_start(run, start, frames):
    """A run's seconds a frame, of so many, without the start, which is the run of START small frames. At least a hundredth of them is left."""
    def left(clock):
        total = getattr(run, clock)
        return max(total - getattr(start, clock), 0.01 * total) / frames
    return replace(run, wall_s=left("wall_s"), processor_s=left("processor_s"))


class Scaling:
    """Runs becalm, and keeps each run's figures in FOLDER/scaling_runs.json."""

    def __init__(self, becalm, data, folder, preset, resume):
        self.becalm, self.data, self.preset, self.made_by = becalm, Path(data), preset, content_hash(becalm)
        self.file = folder / "scaling_runs.json"
        self.rendered = set()  # patterns
        self.kept = json.loads(self.file.read_text()) if resume and self.file.exists() else {}

    def sizes(self, sizes):
        """A run for each size. One that is expected to need more memory than is available is refused: sizes must rise."""
        found = []
        for size in sizes:
            before = next((run for run in reversed(found) if run.peak_mib), None)
            needed = before.peak_mib * pixels_of(size) / before.size if before else 0.0
            if needed > _available_mib() and self._key("pixels", size) not in self.kept:
                found.append(Measured(size, pixels_of(size), refused=f"would need about {needed / 1024:.0f} GiB"))
                continue
            run = self._run("pixels", size, pixels_of(size), PIXEL_FRAMES, lambda size=size: self._rendered(size, PIXEL_FRAMES))
            found.append(_less_start(run, self._small(START), len(PIXEL_FRAMES)))
        return found

    def frames(self, counts):
        return [_less_start(self._small(count), self._small(START), max(count - START, 1)) for count in counts]

    def _small(self, count):
        return self._run("frames", str(count), count, list(range(1, count + 1)), lambda: self._repeated(count))

    def _key(self, axis, what):
        return f"{axis} {what} {self.preset} {self.made_by}"

    def _run(self, axis, what, size, frames, source):
        """Its seconds are those of all frames."""
        key = self._key(axis, what)
        if key not in self.kept:
            pattern = source()
            denoised = pattern.parent / "denoised" / "f.####.exr"
            print(f"denoise {what}, preset {self.preset}, {len(frames)} frames", flush=True)
            _, cost = timed([self.becalm, "denoise", pattern, "-o", denoised, "--frames", frame_range(frames), "--preset", self.preset,
                             "--overwrite", "--quiet", "--cuts", "none"])
            self.kept[key] = asdict(Measured(what, size, cost.wall_s, cost.processor_s, cost.peak_mib))
            write_whole(self.file, json.dumps(self.kept, indent=1))
            for frame in frames:
                frame_path(denoised, frame).unlink()
        return Measured(**self.kept[key])

    def _rendered(self, size, frames):
        pattern = self.data / f"{SCENE}.{size}" / "f.####.exr"
        if pattern not in self.rendered:
            print(f"render {SCENE} {size}, {SPP} spp", flush=True)
            timed([self.becalm, "render", SCENES / f"{SCENE}.json", "-o", pattern, "--frames", frame_range(frames), "--size", size,
                   "--spp", SPP, "--aov-spp", SPP, "--aovs", AOVS, "--resume", "--quiet"])
            self.rendered.add(pattern)
        return pattern

    def _repeated(self, count):
        """Links to the frames of the scene, forwards and backwards."""
        rendered = self._rendered(SMALL, CYCLE)
        pattern = rendered.parent / "repeated" / "f.####.exr"
        pattern.parent.mkdir(exist_ok=True)
        there_and_back = [*CYCLE, *CYCLE[-2:0:-1]]
        for number in range(1, count + 1):
            link = frame_path(pattern, number)
            if not link.is_symlink():
                os.symlink(frame_path(rendered, there_and_back[(number - 1) % len(there_and_back)]).resolve(), link)
        return pattern


def _fit(runs, cost):
    """None with fewer than two runs."""
    usable = [run for run in runs if getattr(run, cost)]
    return exponent([run.size for run in usable], [getattr(run, cost) for run in usable]) if len(usable) > 1 else None


def summary(by_pixels, by_frames, clock):
    """The exponents that the claims are about: cost linear in pixels is 1; time and memory constant in frames are 0."""
    long = [run for run in by_frames if run.size >= TAIL]
    return {"time by pixels": _fit(by_pixels, f"{clock}_s"), "memory by pixels": _fit(by_pixels, "peak_mib"),
            f"time a frame by frames from {TAIL} on": _fit(long, f"{clock}_s"), f"memory by frames from {TAIL} on": _fit(long, "peak_mib")}


def _table(title, runs, clock):
    done = [run for run in runs if not run.refused]
    sizes = [run.size for run in done]
    local = {cost: iter(local_exponents(sizes, [getattr(run, cost) for run in done])) for cost in (f"{clock}_s", "peak_mib")}
    rows = [(run.what, run.refused, "-", "-", "-") if run.refused else
            (run.what, f"{getattr(run, f'{clock}_s'):.4g}", figure(next(local[f"{clock}_s"]), 2), f"{run.peak_mib:.0f}",
             figure(next(local["peak_mib"]), 2)) for run in runs]
    unit = "seconds a frame" if clock == "wall" else "processor seconds a frame"
    return markdown((title, unit, "exponent", "peak memory, MiB", "exponent"), rows)


def report(preset, by_pixels, by_frames, clock):
    """The section's text."""
    claims = markdown(("fitted exponent", "of all runs"), [(name, figure(value, 2)) for name, value in
                                                           summary(by_pixels, by_frames, clock).items()])
    what = wrapped(
        f"`becalm denoise --preset {preset}` of `scenes/{SCENE}.json` at {SPP} sample per pixel, with files, without the start of the program "
        f"(a run of {START} frames of {SMALL}). An exponent in a row is that from the row before. Frames are counted at {SMALL}; each size has "
        f"{len(PIXEL_FRAMES)} frames.")
    return f"{what}\n{claims}\n{_table('pixels', by_pixels, clock)}\n{_table('frames', by_frames, clock)}"


def _decade_or_more(values):
    """Limits of an axis, so wide that what is constant looks constant."""
    low, high = min(values) / 1.3, max(values) * 1.3
    wider = max(1.0, (10.0 * low / high) ** 0.5)
    return low / wider, high * wider


def plot_scaling(path, preset, by_pixels, by_frames, clock):
    seconds = f"{clock}_s"
    figure_, panels = plot_panels([f"{preset}: against pixels", f"{preset}: against frames"], "", ["seconds a frame"] * 2, (13.0, 5.6))
    for axes, runs, x in zip(panels, (by_pixels, by_frames), ("pixels", "frames")):
        done = [run for run in runs if not run.refused]
        if not done:
            continue
        sizes, memory = [run.size for run in done], axes.twinx()
        for where, cost, marker, colour, name in ((axes, seconds, "o", "C0", "seconds a frame"), (memory, "peak_mib", "s", "C1", "peak memory")):
            values = [getattr(run, cost) for run in done]
            where.loglog(sizes, values, marker=marker, color=colour, label=name)
            where.set_ylim(_decade_or_more(values))
            label_log_axis(where.yaxis)
        memory.set_ylabel("MiB")
        axes.set_xlabel(x)
        axes.set_xticks(sizes, [run.what for run in done])
        axes.minorticks_off()
        lines = [*axes.get_lines(), *memory.get_lines()]
        axes.legend(lines, [line.get_label() for line in lines], fontsize=8, loc="upper left")
    save(path, figure_)
