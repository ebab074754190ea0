"""Fields: a stack of layers as height fields, rays through it, and which layers a pixel's rays can meet.

Heights are circles of confusion. N-buffers of them [1] tell a pixel the layers that hold nothing within its reach.

References
----------
.. [1] Decoret (2005), N-Buffers for efficient depth map query, Computer Graphics Forum 24(3).
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof.raster.filters.n_buffer import lowest_in, n_buffer

__all__ = ["Fields", "Ray", "Search", "Visit", "borrow_fields", "extent_in", "fields_of", "visit"]

_BLOCK = 4  # [px] of the N-buffers: windows grow by up to 3 px, memory shrinks sixteenfold


class Fields(NamedTuple):
    """K height fields for kernels.

    coc (K, H, W) [px], inf: empty; near, far (K,) [px]; reach (K,) int64: how far a ray strays from its pixel [px];
    lowest (K, levels, h, w): N-buffers of the heights.
    """

    coc: Float
    near: Float
    far: Float
    reach: Index
    lowest: Float


class Search(NamedTuple):
    """How to search: whether to begin in the middle of a layer; steps of false position and of bisection; highest wall
    that is surface [px]; whether to walk over every texel instead; whether to cull; whether rays that leave the image
    are dropped (else the image's border goes on); whether a layer that the ray leaves over an empty texel counts as
    met, at its far end.
    """

    middle: bool
    steps: int
    bisections: int
    wall: float
    march: bool
    culling: bool
    discard: bool
    holes: bool = False


class Ray(NamedTuple):
    """The ray of a pixel with centre (px, py) [px] through lens point (vx, vy): (px - c vx, py + c vy) at c."""

    px: float
    py: float
    vx: float
    vy: float


class Visit(NamedTuple):
    """What the rays of a pixel can meet: the first `length` of layers (K,), front to back.

    `border`: rays that leave the image are dropped. A layer that holds nothing within their reach drops none: it is
    left out, or without culling noted as ~k.
    """

    layers: Index
    length: int
    border: bool


def fields_of(coc: Float, near: Float, far: Float, largest: float, widening: float = 0.0, wall: float = 1.0) -> Fields:
    """Prepare heights (K, H, W) for lens points up to `largest` from the middle of the unit lens disc.

    Rays read up to `widening` times the circle of confusion beside them. Walls are at most `wall` high.
    """
    end = far.astype(np.float64) + (wall if wall < np.inf else 0.0)
    extent = np.ceil(np.maximum(np.abs(near.astype(np.float64)), np.abs(end)) * (largest + widening))
    reach = np.minimum(extent, max(coc.shape[1:])).astype(np.int64) + 1
    window = 2 * int(reach.max(initial=0)) + 1
    levels = [n_buffer(layer, extremes="min", largest=window, block=_BLOCK).lowest for layer in coc]
    lowest = np.stack(levels) if levels else np.zeros((0, 1, 1, 1), dtype=coc.dtype)
    return Fields(coc, near.astype(coc.dtype), far.astype(coc.dtype), reach, lowest)


@inline
def borrow_fields(fields):
    """`Fields` whose arrays are borrowed."""
    return Fields(
        borrow(fields.coc), borrow(fields.near), borrow(fields.far), borrow(fields.reach), borrow(fields.lowest)
    )


@inline
def visit(fields, x, y, search, layers):
    """The `Visit` of pixel (x, y); layers (K,) is its memory."""
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    count, border = 0, False
    for k in range(len(fields.coc)):
        r = fields.reach[k]
        outside = search.discard and (x < r or y < r or x + r >= width or y + r >= height)
        x0, x1, y0, y1 = max(x - r, 0), min(x + r, width - 1), max(y - r, 0), min(y + r, height - 1)
        empty = (search.culling or outside) and lowest_in(fields.lowest[k], _BLOCK, x0, y0, x1, y1, False) == np.inf
        border = border or (outside and not empty)
        if not (search.culling and empty):
            layers[count] = ~k if empty else k
            count += 1
    return Visit(layers, count, border)


@inline
def extent_in(fields, k, ray):
    """Left, top, right and bottom end [px] of the part of a ray in layer k."""
    near, far = fields.near[k], fields.far[k]
    x0, x1, y0, y1 = ray.px - near * ray.vx, ray.px - far * ray.vx, ray.py + near * ray.vy, ray.py + far * ray.vy
    return min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)
