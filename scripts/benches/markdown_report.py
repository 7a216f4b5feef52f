"""Reports as markdown and JSON."""

import json
import textwrap

from whole_file import write_whole

COLUMNS = 100


def markdown(header, rows):
    """A table whose columns have equal width, so that it can be read as text too."""
    cells = [[str(c) for c in row] for row in [header, *rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(header))]
    lines = ["| " + " | ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths))) + " |"
             for row in cells]
    rule = "| " + " | ".join("-" * w if i == 0 else "-" * (w - 1) + ":" for i, w in enumerate(widths)) + " |"
    return "\n".join([lines[0], rule, *lines[1:]]) + "\n"


def wrapped(text):
    return "\n\n".join(textwrap.fill(part, COLUMNS, break_on_hyphens=False) for part in text.split("\n\n")) + "\n"


def within_columns(text):
    """The text with every paragraph filled anew that has too long a line; tables, headings and lists stay as they are."""
    def too_long(paragraph):
        return not paragraph.startswith(("|", "#", "- ", "```")) and any(len(line) > COLUMNS for line in paragraph.split("\n"))

    return "\n\n".join(wrapped(part).rstrip("\n") if too_long(part) else part for part in text.split("\n\n"))


def items(lines):
    return "".join(textwrap.fill(line, COLUMNS, break_on_hyphens=False, initial_indent="- ", subsequent_indent="  ") + "\n" for line in lines)


def figure(value, digits=4):
    """A number as a cell; None, which was not measured, is a dash."""
    return "-" if value is None else f"{value:.{digits}f}"


class Report:
    """Writes KEY.md and KEY.json for each section, and report.md of all sections in the folder, in the given order of keys."""

    def __init__(self, folder, order, title):
        self.folder, self.order, self.title = folder, order, title
        folder.mkdir(parents=True, exist_ok=True)

    def add(self, key, title, text, data):
        print(f"\n{title}\n\n{text}", flush=True)
        write_whole(self.folder / f"{key}.json", json.dumps(data, indent=1))
        write_whole(self.folder / f"{key}.md", f"## {title}\n\n{text}")
        sections = [self.folder / f"{name}.md" for name in self.order]
        write_whole(self.folder / "report.md", "\n".join([f"# {self.title}\n", *(s.read_text() for s in sections if s.exists())]))

    def clear(self):
        """Removes the sections that an earlier run, perhaps of other scenes, wrote."""
        for key in self.order:
            for suffix in ("md", "json"):
                (self.folder / f"{key}.{suffix}").unlink(missing_ok=True)
