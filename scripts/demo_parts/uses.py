"""The page of the aligner's other uses, with sliders. Called by `scripts/demo uses`."""

import shutil
import sys
import time
from pathlib import Path

from demo_parts.use_antialias import antialias, upsample
from demo_parts.use_burst import burst
from demo_parts.use_runs import Runs
from demo_parts.use_stereo import stereo
from pictures.page import write_page

CONTENT = Path(__file__).with_name("uses.html")
USES = (antialias, upsample, stereo, burst)


def write_uses(path, uses):
    write_page(path, "other uses", CONTENT, {"uses": [use.as_data() for use in uses]})


def main():
    becalm, out = sys.argv[1], Path(sys.argv[2])
    started = time.monotonic()
    folder = out / "uses"
    shutil.rmtree(folder, ignore_errors=True)  # frames that are there would not be rendered again
    uses = [use(Runs(becalm, folder / use.__name__)) for use in USES]
    write_uses(out / "uses.html", uses)
    for use in uses:
        print(f"\n{use.title}. {use.measured}:")
        for row in use.table:
            print("  " + "  ".join(f"{cell:>18}" for cell in row))
    print(f"\n{time.monotonic() - started:.0f} s after the build\n{out / 'uses.html'}")


if __name__ == "__main__":
    main()
