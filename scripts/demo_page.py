"""Fills the template of a page with its data. Everything is inside the one file that comes out."""

import json
from pathlib import Path

PLACE = "__PAGE_DATA__"


def write_page(path, template_name, data):
    """template_name: a file beside this one, with PLACE in a script element of type application/json."""
    template = Path(__file__).with_name(template_name).read_text(encoding="utf-8")
    # In a script element only "</" could end the data early.
    text = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    path.write_text(template.replace(PLACE, text), encoding="utf-8")
