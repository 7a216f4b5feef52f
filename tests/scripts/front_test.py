"""The arithmetic of `scripts/bench front`, on data with known results."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from benches.front.adaptive import at_time, table, target_table
from benches.front.dominance import dominator, dominates, front
from benches.front.exponent import exponent, local_exponents
from benches.front.gaps import Gap, told
from benches.front.joint_bilateral import joint_bilateral
from benches.front.methods import PRESETS, changed_presets
from benches.front.motion_average import motion_average
from benches.front.non_local_means import non_local_means
from benches.front.plain_curve import PlainCurve
from benches.front.points import Point, Trade, mean_trade, mean_worth, positive_errors
from benches.front.tables import dominated, statement
from benches.made_of import sources_of
from benches.peer.run import row
from benches.quality.render_time import note, seconds_a_frame

BECALM = os.environ["BECALM"]
SHAPE = (24, 32)


class AdaptiveSampling(unittest.TestCase):
    def test_errors_at_a_time_are_interpolated_in_logarithms(self):
        curve = [{"seconds": s, "relmse": 1.0 / s} for s in (4.0, 1.0, 2.0)]
        for seconds in (1.0, 1.5, 3.0, 5.0):
            self.assertAlmostEqual(at_time(curve, seconds, "relmse"), 1.0 / seconds)

    def test_errors_that_are_not_above_zero_are_not_compared(self):
        def points(*errors):
            return [{"seconds": float(spp)} | positive_errors({"relmse": error, "temporal": 1.0 / spp}) for spp, error in zip((4, 8, 16), errors)]

        def ratios(adaptive, *uniform):
            return [cell.strip() for cell in table([("a", dict(zip((4, 8, 16), points(*uniform))), adaptive)]).splitlines()[2].split("|")[4:-1]]

        good, bad = points(0.25, -0.001)[:2]
        self.assertEqual(ratios(good, 0.25, 0.125, 0.0625), ["2.000", "1.000", "2.000", "1.000"])
        self.assertEqual(ratios(bad, 0.25, 0.125, 0.0625), ["-", "-", "1.000", "1.000"])
        self.assertEqual(ratios(good, -0.001, 0.125, 0.0625), ["2.000", "-", "2.000", "1.000"])
        self.assertEqual(ratios(good, 0.25, 0.0, 0.0625), ["-", "-", "2.000", "1.000"])
        self.assertIn(" - in 8 s |", target_table([("a", {0.3: good, 0.2: bad})]))


class Peer(unittest.TestCase):
    def test_ratios_are_those_of_the_peer_over_becalm(self):
        rng = np.random.default_rng(1)
        ours, theirs = (1.0 + deviation * rng.standard_normal((64, 40, 50, 3)) for deviation in (0.1, 0.2))
        found = row("scene", (ours, 2.0), (theirs, 3.0))
        self.assertAlmostEqual(found["mean"], 1.0, delta=0.001)
        self.assertAlmostEqual(found["variance"], 4.0, delta=0.1)
        self.assertAlmostEqual(found["equal"], 6.0, delta=0.15)
        self.assertAlmostEqual(found["equal_kept"], 6.0, delta=0.15)


class Dominance(unittest.TestCase):
    def test_less_of_one_is_not_enough(self):
        self.assertTrue(dominates((1.0, 1.0), (2.0, 2.0)))
        self.assertFalse(dominates((1.0, 2.0), (2.0, 1.0)))
        self.assertFalse(dominates((1.0, 2.0), (2.0, 2.0)))

    def test_times_that_repeated_runs_do_not_tell_apart_dominate_nothing(self):
        self.assertFalse(dominates((0.98, 1.0), (1.0, 2.0)))

    def test_the_best_of_the_dominating_points_is_named(self):
        self.assertEqual(dominator((2.0, 2.0), [(1.8, 0.1), (1.5, 1.5), (0.5, 1.0), (3.0, 0.1), (2.0, 2.0)]), 0)
        self.assertIsNone(dominator((2.0, 2.0), [(2.0, 2.0), (3.0, 1.0), (1.0, 3.0)]))

    def test_the_front_falls(self):
        points = [(4.0, 1.0), (1.0, 8.0), (2.0, 4.0), (2.0, 5.0), (3.0, 4.5), (5.0, 1.0)]
        self.assertEqual(front(points), [1, 2, 0])


class PlainRendering(unittest.TestCase):
    def test_between_measured_counts_it_is_interpolated_in_logarithms(self):
        curve = PlainCurve({1: 1.0, 4: 0.5, 16: 0.1}, {})
        self.assertAlmostEqual(curve.samples(0.5), 4.0)
        self.assertAlmostEqual(curve.samples(np.sqrt(0.5)), 2.0)
        self.assertAlmostEqual(curve.error(2.0), np.sqrt(0.5))
        self.assertTrue(curve.is_measured(2.0))

    def test_beyond_them_the_error_falls_as_one_over_n(self):
        curve = PlainCurve({4: 0.5, 16: 0.1}, {})
        self.assertAlmostEqual(curve.samples(0.01), 160.0)
        self.assertAlmostEqual(curve.samples(1.0), 2.0)
        self.assertAlmostEqual(curve.error(160.0), 0.01)
        self.assertFalse(curve.is_measured(160.0) or curve.is_measured(2.0))

    def test_a_curve_that_rises_by_chance_gives_the_least_count(self):
        self.assertAlmostEqual(PlainCurve({1: 1.0, 4: 2.0, 16: 0.5}, {}).samples(1.0), 1.0)

    def test_an_error_that_is_not_above_zero_is_no_measurement(self):
        self.assertEqual(PlainCurve({1: 1.0, 4: -0.1}, {}).spps, (1,))
        with self.assertRaises(ValueError):
            PlainCurve({1: 0.0}, {})

    def test_time_is_a_constant_and_a_share_for_each_sample(self):
        curve = PlainCurve({1: 1.0}, {1: 0.75, 4: 1.5, 16: 4.5})
        self.assertAlmostEqual(curve.seconds(100), 25.5)
        self.assertAlmostEqual(curve.samples_in(25.5), 100.0)
        self.assertIsNone(curve.samples_in(0.5))

    def test_times_that_fit_no_constant_are_proportional(self):
        self.assertAlmostEqual(PlainCurve({1: 1.0}, {4: 1.0}).seconds(8), 2.0)
        self.assertEqual(PlainCurve({1: 1.0}, {1: 0.1, 4: 1.0}).fixed, 0.0)

    def test_without_times_there_are_none(self):
        curve = PlainCurve({1: 1.0}, {})
        self.assertIsNone(curve.seconds(4))
        self.assertIsNone(curve.samples_in(4.0))


class Exponents(unittest.TestCase):
    def test_those_of_power_laws(self):
        sizes = [10, 30, 100, 1000]
        self.assertAlmostEqual(exponent(sizes, [3.0 * s for s in sizes]), 1.0)
        self.assertAlmostEqual(exponent(sizes, [7.0] * 4), 0.0)
        self.assertAlmostEqual(exponent(sizes, [s**1.5 for s in sizes]), 1.5)

    def test_between_neighbours(self):
        first, *others = local_exponents([1, 2, 4], [1.0, 2.0, 2.0])
        self.assertIsNone(first)
        np.testing.assert_allclose(others, [1.0, 0.0], atol=1e-9)


def point(spp, kind, render_s, denoise_s, error):
    name = {"plain": "noisy", "preset": "final"}.get(kind, kind)
    return Point(spp, name, name, kind, render_s, denoise_s, error, error)


def plain_and(*points, render=True):
    plain = [point(spp, "plain", 0.1 * spp if render else None, 0.0, 1.0 / spp) for spp in (1, 4, 16)]
    return Trade("a scene", plain + list(points))


class Points(unittest.TestCase):
    def test_what_denoising_is_worth(self):
        final = point(4, "preset", 0.4, 0.6, 0.005)
        trade = plain_and(final)
        worth = trade.worth(final, "relmse")
        self.assertAlmostEqual(worth.samples, 200.0)
        self.assertAlmostEqual(worth.times, 20.0)
        self.assertAlmostEqual(worth.at_equal_time, 0.05)
        self.assertEqual(statement(final, worth), "4 spp + final = 200* spp: 20 times faster")
        self.assertEqual(dominated(trade), [])

    def test_a_preset_that_more_samples_undercut_is_dominated(self):
        trade = plain_and(point(4, "preset", 0.4, 3.0, 0.1))
        self.assertEqual([better.label for _, metric, better in dominated(trade) if metric == "relmse"], ["16 spp"])

    def test_equal_sample_counts_are_compared_by_the_time_of_denoising(self):
        trade = plain_and(point(16, "preset", 1.6, 0.1, 0.01), point(16, "setting", 1.6, 0.09, 0.009))
        self.assertEqual([better.name for _, _, better in dominated(trade)], ["setting", "setting"])

    def test_without_the_time_of_rendering_only_equal_counts_are_compared(self):
        trade = plain_and(point(1, "preset", None, 3.0, 0.5), point(4, "setting", None, 1.0, 0.1), render=False)
        self.assertEqual(dominated(trade), [])
        trade = plain_and(point(1, "preset", None, 3.0, 0.5), point(1, "setting", None, 1.0, 0.1), render=False)
        self.assertEqual(len(dominated(trade)), 2)
        self.assertIsNone(trade.worth(trade.points[-1], "relmse").times)

    def test_means_are_geometric_and_of_points_that_all_scenes_have(self):
        one = plain_and(point(1, "preset", 0.1, 1.0, 0.1), point(4, "preset", 0.4, 1.0, 0.1))
        two = plain_and(point(1, "preset", 0.1, 4.0, 0.001))
        mean = mean_trade([one, two])
        final = mean.points[-1]
        self.assertEqual([(p.spp, p.name) for p in mean.points], [(1, "noisy"), (4, "noisy"), (16, "noisy"), (1, "final")])
        self.assertAlmostEqual(final.relmse, 0.01)
        self.assertAlmostEqual(final.denoise_s, 2.0)
        self.assertAlmostEqual(mean_worth([one, two], final, "relmse").samples, 100.0)
        self.assertFalse(mean_worth([one, two], final, "relmse").is_measured)


class Gaps(unittest.TestCase):
    def test_gaps_of_one_reason_are_one_line(self):
        gaps = [Gap("mean", scene, spp, "no motion") for scene in ("car", "skin") for spp in (1, 4)]
        self.assertEqual(told([*gaps, Gap("mean", "crowd", 4, "no motion"), Gap("", "cloth", 8, "n8/f.0001.exr is not there")]),
                         ["mean of car, skin at 1, 4 spp; crowd at 4 spp: no motion", "cloth at 8 spp: n8/f.0001.exr is not there"])


class RenderTimes(unittest.TestCase):
    def test_they_are_means_over_all_runs(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            self.assertIsNone(seconds_a_frame(folder, "wall"))
            note(folder, 2, 4.0, 6.0)
            note(folder, 1, 5.0, 9.0)
            self.assertEqual((seconds_a_frame(folder, "wall"), seconds_a_frame(folder, "processor")), (3.0, 5.0))

    def test_another_program_has_its_own(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            note(folder, 2, 4.0, 6.0, "old")
            self.assertIsNone(seconds_a_frame(folder, "wall", "new"))
            self.assertEqual(seconds_a_frame(folder, "wall", None), 2.0)
            (folder / "seconds.json").write_text('{"frames": 1, "wall": 9.0, "processor": 9.0}')  # of nobody knows which
            self.assertIsNone(seconds_a_frame(folder, "wall", "new"))
            note(folder, 1, 3.0, 4.0, "new")
            self.assertEqual(seconds_a_frame(folder, "wall", "new"), 3.0)


class ChangedPresets(unittest.TestCase):
    def test_each_takes_the_values_of_the_others(self):
        text = subprocess.run([BECALM, "denoise", "--help-settings"], check=True, capture_output=True, text=True).stdout
        found = {variant.name: variant for variant in changed_presets(text)}
        self.assertEqual(found["final.match_downsample=4"].options, ("--preset", "final", "--set", "match_downsample=4"))
        self.assertTrue({"draft.smooth=merged", "balanced.directions=forward", "final.smooth=frames"} <= found.keys())
        self.assertNotIn("final.match_downsample=1", found)          # it has this value
        self.assertFalse(any("mask_alpha" in name for name in found))  # all presets have the same
        self.assertTrue(all(name.partition(".")[0] in [preset.name for preset in PRESETS] for name in found))


class Recipes(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(1)
        self.albedo = np.where(np.arange(SHAPE[1])[None, :, None] < SHAPE[1] // 2, 0.8, 0.2) * np.ones((*SHAPE, 3), np.float32)
        self.layers = {"albedo": self.albedo, "normal": np.full((*SHAPE, 3), (0.0, 0.0, 1.0), np.float32), "motion": np.zeros((*SHAPE, 2), np.float32)}
        self.noisy = [(self.albedo * random.gamma(20.0, 1 / 20.0, self.albedo.shape)).astype(np.float32) for _ in range(5)]

    def error(self, image):
        return np.square(image - self.albedo).mean()

    def test_each_lowers_noise_and_keeps_an_edge(self):
        for recipe, share in ((non_local_means, 0.5), (joint_bilateral, 0.1), (motion_average, 0.3)):
            frames = list(recipe((image, self.layers) for image in self.noisy))
            self.assertEqual(len(frames), 5)
            self.assertLess(self.error(frames[-1]), share * self.error(self.noisy[-1]), recipe.__name__)

    def test_kept_figures_are_those_of_what_a_recipe_imports_too(self):
        for recipe, imported in ((motion_average, "warp.py"), (non_local_means, "exposure.py")):
            self.assertEqual({Path(path).name for path in sources_of(recipe)}, {f"{recipe.__name__}.py", imported})

    def test_the_mean_follows_the_motion_and_begins_anew_outside(self):
        first = np.tile(np.arange(SHAPE[1], dtype=np.float32)[None, :, None], (SHAPE[0], 1, 3))
        second = first + 1.0  # at x is what was at x + 1
        motion = np.full((*SHAPE, 2), (1.0, 0.0), np.float32)
        _, mean = motion_average([(first, {"motion": motion}), (second, {"motion": motion})])
        np.testing.assert_allclose(mean[:, :-1], second[:, :-1])
        np.testing.assert_allclose(mean[:, -1], second[:, -1])


if __name__ == "__main__":
    unittest.main()
