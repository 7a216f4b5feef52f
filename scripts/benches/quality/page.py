"""The page of `scripts/bench quality`: goals, a flip-book of all variants and their errors, plots and tables."""

from pathlib import Path

from pictures.files import file_uri
from pictures.page import write_page

CONTENT = Path(__file__).with_name("page.html")


def _book(folder, variants):
    """{variant: {kind: {frame: picture}}} of one scene and sample count; a picture of all frames together has frame 0."""
    book = {}
    for name in [*variants, "reference"]:
        for path in sorted((folder / name).glob("*.jpg")):
            kind, _, frame = path.stem.partition(".")
            book.setdefault(name, {}).setdefault(kind, {})[int(frame or 0)] = file_uri(path)
    return book


def write_quality_page(asked, results, sections, plots):
    pictured = {(cell["scene"], cell["spp"]): [] for cell in results.cells.values() if cell["recipe"]["pictured"]}
    for cell in results.cells.values():
        if cell["recipe"]["pictured"]:
            pictured[cell["scene"], cell["spp"]].append(cell["variant"])
    write_page(asked.output / "index.html", "quality", CONTENT, {
        "titles": {variant.name: variant.title for variant in results.variants} | {"reference": "reference"},
        "books": [{"title": f"{scene}, {spp} spp", "variants": _book(asked.output / "pictures" / f"{scene}.{spp}", variants)}
                  for (scene, spp), variants in pictured.items()],
        "sections": sections,
        "plots": [{"title": title, "uri": file_uri(path)} for title, path in plots.items()],
        "measured": asked.measured,
        "reference_spp": asked.reference_spp,
    })
