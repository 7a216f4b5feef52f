"""Fills scripts/demo_page.html with the demo's data. Everything is inside the one file that comes out."""

import json
from pathlib import Path

TEMPLATE = Path(__file__).with_name("demo_page.html")
PLACE = "__DEMO_DATA__"


def write_page(path, data):
    template = TEMPLATE.read_text(encoding="utf-8")
    # In a script element only "</" could end the data early.
    text = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    path.write_text(template.replace(PLACE, text), encoding="utf-8")
