"""Cells of the tables: each is one variant on one scene at one sample count, denoised, measured and pictured."""

import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.made_of import content_hash, sources_of
from benches.quality.data import frame_path, frame_range
from benches.quality.pictures import write_pictures, write_references
from benches.quality.still import over_ideal, still_pixels
from benches.quality.variants import NOISY
from benches.timed import timed
from pictures.files import read_layers
from whole_file import write_whole


def radiance(path):
    """The beauty's (height, width, 3), read without the file's other layers."""
    image = oiio.ImageBuf(str(path))
    names = image.spec().channelnames
    layers = ["", *(name[:-1] for name in names if name.endswith("Combined.R"))]  # R G B, or Blender's VIEW_LAYER.Combined
    layer = next((layer for layer in layers if all(layer + colour in names for colour in "RGB")), "")
    chosen = oiio.ImageBufAlgo.channels(image, tuple(layer + colour for colour in "RGB"))
    if image.has_error or chosen.has_error:
        raise OSError(f"{path}: {image.geterror() or chosen.geterror()}")
    return chosen.get_pixels(oiio.FLOAT)


def plain_name(layer):
    """The layer's name without Blender's prefixes: `albedo` of `ViewLayer.Denoising Albedo`."""
    return layer.rpartition(".")[2].lower().removeprefix("denoising ")


def copy_without(pattern, frames, layers, folder):
    """Copies the frames without some of their layers. Returns the pattern of the copies."""
    copies = folder / "f.####.exr"
    for frame in frames:
        image = oiio.ImageBuf(str(frame_path(pattern, frame)))
        kept = tuple(name for name in image.spec().channelnames if plain_name(name.rpartition(".")[0]) not in layers)
        copy = oiio.ImageBufAlgo.channels(image, kept)
        if not copy.write(str(frame_path(copies, frame))):
            raise OSError(f"{frame_path(copies, frame)}: {copy.geterror()}")
    return copies


def files_of(variant):
    """The files that the result of a command depends on besides the frames."""
    program, *words = variant.command
    return [path for path in (shutil.which(program) or "", *words, *variant.sources) if os.path.isfile(path)]


class Cells:
    """Measures cells, and keeps their figures as OUTPUT/cells/SCENE.SPP.VARIANT.json."""

    def __init__(self, program, data, output, reference_spp, resume):
        self.program, self.data, self.output, self.reference_spp, self.resume = program, data, output, reference_spp, resume
        (output / "cells").mkdir(parents=True, exist_ok=True)
        self.made_by, self.measured_by = content_hash(program.path), [*map(content_hash, sources_of(Cells.measure))]

    def measure(self, scene, spp, variant, pictured):
        """The cell's figures. Raises MissingFrames if noisy frames or references are missing."""
        noisy, references = self.data.noisy(scene, spp), self.data.references(scene, self.reference_spp)
        file = self.output / "cells" / f"{scene}.{spp}.{variant.name}.json"
        inputs = [frame_path(noisy, frame) for frame in self.data.frames] + [
            frame_path(reference, frame) for reference in references for frame in self.data.measured]
        recipe = {"program": self.made_by, "measured_by": self.measured_by, "options": self._options(variant), "without": list(variant.without),
                  "frames": list(self.data.frames), "measured": list(self.data.measured), "reference_spp": self.reference_spp,
                  "input": str(noisy), "changed": max(path.stat().st_mtime for path in inputs), "pictured": pictured}
        if self.resume and file.exists():
            kept = json.loads(file.read_text())
            if kept["recipe"] == recipe:
                return kept
        with tempfile.TemporaryDirectory(dir=self.output) as folder:
            cell = self._measure(scene, spp, variant, noisy, references, Path(folder), pictured)
        cell = {"scene": scene, "spp": spp, "variant": variant.name, "recipe": recipe} | cell
        write_whole(file, json.dumps(cell, indent=1))
        return cell

    def _measure(self, scene, spp, variant, noisy, references, folder, pictured):
        if variant is NOISY:
            test, times = noisy, {}
        else:
            denoised = folder / "denoised" / "f.####.exr"
            test, times = denoised, self._denoise(variant, noisy, denoised)
        cell = self._compare(references, test, folder / "figures.json") | {"times": times}
        images = {frame: radiance(frame_path(test, frame)) for frame in self.data.frames}
        clean = self._references(scene)
        cell["kept"] = self._energy_kept(images, noisy)
        still = self._still(scene) if variant.history else None
        if still is not None:
            measured = {frame: images[frame] for frame in self.data.measured}
            cell["still"] = float(still.mean())
            cell["over_ideal"] = over_ideal(measured, self._noisy_images(noisy), clean, still, variant.history)
        if pictured:
            pictures = self.output / "pictures" / f"{scene}.{spp}"
            write_pictures(pictures / variant.name, images, clean)
            write_references(pictures / "reference", clean)
        return cell

    def _options(self, variant):
        """What the cell depends on besides the program and its input."""
        if not variant.command:
            return self.program.options(variant)
        return [*variant.command, *map(content_hash, files_of(variant))]

    def _denoise(self, variant, noisy, denoised):
        """Writes the denoised frames. Returns seconds per frame: the median of becalm's filter, the mean of the whole process, and by all its threads."""
        given = noisy
        if variant.without:
            copies = denoised.parent.with_name("given")
            copies.mkdir()
            given = copy_without(noisy, self.data.frames, variant.without, copies)
        frames = frame_range(self.data.frames)
        if variant.command:
            denoised.parent.mkdir()
            command = [word.format(noisy=given, denoised=denoised, frames=frames) for word in variant.command]
        else:
            command = [self.program.path, "denoise", given, "-o", denoised, "--frames", frames, "--quiet", "--profile",
                       *self.program.options(variant)]
        run, cost = timed(command, check=False, stderr=subprocess.PIPE, text=True)
        if run.returncode != 0:
            sys.stderr.write(run.stderr)
        run.check_returncode()
        if not variant.timed:
            return {}
        filter_ms = re.findall(r"^  filter(?: backward)? +([\d.]+) ms$", run.stderr, re.MULTILINE)
        count = len(self.data.frames)
        times = {"process": cost.wall_s / count, "processor": cost.processor_s / count}
        return times if variant.command else times | {"filter": sum(map(float, filter_ms)) / 1e3}

    def _compare(self, references, test, file):
        first, second = references
        subprocess.run([self.program.path, "compare", first, test, "--reference-b", second, "--frames", frame_range(self.data.measured),
                        "--json", file], check=True, stdout=subprocess.DEVNULL)
        figures = json.loads(file.read_text())
        return {"frames": figures["frames"], "mean": figures["mean"]}

    def _energy_kept(self, images, noisy):
        """Relative change of the mean radiance of all frames. Both means have the same noise, which mostly cancels."""
        before = sum(image.mean(dtype=np.float64) for image in self._noisy_images(noisy).values())
        return float(sum(image.mean(dtype=np.float64) for image in images.values()) / before - 1.0)

    @functools.lru_cache(maxsize=1)  # callers measure all variants of one scene and sample count before the next
    def _noisy_images(self, noisy):
        return {frame: radiance(frame_path(noisy, frame)) for frame in self.data.frames}

    @functools.lru_cache(maxsize=1)
    def _references(self, scene):
        """The pair of reference images by measured frame."""
        patterns = self.data.references(scene, self.reference_spp)
        return {frame: [radiance(frame_path(pattern, frame)) for pattern in patterns] for frame in self.data.measured}

    @functools.lru_cache(maxsize=1)
    def _still(self, scene):
        """The mask of still pixels; None if the frames lack the layers that it is found from."""
        layers = []
        for frame in self.data.frames:
            read = read_layers(frame_path(self.data.cleanest(scene), frame))
            if not {"", "motion", "object_id", "variance"} <= read.keys():
                return None
            layers.append({"beauty": read[""][..., :3]} | {name: read[name] for name in ("motion", "object_id", "variance")})
        return still_pixels(layers, [np.mean(pair, axis=0) for pair in self._references(scene).values()])
