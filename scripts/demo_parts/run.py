"""The stages of the demo: render, denoise, references, figures, page. Called by scripts/demo."""

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

from demo_parts.pictures import make_pictures
from pictures.page import write_page

CONTENT = Path(__file__).with_name("page.html")
FRAMES = range(1, 13)
MEASURED = range(10, 13)  # the last three frames: their history is long, and their temporal error is the mean of two differences
SPP = 4
WIDTH, HEIGHT = 640, 360
BUDGET_S = 340.0          # everything after the build: scripts/demo promises six minutes
PICTURES_S = 25.0         # part of the budget: the figures and the page
GOALS = {"relmse": 0.5, "temporal": 1 / 3, "energy": 0.01}  # errors: denoised over noisy; energy: relative error


class Demo:
    def __init__(self, becalm, scene, out):
        self.becalm, self.scene, self.out = becalm, scene, Path(out)
        self.started = time.monotonic()
        self.stages = []  # (name, detail, seconds)

    def run(self, name, detail, *arguments):
        """One becalm command as a timed stage; returns what it wrote to standard error."""
        print(f"== {name}: {detail}", flush=True)
        started = time.monotonic()
        process = subprocess.Popen([self.becalm, *map(str, arguments)], stderr=subprocess.PIPE, text=True)
        lines = []
        for line in process.stderr:
            lines.append(line)
            if not line.startswith((" ", "wall time", "device time")):
                print(line, end="", flush=True)
        if process.wait() != 0:
            sys.exit(process.returncode)
        self.add_stage(name, detail, time.monotonic() - started)
        return "".join(lines)

    def add_stage(self, name, detail, seconds):
        self.stages.append({"name": name, "detail": detail, "seconds": seconds})

    def pattern(self, name):
        return self.out / name / "penumbra.####.exr"

    def path(self, name, frame):
        return self.out / name / f"penumbra.{frame:04d}.exr"

    def render(self, name, title, frames, spp, seed, *options):
        return self.run(title, f"{len(frames)} frames, {WIDTH}x{HEIGHT}, {spp} spp", "render", self.scene, "-o",
                        self.pattern(name), "--frames", f"{frames[0]}-{frames[-1]}", "--size", f"{WIDTH}x{HEIGHT}",
                        "--spp", spp, "--seed", seed, "--type=float", *options)

    def reference_spp(self):
        """Samples per pixel of each of the two references that the remaining time allows."""
        noisy_s = self.stages[0]["seconds"]
        samples_per_s = len(FRAMES) * SPP / noisy_s
        time_left = BUDGET_S - PICTURES_S - (time.monotonic() - self.started)
        spp = 0.92 * time_left * samples_per_s / (2 * len(MEASURED))
        return max(4, min(1024, int(spp) // 4 * 4))

    def compare(self, name):
        report = self.out / f"{name}.json"
        subprocess.run([self.becalm, "compare", self.pattern("reference_a"), self.pattern(name), "--reference-b",
                        self.pattern("reference_b"), "--frames", f"{MEASURED[0]}-{MEASURED[-1]}", "--json", report],
                       check=True, stdout=subprocess.DEVNULL)
        return json.loads(report.read_text())


def passes_of(profile):
    """Device milliseconds per frame of each kernel, summed over its passes, from the output of --profile."""
    device = profile.partition("device time a frame")[2]
    totals = {}
    for kernel, milliseconds in re.findall(r"^  (\S+/\S+) .*?([\d.]+) ms$", device, re.MULTILINE):
        totals[kernel] = totals.get(kernel, 0.0) + float(milliseconds)
    return [{"name": k, "ms": v} for k, v in sorted(totals.items(), key=lambda item: -item[1])]


def figure_rows(noisy, denoised):
    """Rows of the table of errors, one a metric. The goal of energy limits the denoised value, other goals limit the ratio."""
    titles = {"relmse": "relMSE", "temporal": "temporal error", "energy": "energy", "psnr": "PSNR (dB)", "ssim": "SSIM"}
    rows = []
    for key, title in titles.items():
        before, after = noisy["mean"][key], denoised["mean"][key]
        row = {"key": key, "title": title, "noisy": before, "denoised": after}
        if key in ("relmse", "temporal"):
            row["ratio"] = after / before
        if key in GOALS:
            row["goal"] = GOALS[key]
            row["met"] = bool(abs(after if key == "energy" else row["ratio"]) <= GOALS[key])
        rows.append(row)
    return rows


def print_table(rows):
    print(f"\n{'':>16}  {'noisy':>11}  {'denoised':>11}  {'ratio':>7}   goal")
    for row in rows:
        percent = row["key"] == "energy"
        value = (lambda v: f"{100 * v:+.3f} %") if percent else (lambda v: f"{v:.5f}")
        ratio = f"{row['ratio']:.3f}" if "ratio" in row else ""
        goal = ""
        if "goal" in row:
            goal = f"within {100 * row['goal']:.0f} %" if percent else f"at most {row['goal']:.3f}"
            goal += ": met" if row["met"] else ": MISSED"
        print(f"{row['title']:>16}  {value(row['noisy']):>11}  {value(row['denoised']):>11}  {ratio:>7}   {goal}")


def main():
    demo = Demo(*sys.argv[1:])
    demo.render("noisy", "render", FRAMES, SPP, 0, "--aovs", "albedo,normal,depth,motion,variance,half_a,half_b")
    profile = demo.run("denoise", f"{len(FRAMES)} frames, preset final", "denoise", "--preset", "final", demo.pattern("noisy"), "-o",
                       demo.pattern("denoised"), "--diagnostics", "--profile")
    spp = demo.reference_spp()
    for half, seed in (("a", 1), ("b", 2)):
        demo.render(f"reference_{half}", f"reference {half}", MEASURED, spp, seed)

    started = time.monotonic()
    noisy, denoised = demo.compare("noisy"), demo.compare("denoised")
    rows = figure_rows(noisy, denoised)
    pictures = make_pictures(demo.path, demo.out, FRAMES, MEASURED)
    demo.add_stage("figures and pictures", f"{len(MEASURED)} frames measured", time.monotonic() - started)
    write_page(demo.out / "index.html", "demo", CONTENT, {
        "rows": rows,
        "frames": [{"noisy": a, "denoised": b} for a, b in zip(noisy["frames"], denoised["frames"])],
        "stages": demo.stages,
        "passes": passes_of(profile),
        "pictures": pictures,
        "first": FRAMES[0],
        "last": FRAMES[-1],
        "measured": list(MEASURED),
        "spp": SPP,
        "reference_spp": spp,
        "size": [WIDTH, HEIGHT],
        "cores": os.cpu_count(),
    })
    print_table(rows)
    print(f"\nframes {MEASURED[0]}-{MEASURED[-1]} against two references of {spp} spp each; "
          f"{time.monotonic() - demo.started:.0f} s after the build")
    print(f"{demo.out / 'index.html'}")


if __name__ == "__main__":
    main()
