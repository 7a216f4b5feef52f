#!/usr/bin/python3
"""scripts/farm/: how shots are cut, what is submitted, and what a task does, with a stand-in for Slurm."""

import os
import re
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import plan as farm

FARM = Path(farm.__file__).parent

LAYERS = "albedo,normal,depth,motion,variance"  # that the filter uses
FAKE_SBATCH = """#!/bin/sh
echo "$@" >>"$CALLS"
wc -l <"$CALLS" | tr -d ' '
"""
FAKE_BECALM = """#!/bin/sh
echo "$@" >>"$CALLS"
exit ${STATUS:-0}
"""
FAKE_SCONTROL = """#!/bin/sh
echo scontrol "$@" >>"$CALLS"
"""


class Plan(unittest.TestCase):
    def test_ranges(self):
        self.assertEqual(farm.parse_frames("1-96"), (1, 96))
        self.assertEqual(farm.parse_frames("-3--1"), (-3, -1))
        self.assertEqual(farm.parse_frames("7"), (7, 7))
        for wrong in ("", "a-b", "9-1", "1-10x2"):
            self.assertRaises(ValueError, farm.parse_frames, wrong)

    def test_chunks_meet_segments_and_cover_every_frame_once(self):
        self.assertEqual(farm.chunks(1, 96, 32), [(1, 31), (32, 63), (64, 95), (96, 96)])
        self.assertEqual(farm.chunks(-5, 3, 4), [(-5, -5), (-4, -1), (0, 3)])
        for first, last, size in ((1, 240, 32), (-40, 17, 5), (3, 3, 1)):
            frames = [f for a, b in farm.chunks(first, last, size) for f in range(a, b + 1)]
            self.assertEqual(frames, list(range(first, last + 1)))

    def test_a_chunk_reads_its_segments_and_the_warm_up(self):
        chunks = farm.chunks(1, 200, 32)
        self.assertEqual(farm.chunks_read(chunks[0], chunks), [0, 1])
        self.assertEqual(farm.chunks_read(chunks[3], chunks), [2, 3, 4])
        small = farm.chunks(0, 79, 4)
        self.assertEqual(farm.chunks_read(small[8], small), list(range(6, 18)))

    def test_segments_are_those_of_the_program_and_of_its_options(self):
        constants = (FARM.parents[1] / "app/filter_stage.cpp").read_text()
        self.assertEqual(re.findall(r"constexpr int k(?:Segment|Warmup) = (\d+);", constants), [str(farm.SEGMENT), str(farm.WARMUP)])
        presets = (FARM.parents[1] / "filter/settings.cpp").read_text()
        of_presets = re.findall(r'name == "(\w+)"\) \{([^{}]*(?:\{[^{}]*\}[^{}]*)*)\}', presets)
        self.assertEqual({name for name, text in of_presets if "Directions::forward" in text}, set(farm.FORWARD_PRESETS))
        self.assertEqual(farm.segments(["--preset", "final", "-q"]), (32, 8))
        self.assertEqual(farm.segments(["--preset=draft", "--segment", "16", "--warmup=4"]), (16, 4))
        for whole in (["--preset", "draft"], ["--set", "directions=forward"], ["--segment", "0"], ["--segment", "x"], ["--time", "2s"],
                      ["--time=2s"]):
            self.assertRaises(ValueError, farm.segments, whole)
        chunks = farm.chunks(0, 79, 16)
        self.assertEqual(farm.chunks_read(chunks[2], chunks, 16, 4), [1, 2, 3])

    def test_names(self):
        self.assertEqual(farm.frame_paths("out/a.####.exr", 7), ["out/a.0007.exr"])
        self.assertEqual(farm.frame_paths("a.####.exr", -1), ["a.-001.exr"])
        self.assertEqual(farm.frame_paths("/shows/take#2/a.##.exr", 7), ["/shows/take#2/a.07.exr"])
        self.assertEqual(farm.frame_paths("%v/a.%V.##.exr", 7), ["l/a.left.07.exr", "r/a.right.07.exr"])
        self.assertEqual(farm.folder_of("out/a.####.exr"), Path("out/farm.a"))
        self.assertEqual(farm.folder_of("/out/%V/x/a.%v.####.exr"), Path("/out/farm.a"))


class Submitted(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)
        self.calls = self.path / "calls"
        self.calls.touch()
        (self.path / "shot.json").touch()
        for name, text in (("sbatch", FAKE_SBATCH), ("becalm", FAKE_BECALM), ("scontrol", FAKE_SCONTROL)):
            program = self.path / name
            program.write_text(text)
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
        self.environment = {**os.environ, "PATH": f"{self.path}:{os.environ['PATH']}", "CALLS": str(self.calls),
                            "BECALM_FARM_WAIT_S": "0"}

    def tearDown(self):
        self.folder.cleanup()

    def run_script(self, name, *arguments, **variables):
        return subprocess.run([sys.executable, str(FARM / name), *map(str, arguments)], env={**self.environment, **variables},
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def submit(self, source, *more, output="out/a.####.exr"):
        done = self.run_script("submit", source, "-o", self.path / output, "--frames", "1-70", "--becalm",
                               self.path / "becalm", *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = self.calls.read_text().splitlines()
        self.calls.write_text("")
        return lines

    def test_a_scene_is_rendered_denoised_and_checked(self):
        render, *denoise, check = self.submit(self.path / "shot.json", "--partition", "night", "--cpus", "4")
        self.assertIn("--array=0-2", render)
        self.assertIn("--partition=night", render)
        self.assertIn("--requeue", render)
        dependencies = [next(word for word in call.split() if word.startswith("--dependency")) for call in denoise]
        self.assertEqual(dependencies, ["--dependency=afterok:1_0:1_1", "--dependency=afterok:1_0:1_1:1_2",
                                        "--dependency=afterok:1_1:1_2"])
        self.assertIn("--dependency=afterany:2:3:4", check)
        for call in (*denoise, check):
            self.assertIn("--kill-on-invalid-dep=yes", call)

    def test_values_may_begin_with_a_dash(self):
        self.submit(self.path / "shot.json", "--frames", "-3-4", "--denoise-options", "--no-stereo", "--render-options", "-q")
        self.assertEqual(self.task("render", 1)[1][-1].split()[-6:], ["--frames", "0-4", "--resume", "--aovs", LAYERS, "-q"])
        self.assertEqual(self.task("denoise", 0)[1][-1].split()[-4:], ["--frames", "-3--1", "--resume", "--no-stereo"])

    def test_layers_that_are_named_are_kept(self):
        for named in ("--aovs none --spp 8", "--spp 8 --aovs=all"):
            self.submit(self.path / "shot.json", "--render-options", named)
            self.assertTrue(self.task("render", 1)[1][-1].endswith(f"--resume {named}"))

    def test_what_is_refused_leaves_the_plan_before_it(self):
        self.submit(self.path / "shot.json")
        plan = self.path / "out/farm.a/plan.json"
        before = plan.read_text()
        without_slurm = {"PATH": str(self.path / "empty")}
        for source, variables, word in (("typo.json", {}, "no such scene"), ("shot.json", without_slurm, "no Slurm")):
            done = self.run_script("submit", self.path / source, "-o", self.path / "out/a.####.exr", "--frames", "1-9", **variables)
            self.assertEqual(done.returncode, 2)
            self.assertIn(word, done.stderr)
            self.assertEqual(plan.read_text(), before)
            self.assertTrue((self.path / "out/farm.a/jobs").exists())

    def test_frames_that_are_there_are_denoised_as_one_array(self):
        denoise, check = self.submit(self.path / "in.####.exr")
        self.assertIn("--array=0-2", denoise)
        self.assertNotIn("--dependency", denoise)
        self.assertIn("--dependency=afterany:1", check)

    def test_what_cannot_be_queued_leaves_nothing_queued(self):
        for name, text in (("sbatch", "[ $(wc -l <$CALLS) -gt 2 ] && exit 1; echo sbatch >>$CALLS; wc -l <$CALLS"), ("scancel", "echo scancel $@ >>$CALLS")):
            program = self.path / name
            program.write_text(f"#!/bin/sh\n{text}\n")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
        output = self.path / "out/a.####.exr"
        done = self.run_script("submit", self.path / "shot.json", "-o", output, "--frames", "1-70", "--becalm", self.path / "becalm")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(self.calls.read_text().splitlines()[-1], "scancel 1 2 3")
        status = self.run_script("status", output)
        self.assertEqual((status.returncode, status.stderr.count("\n")), (1, 1), status.stderr)
        for option, value in (("-o", self.path / "out/a.#.exr"), ("--denoise-options", "--preset draft"), ("--denoise-options", "--time 2s")):
            refused = self.run_script("submit", self.path / "shot.json", "-o", output, "--frames", "1-70", option, value)
            self.assertEqual(refused.returncode, 2, refused.stderr)

    def task(self, stage, number, **variables):
        done = self.run_script("task", FARM, self.path / "out/farm.a", stage, SLURM_ARRAY_TASK_ID=str(number),
                               SLURM_ARRAY_JOB_ID="9", **variables)
        return done.returncode, self.calls.read_text().splitlines()

    def test_tasks_resume_their_chunk_and_try_again_what_passes(self):
        self.submit(self.path / "shot.json", "--render-options", "--spp 8")
        status, calls = self.task("render", 1)
        noisy = self.path / "out/noisy/a.####.exr"
        self.assertEqual((status, calls),
                         (0, [f"render {self.path}/shot.json -o {noisy} --frames 32-63 --resume --aovs {LAYERS} --spp 8"]))
        self.assertEqual(self.task("denoise", 0, STATUS="4")[1][-1], "scontrol requeue 9_0")
        self.assertEqual(self.task("denoise", 0, STATUS="3")[1][-1].split()[0], "denoise")
        status = self.run_script("status", self.path / "out/a.####.exr")
        self.assertEqual(status.returncode, 1, status.stderr)
        self.assertIn("rendered 0 of 70 frames", status.stdout)
        self.assertIn("denoise.0 failed with status 3", status.stdout)
        self.assertEqual(self.task("check", 0, STATUS="3")[0], 1)
        status, calls = self.task("check", 0, STATUS="4")
        self.assertEqual((status, calls[-1]), (4, "scontrol requeue 9_0"), "trouble with the machine says nothing of a frame")
        self.assertEqual(self.task("check", 0)[0], 0)

    def test_what_cannot_be_requeued_has_failed(self):
        self.submit(self.path / "shot.json")
        (self.path / "scontrol").unlink()
        self.assertEqual(self.task("denoise", 0, STATUS="4")[0], 4)
        self.assertEqual((self.path / "out/farm.a/states/denoise.0").read_text(), "failed with status 4")

    def test_tasks_that_end_otherwise_have_failed(self):
        self.submit(self.path / "shot.json")
        status = lambda: self.run_script("status", self.path / "out/a.####.exr")
        (self.path / "becalm").unlink()
        self.assertNotEqual(self.task("denoise", 0)[0], 0)
        self.assertEqual(status().returncode, 1)
        self.assertIn("denoise.0 failed: ", status().stdout)
        (self.path / "out/farm.a/states/denoise.0").write_text("running on a node")
        for squeue, expected in (("echo becalm-denoise 0 RUNNING", 3), ("echo becalm-check 0 PENDING", 1), ("echo 'slurm_load_jobs error: Unable to contact' >&2; exit 1", 3), ("exit 0", 1),
                                 ("echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1", 1)):
            program = self.path / "squeue"
            program.write_text(f"#!/bin/sh\n{squeue}\n")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            self.assertEqual(status().returncode, expected, squeue)

    def test_tasks_that_were_cancelled_before_they_began_are_over(self):
        self.submit(self.path / "shot.json")
        for squeue, expected in (("echo becalm-check 0 PENDING", 3), ("echo 'slurm_load_jobs error: Unable to contact' >&2; exit 1", 3), ("exit 0", 1)):
            program = self.path / "squeue"
            program.write_text(f"#!/bin/sh\n{squeue}\n")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            self.assertEqual(self.run_script("status", self.path / "out/a.####.exr").returncode, expected, squeue)

    def test_partial_states_are_of_no_task(self):
        self.submit(self.path / "shot.json")
        program = self.path / "squeue"
        program.write_text("#!/bin/sh\necho becalm-check 0 PENDING\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        (self.path / "out/farm.a/states/denoise.0.4711").write_text("running on a node")
        status = self.run_script("status", self.path / "out/a.####.exr")
        self.assertEqual((status.returncode, "denoise.0" in status.stdout), (3, False), status.stdout)

    def test_each_eye_may_have_a_file(self):
        output = self.path / "out/a.%V.####.exr"
        self.submit(self.path / "shot.json", output="out/a.%V.####.exr")
        noisy = self.path / "out/noisy/a.%V.####.exr"
        self.assertEqual(self.task("denoise", 1)[1], [f"denoise {noisy} -o {output} --frames 32-63 --resume"])
        for eye in ("left", "right"):
            (self.path / f"out/a.{eye}.0003.exr").touch()
        (self.path / "out/a.left.0004.exr").touch()
        self.assertIn("denoised 1 of 70 frames", self.run_script("status", output).stdout)
        self.calls.write_text("")
        self.task("check", 0)
        self.assertIn(f"info {self.path}/out/a.right.0070.exr", self.calls.read_text().splitlines())
        refused = self.run_script("submit", self.path / "in.%V.####.exr", "-o", self.path / "b.####.exr", "--frames", "1-2")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("expected %V", refused.stderr)

    def test_usage(self):
        for wrong in (["x.json"], ["x.json", "-o", "a.exr", "--frames", "1-2"],
                      ["x.json", "-o", "a.#.exr", "--frames", "2-1"]):
            self.assertEqual(self.run_script("submit", *wrong).returncode, 2)
        self.assertEqual(self.run_script("status").returncode, 2)
        self.assertEqual(self.run_script("status", self.path / "b.#.exr").returncode, 2)


if __name__ == "__main__":
    unittest.main()
