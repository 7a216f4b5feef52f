"""Every Python file of scripts/, scenes/ and tests/ parses, also those that no test runs."""

import ast
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def is_python_program(path):
    with path.open("rb") as file:
        first = file.readline(80)
    return first.startswith(b"#!") and b"python" in first


class Parse(unittest.TestCase):
    def test_every_file_parses(self):
        files = [path for folder in ("scripts", "scenes", "tests") for path in sorted((ROOT / folder).rglob("*")) if path.is_file()]
        paths = [path for path in files if path.suffix == ".py" or is_python_program(path)]
        self.assertGreater(len(paths), 50)
        self.assertIn(ROOT / "scripts/farm/task", paths)
        for path in paths:
            with self.subTest(path=str(path.relative_to(ROOT))):
                ast.parse(path.read_text(), str(path))


if __name__ == "__main__":
    unittest.main()
