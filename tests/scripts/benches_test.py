"""What `scripts/bench antialias` does itself, with stand-ins for the program."""

import tempfile
import unittest
from pathlib import Path

from benches.antialias.upsample import per_frame


def executable(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Upsampling(InFolder):
    def test_the_frames_that_stay_are_those_of_the_whole_run(self):
        becalm = executable(self.folder / "becalm", f'echo "$@" >{self.folder}/f.0001.exr')
        per_frame([becalm, "antialias"], 16, "--context", "none")
        self.assertEqual((self.folder / "f.0001.exr").read_text(), "antialias --frames 1-16 --overwrite --quiet\n")


if __name__ == "__main__":
    unittest.main()
