"""Tests of RESULTS.md's first table, of the trainings it tells of, and of the evaluation of Open Image Denoise's networks that becalm is compared with."""

import struct
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import torch

from benches import training
from benches.at_a_glance import at_a_glance
from benches.markdown_report import within_columns
from benches.quality.oidn import PerceptualRange, exposure, from_srgb, to_srgb


class AtAGlance(unittest.TestCase):
    def test_has_what_the_parts_say(self):
        parts = {"quality": "| preset draft | 8 | 0.1 | 1/9 | 0.2 | 1/11 |\n| OIDN, each frame alone | 8 | 0.1 | 1/12 | 0.3 | 1/13 |\n",
                 "scenes": "| preset draft | 10 | 0.1 | 1/8 | 0.2 | 1/30 |\n", "time": "| draft | 1.5 | 2.5 | 1400 |\n"}
        rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in at_a_glance(parts).strip().splitlines()[2:]]
        self.assertEqual(rows, [["`draft`", "1/9", "1/11", "1/8", "1/30", "1.5", "1400"],
                                ["OIDN, each frame alone", "1/12", "1/13", "-", "-", "-", "-"]])


class Trainings(unittest.TestCase):
    def test_what_was_trained_otherwise_starts_anew(self):
        with tempfile.TemporaryDirectory() as name:
            shot, out = Path(name) / "data/becalm-000000", Path(name) / "out"
            shot.mkdir(parents=True)
            (shot / "shot.json").touch()
            went_on, steps_left = [], iter([1])  # the first training is stopped

            def train(command, **_):
                went_on.append((out / "checkpoint.pt").exists())
                torch.save({"step": int(command[command.index("--steps") + 1]) - next(steps_left, 0)}, out / "checkpoint.pt")

            def trained(steps=3, options=(), radiance=1.0, changed=""):
                np.savez(shot / "pairs.npz", color=np.full(3, radiance))
                hashed = lambda path: path.name + "changed" * (path.name == changed)
                with (unittest.mock.patch.multiple(training, DATA=name + "/data", STEPS=steps, content_hash=hashed),
                      unittest.mock.patch("subprocess.run", train)):
                    return training.trained(out, list(options))["step"]

            self.assertEqual((trained(), trained(), trained(), went_on), (2, 3, 3, [False, True]))
            for other in ({"steps": 2}, {"options": ["--rate", "1"]}, {"radiance": 2.0}, {"changed": "losses.py"}):
                went_on.clear()
                self.assertEqual((trained(**other), went_on), (other.get("steps", 3), [False]), other)


class WithinColumns(unittest.TestCase):
    def test_prose_is_wrapped_and_tables_stay(self):
        row, prose = "| a |" + " b" * 60 + " |", "word " * 30 + "end"
        filled = within_columns(f"## {'title ' * 20}\n\n{prose}\n\n{row}\n\nshort\nlines")
        title, paragraph, table, short = filled.split("\n\n")
        self.assertEqual(title, f"## {'title ' * 20}")
        self.assertLessEqual(max(map(len, paragraph.split("\n"))), 100)
        self.assertEqual(paragraph.split(), prose.split())
        self.assertEqual((table, short), (row, "short\nlines"))


def write_network(path):
    """A network of OIDN's layers whose result is the three colours that it sees."""
    def pick(outputs, inputs, first):
        weight = np.zeros((outputs, inputs, 3, 3), np.float32)
        if first is not None:
            weight[range(outputs), range(first, first + outputs), 1, 1] = 1
        return weight

    layers = {f"enc_conv{level}{part}": pick(1, 9 if (level, part) == (1, "a") else 1, None) for level in range(1, 6) for part in "ab"}
    layers |= {f"dec_conv{level}{part}": pick(1, 2 if part == "a" else 1, None) for level in (4, 3, 2) for part in "ab"}
    layers |= {"dec_conv1a": pick(3, 10, 1), "dec_conv1b": pick(3, 3, 0), "dec_conv1c": pick(3, 3, 0)}
    tensors = {}
    for name, weight in layers.items():
        tensors |= {f"{name}.weight": weight.astype(np.float16), f"{name}.bias": np.zeros(weight.shape[0], np.float32)}
    body, table = b"", struct.pack("<I", len(tensors))
    header = struct.calcsize("<HBBQ")
    for name, values in tensors.items():
        layout = b"oihw" if values.ndim == 4 else b"x"
        table += struct.pack("<H", len(name)) + name.encode() + struct.pack(f"<B{values.ndim}I", values.ndim, *values.shape) + layout
        table += struct.pack("<cQ", b"h" if values.dtype == np.float16 else b"f", header + len(body))
        body += values.tobytes()
    path.write_bytes(struct.pack("<HBBQ", 0x41D7, 2, 0, header + len(body)) + body + table)


class Oidn(unittest.TestCase):
    def test_transfer_functions_have_inverses(self):
        values = np.concatenate([[0.0], np.geomspace(1e-7, 6e4, 100)])
        transfer = PerceptualRange()
        np.testing.assert_allclose(transfer.inverse(transfer.forward(values)), values, rtol=1e-5, atol=1e-9)
        self.assertAlmostEqual(float(transfer.forward(np.array(65504.0))), 1.0)
        shares = np.linspace(0, 1, 50)
        np.testing.assert_allclose(from_srgb(to_srgb(shares)), shares, atol=1e-6)

    def test_exposure_brings_the_mean_to_the_key(self):
        self.assertAlmostEqual(exposure(np.full((20, 33, 3), 0.36, np.float32)), 0.5, places=5)
        self.assertEqual(exposure(np.zeros((4, 4, 3), np.float32)), 1.0)

    def test_a_network_that_passes_colours_leaves_the_frame_as_it_is(self):
        names = ("R", "G", "B", "layer.albedo.R", "layer.albedo.G", "layer.albedo.B", "layer.normal.X", "layer.normal.Y", "layer.normal.Z")
        pixels = np.random.default_rng(1).uniform(0.01, 4.0, (21, 35, 9)).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            noisy, denoised, weights = (Path(folder) / name for name in ("n.####.exr", "d.####.exr", "w.tza"))
            spec = oiio.ImageSpec(35, 21, 9, oiio.FLOAT)
            spec.channelnames = names
            image = oiio.ImageBuf(spec)
            image.set_pixels(oiio.ROI(), pixels)
            self.assertTrue(image.write(str(noisy).replace("####", "0003")))
            write_network(weights)
            subprocess.run([sys.executable, "-m", "benches.quality.oidn", weights, noisy, denoised, "3-3"], check=True)
            result = oiio.ImageBuf(str(denoised).replace("####", "0003")).get_pixels(oiio.FLOAT)
        np.testing.assert_allclose(result, pixels[..., :3], rtol=1e-3)


if __name__ == "__main__":
    unittest.main()
