"""The crops that scripts/train/ makes itself: rare ones, things before other backgrounds, patterns, noise of the albedo, noise that
neighbours share."""

import unittest
import unittest.mock

import numpy as np
import torch

import albedo_noise
import backgrounds
import batches
import losses
import patterns
import rare_crops
import shared_noise
import shots
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

    def test_noise_of_both_is_told_as_their_mix_has_it(self):
        size, variance = 300, 0.04
        for samples, share, noise in ((2, 0.5, 0.0), (16, 0.25, 0.0), (16, 0.5, 0.1), (16, 0.9, 0.1)):
            background = backgrounds.Background(np.full((3, size, size), 2.0), noise, np.full((size, size), share), np.ones((3, size, size)), samples)
            colors = np.tile(1 + np.sqrt(variance) * self.rng.normal(size=(3, size, size)), (2, 1, 1))
            mixed, told, _, _ = backgrounds.put_behind(self.rng, background, colors, np.full((1, size, size), variance), np.ones((14, size, size)),
                                                       np.ones((2, 3, size, size)))
            self.assertAlmostEqual(told.mean() / mixed[:3].var(), 1.0, delta=0.03)


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


class SharedNoise(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(1)

    def pair(self, name="becalm-000000/004.0001"):
        noise = lambda channels: self.rng.random((channels, SIZE, SIZE)).astype(np.float16)
        return shots.Pair(name, noise(3), [np.full((1, SIZE, SIZE), 0.5, np.float16)], [noise(7), noise(7)], [noise(3), noise(3)])

    def test_kernels_keep_the_brightness_and_spread_most_to_the_next_pixel(self):
        for _ in range(100):
            kernel = shared_noise.random_kernel(self.rng)
            self.assertAlmostEqual(kernel.sum(), 1.0, delta=1e-6)
            np.testing.assert_array_equal(kernel, kernel[::-1])
            self.assertTrue(kernel[2] > kernel[1] > abs(kernel[0]), kernel)

    def test_a_variance_is_that_of_the_convolved_radiance(self):
        kernel = shared_noise.random_kernel(self.rng)
        sides = np.where(np.arange(64) < 32, 1.0, 4.0) * np.ones((64, 1))
        noise = sides * self.rng.normal(size=(3000, 64, 64))
        layers = shared_noise.convolved_layers({"color": noise, "variance": sides[None] ** 2, "depth": noise}, kernel)
        np.testing.assert_allclose(layers["color"].var(0)[4:60, 4:60], layers["variance"][0][4:60, 4:60], rtol=0.2)
        self.assertAlmostEqual(layers["color"].var(0)[4:60, 4:60].mean() / layers["variance"][0][4:60, 4:60].mean(), 1.0, delta=0.02)
        np.testing.assert_array_equal(layers["depth"], noise)

    def test_an_even_image_stays_up_to_its_border(self):
        even = np.full((3, SIZE, SIZE), 2.0, np.float32)
        np.testing.assert_allclose(shared_noise.convolved(even, shared_noise.random_kernel(self.rng)), even, rtol=1e-6)

    def test_a_pair_is_convolved_as_a_whole(self):
        pair = self.pair()
        kernel = np.float32([0.0, 0.25, 0.5, 0.25, 0.0])
        shared = shared_noise.convolved_pair(pair, kernel)
        exposure = shots.exposure_of(shared_noise.convolved(np.float32(pair.color), kernel))
        both = [(exposure, pair.color, shared.color)] + [(exposure, a, b) for a, b in zip(pair.references, shared.references)]
        both += [(1, a[:6], b[:6]) for a, b in zip(pair.features, shared.features)]
        for gain, before, after in both:
            np.testing.assert_allclose(after, gain * shared_noise.convolved(np.float32(before), kernel), atol=2e-3)
        self.assertAlmostEqual(shots.exposure_of(shared.color), 1.0, delta=1e-3)
        for before, after in zip(pair.features, shared.features):
            np.testing.assert_array_equal(after[6], before[6])
        np.testing.assert_allclose(shared.variances[0], exposure * 0.5 * 0.375, rtol=2e-3)

    def test_a_crop_is_convolved_as_a_whole(self):
        kernel = np.float32([0.0, 0.25, 0.5, 0.25, 0.0])
        crop = [self.rng.random((channels, SIZE, SIZE)).astype(np.float32) for channels in (6, 1, 14)]
        crop.append(self.rng.random((2, 3, SIZE, SIZE)).astype(np.float32))
        colors, variance, features, references = shared_noise.convolved_crop(crop, kernel)
        np.testing.assert_allclose(colors, shared_noise.convolved(crop[0], kernel))
        np.testing.assert_allclose(variance, shared_noise.convolved(crop[1], kernel**2))
        np.testing.assert_allclose(references[1], shared_noise.convolved(crop[3][1], kernel))
        for first in (0, 7):
            np.testing.assert_allclose(features[first : first + 6], shared_noise.convolved(crop[2][first : first + 6], kernel))
            np.testing.assert_array_equal(features[first + 6], crop[2][first + 6])
        crop[1][:] = -1.0
        np.testing.assert_array_equal(shared_noise.convolved_crop(crop, kernel)[1], crop[1])  # unknown stays unknown

    def test_some_made_crops_are_convolved_if_asked_for(self):
        pair = self.pair()
        with unittest.mock.patch.object(shared_noise, "convolved_crop", wraps=shared_noise.convolved_crop) as convolved_crop:
            for shared in (False, True):
                for _ in range(40):
                    crop = batches.made_crop(self.rng, pair, 16, shared)
                    self.assertEqual([a.shape[0] for a in crop], [6, 1, 14, 2])
                self.assertEqual(convolved_crop.call_count > 0, shared)
            self.assertLess(convolved_crop.call_count, 40)

    def test_a_share_of_the_pairs_is_convolved_always_the_same_ones(self):
        pairs = [self.pair(f"becalm-{i:06d}/004.0001") for i in range(200)]
        first, second = shared_noise.some_convolved(pairs), shared_noise.some_convolved(pairs)
        self.assertAlmostEqual(len(first) / len(pairs), shared_noise.SHARE, delta=0.1)
        for a, b in zip(first, second, strict=True):
            np.testing.assert_array_equal(a.color, b.color)
        pairs[0].own = pairs[0].color
        with unittest.mock.patch.object(shared_noise, "SHARE", 1.0):
            self.assertEqual([p.name for p in shared_noise.some_convolved(pairs[:2])], ["becalm-000001/shared_004.0001"])

if __name__ == "__main__":
    unittest.main()
