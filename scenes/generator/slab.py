"""The lamp above the slab."""

from .mesh import lathe


def spotlight():
    """A housing that is open downward; the light comes from the origin."""
    outside = [[(0.10, -0.12), (0.10, 0.16)], [(0.10, 0.16), (0.085, 0.21), (0.0, 0.23)]]
    inside = [[(0.0, 0.05), (0.09, 0.05)], [(0.09, 0.05), (0.09, -0.12)], [(0.09, -0.12), (0.10, -0.12)]]
    return lathe(outside + inside, 28)


MESHES = {"spotlight": spotlight}
