"""Errors of stereo pairs against references of which two independent halves are known."""

import cv2
import numpy as np


def squared_error(test, half_a, half_b):
    """The mean of (x - a)(x - b), which the noise of the reference leaves alone, of colours clamped to [0,1]."""
    x, a, b = (np.clip(image, 0, 1) for image in (test, half_a, half_b))
    return float(np.mean((x - a) * (x - b)))


class Reprojection:
    """Where each eye's pixels are seen by the other one, by depth (distances along the rays) and the camera."""

    def __init__(self, depth, camera):
        self.maps = {}
        for eye, sign in (("left", -1), ("right", 1)):
            other = "right" if eye == "left" else "left"
            height, width = depth[eye].shape[:2]
            x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
            z = depth[eye][..., 0] * self._cosine(x, y, eye, width, height, camera)
            there = x + sign * camera["focal_px"] * camera["separation"] * (1 / z - 1 / camera["convergence"])
            expected = z / self._cosine(there, y, other, width, height, camera)
            at = ((there - 0.5).astype(np.float32), (y - 0.5).astype(np.float32))
            found = cv2.remap(np.where(np.isfinite(depth[other][..., 0]), depth[other][..., 0], 1e9).astype(np.float32), *at, cv2.INTER_NEAREST,
                              borderMode=cv2.BORDER_CONSTANT, borderValue=-1)
            expected = np.where(np.isfinite(expected), expected, 1e9)
            self.maps[eye] = at, np.abs(found - expected) <= 0.02 * expected

    @staticmethod
    def _cosine(x, y, eye, width, height, camera):
        focal = camera["focal_px"]
        axis = focal * camera["separation"] / camera["convergence"] * (-0.5 if eye == "left" else 0.5)
        return focal / np.sqrt(focal**2 + (x - 0.5 * width - axis) ** 2 + (y - 0.5 * height) ** 2)

    def warped(self, image_of_other, eye):
        """The other eye's image at the eye's pixels, and where it sees the same surface."""
        at, sees = self.maps[eye]
        return cv2.remap(np.ascontiguousarray(image_of_other, np.float32), *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), sees

    def shrinking(self, eye):
        """The factor by which bilinear reads shrink the variance."""
        part = np.mod(self.maps[eye][0][0], 1)
        return part**2 + (1 - part) ** 2

    def difference(self, images, images_b=None):
        """Mean squared reprojected stereo difference; of two independent pairs the product, which noise leaves alone."""
        total = []
        for eye, other in (("left", "right"), ("right", "left")):
            differences = []
            for pair in (images, images_b or images):
                warped, sees = self.warped(np.clip(pair[other], 0, 1), eye)
                differences.append(np.clip(pair[eye], 0, 1) - warped)
            total.append(np.mean((differences[0] * differences[1])[sees]))
        return float(np.mean(total))
