"""Runs of becalm that the page of other uses shows, and what the page needs of each use."""

import shlex
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pictures.colours import display_like
from pictures.files import jpeg_uri


@dataclass
class Use:
    """A section of the page."""
    name: str
    title: str
    text: str
    frames: list
    pictures: dict  # colours of each frame, by name
    left: str  # the pictures that are shown first
    right: str
    measured: str  # what the table holds
    table: list  # rows of cells, the first one the head
    commands: list

    def as_data(self):
        height, width, _ = next(iter(self.pictures.values()))[0].shape
        uris = {name: [jpeg_uri(colours) for colours in frames] for name, frames in self.pictures.items()}
        return vars(self) | {"pictures": uris, "size": [width, height]}


@dataclass
class Runs:
    """The program, a folder for files, and the commands that a reader may copy."""
    becalm: str
    folder: Path
    shown: list = field(default_factory=list)

    def run(self, *words):
        command = [str(word) for word in (self.becalm, *words, "--overwrite")]
        self.shown.append(shlex.join(command))
        print(f"== {self.shown[-1]}", flush=True)
        subprocess.run([*command, "--quiet"], check=True)


def displayed(images, reference):
    """Colours of frames, all with the exposure of the reference's first one."""
    return [display_like(image, reference[0]) for image in images]


def enlarged(image, size):
    """Each pixel repeated, to another (width, height)."""
    width, height = size
    rows, columns = (np.arange(side) * have // side for side, have in zip((height, width), image.shape))
    return image[rows][:, columns]
