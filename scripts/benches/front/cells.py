"""Cells of recipes besides those of becalm."""

import time

import numpy as np
import OpenImageIO as oiio

from benches.front.methods import Recipe
from benches.made_of import content_hash, sources_of
from benches.quality.cells import Cells, plain_name, radiance
from benches.quality.data import frame_path
from pictures.files import read_layers


class MissingLayer(Exception):
    pass


class FrontCells(Cells):
    def _options(self, variant):
        if not isinstance(variant, Recipe):
            return super()._options(variant)
        return [content_hash(path) for path in (*sources_of(variant.filter), __file__)]

    def _denoise(self, variant, noisy, denoised):
        if not isinstance(variant, Recipe):
            return super()._denoise(variant, noisy, denoised)
        denoised.parent.mkdir()
        started = time.monotonic(), time.process_time()
        for frame, image in zip(self.data.frames, variant.filter(self._layers(noisy, variant.needs))):
            _write(frame_path(denoised, frame), image)
        count = len(self.data.frames)
        return {"process": (time.monotonic() - started[0]) / count, "processor": (time.process_time() - started[1]) / count}

    def _layers(self, noisy, needs):
        for frame in self.data.frames:
            path = frame_path(noisy, frame)
            layers = {plain_name(name): layer for name, layer in read_layers(path).items()} if needs else {}
            for name in needs:
                if name not in layers:
                    raise MissingLayer(f"the frames have no layer '{name}'")
            yield radiance(path), layers


def _write(path, image):
    height, width, _ = image.shape
    file = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
    file.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), np.ascontiguousarray(image, np.float32))
    if not file.write(str(path)):
        raise OSError(f"{path}: {file.geterror()}")
