"""Runs a program and measures it by /usr/bin/time, whose own memory is too small to count as the program's peak."""

import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

TIME = "/usr/bin/time"


@dataclass(frozen=True)
class Cost:
    wall_s: float
    processor_s: float
    peak_mib: float


def timed(command, **options):
    """The process as subprocess.run returns it with these options, and its Cost. Raises CalledProcessError if it fails, unless check=False."""
    if not Path(TIME).exists():
        raise OSError(f"{TIME} is not there: it is in Debian's package time")
    with tempfile.NamedTemporaryFile("r") as file:
        run = subprocess.run([TIME, "-o", file.name, "-f", "%e %U %S %M", *map(str, command)], **{"check": True} | options)
        wall, user, system, kib = map(float, file.read().split()[-4:])  # the line before them tells a failure
    return run, Cost(wall, user + system, kib / 1024)
