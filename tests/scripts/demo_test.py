"""The page of `scripts/demo uses`, of made-up results, as a browser lays it out."""

import html
import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

from demo_parts import uses
from demo_parts.use_runs import Use, enlarged

ROOT = Path(__file__).resolve().parents[2]

# What the page itself finds once it is laid out, as its only text.
PROBE = """<script>
addEventListener("error", (event) => { document.documentElement.dataset.problem = event.message; });
addEventListener("load", () => {
  const found = [...document.querySelectorAll("section")].map((section) => {
    const divider = section.querySelector(".divider");
    divider.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true, cancelable: true }));
    for (const button of section.querySelectorAll(".viewing button")) button.click();
    return { id: section.id, split: divider.getAttribute("aria-valuenow"), rows: section.querySelectorAll("tr").length,
             images: section.querySelectorAll("img").length,
             broken: [...section.querySelectorAll("img")].filter((image) => image.naturalWidth === 0).length,
             commands: [...section.querySelectorAll("code")].map((code) => code.textContent) };
  });
  document.body.replaceChildren(JSON.stringify({ found, problem: document.documentElement.dataset.problem ?? "" }));
});
</script>"""


def laid_out(page, folder):
    """What the probe found in the page."""
    path = folder / "probed.html"
    path.write_text(page.replace("<style>", PROBE + "<style>", 1))
    dom = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}",
                          "--virtual-time-budget=20000", "--dump-dom", f"file://{path}"], capture_output=True, text=True, check=True).stdout
    return json.loads(html.unescape(re.search(r"<body>(.*)</body>", dom, re.DOTALL).group(1)))


def made_up(name):
    """A use of two frames, the second one white."""
    frames = [np.full((9, 16, 3), value) for value in (0.2, 1.0)]
    return Use(name, f"{name} </script>", "", [5, 6], {"before": frames, "after": frames[::-1]}, "before", "after", "",
               [["", "relMSE"], ["before", "1"], ["after", "0"]], [f"becalm {name} 'in.####.exr'"])


class Uses(unittest.TestCase):
    def test_every_use_has_a_slider_a_table_and_commands(self):
        with tempfile.TemporaryDirectory() as name:
            page = Path(name) / "uses.html"
            uses.write_uses(page, [made_up(use.__name__) for use in uses.USES])
            report = laid_out(page.read_text(), page.parent)
        self.assertEqual(report["problem"], "")
        self.assertEqual([use["id"] for use in report["found"]], ["antialias", "upsample", "stereo", "burst"])
        for use in report["found"]:
            self.assertEqual(use["split"], "52", "an arrow key moves the divider")
            self.assertEqual((use["images"], use["broken"]), (2, 0))
            self.assertEqual(use["rows"], 3)
            self.assertEqual(use["commands"], [f"becalm {use['id']} 'in.####.exr'"])

    def test_pixels_are_repeated(self):
        image = np.arange(4.0).reshape(2, 2, 1)
        self.assertEqual(enlarged(image, (4, 2))[..., 0].tolist(), [[0, 0, 1, 1], [2, 2, 3, 3]])

    def test_other_parts_of_the_demo_are_refused(self):
        self.assertEqual(subprocess.run([ROOT / "scripts/demo", "abuses"], capture_output=True, check=False).returncode, 2)


if __name__ == "__main__":
    unittest.main()
