"""Combine: the blurred picture, of half the size, over the sharp one, tile by tile.

Row by row, with every channel of the blurred one apart, where loops vectorise.
"""

import numpy as np

from refdof._check import Index
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods.filament.rings import ALIKE
from refdof.raster.filters.tiles import Tiles

__all__ = ["BLURRED_ALONE", "NOT_BLURRED", "OVER", "combined", "sorts_of"]

NOT_BLURRED, OVER, BLURRED_ALONE = 0, 1, 2


def sorts_of(tiles: Tiles) -> Index:
    """What each tile does: the blurred picture is alone where all around is blurred alike, by 2 px at least."""
    least, greatest = tiles
    largest = np.maximum(np.abs(least), np.abs(greatest))
    alone = (greatest - least <= least.dtype.type(ALIKE) * np.abs(greatest)) & (np.abs(least) >= 2)
    return np.where(largest < 1, NOT_BLURRED, np.where(alone, BLURRED_ALONE, OVER))


@kernel
def combined(color, soft, tiles, side):
    """Color (H, W, 3), soft (h, w, 4) of premultiplied colours and alpha, tiles of `side` pixels: what each does.

    Soft is filled up to whole tiles. Where nothing is blurred the sharp picture stays to the bit.
    """
    height, width = color.shape[:2]
    rows, columns = soft.shape[:2]
    out = np.empty_like(color)
    texels, sharp = soft.reshape(rows, 4 * columns), color.reshape(height, 3 * width)
    pixels = out.reshape(height, 3 * width)
    for y in prange(height):
        narrow, wide = np.empty((4, columns + 2), dtype=color.dtype), np.empty((4, 2 * columns), dtype=color.dtype)
        first, second = max((y + 1) // 2 - 1, 0), min((y + 1) // 2, rows - 1)
        down = color.dtype.type(0.25 if y % 2 == 1 else 0.75)
        _between(borrow(texels)[first], borrow(texels)[second], down, borrow(narrow))
        for c in range(4):
            _widen(borrow(narrow)[c], borrow(wide)[c])
        _leave(borrow(tiles)[y // side], side, borrow(wide))
        _lay(borrow(wide), borrow(sharp)[y], borrow(pixels)[y])
    return out


@inline
def _between(upper, lower, weight, out):
    """Blend two rows of texels (4 w): planes (4, w + 2), whose ends are repeated."""
    last = out.shape[1] - 2
    for x in range(last):
        for c in range(4):
            out[c, x + 1] = upper[4 * x + c] + (lower[4 * x + c] - upper[4 * x + c]) * weight
    for c in range(4):
        out[c, 0], out[c, last + 1] = out[c, 1], out[c, last]


@inline
def _widen(texels, out):
    """Pixels (2 w) a quarter of a texel before and after the centre of each, of (w + 2)."""
    before, after = out.dtype.type(0.75), out.dtype.type(0.25)
    for x in range(len(texels) - 2):
        left, here, right = texels[x], texels[x + 1], texels[x + 2]
        out[2 * x] = left + (here - left) * before
        out[2 * x + 1] = here + (right - here) * after


@inline
def _leave(sorts, side, wide):
    """Alpha to how much of the sharp picture is left, by tiles."""
    zero, one = wide.dtype.type(0), wide.dtype.type(1)
    for tile in range(len(sorts)):
        tops, bottom = wide[:, side * tile : side * (tile + 1)], one if sorts[tile] == OVER else zero
        if sorts[tile] == NOT_BLURRED:
            tops[:3], tops[3] = zero, one
        else:
            for x in range(side):
                tops[3, x] = bottom - tops[3, x] * bottom


@inline
def _lay(wide, sharp, out):
    """The sum of blurred pixels (4, W), and of what they leave of a row (3 W)."""
    for x in range(len(out) // 3):
        rest = wide[3, x]
        out[3 * x] = wide[0, x] + rest * sharp[3 * x]
        out[3 * x + 1] = wide[1, x] + rest * sharp[3 * x + 1]
        out[3 * x + 2] = wide[2, x] + rest * sharp[3 * x + 2]
