"""Bilinear reads: the texels around a place, weights, and the blend of four texels."""

import numpy as np

from refdof._jit import inline

__all__ = ["bilinear", "first_of_two", "four_around", "texels_around"]


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
    """The four texels from (column, row) on of a level that begins at `start`; beyond the last, the last count."""
    upper = start + width * row
    lower = upper + (width if row + 1 < height else 0)
    right = column + (1 if column + 1 < width else 0)
    return upper + column, upper + right, lower + column, lower + right


@inline
def bilinear(p, q, r, s, wx, wy):
    """Blend p and q, and r and s below them, by wx, and then those two by wy."""
    a, b = p + (q - p) * wx, r + (s - r) * wx
    return a + (b - a) * wy
