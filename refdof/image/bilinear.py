"""Bilinear reads: the texels around a place, weights, and the blend of four texels."""

import numpy as np

from refdof._jit import inline
from refdof._jit.texel_registers import blend_to
from refdof._jit.texel_sums import add_blend, add_blend_twice

__all__ = ["add_read", "add_read_twice", "bilinear", "first_of_two", "four_around", "read_to", "texels_around"]


@inline
def texels_around(place, size):
    """The two texels around `place` [texels from the corner], cut at the border, and the second's weight."""
    centred = min(max(place - type(place)(0.5), type(place)(0)), type(place)(size - 1))
    first = int(centred)
    return first, min(first + 1, size - 1), centred - type(place)(first)


@inline
def first_of_two(place, size):
    """The first of `texels_around`, int32, and the second's weight, in steps that vectorise."""
    centred = min(max(place - type(place)(0.5), type(place)(0)), type(place)(np.int32(size - 1)))
    first = np.floor(centred)
    return np.int32(first), centred - first


@inline
def four_around(start, width, height, column, row):
    """The four texels from (column, row) on of a level that begins at `start`; beyond the last, the last count.

    All are integers of the type of `column`: Numba's sums of two int32 would be int64, which vectorise half as wide.
    """
    whole, one, none = type(column), type(column)(1), type(column)(0)
    upper = whole(start + whole(width * row))
    lower = whole(upper + (whole(width) if row < whole(height - one) else none))
    right = whole(column + (one if column < whole(width - one) else none))
    return whole(upper + column), whole(upper + right), whole(lower + column), whole(lower + right)


@inline
def bilinear(p, q, r, s, wx, wy):
    """Blend p and q, and r and s below them, by wx, and then those two by wy."""
    a, b = p + (q - p) * wx, r + (s - r) * wx
    return a + (b - a) * wy


@inline
def add_read(texels, size, u, v, weight, sums, k):
    """Add to row k of sums (K, 4) a picture (H W, 4) of `size` (H, W), read at (u, v) [texels from the corner]."""
    a, b, c, d, across, down = _places(size, u, v)
    add_blend(sums, k, weight, texels, a, b, c, d, across, down)


@inline
def add_read_twice(texels, size, u, v, weights, sums, k):
    """The same to rows k and k + 1, with a weight of its own each."""
    a, b, c, d, across, down = _places(size, u, v)
    add_blend_twice(sums, k, weights, texels, a, b, c, d, across, down)


@inline
def read_to(texels, size, u, v, out, k):
    """Set row k of out (K, 4) to a picture (H W, 4) of `size` (H, W), read at (u, v) [texels from the corner]."""
    a, b, c, d, across, down = _places(size, u, v)
    blend_to(texels, a, b, c, d, across, down, out, k)


@inline
def _places(size, u, v):
    column, across = first_of_two(u, size[1])
    row, down = first_of_two(v, size[0])
    a, b, c, d = four_around(np.int64(0), np.int64(size[1]), np.int64(size[0]), np.int64(column), np.int64(row))
    return a, b, c, d, across, down
