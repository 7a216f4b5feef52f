"""HTML pages that hold everything in one file: the skeleton of page.html, a page's own content, and its data."""

import json
from pathlib import Path

from whole_file import write_whole

SKELETON = Path(__file__).with_name("page.html")


def write_page(path, title, content, data):
    """content: the file of the page's own HTML, which begins with its style element and may use the skeleton's style and functions."""
    style, _, body = content.read_text(encoding="utf-8").partition("</style>\n")
    # In a script element only "</" could end the data early.
    text = json.dumps(data, separators=(",", ":")).replace("</", "<\\/")
    page = SKELETON.read_text(encoding="utf-8")
    for place, value in (("__TITLE__", title), ("__STYLE__", style + "</style>"), ("__CONTENT__", body), ("__DATA__", text)):
        page = page.replace(place, value)
    write_whole(path, page)
