"""Uncompressed DNG files of one mosaic, as small as they can be."""

import struct

import numpy as np

BYTE, ASCII, SHORT, LONG, RATIONAL, SRATIONAL = 1, 2, 3, 4, 5, 10
FORMATS = {BYTE: "B", SHORT: "H", LONG: "I", RATIONAL: "II", SRATIONAL: "ii"}


def rationals(values):
    return [part for value in values for part in (round(value * 1e6), 1_000_000)]


def packed(kind, values):
    return values if kind == ASCII else struct.pack("<" + FORMATS[kind][0] * len(values), *values)


def directory(tags, at):
    """The bytes of a directory at this place in the file, its values behind it."""
    entries, data = struct.pack("<H", len(tags)), b""
    behind = at + 2 + 12 * len(tags) + 4
    for tag, kind, values in tags:
        value = packed(kind, values)
        entries += struct.pack("<HHI", tag, kind, len(values) // len(FORMATS.get(kind, "B")))
        if len(value) <= 4:
            entries += value.ljust(4, b"\0")
        else:
            entries += struct.pack("<I", behind + len(data))
            data += value.ljust((len(value) + 3) // 4 * 4, b"\0")
    return entries + struct.pack("<I", 0) + data


def write(path, mosaic, *, cfa, black, white, neutral, color_matrix, iso, shutter_s, model="camera"):
    """`mosaic`: uint16. `cfa`: the pattern as a square array of 0 red, 1 green, 2 blue."""
    height, width = mosaic.shape

    def tags(exif_at, pixels_at):
        return [
            (254, LONG, [0]), (256, LONG, [width]), (257, LONG, [height]), (258, SHORT, [16]), (259, SHORT, [1]),
            (262, SHORT, [32803]), (271, ASCII, b"becalm\0"), (272, ASCII, model.encode() + b"\0"),
            (273, LONG, [pixels_at]), (274, SHORT, [1]), (277, SHORT, [1]), (278, LONG, [height]),
            (279, LONG, [2 * mosaic.size]), (33421, SHORT, list(cfa.shape)), (33422, BYTE, cfa.ravel().tolist()),
            (34665, LONG, [exif_at]), (50706, BYTE, [1, 4, 0, 0]), (50708, ASCII, model.encode() + b"\0"),
            (50714, SHORT, [black]), (50717, LONG, [white]),
            (50721, SRATIONAL, rationals(np.ravel(color_matrix))), (50728, RATIONAL, rationals(neutral)),
            (50778, SHORT, [21]),
        ]

    exif_at = 8 + len(directory(tags(0, 0), 8))
    exif = directory([(33434, RATIONAL, rationals([shutter_s])), (34855, SHORT, [iso])], exif_at)
    head = struct.pack("<2sHI", b"II", 42, 8) + directory(tags(exif_at, exif_at + len(exif)), 8) + exif
    path.write_bytes(head + mosaic.astype("<u2").tobytes())
