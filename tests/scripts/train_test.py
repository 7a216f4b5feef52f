"""The training of scripts/train/ on shots so small that it takes seconds."""

import json
import math
import os
import re
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import torch

import batches
import device_batches
import export
import idle_channels
import losses
import merged_shots
import network as network_module
import own_share
import shared_noise
import shots
import train
from network import CHANNELS, Network

torch.set_num_threads(1)  # other tests run beside this one, and torch's threads wait by spinning
SIZE = 32
PROJECT = Path(__file__).resolve().parents[2]


def write_exr(path, channels):
    """A file of the named channels, each (height, width)."""
    spec = oiio.ImageSpec(SIZE, SIZE, len(channels), oiio.FLOAT)
    spec.channelnames = list(channels)
    out = oiio.ImageOutput.create(path)
    out.open(path, spec)
    out.write_image(np.stack(list(channels.values()), -1).astype(np.float32))
    out.close()


def layer(name, image, suffixes="RGB"):
    prefix = f"{name}." if name else ""
    return {prefix + suffix: image[i] for i, suffix in enumerate(suffixes)}


def write_shot(folder, renderer, seed, frames=1):
    """A chequered surface under light that is brighter to the right, at 4 samples a pixel. The first frame has references."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(SIZE), np.arange(SIZE))
    albedo = np.where((x // 8 + y // 8) % 2, 0.7, 0.3)[None] * np.array([1.0, 0.8, 0.6])[:, None, None]
    clean = albedo * (0.5 + x / SIZE)
    normal = np.stack([0 * x, 0 * x, 0 * x + 1.0])
    depth = (2.0 + y / SIZE)[None]
    noisy = lambda: clean * rng.gamma(2.0, 0.5, clean.shape)
    os.makedirs(folder)
    names = [("", "albedo", "normal", "depth"), ("ViewLayer.Combined", "ViewLayer.Denoising Albedo", "ViewLayer.Denoising Normal", "ViewLayer.Denoising Depth")]
    beauty, of_albedo, of_normal, of_depth = names[renderer == "cycles"]
    features = layer(of_albedo, albedo) | layer(of_normal, normal, "XYZ") | layer(of_depth, depth, "Z")
    for frame in range(1, frames + 1):
        a, b = noisy(), noisy()
        if renderer == "cycles":
            write_exr(f"{folder}/n004_a.{frame:04d}.exr", layer(beauty, a) | features)
            write_exr(f"{folder}/n004_b.{frame:04d}.exr", layer(beauty, b) | features)
        else:
            halves = layer("half_a", a) | layer("half_b", b) | layer("variance", (clean * 0.35) ** 2)
            write_exr(f"{folder}/n004.{frame:04d}.exr", layer(beauty, 0.5 * (a + b)) | halves | features)
    for name in "ab":
        write_exr(f"{folder}/r_{name}.0001.exr", layer(beauty, clean * rng.gamma(64.0, 1 / 64.0, clean.shape)) | features)
    with open(f"{folder}/shot.json", "w") as file:
        json.dump({"renderer": renderer, "seed": seed, "frames": frames, "references": [1], "spp": [4]}, file)


def neighbours_alike(image, references):
    """The correlation of the noise of pixels that lie side by side."""
    noise = np.float32(image) / np.float32(references).mean(0) - 1
    return np.corrcoef(noise[..., 1:].ravel(), noise[..., :-1].ravel())[0, 1]


class Shots(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for renderer in ("becalm", "cycles"):
            write_shot(f"{self.folder.name}/{renderer}-000000", renderer, 1)
            write_shot(f"{self.folder.name}/{renderer}-000009", renderer, 2)
        os.makedirs(f"{self.folder.name}/cycles-000001")  # not rendered to its end

    def test_constants_are_those_of_the_program(self):
        for value, file, name in (
            (own_share.OUTLIER, "shaders/smooth/own_share.comp", "kOutlier"),
            (own_share.LARGEST_PATCH, "shaders/smooth/own_share.comp", "kLargestPatch"),
            (own_share.LARGEST_INPUT, "shaders/smooth/own_share.comp", "kLargestInput"),
            (own_share.LEAST_INPUT, "shaders/smooth/own_share.comp", "kLeastInput"),
            (own_share.LEAST_OF_PATCH, "shaders/smooth/difference.comp", "kLeastOfPatch"),
            (own_share.LARGEST_LEAST, "shaders/smooth/difference.comp", "kLargestLeast"),
            (own_share.UNSURE, "shaders/smooth/share.comp", "kUnsure"),
            (own_share.SIGNIFICANCE, "shaders/smooth/share.comp", "kSignificance"),
            (own_share.CERTAIN, "shaders/smooth/share.comp", "kCertain"),
            (own_share.FARTHEST_SURFACE, "shaders/lib/surface.glsl", "kFarthestSurface"),
            (own_share.RADIUS, "filter/smooth/own_share.cpp", "kRadius"),
            (own_share.LOST_RADIUS, "filter/smooth/detail_share.cpp", "kLostRadius"),
            (own_share.INPUTS, "filter/smooth/weights.h", "kOwnShareInputs"),
            (own_share.HIDDEN, "filter/smooth/weights.h", "kOwnShareHidden"),
            (network_module.LOSS_SCALE, "shaders/lib/network.glsl", "kErrorScale"),
            (network_module.LOSS_FLOOR, "shaders/lib/network.glsl", "kErrorFloor"),
            (network_module.LARGEST_NOISE, "shaders/lib/network.glsl", "kLargestNoise"),
            (network_module.LEAST_CONFIDENCE, "shaders/lib/network.glsl", "kLeastConfidence"),
            (network_module.INPUTS, "filter/smooth/weights.h", "kNetworkInputs"),
            (network_module.TAPS, "filter/smooth/weights.h", "kWindowTaps"),
            (network_module.COARSE_TAPS, "filter/smooth/weights.h", "kCoarseTaps"),
            (network_module.OWN_TAPS, "filter/smooth/weights.h", "kOwnTaps"),
            (network_module.AFFINITIES, "filter/smooth/weights.h", "kAffinities"),
            (shots.NOTHING_HIT, "filter/input/host_images.cpp", "kNothingHit"),
        ):
            found = re.search(rf"\b{name} = ([-+.\de]+)f?;", (PROJECT / file).read_text())
            self.assertIsNotNone(found, f"{file}: {name}")
            self.assertEqual(float(found[1]), value, f"{file}: {name}")

    def test_depth_is_packed_as_the_filter_does(self):
        depth = np.float32([[1e5, 4e5, 1e10, math.inf, 0.0, -1.0, math.nan]])[None]
        layers = {"albedo": np.ones((3, 1, 7), np.float32), "normal": np.zeros((3, 1, 7), np.float32), "depth": depth}
        packed = shots.packed_features(layers)[6, 0]
        np.testing.assert_allclose(packed, [2 / 3, 4 / 3, 2, 2, 0, 0, 0], atol=2e-3)

    def test_pairs_of_both_renderers_are_read(self):
        learn, choose = batches.load(self.folder.name)
        names = lambda shot: [f"{shot}/{name}.0001" for name in ("004", "r_a", "r_b")]
        self.assertEqual([p.name for p in learn], names("becalm-000000") + names("cycles-000000"))
        self.assertEqual([p.name for p in choose], ["becalm-000009/004.0001", "cycles-000009/004.0001"])
        self.assertEqual([len(p.variances) for p in learn], [2, 0, 0, 1, 0, 0])
        for pair in filter(lambda pair: pair.independent, learn):
            self.assertAlmostEqual(shots.exposure_of(pair.color), 1.0, delta=0.01)
            self.assertLess(losses.rel_mse(torch.from_numpy(np.float32(pair.references[0]))[None],
                                           batches.whole_frame(pair)[3]), 0.01)

    def test_some_frames_are_learned_from_with_noise_that_neighbours_share(self):
        with unittest.mock.patch.object(shared_noise, "SHARE", 1.0):
            learn, choose = batches.load(self.folder.name, shared=True)
        self.assertEqual([p.name for p in choose if p.name.startswith("becalm")], ["becalm-000009/004.0001", "becalm-000009/shared_004.0001"])
        self.assertEqual(sum(p.of_shared_noise for p in learn), len(learn) / 2)

    def test_an_albedo_stands_for_the_radiance_and_has_none_itself(self):
        frames = [p for p in batches.load(self.folder.name)[0] if p.independent]
        learn, choose = batches.load(self.folder.name, albedo=True)
        self.assertEqual([p.name for p in learn], [p.name for p in frames])
        self.assertEqual(len(choose), 2)
        for of_albedo, frame in zip(learn, frames):
            np.testing.assert_array_equal(of_albedo.color, frame.features[0][:3])
            np.testing.assert_array_equal(of_albedo.references[1], frame.features[1][:3])
            np.testing.assert_array_equal(of_albedo.features[0][3:], frame.features[0][3:])
            self.assertEqual((of_albedo.features[0][:3].min(), of_albedo.variances), (1.0, []))

    def test_some_crops_have_the_albedo_smoothed(self):
        pair = batches.load(self.folder.name)[0][0]
        network = Network(CHANNELS["small"])
        batches.smooth_albedos([pair], network)
        albedo, raw = np.float32(pair.smoothed_albedo), np.float32(pair.features[0][:3])
        self.assertGreater(np.abs(albedo - raw).max(), 0.01)
        self.assertAlmostEqual(albedo.mean(), raw.mean(), delta=0.02)
        np.testing.assert_array_equal(batches.features_of(pair, clean=False, smoothed=True)[:3], pair.smoothed_albedo)
        np.testing.assert_array_equal(batches.features_of(pair, clean=False, smoothed=True)[3:7], pair.features[0][3:])
        np.testing.assert_array_equal(batches.features_of(pair, clean=False, smoothed=False)[:7], pair.features[0])
        np.testing.assert_array_equal(batches.features_of(pair, clean=True, smoothed=True)[7:], pair.features[1])
        np.testing.assert_array_equal(batches.whole_frame(pair)[2][0, :3], pair.smoothed_albedo)
        # A fifth of the crops: of the others some lack the albedo, some have that of the references.
        pair.features, pair.smoothed_albedo = [np.full_like(f, 0.25) for f in pair.features], np.full_like(pair.smoothed_albedo, 0.75)
        rng = np.random.default_rng(1)
        shown = [float(batches.crop(rng, pair, SIZE)[2][0, 5, 5]) for _ in range(200)]
        self.assertTrue(20 < shown.count(0.75) < 65, shown.count(0.75))
        self.assertGreater(shown.count(0.25), 40)

    def test_of_a_merged_frame_the_own_albedo_is_smoothed(self):
        pair = batches.load(self.folder.name)[0][0]
        pair.features, pair.own = [pair.features[1], pair.features[1], pair.features[0]], pair.color
        batches.smooth_albedos([pair], Network(CHANNELS["small"]))
        features = batches.features_of(pair, clean=False, smoothed=True)
        np.testing.assert_array_equal(features[:7], pair.features[0])
        np.testing.assert_array_equal(features[7:10], pair.smoothed_albedo)

    def test_shots_are_merged_by_the_program_itself(self):
        names = ["forward0.0001", "both1.0001", "shared_forward2.0001", "shared_both3.0001"]
        for renderer, of_shared in (("becalm", 2), ("cycles", 0)):
            folder = f"{self.folder.name}/{renderer}-000002"
            write_shot(folder, renderer, 3, frames=3)
            with unittest.mock.patch.multiple(merged_shots, MERGES=2, SHARED_MERGES=of_shared):
                merged_shots.merge_shot(os.environ["BECALM"], folder, shots.MERGED)
            self.assertTrue(merged_shots.is_merged(f"{folder}/{shots.MERGED}", os.environ["BECALM"]))
            self.assertFalse(merged_shots.is_merged(f"{folder}/{shots.MERGED}", __file__))
            pairs = {p.name.split("/")[1]: p for p in shots.load_shot(folder) if p.merged}
            self.assertEqual(set(pairs), set(names[:2 + of_shared]))
            for name, pair in pairs.items():
                alike = neighbours_alike(pair.own, pair.references)
                if pair.of_shared_noise:
                    self.assertGreater(alike, 0.1, name)
                else:
                    self.assertLess(abs(alike), 0.1, name)
            truth = np.float32(pairs["both1.0001"].references).mean(0)
            error = lambda image: ((np.float32(image) - truth) ** 2).mean()
            self.assertLess(error(pairs["both1.0001"].color), 0.6 * error(pairs["both1.0001"].own))
        learn = lambda shared: {p.name for p in batches.load(self.folder.name, shared=shared)[0] if p.merged and p.of_shared_noise}
        self.assertEqual(learn(True), {"becalm-000002/shared_forward2.0001", "becalm-000002/shared_both3.0001"})
        self.assertEqual(learn(False), set())

    def test_merged_frames_are_read_and_always_tell_their_variance(self):
        folder = f"{self.folder.name}/becalm-000000"
        frame = batches.load(self.folder.name)[0][0]
        features = [*frame.features, frame.features[0]]
        merged = shots.packed_pair(frame.color, [0.5 * frame.variances[0]], features, frame.references, frame.color)
        shots.save(f"{folder}/{shots.MERGED}", {f"both.0001.{name}": array for name, array in merged.items()})
        pairs = shots.load_shot(folder)
        self.assertEqual([p.name for p in pairs if p.merged], ["becalm-000000/both.0001"])
        rng = np.random.default_rng(1)
        told = lambda pair: sum(batches.crop(rng, pair, SIZE)[1].min() >= 0 for _ in range(100))
        self.assertEqual(told(pairs[-1]), 100)
        self.assertLess(told(pairs[0]), 90)

    def test_the_own_share_is_learned_from_merged_frames_and_survives_export(self):
        network = Network(CHANNELS["small"])
        rng = np.random.default_rng(1)
        frame = batches.load(self.folder.name)[0][0]
        clean = np.float32(frame.references[0])
        # A merged frame that lost all detail, while the frame itself is nearly clean.
        features = [*frame.features, frame.features[0]]
        blurred = np.broadcast_to(clean.mean((1, 2), keepdims=True), clean.shape)
        merged = shots.packed_pair(blurred, [np.full((1, SIZE, SIZE), 0.01)], features, frame.references,
                                   clean * (1 + 0.01 * rng.normal(size=clean.shape)))
        shots.save(f"{self.folder.name}/becalm-000000/{shots.REMERGED}", {f"both.0001.{name}": a for name, a in merged.items()})
        pair = shots.load_pairs(f"{self.folder.name}/becalm-000000", shots.REMERGED)[0]
        prepared = [own_share.prepared(network, pair)]
        trained = own_share.train(prepared, 300)
        error = own_share.gain(trained, prepared)
        self.assertLess(error, 0.3)
        self.assertAlmostEqual(own_share.gain(own_share.from_bytes(own_share.to_bytes(trained)), prepared), error, delta=0.01)

    def test_an_own_share_of_another_file_is_refused(self):
        data = own_share.to_bytes(own_share.OwnShare())
        for wrong, said in ((b"becalmNW" + data[8:], "magic becalmOS"), (data[:-2], f"{len(data) - 2} bytes, expected {len(data)}"), (data + b"\0\0", "bytes")):
            with self.assertRaisesRegex(ValueError, said):
                own_share.from_bytes(wrong)

    def test_detail_beyond_the_noise_is_put_back(self):
        noisy = torch.rand(1, 3, SIZE, SIZE) + 0.5
        smoothed = noisy.mean((2, 3), keepdim=True).expand_as(noisy)
        error = torch.full((1, 1, SIZE, SIZE), 0.1)
        surface = torch.ones_like(error, dtype=torch.bool)
        for variance, close in ((1e-6, True), (1.0, False)):
            result, left, noise = own_share.with_detail(smoothed, error, noisy, torch.full_like(error, variance), surface)
            expected = noisy if close else smoothed
            self.assertLess((result - expected).abs().max().item(), 1e-3)
            self.assertLess((left - (variance if close else error)).abs().max().item(), 1e-3)
            brightness = smoothed[0, :, 0, 0].dot(torch.tensor((0.2126, 0.7152, 0.0722))) + 0.1
            self.assertAlmostEqual(noise.mean().item(), variance / brightness.item() ** 2, delta=1e-3 * variance)

    def test_noise_of_surfaces_is_not_that_of_what_is_behind(self):
        noisy = torch.rand(1, 3, SIZE, SIZE) + 0.5
        smoothed = noisy.mean((2, 3), keepdim=True).expand_as(noisy)
        features = torch.zeros(1, 7, SIZE, SIZE)
        features[:, 5, ::2], features[:, 6] = 1.0, 2.0
        features[:, 6, ::2] = 0.5
        surface = own_share.shows_surface(features)
        variance = torch.where(surface, 1.0, 1e-6)
        result, _, _ = own_share.with_detail(smoothed, torch.full_like(variance, 0.1), noisy, variance, surface)
        self.assertLess((result - noisy)[..., 1::2, :].abs().max().item(), 1e-3)
        self.assertLess((result - smoothed)[..., ::2, :].abs().max().item(), 1e-3)

    def test_a_reference_is_a_frame_too_and_the_other_is_what_it_is_to_become(self):
        of_a, of_b = batches.load(self.folder.name)[0][1:3]
        ratio = np.float32(of_a.references[0]) / np.float32(of_b.color)
        np.testing.assert_allclose(ratio, ratio.mean(), rtol=2e-3)
        self.assertFalse(of_a.independent)
        rng = np.random.default_rng(1)
        for _ in range(20):
            references = batches.crop(rng, of_a, SIZE)[3]
            np.testing.assert_array_equal(references[0], references[1])

    def test_training_begins_with_the_weights_given(self):
        start = f"{self.folder.name}/start.weights"
        network = Network(CHANNELS["small"])
        with open(start, "wb") as file:
            file.write(export.to_bytes(network))
        args = train.parse(["--start", start, "--steps", "0", self.folder.name, f"{self.folder.name}/out"])
        trainer = train.Trainer(args)
        self.assertEqual(trainer.network.channels, CHANNELS["small"])
        for found, expected in zip(trainer.network.parameters(), network.parameters()):
            self.assertLess((found - expected).abs().max().item(), 1e-3)

    def test_channels_that_are_zero_start_anew_and_change_nothing(self):
        _, pairs = batches.load(self.folder.name)
        torch.manual_seed(1)
        network = Network(CHANNELS["small"])
        layers = [*network.encode, *network.decode, network.finish]
        with torch.no_grad():
            for layer in layers:
                layer.conv.bias[1] = -1e3
        before = [losses.smoothed(network, batches.whole_frame(pair)) for pair in pairs]
        idle = idle_channels.largest_outputs(network, pairs)
        count = sum(int((largest <= 0).sum()) for largest in idle.values())
        self.assertGreaterEqual(count, len(layers))
        self.assertEqual(idle_channels.restart(network, pairs), count)
        for pair, expected in zip(pairs, before):
            for found, image in zip(losses.smoothed(network, batches.whole_frame(pair)), expected):
                self.assertLess((found - image).abs().max().item(), 1e-5)
        alive = idle_channels.largest_outputs(network, pairs)
        revived = sum(int(((idle[layer] <= 0) & (alive[layer] > 0)).sum()) for layer in layers)
        self.assertGreater(revived, 0.5 * count)

    def test_crops_of_the_device_are_as_those_of_the_processor(self):
        folder = f"{self.folder.name}/becalm-000000"
        frame = batches.load(self.folder.name)[0][0]
        merged = shots.packed_pair(frame.color, [frame.variances[0]], [*frame.features, frame.features[0]], frame.references, frame.color)
        shots.save(f"{folder}/{shots.MERGED}", {f"both.0001.{name}": array for name, array in merged.items()})
        pairs = batches.load(self.folder.name)[0]
        torch.manual_seed(1)
        rng = np.random.default_rng(1)
        of_device = device_batches.RenderedCrops(pairs, "cpu").batch(3000, 16)
        with unittest.mock.patch.multiple(batches, WITH_BACKGROUND=0.0, TEXTURED=0.0):
            of_processor = batches.batch(rng, pairs, 3000, 16)
        for a, b, name in zip(of_device, of_processor, ("colors", "variance", "features", "references")):
            self.assertEqual(a.shape, b.shape, name)
            figures = lambda x: [(x.clamp(max=2) ** power).mean(0).mean((-2, -1)) for power in (1, 2)]
            for of_a, of_b in zip(figures(a), figures(b)):
                np.testing.assert_allclose(of_a, of_b, rtol=0.1, atol=0.03, err_msg=name)
        # A crop is a piece of its pair, whatever its orientation: radiance over the references does not depend on them.
        noise = lambda batch: (batch[0][:, :3] / batch[3][:, 0]).log().clamp(-5, 5).std()
        self.assertAlmostEqual(noise(of_device).item(), noise(of_processor).item(), delta=0.03)

    def test_made_crops_are_a_part_of_a_batch_on_the_device(self):
        pairs = batches.load(self.folder.name)[0]
        stream = device_batches.stream(pairs, 10, 16, [1, 0], 0, "cpu")
        shapes = [tuple(x.shape) for x in next(stream)]
        self.assertEqual(shapes, [(10, 6, 16, 16), (10, 1, 16, 16), (10, 14, 16, 16), (10, 2, 3, 16, 16)])

    def test_batches_come_from_other_processes_too(self):
        pairs, _ = batches.load(self.folder.name)
        for workers in (0, 2):
            stream = batches.stream(pairs, 3, SIZE, [1, 0], workers)
            first, second = next(stream), next(stream)
            self.assertEqual([tuple(t.shape[:2]) for t in first], [(3, 6), (3, 1), (3, 14), (3, 2)])
            self.assertFalse(torch.equal(first[0], second[0]))

    def test_the_loss_falls_and_training_goes_on_where_it_stopped(self):
        out = f"{self.folder.name}/out"
        def trained(steps):
            args = train.parse(["--size", "small", "--steps", str(steps), "--crop", "32", self.folder.name, out])
            trainer = train.Trainer(args)
            with unittest.mock.patch.object(train, "EVALUATE_EVERY_MIN", math.inf):  # at the end alone, however long it takes
                trainer.run()
            return trainer
        first = trained(100)
        error = train.held_out_error(Network(CHANNELS["small"]), batches.load(self.folder.name)[1])[0]
        self.assertLess(first.best, 0.85 * error)
        second = trained(120)
        self.assertEqual((first.step, second.step), (100, 120))
        self.assertTrue(os.path.exists(f"{out}/best.pt"))
        with open(f"{out}/curve.csv") as file:
            self.assertEqual(len(file.readlines()), 2)

    def test_each_step_draws_the_same_numbers_whether_training_was_stopped_or_not(self):
        drawn = {}
        def trained(out, steps):
            args = train.parse(["--size", "small", "--steps", str(steps), "--crop", "16", "--batch", "2", self.folder.name, f"{self.folder.name}/{out}"])
            def scales(*asked):
                drawn.setdefault(out, []).append(made := random_scales(*asked))
                return made
            random_scales = losses.random_scales
            with unittest.mock.patch.object(losses, "random_scales", scales):
                train.Trainer(args).run()
        for out, steps in (("stopped", 2), ("stopped", 4), ("whole", 4)):
            trained(out, steps)
        self.assertEqual(len(drawn["whole"]), 4)
        torch.testing.assert_close(drawn["stopped"], drawn["whole"])
        self.assertEqual(len({float(scales[0]) for scales in drawn["whole"]}), 4)

    def test_what_was_best_is_measured_anew_on_other_shots(self):
        out = f"{self.folder.name}/out_of_others"
        trainer = train.Trainer(train.parse(["--size", "small", "--crop", "32", self.folder.name, out]))
        choose = batches.load(self.folder.name)[1]
        trainer.choose_on(choose)
        trainer.evaluate(choose, math.nan)
        error, trainer.best = trainer.best, 1e-9  # as of shots that are easier
        trainer.choose_on(choose)
        self.assertEqual(trainer.best, 1e-9)
        trainer.choose_on(choose[:-1])
        self.assertAlmostEqual(trainer.best, error, delta=0.5 * error)
        self.assertEqual(trainer.chosen_on, [pair.name for pair in choose[:-1]])


if __name__ == "__main__":
    unittest.main()
