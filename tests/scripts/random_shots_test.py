"""The generators of random shots of scripts/train/."""

import unittest

import numpy as np

import batches
import becalm_layouts
import becalm_materials
import becalm_scene
import noise_levels


class Layouts(unittest.TestCase):
    def test_trained_and_held_out_shots_have_all_of_them(self):
        seeds = range(200)
        held_out = {becalm_scene.layout_of(seed, 0) for seed in seeds if batches.is_held_out(f"becalm-{seed:06}")}
        trained = {becalm_scene.layout_of(seed, 0) for seed in seeds if not batches.is_held_out(f"becalm-{seed:06}")}
        self.assertEqual(held_out, set(becalm_layouts.LAYOUTS))
        self.assertEqual(trained, set(becalm_layouts.LAYOUTS))


class Relief(unittest.TestCase):
    def test_procedural_surfaces_have_none_of_it_however_it_is_mixed(self):
        materials = becalm_materials.Materials(np.random.default_rng(1), {}, textured_share=0)
        materials.entries = {"bumpy": {"type": "diffuse", "bump": {}}, "carved": {"type": "conductor", "normal_map": {}},
                             "both": {"type": "mix", "materials": ["bumpy", "carved"], "factor": 0.5}}
        stage = becalm_layouts.Stage(np.random.default_rng(1), materials, [{"kind": f"kind {i}"} for i in range(9)])
        stage.put(stage.mesh("waves", procedural="ocean"), "both")
        self.assertEqual(materials.entries["bumpy"], {"type": "diffuse"})
        self.assertEqual(materials.entries["carved"], {"type": "conductor"})


class NoiseLevels(unittest.TestCase):
    def test_samples_follow_the_noise_and_are_two_different_counts(self):
        draws = iter([0.5, 0.5, 0.0, 0.0, 1.0, 1.0])
        random = lambda: next(draws)
        self.assertEqual(noise_levels.noise_levels(0.4, random), [4, 8])  # of 0.095, twice the same
        self.assertEqual(noise_levels.noise_levels(0.4, random), [64, 32])  # of 0.003, beyond the most
        self.assertEqual(noise_levels.noise_levels(0.4, random), [1, 2])
        self.assertEqual(noise_levels.sample_count(0.0, 0.1), 1)

    def test_the_whole_shot_may_have_either_level_and_references_have_more_than_both(self):
        for draws, expected in (([0.0, 1.0], [64, 1]), ([1.0, 0.0], [1, 64])):
            levels = noise_levels.noise_levels(0.4, iter(draws).__next__)
            self.assertEqual(levels, expected)
            self.assertEqual(noise_levels.reference_samples(levels, 32), 128)


if __name__ == "__main__":
    unittest.main()
