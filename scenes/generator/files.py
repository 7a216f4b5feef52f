"""Writers whose bytes depend on the data alone: indexed PNG and OBJ by hand, EXR through OpenImageIO."""

import struct
import zlib
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio


def write_indexed_png(path, indices, palette):
    """indices: (h, w) integers below 16; palette: (n, 3) in [0, 255]. Four bits a pixel keep the textures small."""
    height, width = indices.shape
    assert width % 2 == 0 and indices.max() < len(palette) <= 16
    packed = (indices[:, 0::2].astype(np.uint8) << 4) | indices[:, 1::2].astype(np.uint8)
    rows = np.concatenate([np.zeros((height, 1), np.uint8), packed], axis=1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 4, 3, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", header))
        file.write(chunk(b"PLTE", np.asarray(palette, np.uint8).tobytes()))
        file.write(chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)))
        file.write(chunk(b"IEND", b""))


def write_exr(path, image):
    """image: (h, w, 3), linear; written as half."""
    height, width, channels = image.shape
    spec = oiio.ImageSpec(width, height, channels, "half")
    spec["compression"] = "piz"
    spec["DateTime"] = "1970:01:01 00:00:00"  # otherwise the time of writing, and other bytes every time
    output = oiio.ImageOutput.create(str(path))
    if not output or not output.open(str(path), spec):
        raise OSError(f"{path}: {oiio.geterror()}")
    output.write_image(np.ascontiguousarray(image, np.float32))
    output.close()


def few_bits(image):
    """Rounds to 5 bits of mantissa: steps of 3% are below what shading shows, and the file shrinks to a third."""
    mantissa, exponent = np.frexp(image)
    return np.ldexp((mantissa * 64).round() / 64, exponent)


def write_obj(path, mesh):
    """Three decimals: a millimetre where the scene unit is a metre."""
    if mesh.uvs is None and mesh.normals is None:
        mesh = _welded(mesh)
    lines = [f"v {x:.3f} {y:.3f} {z:.3f}" for x, y, z in mesh.positions]
    if mesh.uvs is not None:
        lines += [f"vt {u:.3f} {v:.3f}" for u, v in mesh.uvs]
    if mesh.normals is not None:
        lines += [f"vn {x:.3f} {y:.3f} {z:.3f}" for x, y, z in mesh.normals]

    def corner(index):
        uv = str(index + 1) if mesh.uvs is not None else ""
        if mesh.normals is not None:
            return f"{index + 1}/{uv}/{index + 1}"
        return f"{index + 1}/{uv}" if uv else str(index + 1)

    lines += ["f " + " ".join(corner(i) for i in face) for face in mesh.faces]
    with open(path, "w", encoding="ascii", newline="\n") as file:
        # "-0.000" and "0.000" are one number; which of them rounding gives may differ between machines.
        file.write("\n".join(lines).replace("-0.000", "0.000") + "\n")


def _welded(mesh):
    positions, index = np.unique(mesh.positions.round(3) + 0.0, axis=0, return_inverse=True)
    return replace(mesh, positions=positions, faces=[tuple(index[i] for i in face) for face in mesh.faces])
