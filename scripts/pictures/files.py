"""Pictures from EXR files, and to PNG and JPEG files and data URIs."""

import base64
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio


def read_layers(path):
    """The layers of all parts by name, bare channels of the first part under '', of others under the part's name; of two of one name
    the first. Each is (height, width, channels) in the file's channel order."""
    layers = {}
    part, parts = 0, 1
    while part < parts:
        image = oiio.ImageBuf(str(path), part, 0)
        if image.has_error:
            raise OSError(f"{path}: {image.geterror()}")
        parts = image.nsubimages
        pixels = image.get_pixels(oiio.FLOAT)
        bare = image.spec().getattribute("oiio:subimagename") or f"part {part}" if part > 0 else ""
        of_part = {}
        for index, name in enumerate(image.spec().channelnames):
            of_part.setdefault(name.rpartition(".")[0] or bare, []).append(pixels[..., index])
        layers = {name: np.stack(channels, axis=-1) for name, channels in of_part.items()} | layers
        part += 1
    return layers


def write_picture(path, colours, jpeg_quality=90):
    """Colours in [0,1] as 8 bits; the name's extension chooses the format."""
    height, width, _ = colours.shape
    spec = oiio.ImageSpec(width, height, 3, "uint8")
    spec["CompressionQuality"] = jpeg_quality
    spec["jpeg:subsampling"] = "4:4:4"
    image = oiio.ImageBuf(spec)
    image.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), np.ascontiguousarray(colours, np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def file_uri(path):
    """A JPEG or PNG file as a data URI."""
    kind = {".jpg": "jpeg", ".png": "png"}[path.suffix]
    return f"data:image/{kind};base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def jpeg_uri(colours):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.jpg"
        write_picture(path, colours)
        return file_uri(path)
