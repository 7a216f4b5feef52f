"""The crops that scripts/train/ makes itself: rare ones, things before other backgrounds, patterns, noise of the albedo."""

import unittest
import unittest.mock

import numpy as np
import torch

import albedo_noise
import backgrounds
import losses
import patterns
import rare_crops
from network import CHANNELS, Network

SIZE = 32


class RareCrops(unittest.TestCase):
    def test_textures_have_the_noise_that_is_told(self):
        rng = np.random.default_rng(1)
        for history in (1, 8):
            for _ in range(5):
                colors, variance, features, references = rare_crops.textured_crop(rng, SIZE, history)
                self.assertEqual([a.shape[0] for a in (colors, variance, features, references)], [6, 1, 14, 2])
                noise = ((colors[:3] - references[0]) ** 2).mean()
                self.assertLess(noise, 0.01)
                if variance.min() >= 0:
                    self.assertAlmostEqual(noise / variance.mean(), 1.0, delta=0.15)
                own = ((colors[3:] - references[0]) ** 2).mean()
                self.assertAlmostEqual(own / noise / history, 1.0, delta=0.2)

    def test_fireflies_are_few_and_bright(self):
        own = np.ones((3, SIZE, SIZE), np.float32)
        changed = [rare_crops.with_fireflies(np.random.default_rng(i), own) for i in range(20)]
        hit = np.stack(changed)[:, 0] != 1
        self.assertTrue(0.001 < hit.mean() < 0.006, hit.mean())
        self.assertTrue(all(image[image != 1].min(initial=10) >= 10 for image in changed))


class Backgrounds(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(3)
        self.background = backgrounds.random_background(self.rng, SIZE)
        self.background.radiance[:] = 7.0
        self.background.noise = 0.0

    def put_behind(self, history, variance=0.5):
        return backgrounds.put_behind(
            self.rng, self.background, np.ones((6, SIZE, SIZE), np.float32), np.full((1, SIZE, SIZE), variance),
            np.ones((14, SIZE, SIZE), np.float32), np.ones((2, 3, SIZE, SIZE), np.float32), history)

    def test_a_pixel_that_shows_it_alone_is_clean_and_others_keep_what_they_had(self):
        self.background.coverage[:, :16], self.background.coverage[:, 16:] = 1.0, 0.0
        colors, variance, features, references = self.put_behind(1)
        for image, behind, before in ((colors, 7.0, 1.0), (variance, 0.0, 0.5), (features[6], 2.0, 1.0), (references, 7.0, 1.0)):
            np.testing.assert_allclose(image[..., :16], behind)
            np.testing.assert_allclose(image[..., 16:], before)

    def test_edges_are_unbiased_with_the_variance_they_tell_and_less_of_it_after_merging(self):
        self.background.coverage[:] = 0.5
        self.background.samples = 8
        of_history = []
        for history in (1, 4):
            colors, variance, _, references = self.put_behind(history, variance=0.0)
            self.assertAlmostEqual(colors.mean(), 4.0, delta=0.1)
            self.assertAlmostEqual(references.mean(), 4.0, delta=0.05)
            self.assertAlmostEqual(colors[:3].var() / variance.mean(), 1.0, delta=0.2)
            of_history.append(variance.mean())
        self.assertAlmostEqual(of_history[1] / of_history[0], 0.25, delta=0.05)
        self.assertLess(self.put_behind(1, variance=-1.0)[1].max(), 0.0)  # unknown stays unknown


class Patterns(unittest.TestCase):
    def pattern(self, kind, **changed):
        made = patterns.Pattern(np.random.default_rng(1), SIZE)
        made.kind = kind
        straight = {"turn": 0.0, "stretch": (0.0, 0.0), "bend": (0.0, 0.0), "phase": (0.0, 0.0), "periods": (4.0, 4.0), "width": 0.5}
        colours = {"colours": np.eye(3, dtype=np.float32), "cells": np.random.default_rng(2).random((3, 64, 64), np.float32)}
        for name, value in {**straight, **colours, **changed}.items():
            setattr(made, name, value)
        return made

    def test_stripes_repeat_by_their_period(self):
        image = self.pattern(patterns.stripes).mean_of(np.random.default_rng(2), 64)
        np.testing.assert_array_equal(image[..., 4:], image[..., :-4])
        self.assertEqual(len(np.unique(image[0])), 2)

    def test_a_turned_stretched_or_bent_pattern_differs(self):
        straight = self.pattern(patterns.chequers).mean_of(np.random.default_rng(2), 16)
        for changed in ({"turn": 0.3}, {"stretch": (0.5, 0.0)}, {"bend": (3.0, 0.0)}):
            other = self.pattern(patterns.chequers, **changed).mean_of(np.random.default_rng(2), 16)
            self.assertGreater(np.abs(other - straight).mean(), 0.01)

    def test_the_mean_of_few_samples_is_noisy_and_unbiased(self):
        for kind in patterns.KINDS:
            made = self.pattern(kind, periods=(2.7, 3.1), turn=0.4)
            few, many = (made.mean_of(np.random.default_rng(seed), samples) for seed, samples in ((3, 2), (4, 256)))
            self.assertGreater(np.abs(few - many).mean(), 0.002, kind.__name__)
            self.assertLess(abs((few - many).mean()), 0.01, kind.__name__)


class AlbedoNoise(unittest.TestCase):
    def test_the_truth_is_its_mean(self):
        clean = np.random.default_rng(1).random((3, SIZE, SIZE))
        for make in (albedo_noise.coated, albedo_noise.blurred):
            for seed in range(3):
                noisy, truth = make(np.random.default_rng(seed), clean)
                self.assertTrue(0 <= noisy.min() and noisy.max() <= 1)
                self.assertGreater(np.abs(noisy - truth).mean(), 0.005)
                self.assertLess(abs((noisy - truth).mean()), 0.02)

    def test_some_albedos_are_patterns(self):
        rng = np.random.default_rng(1)
        even = np.full((3, SIZE, SIZE), 0.5, np.float32)
        with unittest.mock.patch.object(patterns, "random_pattern", wraps=patterns.random_pattern) as made_pattern:
            made = [albedo_noise.with_noise(rng, even) for _ in range(60)]
        self.assertTrue(5 < made_pattern.call_count < 55, made_pattern.call_count)
        self.assertTrue(all(image.dtype == np.float32 and 0 <= image.min() and image.max() <= 1 for pair in made for image in pair))

    def test_an_untrained_network_lets_an_albedo_pass(self):
        torch.manual_seed(1)
        network = Network(CHANNELS["albedo"])
        network.start_from_identity()
        albedo = torch.rand(1, 3, SIZE, SIZE)
        features = torch.ones(1, 14, SIZE, SIZE)
        with torch.no_grad():
            found = losses.smoothed(network, [torch.cat([albedo, albedo], 1), -torch.ones(1, 1, SIZE, SIZE), features, None])[0]
        self.assertLess((found - albedo).abs().mean().item(), 0.25 * (albedo - albedo.mean()).abs().mean().item())


if __name__ == "__main__":
    unittest.main()
