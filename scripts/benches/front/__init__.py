"""The parts of `scripts/bench front`. Importing one ends with a clear message if a Python module is missing that they need."""

import importlib.util
import sys

PACKAGES = {"cv2": "python3-opencv", "matplotlib": "python3-matplotlib", "numpy": "python3-numpy", "OpenImageIO": "python3-openimageio"}

_missing = [f"{module} (Debian's {package})" for module, package in PACKAGES.items() if importlib.util.find_spec(module) is None]
if _missing:
    sys.exit(f"bench front: {sys.executable} has no module {', '.join(_missing)}")
