"""Tables as markdown and JSON."""

import json


def markdown(header, rows):
    """Cells as they are; columns of equal width, so that the table can be read as text too."""
    cells = [[str(c) for c in row] for row in [header, *rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(header))]
    lines = ["| " + " | ".join(c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths))) + " |"
             for row in cells]
    rule = "| " + " | ".join("-" * w if i == 0 else "-" * (w - 1) + ":" for i, w in enumerate(widths)) + " |"
    return "\n".join([lines[0], rule, *lines[1:]]) + "\n"


def figure(value, digits=4):
    """A number for a cell; what was not measured is a dash."""
    return "-" if value is None else f"{value:.{digits}f}"


class Report:
    """A markdown file and a JSON file that grow section by section."""

    def __init__(self, folder):
        self.folder, self.text, self.data = folder, [], {}

    def add(self, key, title, text, data):
        self.text.append(f"## {title}\n\n{text}")
        self.data[key] = data
        print(f"\n{title}\n\n{text}", flush=True)
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / "report.md").write_text("# Alignment experiments\n\n" + "\n".join(self.text))
        (self.folder / "report.json").write_text(json.dumps(self.data, indent=1))
