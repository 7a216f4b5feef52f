#!/usr/bin/env python3
"""Plants bugs, builds once, and runs the suites of this folder with one bug at a time: a table of the cases that
catch it. Takes a build of the tracer, so it is not part of scripts/test.

  tests/regression/mutations.py [--in-place] [--parallel N] [NAME...]

Works on a copy of the sources in build/mutations, which is kept for the next run; --in-place plants the bugs in
this checkout and build/release instead, and puts the sources back.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Name: file, where in it (found once; {} stands for the expression), the expression, and the wrong one.
MUTATIONS = {
    "diffuse evaluation without its cosine": (
        "tracer/materials/diffuse.inl", "return {{}, cos_pi};", "bsdf.reflectance * cos_pi",
        "bsdf.reflectance * std::numbers::inv_pi_v<float>"),
    "diffuse pdf twice too large": (
        "tracer/materials/diffuse.inl", ", {}};\n}\n\nstd::optional", "cos_pi", "2.0f * cos_pi"),
    "half of the reflectance in indirect light": (
        "tracer/materials/diffuse.inl", ".weight = {},", "bsdf.reflectance", "bsdf.reflectance * 0.5f"),
    "Fresnel of the wrong side of glass": (
        "tracer/materials/dielectric.inl", "return {};", "wo.z > 0.0f ? bsdf.eta : 1.0f / bsdf.eta",
        "wo.z < 0.0f ? bsdf.eta : 1.0f / bsdf.eta"),
    "rough metal without masking": (
        "tracer/materials/conductor.inl", "1.0f)) * {} +", "mirrored(o, i, m, bsdf.alpha)",
        "pdf_mirrored_normal(o, m, bsdf.alpha)"),
    "roulette without its weight": ("tracer/path_trace.cpp", "throughput_ /= {};", "survival", "1.0f"),
    "direct light without the MIS weight": (
        "tracer/path_surface.inl", "contribution *= {};",
        "mis_weight(integrator_.heuristic, light->pdf_solid_angle, bsdf.pdf_solid_angle)", "1.0f"),
    "light choice without its probability": (
        "tracer/lights/lights.cpp", "sample->pdf_solid_angle *= {};", "probability", "1.0f"),
    "spot with a linear edge": ("tracer/lights/spot_light.h", "return {};", "t * t * (3.0 - 2.0 * t)", "t"),
    "scattering backward instead of forward": (
        "tracer/path_media.inl", "sample_henyey_greenstein({}, -ray_.dir, u_phase)", "g", "-g"),
    "tent filter with the density of a box": (
        "tracer/sampling/pixel_filter.cpp", "std::copysign({}, centred)", "1.0f - std::sqrt(rest)",
        "std::abs(centred)"),
    "pixel filter one pixel to the right": (
        "tracer/render.cpp", "static_cast<float>(x) + {} + offset.x", "0.5f", "1.5f"),
    "shutter that closes too early": (
        "tracer/path.h", "time_ = {};", "sampler.next_1d()", "0.5f * sampler.next_1d()"),
    "motion vectors of the opposite sign": (
        "tracer/path_trace.cpp", "{}", "V2f(*previous - *current)", "V2f(*current - *previous)"),
    "half of the albedo layer": (
        "tracer/materials/diffuse.inl", "albedo_model(const DiffuseBsdf& bsdf) {\n  return {};", "bsdf.reflectance",
        "bsdf.reflectance * 0.5f"),
    "NaN in one pixel": (
        "tracer/film.cpp", "Imath::Vec4<double>({}, sums_.mean.y", "sums_.mean.x",
        "x == 20 && y == 20 ? std::numeric_limits<double>::quiet_NaN() : sums_.mean.x"),
    "antialiasing that weighs new samples alike": (
        "filter/antialias/antialias_chain.cpp", ".specialize(\"rule\", {})", "static_cast<int>(settings.accumulate)",
        "static_cast<int>(Accumulate::exponential)"),
    "samples at the opposite side of their pixels": (
        "filter/antialias/sample_grid.cpp", "const Imath::V2f position = {};", "jitter->positions_px.front()",
        "-jitter->positions_px.front()"),
    "burst whose reference counts as free of noise": (
        "filter/burst/burst_merger.cpp", "{},\n            static_cast<float>(noise.a)",
        "static_cast<float>(reference_noise.b)", "0.0f"),
    "energy of the red channel in all channels": (
        "filter/smooth/energy.cpp", "block.frame[c] += exposure * {};", "beauty[4 * i + c]", "beauty[4 * i]"),
}

SWITCH = "BECALM_PLANTED_BUG"
# Before the first line of each file with a planted bug.
HEAD = f"""#ifndef BECALM_PLANTED
#define BECALM_PLANTED
#include <cstdlib>
inline bool planted(int bug) {{
  static const int chosen = [] {{
    const char* text = std::getenv("{SWITCH}");
    return text != nullptr ? std::atoi(text) : -1;
  }}();
  return chosen == bug;
}}
#endif
"""


def planted(source):
    """The texts of the files with all bugs, each behind a switch, so that one build serves all; and their texts before."""
    originals, texts = {}, {}
    for number, (name, (file, where, right, wrong)) in enumerate(MUTATIONS.items()):
        path = source / file
        if path not in texts:
            originals[path] = texts[path] = path.read_text(encoding="utf-8")
        text = texts[path]
        place = where.replace("{}", right)
        if text.count(place) != 1:
            sys.exit(f"{name}: {file}: expected once, found {text.count(place)} times: {place}")
        both = where.replace("{}", f"(planted({number}) ? ({wrong}) : ({right}))")
        head = "" if text.startswith(HEAD) else HEAD
        texts[path] = head + text.replace(place, both)
    return texts, originals


def write(texts):
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")


def run(command, log, **environment):
    return subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=False,
                          env={**os.environ, **environment}).returncode


def judged(source, log, bug):
    """The cases that did not pass, and how many there are."""
    results = source / f"build/release/planted_{bug}.json"
    results.unlink(missing_ok=True)
    run([source / "build/release/becalm", "test", ROOT / "tests/regression", "--jobs", "2", "--json", results], log,
        **{SWITCH: str(bug)})
    cases = json.loads(results.read_text())["cases"]
    return [case["name"] for case in cases if case["outcome"] != "passed"], len(cases)


def copy_of_sources():
    """Files that did not change keep their time, so that the next build is incremental."""
    copy = ROOT / "build/mutations"
    names = subprocess.run(["git", "-C", ROOT, "ls-files"], capture_output=True, text=True, check=True).stdout
    for name in names.splitlines():
        source, target = ROOT / name, copy / name
        if not source.is_file() or target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)
    subprocess.run(["cmake", "-S", copy, "-B", copy / "build/release", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DBECALM_TESTS=OFF"], stdout=subprocess.DEVNULL, check=True)
    return copy


def table(source, names, side_by_side, log):
    clean, total = judged(source, log, -1)
    if clean:
        sys.exit(f"without a bug these do not pass: {', '.join(clean)}")
    print(f"| planted bug | caught by, of {total} | such as |\n| --- | --- | --- |", flush=True)
    missed = 0
    chosen = [(number, name) for number, name in enumerate(MUTATIONS) if name in names]
    with concurrent.futures.ThreadPoolExecutor(side_by_side) as pool:
        for (_, name), (caught, _) in zip(chosen, pool.map(lambda bug: judged(source, log, bug[0]), chosen)):
            missed += not caught
            print(f"| {name} | {len(caught)} | {', '.join(caught[:3]) or 'MISSED'} |", flush=True)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--in-place", action="store_true")
    parser.add_argument("--parallel", type=int, default=1, metavar="N", help="bugs that are judged side by side")
    parser.add_argument("names", nargs="*", help=f"some of: {'; '.join(MUTATIONS)}")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in MUTATIONS]
    if unknown:
        parser.error(f"no planted bug '{unknown[0]}'")
    source = ROOT if arguments.in_place else copy_of_sources()
    texts, originals = planted(source)
    try:
        write(texts)
        with open(source / "build/mutations.log", "w", encoding="utf-8") as log:
            if run(["cmake", "--build", source / "build/release", "--target", "becalm"], log) != 0:
                sys.exit(f"the build failed: see {log.name}")
            missed = table(source, arguments.names or MUTATIONS, arguments.parallel, log)
    finally:
        write(originals)
    if missed:
        sys.exit(f"{missed} planted bugs were not caught")


if __name__ == "__main__":
    main()
