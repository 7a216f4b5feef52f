"""becalm's aligner: a bench_align process that takes commands and raw files, and stays alive between runs."""

import contextlib
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

THREADS = 2  # of OpenCV and of the software device, whose number LP_NUM_THREADS overrides


class AlignError(Exception):
    pass


class Aligner:
    """One aligner, built for one size and one set of settings."""

    def __init__(self, bench_align, size, settings, *, preset="final", input="frames", aovs=(), alias=True, device=None):
        self.process = subprocess.Popen([bench_align, *([device] if device else [])], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True,
                                        env={"LP_NUM_THREADS": str(THREADS)} | os.environ)
        self.folder = tempfile.TemporaryDirectory()
        self.size, self.aovs, self.input = size, list(aovs), input
        try:
            self.device = self.command(do="device")
            self.built = self.command(do="build", input=input, width=size[0], height=size[1], preset=preset,
                                      set=list(settings), aovs=self.aovs, alias=alias)
        except AlignError:
            self.close()
            raise

    def command(self, **command):
        try:
            self.process.stdin.write(json.dumps(command) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # the process ended and gave the reason on standard error
        line = self.process.stdout.readline()
        if not line:
            raise AlignError(f"bench_align ended with status {self.process.wait()}")
        answer = json.loads(line)
        if "error" in answer:
            raise AlignError(f"bench_align: {command['do']}: {answer['error']}")
        return answer

    def _file(self, name):
        return Path(self.folder.name) / name

    def load(self, target, source):
        """Layers of both frames by name; an aligner of input "plane" takes the layer "plane" only."""
        files = {}
        for side, layers in (("target", target), ("source", source)):
            files[side] = {}
            for name in ["plane"] if self.input == "plane" else ["beauty", *self.aovs]:
                files[side][name] = str(self._file(f"{side}.{name}"))
                np.ascontiguousarray(layers[name], "<f4").tofile(files[side][name])
        self.command(do="load", **files)

    def run(self, times=1):
        return self.command(do="run", times=times)

    def result(self):
        """Offsets (height, width, 2) and the finest level's residual of the last run."""
        paths = {name: str(self._file(name)) for name in ("offset", "residual")}
        self.command(do="save", **paths)
        width, height = self.size
        columns, rows = self.built["levels"][0]
        return (np.fromfile(paths["offset"], "<f4").reshape(height, width, 2),
                np.fromfile(paths["residual"], "<f4").reshape(rows, columns))

    def close(self):
        with contextlib.suppress(BrokenPipeError):  # the process ended and left a command unread
            self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.folder.cleanup()


class Aligners:
    """Aligners, each built once for a size, settings and options."""

    def __init__(self, bench_align, device=None):
        self.bench_align, self.device, self.built = bench_align, device, {}

    def get(self, size, settings, **options):
        key = (tuple(size), tuple(settings), tuple(sorted((k, tuple(v) if isinstance(v, list) else v)
                                                          for k, v in options.items())))
        if key not in self.built:
            self.built[key] = Aligner(self.bench_align, size, settings, device=self.device, **options)
        return self.built[key]

    def close(self):
        for aligner in self.built.values():
            aligner.close()
        self.built.clear()
