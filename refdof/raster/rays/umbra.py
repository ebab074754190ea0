"""Umbra peeling: of all surfaces along a pixel's ray, those that some point of the lens can see past the one before.

1. The nearest surface is kept.
2. It hides everything behind it from the whole lens, as far as its umbra reaches   `umbra_step`
3. The nearest surface beyond the umbra is kept, and so on                          `survivors`

A blocker of half size s at depth d hides the cone up to d + x with x = d s / (E - s), E the lens radius. With s
proportional to d (a size in pixels), that is a constant step in inverse depth: 1 / d_next = 1 / d - step.

Departures from the paper
-------------------------
- `extent_px` = 2 is the paper's extended umbra, s = one pixel pitch, which reaches the neighbouring pixels' centres;
  1 is the pixel itself, s = half a pitch, where nothing is lost that a lens sees past one pixel.
- "10 layers are always enough" (30 degrees, 1 m to infinity, 9 mm, 600 rows) holds where nothing lies beyond 131.66 m;
  the worst case is 11.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, ACM Transactions on Graphics 29(4).
"""

import math

import numpy as np

from refdof._check import Float, Index, InputError, as_depth, as_instance, as_integer, as_number
from refdof._jit import inline, kernel, prange
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["reach_beyond", "survivors", "umbra_step", "worst_case_layers"]

_LEAST = 2.0**-1023  # depth: below, the inverse is no number


def umbra_step(camera: Camera, lens: ThinLens, extent_px: int = 2) -> float:
    """How far the umbra of a surface reaches, in inverse depth [1 / scene unit]; inf for a pinhole.

    Raises
    ------
    InputError
        If `extent_px` is neither 1 nor 2.
    """
    as_instance("camera", camera, Camera)
    as_instance("lens", lens, ThinLens)
    extent_px = as_integer("extent_px", extent_px, minimum=1, maximum=2)
    if lens.radius == 0.0:
        return math.inf
    return extent_px / (2.0 * camera.pixels_per_tangent * lens.radius * lens.aperture.reach)


def survivors(depth: Float, camera: Camera, lens: ThinLens, extent_px: int = 2) -> Index:
    """Which layers umbra peeling keeps.

    Parameters
    ----------
    depth : (N, H, W)
        All surfaces, front to back [scene units], > 0; inf is empty.
    camera, lens, extent_px
        Give the umbra.

    Returns
    -------
    (M, H, W) int32
        Indices into the first axis of `depth`, -1 where nothing is left; M as many as the deepest pixel needs.

    Raises
    ------
    InputError
        If a depth is NaN or not above 0, or layers are not ordered front to back.
    """
    depth = as_depth(depth, (None, None, None), dtype=np.float64)
    if (depth[1:] < depth[:-1]).any():
        raise InputError("depth: layers are not ordered; allowed is front to back along the first axis")
    kept, count = _keep(depth, umbra_step(camera, lens, extent_px))
    return kept[: int(count.max(initial=0))]


def worst_case_layers(camera: Camera, lens: ThinLens, near: float, far: float = math.inf, extent_px: int = 2) -> int:
    """The most layers that any scene between `near` and `far` [scene units] can need."""
    near = as_number("near", near, above=0.0)
    far = as_number("far", far, minimum=near, finite=False)
    step = umbra_step(camera, lens, extent_px)
    if math.isinf(step):
        return 1
    layers = (1.0 / near - 1.0 / far) / step if 1.0 / near < math.inf else math.inf
    if math.isinf(layers):
        raise InputError(f"near: got {near:g}; allowed are depths that need a finite number of layers")
    return max(1, math.ceil((1.0 / near - 1.0 / far) / step))


@kernel
def _keep(depth, step):
    """Indices (N, H, W) int32 of the layers kept at every pixel, -1 beyond them, and their count (H, W)."""
    layers, height, width = depth.shape
    kept = np.full(depth.shape, np.int32(-1), dtype=np.int32)
    count = np.zeros((height, width), dtype=np.int64)
    for y in prange(height):
        for x in range(width):
            reach = np.inf  # inverse depth: the next surface must lie beyond it
            for k in range(layers):
                nearness = 1.0 / max(depth[k, y, x], _LEAST)
                if nearness > 0.0 and nearness < reach:
                    kept[count[y, x], y, x] = k
                    count[y, x] += 1
                    reach = reach_beyond(nearness, step)
    return kept, count


@inline
def reach_beyond(nearness, step):
    """The inverse depth below which the next surface is seen past one at `nearness`: x = d s / (E - s) of [1]."""
    return nearness - step
