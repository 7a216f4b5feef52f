"""A camera that photographs frames rendered by becalm: hand shake, a thing that moves, a mosaic of colour filters, shot and read
noise, black and white level, 14 bits. Everything but the noise is known exactly, of every sample."""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio

from benches.burst import dng

BAYER = np.array([[0, 1], [1, 2]], np.uint8)
X_TRANS = np.array([[1, 0, 1, 1, 2, 1], [2, 1, 2, 0, 1, 0], [1, 0, 1, 1, 2, 1],
                    [1, 2, 1, 1, 0, 1], [0, 1, 0, 2, 1, 2], [1, 2, 1, 1, 0, 1]], np.uint8)
MOSAICS = {"bayer": BAYER, "xtrans": X_TRANS}

OVERSAMPLED = 2  # pixels of the render a side of one of the sensor
MARGIN = 24  # pixels of the sensor that shake may reach
BLACK, WHITE = 1024, 16383
NEUTRAL = np.array([0.5, 1.0, 0.62])  # of white light, in the camera's colours
# Of a common camera: linear Rec. 709 to its white-balanced colours. Rows add up to 1.
FROM_REC709 = np.array([[0.70, 0.24, 0.06], [0.13, 0.78, 0.09], [0.05, 0.22, 0.73]])
TO_REC709 = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]])
COLOR_MATRIX = np.diag(NEUTRAL) @ FROM_REC709 @ TO_REC709
ELECTRONS = 50_000  # at white, ISO 100
READ_NOISE_E, CONVERTER_NOISE = 2.5, 1.5 / (WHITE - BLACK)


@dataclass
class Burst:
    """Noise-free mosaics of one burst, the first of which is the reference."""
    mosaics: list
    cfa: np.ndarray
    picture: np.ndarray  # of the reference, linear Rec. 709
    swept: np.ndarray  # where the thing that moves is in one of the frames
    outside: np.ndarray = field(default=None)  # neither swept, nor at the border, nor saturated


def scene(path):
    """A render in the camera's colours, light balanced, exposed so that 1 % of it is above 0.8."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[..., :3].clip(0, None)
    exposure = 0.8 / np.percentile(pixels[..., 1], 99)
    return (pixels * exposure).astype(np.float32)


def disc(picture, centre, radius):
    """Pastes a disc with another part of the picture as its texture; returns its coverage."""
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
    coverage = np.clip(radius + 0.5 - np.hypot(x - centre[0], y - centre[1]), 0, 1).astype(np.float32)[..., None]
    source = picture[::-1, ::-1]
    # The texture moves with the disc.
    shift = np.float32([[1, 0, centre[0] - picture.shape[1] / 2], [0, 1, centre[1] - picture.shape[0] / 2]])
    texture = cv2.warpAffine(source, shift, picture.shape[1::-1], flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
    picture += coverage * (0.7 * texture + 0.12 - picture)
    return coverage[..., 0]


def photographed(scene_pixels, mosaic, frames, seed, moving=True):
    """A burst of a scene: `frames` exposures at random places of a shaking hand."""
    random = np.random.default_rng(seed)
    cfa = MOSAICS[mosaic]
    height, width = scene_pixels.shape[:2]
    size = [(side // OVERSAMPLED - 2 * MARGIN) // 6 * 6 for side in (height, width)]
    shift = np.zeros(2)
    mosaics, picture, swept = [], None, np.zeros(size, bool)
    for number in range(frames):
        angle = 0.0 if number == 0 else np.radians(random.normal(0, 0.12))
        if number > 0:  # a random walk that leads back
            shift = 0.8 * shift + random.normal(0, 3.0, 2)
        shift = shift.clip(-MARGIN / 2, MARGIN / 2)
        moved = scene_pixels.copy()
        coverage = np.zeros(moved.shape[:2], np.float32)
        if moving:
            along = 0.25 + 0.5 * number / 12
            coverage = disc(moved, (width * along, height * (0.62 - 0.2 * along)), height / 9)
        cos, sin = np.cos(angle), np.sin(angle)
        middle = np.array([width, height]) / 2
        turn = np.array([[cos, -sin], [sin, cos]])
        place = middle - turn @ middle + shift * OVERSAMPLED
        warp = np.hstack([turn, place[:, None]])
        seen = cv2.warpAffine(moved, warp, (width, height), flags=cv2.INTER_LANCZOS4 | cv2.WARP_INVERSE_MAP,
                              borderMode=cv2.BORDER_REFLECT) if number > 0 else moved

        def cut(image):
            small = cv2.resize(image, (width // OVERSAMPLED, height // OVERSAMPLED), interpolation=cv2.INTER_AREA)
            return small[MARGIN : MARGIN + size[0], MARGIN : MARGIN + size[1]]

        rgb = cut(seen).clip(0, None)
        swept |= cut(coverage) > 0
        camera = np.einsum("ij,yxj->yxi", FROM_REC709, rgb) * NEUTRAL
        colors = np.tile(cfa, (size[0] // len(cfa) + 1, size[1] // len(cfa) + 1))[: size[0], : size[1]]
        mosaics.append(np.take_along_axis(camera, colors[..., None].astype(int), 2)[..., 0].clip(0, 1))
        picture = rgb if number == 0 else picture
    swept = cv2.dilate(swept.astype(np.uint8), np.ones((9, 9))) > 0
    border = np.ones(size, bool)
    border[MARGIN:-MARGIN, MARGIN:-MARGIN] = False
    saturated = cv2.dilate((mosaics[0] > 0.95).astype(np.uint8), np.ones((9, 9))) > 0
    return Burst(mosaics, cfa, picture, swept & ~border & ~saturated, ~(swept | border | saturated))


def noisy(mosaic, iso, random):
    electrons = ELECTRONS * 100 / iso
    value = (random.poisson(mosaic * electrons) + random.normal(0, READ_NOISE_E, mosaic.shape)) / electrons
    value += random.normal(0, CONVERTER_NOISE, mosaic.shape)
    return np.rint(BLACK + value * (WHITE - BLACK)).clip(0, WHITE).astype(np.uint16)


def write(folder, burst, iso, seed):
    """DNG files of a burst; returns their paths."""
    random = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, mosaic in enumerate(burst.mosaics):
        paths.append(Path(folder) / f"{number:02}.dng")
        dng.write(paths[-1], noisy(mosaic, iso, random), cfa=burst.cfa, black=BLACK, white=WHITE, neutral=NEUTRAL,
                  color_matrix=COLOR_MATRIX, iso=iso, shutter_s=1 / 60)
    return paths


def samples_of(path):
    """Samples of a DNG file of `write`: 0 black, 1 white."""
    data = Path(path).read_bytes()
    height, width = (int.from_bytes(data[at : at + 4], "little") for at in (8 + 2 + 12 * 2 + 8, 8 + 2 + 12 + 8))
    pixels = np.frombuffer(data[-2 * width * height :], "<u2").reshape(height, width)
    return (pixels.astype(np.float64) - BLACK) / (WHITE - BLACK)
