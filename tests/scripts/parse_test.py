"""Every Python file of scripts/, scenes/ and tests/ parses, also those that no test runs."""

import ast
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Parse(unittest.TestCase):
    def test_every_file_parses(self):
        paths = [path for folder in ("scripts", "scenes", "tests") for path in sorted((ROOT / folder).rglob("*.py"))]
        self.assertGreater(len(paths), 50)
        for path in paths:
            with self.subTest(path=str(path.relative_to(ROOT))):
                ast.parse(path.read_text(), str(path))


if __name__ == "__main__":
    unittest.main()
