"""Footprint: the part of the picture under all rays of a pixel, and the range of inverse depths in which they can hit.

1. bound the rays' places between two depths                       `thin_lens_bounds`, `ray_bounds`
2. look up the nearest and the farthest surface in those bounds    `refdof.raster.filters.n_buffer`
3. cut the rays to that range, and begin again                     `narrow`

Rays are those of `refdof.methods.lensblur.texel_walk`: affine in u, inverse depth in pixels of parallax. Every cut
keeps all that the rays can hit if the bounds hold all rays: `narrow` changes the work, not the picture.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
.. [2] Potmesil & Chakravarty (1981), A Lens and Aperture Camera Model for Synthetic Image Generation.
"""

import math

import numpy as np

from refdof._jit import inline
from refdof.raster.filters.n_buffer import highest_in, lowest_in

__all__ = ["narrow", "ray_bounds", "thin_lens_bounds"]

_MARGIN = 0.01  # px: the walk may round a ray's place across a texel's border


@inline
def narrow(stack, group, rays, stride, center, near, far, iterations):
    """Cut [far, near] to where the rays of one pixel can hit a group of layers: near and far, near < far if nowhere.

    stack is a `refdof.methods.lensblur.layer_trace.Stack` with N-buffers of u. rays (4, N) are ax, ay, wx, wy. stride 0
    takes the closed form of a thin lens, center = (x, y, u of the focal plane); else every stride-th ray is bounded.
    """
    lowest, highest, block = stack.lowest[group], stack.highest[group], stack.block
    height, width, scalar = stack.packs.shape[1], stack.packs.shape[2], lowest.dtype.type
    for _ in range(iterations):
        if stride == 0:
            x0, y0, x1, y1 = thin_lens_bounds(center[0], center[1], center[2], near, far)
        else:
            x0, y0, x1, y1 = ray_bounds(rays, stride, near, far)
        left, top = _texel(x0 - scalar(_MARGIN), width), _texel(y0 - scalar(_MARGIN), height)
        right, bottom = _texel(x1 + scalar(_MARGIN), width), _texel(y1 + scalar(_MARGIN), height)
        low = lowest_in(lowest, block, left, top, right, bottom, False)
        high = highest_in(highest, block, left, top, right, bottom, False)
        if low > high:
            return scalar(-1.0), scalar(0.0)
        new_far, new_near = max(far, low - stack.extension), min(near, high)
        if new_far == far and new_near == near:
            break
        far, near = new_far, new_near
    return near, far


@inline
def _texel(place, size):
    """The texel of a place along one axis, in the picture."""
    scalar = type(place)
    return math.floor(min(max(place, scalar(0.0)), scalar(size - 1)))


@inline
def thin_lens_bounds(x, y, focus, near, far):
    """Bounds x0, y0, x1, y1 [px] of a thin lens's rays: the larger of the circles of confusion at both ends, [2].

    (x, y) is the pixel's centre, focus the u of the focal plane; a circle's radius is |u - focus| pixels.
    """
    radius = max(abs(near - focus), abs(far - focus))
    return x - radius, y - radius, x + radius, y + radius


@inline
def ray_bounds(rays, stride, near, far):
    """Bounding quad x0, y0, x1, y1 [px] of where every stride-th of the rays (4, N) crosses both depths."""
    scalar = rays.dtype.type
    x0, y0, x1, y1 = scalar(np.inf), scalar(np.inf), scalar(-np.inf), scalar(-np.inf)
    for n in range(0, rays.shape[1], stride):
        ax, ay, wx, wy = rays[0, n], rays[1, n], rays[2, n], rays[3, n]
        first, second = ax + near * wx, ax + far * wx
        x0, x1 = min(x0, first, second), max(x1, first, second)
        first, second = ay + near * wy, ay + far * wy
        y0, y1 = min(y0, first, second), max(y1, first, second)
    return x0, y0, x1, y1
