"""What `scripts/bench quality` computes itself, on data with known results."""

import contextlib
import json
import os
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.frame_errors import rel_mse, temporal_error
from benches.geometric_mean import geometric_mean
from benches.made_of import content_hash, keep_if_same
from benches.quality import reference_noise
from benches.quality.cells import Cells, files_of, radiance
from benches.quality.data import Data, MissingFrames, Renderer, frame_path
from benches.quality.goals import seam_ratio
from benches.quality.run import arguments, find_data
from benches.quality.shots import Shots
from benches.quality.still import over_ideal, relative_error, still_pixels
from benches.quality.tables import Results, scene_table
from benches.quality.variants import NOISY, VARIANTS, Program, Variant, oidn
from whole_file import write_whole

BECALM = os.environ["BECALM"]
SHAPE = (60, 80)
MOVING = np.s_[:, 60:]          # these pixels have motion vectors
SHADED = np.s_[0:20, 0:20]      # no motion vectors, but the light changes from frame to frame
FRAMES = range(1, 17)
MEASURED = range(7, 11)
SIGMA = 0.1


def write_float(path, image):
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width, channels = image.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, "float"))
    buffer.set_pixels(oiio.ROI(), np.ascontiguousarray(image, np.float32))
    buffer.write(str(path))


def noisy(random, truth, sigma=SIGMA):
    return truth + sigma * random.standard_normal(truth.shape)


class FrameErrors(unittest.TestCase):
    """As tests/frame/metrics_test.cpp has them."""

    def test_are_relative_to_the_references(self):
        frames = lambda *values: [np.full((1, 1, 3), value) for value in values]
        self.assertAlmostEqual(rel_mse(frames(1.0), frames(1.0), frames(3.0)), 4.0 / 1.01)
        self.assertAlmostEqual(rel_mse(frames(1.0), frames(2.0), frames(3.0)), 2.0 / 2.26)
        self.assertAlmostEqual(temporal_error(frames(1.0, 2.0), frames(1.0, 2.0), frames(1.0, 4.0)), 4.0 / 2.51)

    def test_the_noise_of_two_references_is_no_error(self):
        random = np.random.default_rng(2)
        truth = [np.full((200, 200, 3), 1.0)] * 2
        sigma = 0.02
        a, b = ([noisy(random, frame, sigma) for frame in truth] for _ in "ab")
        for error, of_noise in ((rel_mse, 1.0), (temporal_error, 2.0)):
            self.assertAlmostEqual(error(a, b, truth), 0.0, delta=2e-5)
            self.assertAlmostEqual(error(a, a, truth), of_noise * sigma**2, delta=2e-5)


class ReferenceNoise(unittest.TestCase):
    def test_adds_to_errors_what_is_told(self):
        random = np.random.default_rng(4)
        variance = 0.04
        a, b = (1 + np.sqrt(variance) * random.normal(size=(2, 2, 1000, 1000)) for _ in "ab")
        self.assertAlmostEqual(reference_noise.relative_variance(a, b) / variance, 1, delta=0.1)
        self.assertAlmostEqual(rel_mse(a, b, np.ones_like(a)) / (1.5 * variance**2), 1, delta=0.4)
        self.assertAlmostEqual(temporal_error(a, b, np.ones_like(a)) / (-0.5 * variance**2), 1, delta=0.4)

    def test_the_note_leaves_out_scenes_that_are_not_resolved(self):
        random = np.random.default_rng(5)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "cells").mkdir()
            for scene, sigma, final in (("clean", 0.05, 0.25), ("rare", 0.6, 0.001)):
                for name in "ab":
                    write_float(Path(folder) / scene / name / "f.0007.exr", 1 + sigma * random.normal(size=(32, 32, 3)))
                for variant, error in (("noisy", 1.0), ("final", final)):
                    cell = {"scene": scene, "variant": variant, "recipe": {"measured": [7]}, "mean": {"relmse": error, "temporal": error / 2}}
                    (Path(folder) / "cells" / f"{scene}.8.{variant}.json").write_text(json.dumps(cell))
            text = reference_noise.note(folder, folder, ["final"]).replace("\n", " ")
        self.assertIn("`clean` 0.0025", text)
        self.assertIn("Of `rare` that is more than a tenth of an error below; without, the geometric means are `final` 1/4 and 1/4.", text)


class KeptFrames(unittest.TestCase):
    def test_stay_for_as_long_as_they_would_be_made_the_same(self):
        with tempfile.TemporaryDirectory() as name:
            program, frame = Path(name) / "program", Path(name) / "frames/f.0001.exr"
            for text, recipe, stays in (("old", {"spp": 1}, False), ("old", {"spp": 1}, True), ("old", {"spp": 2}, False), ("new", {"spp": 2}, False)):
                program.write_text(text)
                keep_if_same(frame.parent, program, **recipe)
                self.assertEqual(frame.exists(), stays)
                frame.touch()


class WholeFiles(unittest.TestCase):
    def test_what_was_there_stays_until_all_is_written(self):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "a.json"
            write_whole(path, "before")
            self.assertRaises(UnicodeEncodeError, write_whole, path, "\udcff")
            self.assertEqual((path.read_text(), [found.name for found in path.parent.iterdir()]), ("before", ["a.json"]))


class StillPixels(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(1)
        self.truth = {frame: np.full((*SHAPE, 3), 0.5) for frame in FRAMES}
        for frame in FRAMES:
            self.truth[frame][SHADED] *= 1.0 - 0.03 * frame
        motion = np.zeros((*SHAPE, 2))
        motion[MOVING] = (0.5, 0.0)
        self.noisy = {frame: noisy(random, self.truth[frame]) for frame in FRAMES}
        self.layers = [{"beauty": self.noisy[frame], "motion": motion, "object_id": np.ones((*SHAPE, 1)),
                        "variance": np.full((*SHAPE, 3), SIGMA**2)} for frame in FRAMES]
        self.references = {frame: [noisy(random, self.truth[frame], 0.02) for _ in "ab"] for frame in MEASURED}
        self.still = still_pixels(self.layers, [np.mean(pair, axis=0) for pair in self.references.values()])

    def test_motion_and_changes_of_light_are_not_still(self):
        self.assertFalse(self.still[:, 58:].any())  # the margin too
        self.assertFalse(self.still[0:18, 0:18].any())
        self.assertGreater(self.still[30:, :50].mean(), 0.99)

    def test_another_object_is_not_still(self):
        self.layers[3]["object_id"] = np.where(np.arange(SHAPE[1]) == 40, 2, 1)[None, :, None] * np.ones((*SHAPE, 1))
        still = still_pixels(self.layers, [np.mean(pair, axis=0) for pair in self.references.values()])
        self.assertFalse(still[:, 38:43].any())
        self.assertTrue(still[30:, 37].all())

    def test_plain_means_are_ideal(self):
        for history in ("before", "all"):
            means = {frame: np.mean([self.noisy[g] for g in FRAMES if history == "all" or g <= frame], axis=0) for frame in MEASURED}
            self.assertAlmostEqual(over_ideal(means, self.noisy, self.references, self.still, history), 1.0, delta=0.1)

    def test_noisy_frames_are_as_many_times_worse_as_there_are(self):
        frames = {frame: self.noisy[frame] for frame in MEASURED}
        self.assertAlmostEqual(over_ideal(frames, self.noisy, self.references, self.still, "all"), len(FRAMES), delta=0.8)

    def test_too_little_is_not_judged(self):
        self.assertIsNone(over_ideal(self.noisy, self.noisy, self.references, np.zeros(SHAPE, bool), "all"))


class RelativeError(unittest.TestCase):
    def test_its_mean_is_what_becalm_compares(self):
        random = np.random.default_rng(2)
        images = {name: random.random((24, 32, 3), np.float32) for name in ("a", "b", "test")}
        with tempfile.TemporaryDirectory() as folder:
            for name, pixels in images.items():
                image = oiio.ImageBuf(oiio.ImageSpec(32, 24, 3, "float"))
                image.set_pixels(oiio.ROI(0, 32, 0, 24, 0, 1, 0, 3), pixels)
                self.assertTrue(image.write(f"{folder}/{name}.exr"))
            subprocess.run([BECALM, "compare", f"{folder}/a.exr", f"{folder}/test.exr", "--reference-b", f"{folder}/b.exr", "--json",
                            f"{folder}/figures.json"], check=True, stdout=subprocess.DEVNULL)
            compared = json.loads(Path(folder, "figures.json").read_text())["mean"]["relmse"]
        self.assertAlmostEqual(relative_error(images["test"], images["a"], images["b"]).mean(), compared, places=5)


class Seams(unittest.TestCase):
    def test_pairs_are_compared_with_themselves(self):
        def figures(seam):
            """Frame 10 is hard whether there is a seam or not."""
            errors = {7: None, 8: 1.0, 9: 1.0, 10: 5.0}
            return [{"frame": f, "temporal": e and e * (1.2 if f == seam else 1.0)} for f, e in errors.items()]

        self.assertAlmostEqual(seam_ratio([(8, figures(8)), (5, figures(10))]), 1.2)
        self.assertAlmostEqual(seam_ratio([(8, figures(None)), (5, figures(None))]), 1.0)
        self.assertIsNone(seam_ratio([(8, figures(8))]))


def write_exr(path, values, channels=("R", "G", "B")):
    """Writes 4x3 pixels with one value for each channel."""
    path.parent.mkdir(parents=True, exist_ok=True)
    spec = oiio.ImageSpec(4, 3, len(channels), "half")
    spec.channelnames = channels
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.ROI(0, 4, 0, 3, 0, 1, 0, len(channels)), np.full((3, 4, len(channels)), values, np.float32))
    assert image.write(str(path)), image.geterror()


class RenderedFrames(unittest.TestCase):
    def test_those_of_another_tracer_are_rendered_anew_those_of_another_filter_stay(self):
        with tempfile.TemporaryDirectory() as name:
            folder, becalm = Path(name), Path(name) / "becalm"
            for value in (1, 2):
                write_exr(folder / f"{value}.exr", value)
            for build, tracer in enumerate((1, 1, 2)):
                becalm.write_text(f"""#!/bin/sh
                    # build {build}
                    file=$(echo "$4" | sed s/####/0008/)
                    [ -e "$file" ] || cp {folder}/{tracer}.exr "$file"
                """)
                becalm.chmod(0o755)
                with contextlib.redirect_stdout(None):
                    frame = frame_path(Data(folder / "data", [8], [8], [1], Renderer(becalm, "4x3")).noisy("spheres", 1), 8)
                rendered = rendered if build else frame.stat().st_mtime_ns
                self.assertEqual(frame.stat().st_mtime_ns == rendered, tracer == 1)
                self.assertEqual(frame.read_bytes(), (folder / f"{tracer}.exr").read_bytes())


class ShotsOfOthers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for shot in ("garden", "cellar"):
            self.write(self.folder / shot, "f.{:04d}.exr")

    def write(self, shot, name):
        for frame in range(4, 9):
            write_exr(shot / "n8" / name.format(frame), 0.5)
        for reference in "ab":
            for frame in (6, 7):
                write_exr(shot / reference / name.format(frame), 0.5)

    def test_a_folder_of_shots_says_what_it_has(self):
        shots = Shots(self.folder)
        self.assertEqual(list(shots.roots), ["cellar", "garden"])
        self.assertEqual((shots.frames, shots.measured, shots.spps), ([4, 5, 6, 7, 8], [6, 7], [8]))
        self.assertEqual(shots.noisy("garden", 8), self.folder / "garden/n8/f.####.exr")

    def test_a_single_shot_may_have_other_names(self):
        self.write(self.folder / "mine", "shot_010.beauty.{}.exr")
        shots = Shots(self.folder / "mine")
        self.assertEqual(list(shots.roots), ["mine"])
        first, second = shots.references("mine", None)
        self.assertTrue(frame_path(first, 7).exists() and frame_path(second, 7).exists())

    def test_an_unfinished_shot_is_missing_not_shorter(self):
        (self.folder / "garden/b/f.0007.exr").unlink()
        shots = Shots(self.folder)
        self.assertEqual(len(shots.references("cellar", None)), 2)
        with self.assertRaisesRegex(MissingFrames, "garden/b/f.0007.exr"):
            shots.references("garden", None)

    def test_all_variants_are_measured_where_no_shot_has_4_samples(self):
        with unittest.mock.patch("sys.argv", ["quality", "--shots", str(self.folder), "--oidn", "weights"]):
            asked = arguments()
        find_data(asked)
        self.assertEqual(asked.ablation_spp, [8])

    def measured(self, command, resume=False):
        """The garden's cell by another denoiser."""
        shots = Shots(self.folder)
        cells = Cells(Program(BECALM), shots, self.folder / "out", None, resume)
        return cells.measure("garden", 8, Variant("other", "other", command=command), False)

    def test_another_denoiser_is_measured_on_what_it_writes(self):
        brighter = 'for file in "$(dirname "$1")"/*.exr; do oiiotool "$file" --mulc 1.1 -o "$(dirname "$2")/$(basename "$file")"; done; echo "$3" >&2'
        cell = self.measured(("sh", "-c", brighter, "-", "{noisy}", "{denoised}", "{frames}"))
        self.assertAlmostEqual(cell["mean"]["energy"], 0.1, delta=1e-3)
        self.assertEqual(cell["times"].keys(), {"process", "processor"})

    def test_kept_figures_of_another_denoiser_are_those_of_its_files(self):
        script, calls = self.folder / "denoise.sh", self.folder / "calls"
        command = ("sh", str(script), "{noisy}", "{denoised}")
        for factor, expected in ((1.1, 1), (1.1, 1), (1.2, 2)):
            script.write_text(f'for file in "$(dirname "$1")"/*.exr; do oiiotool "$file" --mulc {factor} -o "$(dirname "$2")/$(basename "$file")"; done\necho x >>{calls}\n')
            self.assertAlmostEqual(self.measured(command, resume=True)["mean"]["energy"], factor - 1, delta=1e-3)
            self.assertEqual(calls.read_text().count("x"), expected)

    def test_figures_that_other_code_measured_are_measured_anew(self):
        calls = self.folder / "calls"
        command = ("sh", "-c", f'cp "$(dirname "$1")"/*.exr "$(dirname "$2")"; echo x >>{calls}', "-", "{noisy}", "{denoised}")
        for changed, expected in (("", 1), ("", 1), ("still.py", 2), ("cells.py", 3)):
            hashed = lambda path: content_hash(path) + (Path(path).name == changed) * "changed"
            with unittest.mock.patch("benches.quality.cells.content_hash", hashed):
                self.measured(command, resume=True)
            self.assertEqual(calls.read_text().count("x"), expected)

    def test_the_evaluation_of_open_image_denoise_is_one_of_its_files(self):
        for variant in oidn("weights"):
            self.assertIn("oidn.py", [Path(path).name for path in files_of(variant)])

    def test_another_denoiser_that_fails_is_no_cell(self):
        with self.assertRaises(subprocess.CalledProcessError):
            self.measured(("sh", "-c", "exit 3 # {denoised}"))
        self.assertFalse((self.folder / "out/cells/garden.8.other.json").exists())

    def test_a_folder_without_shots_is_refused(self):
        with self.assertRaisesRegex(OSError, "no folder n8"):
            Shots(self.folder / "garden/n8")

    def test_radiance_is_the_combined_layer(self):
        channels = tuple(f"ViewLayer.{name}" for name in ("Combined.B", "Combined.G", "Combined.R", "Denoising Albedo.R"))
        write_exr(self.folder / "layers.exr", (3, 2, 1, 9), channels)
        self.assertEqual(radiance(self.folder / "layers.exr")[0, 0].tolist(), [1, 2, 3])


class GeometricMean(unittest.TestCase):
    def test_it_is_over_the_scenes(self):
        results = Results([NOISY, VARIANTS[1]], {})
        for scene, share in (("one", 0.5), ("two", 0.02)):
            for variant, figure in ((NOISY, 3.0), (VARIANTS[1], 3.0 * share)):
                results.add({"scene": scene, "spp": 8, "variant": variant.name, "mean": {"relmse": figure}})
        self.assertTrue(scene_table(results, 8, "relmse").splitlines()[3].endswith("1/10 |"))

    def test_without_positive_shares_there_is_none(self):
        self.assertIsNone(geometric_mean([]))
        self.assertIsNone(geometric_mean([0.5, -0.1]))
        self.assertIsNone(geometric_mean([0.5, None]))


class Variants(unittest.TestCase):
    def test_names_are_unique(self):
        names = [variant.name for variant in VARIANTS]
        self.assertEqual(len(names), len(set(names)))

    def test_what_the_program_does_not_know_is_refused_with_its_words(self):
        program = Program(BECALM)
        unknown = Variant("unknown", "unknown", ("--set", "nonsense=1"))
        self.assertIn("nonsense", program.refusal(unknown))
        known = Variant("known", "known", ("--set", "patch_radius=2"))
        self.assertEqual(program.refusal(known), "")
        self.assertEqual(program.refusal(VARIANTS[0]), "")


if __name__ == "__main__":
    unittest.main()
