"""The bugs of tests/regression/mutations.py can still be planted: what each replaces is in the sources once."""

import unittest

import mutations


class Mutations(unittest.TestCase):
    def test_every_bug_has_its_place(self):
        texts, originals = mutations.planted(mutations.ROOT)
        self.assertEqual(texts.keys(), originals.keys())
        switches = "".join(texts.values()).count("(planted(")
        self.assertEqual(switches, len(mutations.MUTATIONS))


if __name__ == "__main__":
    unittest.main()
