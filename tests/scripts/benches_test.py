"""What the benches of antialiasing, alignment, stereo and the tracer do themselves, and `bench`, `demo` and `check`, with stand-ins for the programs."""

import contextlib
import io
import os
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benches.align import speed
from benches.align.renders import Renders
from benches.align.service import AlignError
from benches.antialias import run as antialias
from benches.antialias import zone_plate
from benches.antialias.upsample import per_frame
from benches.peer import run as peer
from benches.stereo.run import Shot

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


def executable(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


def refusal(main, *arguments):
    """What a command says to arguments that it refuses."""
    said = io.StringIO()
    with unittest.mock.patch("sys.argv", ["bench", *arguments]), contextlib.redirect_stderr(said):
        try:
            main()
        except SystemExit as end:
            return said.getvalue() if end.code == 2 else None


class Commands(InFolder):
    """bench and check with stand-ins for what they call."""

    def setUp(self):
        super().setUp()
        self.scripts = self.folder / "scripts"
        shutil.copytree(SCRIPTS, self.scripts, ignore=shutil.ignore_patterns("benches", "demo_parts"))

    def ran(self, script, *arguments):
        environment = os.environ | {"PATH": f"{self.folder}:{os.environ['PATH']}"}
        return subprocess.run([self.scripts / script, *arguments], env=environment, capture_output=True, text=True)

    def said(self, script, *arguments):
        return self.ran(script, *arguments).stderr

    def test_open_image_denoise_comes_with_pytorch(self):
        executable(self.scripts / "setup", 'echo "$@" >&2; exit 9')
        for bench in ("quality", "report"):
            plain = self.said("bench", bench).split()
            for option in (("--oidn", "weights"), ("--oidn=weights",)):
                self.assertEqual(set(self.said("bench", bench, *option).split()) - set(plain), {"libopenblas0-pthread", "python3-torch"})

    def test_options_are_listed_without_a_build(self):
        executable(self.scripts / "setup", "")
        executable(self.folder / "cmake", "echo built >&2; exit 1")
        (self.scripts / "benches").symlink_to(SCRIPTS / "benches")
        for part, option in (("align_accuracy", "-h"), ("quality", "--help"), ("report", "--help"), ("tracer", "-h"), ("judge", "--help")):
            listed = self.ran("bench", part, option)
            self.assertEqual((listed.returncode, listed.stderr), (0, ""), part)
            self.assertIn(f"scripts/bench {part}", listed.stdout)
            self.assertEqual(self.said("bench", part), "built\n")

    def test_the_demo_refuses_what_it_does_not_know_before_it_installs(self):
        executable(self.scripts / "setup", "echo installed >&2; exit 9")
        for arguments in (("uses", "nonsense"), ("nonsense",), ("", "nonsense"), ("--help", "nonsense")):
            refused = self.ran("demo", *arguments)
            self.assertEqual((refused.returncode, "installed" in refused.stderr), (2, False), arguments)

    def test_check_tells_why_it_cannot_configure(self):
        executable(self.scripts / "setup", "")
        executable(self.folder / "cmake", "echo CMake Error >&2; exit 1")
        self.assertEqual(self.said("check", "a.cpp"), "CMake Error\n")


class ZonePlates(InFolder):
    def test_frames_that_cannot_be_written_are_an_error(self):
        pixels = np.zeros((2, 2), np.float32)
        self.assertRaises(OSError, zone_plate.write, self.folder / "missing/f.exr", pixels, (0, 0), (0, 0))


class Antialiasing(unittest.TestCase):
    def test_every_method_has_its_ratio_to_clamping(self):
        rows = antialias.rows_of("spheres", {"1 spp": (0.4, 0.5, 0.1), "clamping": (0.2, 0.7, 0.1)})
        self.assertEqual([row[1:4] for row in rows], [("1 spp", "0.4000", "2.00"), ("clamping", "0.2000", "1.00")])
        self.assertEqual(antialias.rows_of("spheres", {"best": (0.1, 0.9, 0.1)})[0][3], "-")

    def test_methods_that_do_not_exist_or_would_replace_the_input_are_refused(self):
        self.assertIn("no method 'nosuch'; there are 1 spp, clamping", refusal(antialias.main, "--method", "nosuch"))
        for name in ("reference", "jittered"):
            self.assertIn(f"--method {name}: ", refusal(antialias.main, "--method", f"{name}:--preset best"))


class Aligners(InFolder):
    def failed(self, script):
        """The processes that `bench align` has started with this aligner, and what it fails with."""
        started = []

        class Recorded(subprocess.Popen):
            def __init__(self, *arguments, **options):
                super().__init__(*arguments, **options)
                started.append(self)

        aligner = executable(self.folder / "bench_align", script)
        with (unittest.mock.patch("subprocess.Popen", Recorded), unittest.mock.patch.object(speed, "SIZE", (16, 9)),
              unittest.mock.patch("sys.argv", ["bench", "--bench-align", str(aligner)]), self.assertRaises(AlignError) as raised):
            speed.main()
        return started, str(raised.exception)

    def test_that_fail_are_waited_for(self):
        for refused in ("device", "build", "load"):
            answer = """while read -r line; do case "$line" in *REFUSED*) echo '{"error": "no"}' ;; *) echo '{}' ;; esac; done"""
            started, said = self.failed(answer.replace("REFUSED", refused))
            self.assertEqual(said, f"bench_align: {refused}: no")
            self.assertEqual([process.returncode for process in started], [0] * len(started))
            self.assertTrue(started)

    def test_that_end_say_how(self):
        self.assertEqual(self.failed("exit 3")[1], "bench_align ended with status 3")


class RenderedPairs(InFolder):
    def test_another_program_renders_them_again(self):
        frame = oiio.ImageBuf(oiio.ImageSpec(4, 3, 3, "half"))
        self.assertTrue(frame.write(str(self.folder / "frame.exr")))
        calls = self.folder / "calls"
        for version, expected in ((1, 1), (1, 1), (2, 2)):
            becalm = executable(self.folder / "becalm", f"""# {version}
                echo "$@" >>{calls}
                for number in 0010 0011; do cp {self.folder}/frame.exr "$(echo "$4" | sed s/####/$number/)"; done""")
            with contextlib.redirect_stdout(None):
                Renders(becalm, self.folder / "renders", "4x3").frames("spheres", 1, 0)
            self.assertEqual(len(calls.read_text().splitlines()), expected)


class Peer(unittest.TestCase):
    def test_frames_of_one_sample_which_tell_the_start_are_refused(self):
        self.assertIn("--spp: expected at least 2", refusal(peer.main, "--spp", "1"))


class Stereo(unittest.TestCase):
    def test_a_difference_of_references_below_zero_is_zero(self):
        shot = Shot.__new__(Shot)
        shot.measured, shot.halves = [1], {1: ("a", "b")}
        shot.reprojection = {1: unittest.mock.Mock(difference=lambda a, b: -1e-6)}
        self.assertEqual(shot.reference_difference(), 0)


class Upsampling(InFolder):
    def test_the_frames_that_stay_are_those_of_the_whole_run(self):
        becalm = executable(self.folder / "becalm", f'echo "$@" >{self.folder}/f.0001.exr')
        per_frame([becalm, "antialias"], 16, "--context", "none")
        self.assertEqual((self.folder / "f.0001.exr").read_text(), "antialias --frames 1-16 --overwrite --quiet\n")


if __name__ == "__main__":
    unittest.main()
