"""The networks that scripts/train/ trains, their export, and the loss that they learn from."""

import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import torch

import export
import losses
from network import CHANNELS, Network, parameter_count

SIZE = 32


class Networks(unittest.TestCase):
    def setUp(self):
        torch.manual_seed(1)
        self.network = Network(CHANNELS["small"])
        for head in self.network.window:
            torch.nn.init.normal_(head.weight, std=0.3)
        self.colors, self.features = 2.0 * torch.rand(1, 6, SIZE, SIZE), torch.rand(1, 14, SIZE, SIZE)
        self.variance = torch.rand(1, 1, SIZE, SIZE)

    def smoothed(self, network, colors):
        with torch.no_grad():
            return losses.smoothed(network, [colors, self.variance, self.features, None])[0]

    def test_export_and_import_give_the_same_pixels(self):
        data = export.to_bytes(self.network)
        again = export.from_bytes(data)
        self.assertEqual(export.to_bytes(again), data)
        expected, found = self.smoothed(self.network, self.colors), self.smoothed(again, self.colors)
        self.assertLess(((found - expected).abs() / expected).max().item(), 2e-2)  # of weights in half floats
        self.assertEqual(len(data), 32 + 2 * parameter_count(self.network))

    def test_an_export_that_fails_leaves_the_weights_that_were_there(self):
        with tempfile.TemporaryDirectory() as folder:
            trained, out = Path(folder) / "best.pt", Path(folder) / "standard.weights"
            out.write_bytes(b"earlier weights")
            self.network.albedo.bias.data.fill_(1e6)  # beyond half floats
            torch.save({"channels": self.network.channels, "network": self.network.state_dict()}, trained)
            with mock.patch.object(sys, "argv", ["export.py", str(trained), str(out)]), self.assertRaises(ValueError):
                export.main()
            self.assertEqual(out.read_bytes(), b"earlier weights")
            self.network.albedo.bias.data.fill_(1.0)
            export.write_weights(out, export.to_bytes(self.network))
            self.assertEqual(export.read_weights(out).albedo.bias[0].item(), 1.0)

    def test_weights_are_positive_and_sum_to_one(self):
        self.features[:, :3] = self.features[:, 7:10] = 1.0  # no albedo
        found = self.smoothed(self.network, self.colors)
        self.assertGreaterEqual(found.min().item(), self.colors.min().item() - 1e-6)
        self.assertLessEqual(found.max().item(), self.colors.max().item() + 1e-6)
        even = torch.full_like(self.colors, 3.0)
        self.assertLess((self.smoothed(self.network, even) - 3.0).abs().max().item(), 1e-5)

    def test_the_error_is_learned_without_the_noise_of_references(self):
        clean = torch.ones(1, 3, 256, 256)
        noise = lambda: 0.5 * torch.randn(1, 3, 256, 256)
        result = 1.2 * clean
        references = torch.stack([clean + noise(), clean + noise()], 1)
        def likelihood(log_error):
            error = torch.full((1, 1, 256, 256), log_error)
            return losses.training_loss(result, error, references, losses.LOSS_SCALE)[0].item()
        truth = np.log((0.3 * 0.2) ** 2 / ((0.3 * 1.2) ** 2 + 0.01))
        self.assertLess(likelihood(truth), likelihood(truth + 0.5))
        self.assertLess(likelihood(truth), likelihood(truth - 0.5))

    def test_the_error_is_not_learned_from_one_reference(self):
        result, reference = torch.rand(1, 3, 8, 8), torch.rand(1, 1, 3, 8, 8)
        log_error = torch.zeros(1, 1, 8, 8, requires_grad=True)
        losses.training_loss(result, log_error, reference.expand(1, 2, 3, 8, 8), losses.LOSS_SCALE)[0].backward()
        self.assertEqual(log_error.grad.abs().max().item(), 0.0)

    def test_a_crop_counts_by_its_own_error_not_by_that_of_its_references(self):
        def pull(noise):
            """The gradient's size for a result that is 10 % too bright."""
            torch.manual_seed(2)
            result = torch.full((1, 3, 64, 64), 1.1, requires_grad=True)
            references = 1.0 + noise * torch.randn(1, 2, 3, 64, 64)
            losses.training_loss(result, torch.zeros(1, 1, 64, 64), references, losses.LOSS_SCALE)[0].backward()
            return result.grad.mean().item()
        self.assertGreater(pull(0.15), 0.7 * pull(0.001))


if __name__ == "__main__":
    unittest.main()
