"""The bench's page: goals, a flip-book of variants side by side with their errors, plots and tables, in one file."""

import base64

from demo_page import write_page


def _uri(path):
    kind = {".jpg": "jpeg", ".png": "png"}[path.suffix]
    return f"data:image/{kind};base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def _book(folder, variants):
    """{variant: {kind: {frame: picture}}} of one scene and sample count; what is no frame's has frame 0."""
    book = {}
    for name in [*variants, "reference"]:
        for path in sorted((folder / name).glob("*.jpg")):
            kind, _, frame = path.stem.partition(".")
            book.setdefault(name, {}).setdefault(kind, {})[int(frame or 0)] = _uri(path)
    return book


def write_quality_page(asked, results, sections, plots):
    pictured = {(cell["scene"], cell["spp"]): [] for cell in results.cells.values() if cell["recipe"]["pictured"]}
    for cell in results.cells.values():
        if cell["recipe"]["pictured"]:
            pictured[cell["scene"], cell["spp"]].append(cell["variant"])
    write_page(asked.output / "index.html", "quality_page.html", {
        "titles": {variant.name: variant.title for variant in results.variants} | {"reference": "reference"},
        "books": [{"title": f"{scene}, {spp} spp", "variants": _book(asked.output / "pictures" / f"{scene}.{spp}", variants)}
                  for (scene, spp), variants in pictured.items()],
        "sections": sections,
        "plots": [{"title": title, "uri": _uri(path)} for title, path in plots.items()],
        "measured": asked.measured,
        "reference_spp": asked.reference_spp,
    })
