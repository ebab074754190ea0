"""Half: colour and nearest circle at half the size, their mip levels, tiles, and the noise of the taps."""

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline, kernel, prange
from refdof.raster.filters.tiles import Tiles, tiles_of

__all__ = ["LEVELS", "TILE", "Half", "half_of", "noise"]

LEVELS = 4
TILE = 8  # texels of half the size
_SHAPE = 2 * TILE  # pixels: sides are filled up to whole tiles


class Half(NamedTuple):
    """Levels of colour and circle in one array, (T, 4), each of which begins at `starts` and is `widths` wide.

    After the last one there is a texel more, as `add_reads` asks for.

    tiles : least and greatest circle of tiles and of two rings of tiles around
    """

    texels: Float
    starts: Index
    widths: Index
    heights: Index
    tiles: Tiles

    @property
    def finest(self) -> Float:
        """(h, w, 4)."""
        return self.texels[: self.starts[1]].reshape(self.heights[0], self.widths[0], 4)


def half_of(color: Float, coc: Float, largest_px: float) -> Half:
    """Halve a picture (H, W, 3) and its circles (H, W), px, whose edges are repeated to whole tiles."""
    height, width = (-(-side // _SHAPE) * TILE for side in coc.shape)
    heights, widths = (np.array([side >> level for level in range(LEVELS)]) for side in (height, width))
    starts = np.concatenate([[0], np.cumsum(heights * widths)])
    texels = np.zeros((starts[-1] + 1, 4), dtype=color.dtype)
    places = zip(starts, starts[1:], heights, widths, strict=False)
    levels = [texels[start:end].reshape(rows, columns, 4) for start, end, rows, columns in places]
    _halve(color, coc, coc.dtype.type(largest_px), levels[0])
    for finer, coarser in pairwise(levels):
        _coarsen(finer, coarser)
    return Half(texels, starts, widths, heights, tiles_of(levels[0][..., 3], TILE).dilated(2))


@kernel
def _halve(color, coc, largest, out):
    """Weighted means of four colours, and their nearest circle, 0 below a pixel: out (h, w, 4)."""
    one, last_row, last_column = color.dtype.type(1), coc.shape[0] - 1, coc.shape[1] - 1
    for y in prange(len(out)):
        rows = min(2 * y, last_row), min(2 * y + 1, last_row)
        upper, lower = borrow(color)[rows[0]], borrow(color)[rows[1]]
        above, below, row = borrow(coc)[rows[0]], borrow(coc)[rows[1]], borrow(out)[y]
        for x in range(len(row)):
            left, right = min(2 * x, last_column), min(2 * x + 1, last_column)
            a, b, c, d = _light(upper[left]), _light(upper[right]), _light(lower[left]), _light(lower[right])
            whole = one / (a + b + c + d)
            for k in range(3):
                total = a * upper[left, k] + b * upper[right, k] + c * lower[left, k] + d * lower[right, k]
                row[x, k] = total * whole
            nearest = min(min(above[left], above[right]), min(below[left], below[right]))
            nearest = max(min(nearest, largest), -largest)
            row[x, 3] = nearest if abs(nearest) >= one else color.dtype.type(0)


@inline
def _light(texel):
    """The weight of a colour: less of a bright one."""
    one = type(texel[0])(1)
    return one / (one + max(max(texel[0], texel[1]), max(texel[2], one - one)))


@kernel
def _coarsen(finer, out):
    """The next mip level (h, w, 4) of (2 h, 2 w, 4): mean colours, nearest circles."""
    quarter = finer.dtype.type(0.25)
    for y in prange(len(out)):
        row, upper, lower = borrow(out)[y], borrow(finer)[2 * y], borrow(finer)[2 * y + 1]
        for x in range(len(row)):
            i = 2 * x
            for c in range(3):
                row[x, c] = ((upper[i, c] + upper[i + 1, c]) + (lower[i, c] + lower[i + 1, c])) * quarter
            row[x, 3] = min(min(upper[i, 3], upper[i + 1, 3]), min(lower[i, 3], lower[i + 1, 3]))


@lru_cache(maxsize=2)
def noise(height: int, width: int, dtype: np.dtype) -> Float:
    """Where each pixel's taps are moved, (h, w, 2), in half distances of rings: interleaved gradient noise.

    Kept for the next picture of this size, as an engine does with a table.
    """
    y, x = np.arange(height)[:, None] + 0.5, np.arange(width) + 0.5
    angle, far = 2.0 * np.pi * _gradient(x, y), 0.5 * np.sqrt(_gradient(5099.0 * x, 3499.0 * y))
    return np.stack([far * np.cos(angle), far * np.sin(angle)], axis=2).astype(dtype)


def _gradient(x: Float, y: Float) -> Float:
    return (52.9829189 * ((0.06711056 * x + 0.00583715 * y) % 1.0)) % 1.0
