"""Combine: the blurred picture, of half the size, over the sharp one, tile by tile."""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange

__all__ = ["BLURRED_ALONE", "NOT_BLURRED", "OVER", "combined"]

NOT_BLURRED, OVER, BLURRED_ALONE = 0, 1, 2


@kernel
def combined(color, soft, tiles, side):
    """Color (H, W, 3), soft (h, w, 4) of premultiplied colours and alpha, tiles of `side` pixels: what each does.

    A pixel lies a quarter of a texel of half the size from the nearest one's centre, towards one of its neighbours.
    """
    height, width = color.shape[:2]
    rows, columns = soft.shape[:2]
    out = np.empty_like(color)
    for y in prange(height):
        line = np.empty(4 * (columns + 2), dtype=color.dtype)
        upper, lower = max((y + 1) // 2 - 1, 0), min((y + 1) // 2, rows - 1)
        _between(borrow(soft)[upper], borrow(soft)[lower], y, line)
        row, sharp, blurred, sorts = borrow(out)[y], borrow(color)[y], borrow(line), borrow(tiles)[y // side]
        for tile in range(len(sorts)):
            begin, end = side * tile, min(side * (tile + 1), width)
            if sorts[tile] == NOT_BLURRED:
                for x in range(begin, end):
                    for c in range(3):
                        row[x, c] = sharp[x, c]
            else:
                _lay(blurred, sorts[tile] == OVER, begin, end, sharp, row)
    return out


@inline
def _between(upper, lower, y, out):
    """What row y reads between two rows of texels (w, 4): out (4 (w + 2)), whose ends are repeated."""
    columns, weight = len(upper), _second(y, out.dtype.type)
    for x in range(columns):
        for c in range(4):
            out[4 * (x + 1) + c] = upper[x, c] + (lower[x, c] - upper[x, c]) * weight
    for c in range(4):
        out[c], out[4 * (columns + 1) + c] = out[4 + c], out[4 * columns + c]


@inline
def _lay(blurred, over, begin, end, sharp, row):
    """Lay blurred texels over sharp pixels `begin` .. `end`, or put them there."""
    kind = row.dtype.type
    for x in range(begin, end):
        first, weight = 4 * ((x + 1) // 2), _second(x, kind)
        left, right = blurred[first + 3], blurred[first + 7]
        rest = kind(1) - (left + (right - left) * weight) if over else kind(0)
        for c in range(3):
            left, right = blurred[first + c], blurred[first + 4 + c]
            row[x, c] = left + (right - left) * weight + rest * sharp[x, c]


@inline
def _second(place, kind):
    """The weight of the second of the two texels around a pixel."""
    return kind(0.25) if place % 2 == 1 else kind(0.75)
