"""Half: colour and nearest circle at half the size, their mip levels, tiles, and the noise of the taps."""

from functools import lru_cache
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

    @property
    def places(self) -> Index:
        """Starts, widths and heights of the levels, (3, levels)."""
        return np.stack([self.starts[:-1], self.widths, self.heights])


def half_of(color: Float, coc: Float, largest_px: float) -> Half:
    """Halve a picture (H, W, 3) and its circles (H, W), px, whose edges are repeated to whole tiles."""
    height, width = (-(-side // _SHAPE) * TILE for side in coc.shape)
    heights, widths = (np.array([side >> level for level in range(LEVELS)]) for side in (height, width))
    starts = np.concatenate([[0], np.cumsum(heights * widths)])
    texels = np.empty((starts[-1] + 1, 4), dtype=color.dtype)
    texels[-1] = 0
    _fill(color.reshape(len(color), -1), coc, coc.dtype.type(largest_px), starts, widths, texels.reshape(-1))
    circles = texels[: starts[1], 3].reshape(height, width)
    return Half(texels, starts, widths, heights, tiles_of(circles, TILE).dilated(2))


@kernel
def _fill(color, coc, largest, starts, widths, texels):
    """All levels of color (H, 3 W) and coc (H, W), tiles by tiles of half the size: texels (4 T)."""
    last, columns = coc.shape[0] - 1, widths[0]
    for tile in prange((starts[1] - starts[0]) // (columns * TILE)):
        planes, out = borrow(np.empty((5, 2 * columns), dtype=color.dtype)), borrow(texels)
        for y in range(TILE * tile, TILE * (tile + 1)):
            for row in (2 * y, 2 * y + 1):
                _weigh(borrow(color)[min(row, last)], borrow(coc)[min(row, last)], row % 2 == 0, planes)
            _halve(planes, largest, out[4 * y * columns : 4 * (y + 1) * columns])
        for level in range(1, LEVELS):
            for y in range((TILE * tile) >> level, (TILE * (tile + 1)) >> level):
                width, finer = widths[level], 4 * (starts[level - 1] + 2 * y * widths[level - 1])
                upper, lower = out[finer : finer + 8 * width], out[finer + 8 * width : finer + 16 * width]
                start = 4 * (starts[level] + y * width)
                _coarsen(upper, lower, out[start : start + 4 * width])


@inline
def _weigh(color, coc, first, out):
    """Weighted colours, weights and circles of two rows of pixels, one by one: out (5, 2 w). Bright ones weigh less."""
    kind, width = out.dtype.type, len(coc)
    zero, one = kind(0), kind(1)
    for x in range(width):
        red, green, blue = color[3 * x], color[3 * x + 1], color[3 * x + 2]
        weight = one / (one + max(max(red, green), max(blue, zero)))
        out[0, x] = weight * red if first else out[0, x] + weight * red
        out[1, x] = weight * green if first else out[1, x] + weight * green
        out[2, x] = weight * blue if first else out[2, x] + weight * blue
        out[3, x] = weight if first else out[3, x] + weight
        out[4, x] = coc[x] if first else min(out[4, x], coc[x])
    for x in range(width, out.shape[1]):
        for k in range(5):
            out[k, x] = out[k, width - 1]


@inline
def _halve(planes, largest, out):
    """Weighted means of four colours, and their nearest circle, 0 below a pixel: out (4 w)."""
    zero, one = out.dtype.type(0), out.dtype.type(1)
    for x in range(len(out) // 4):
        left, right = 2 * x, 2 * x + 1
        whole = one / (planes[3, left] + planes[3, right])
        out[4 * x] = (planes[0, left] + planes[0, right]) * whole
        out[4 * x + 1] = (planes[1, left] + planes[1, right]) * whole
        out[4 * x + 2] = (planes[2, left] + planes[2, right]) * whole
        nearest = max(min(min(planes[4, left], planes[4, right]), largest), -largest)
        out[4 * x + 3] = nearest if abs(nearest) >= one else zero


@inline
def _coarsen(upper, lower, out):
    """The next level of two rows: mean colours, nearest circles."""
    quarter = out.dtype.type(0.25)
    for x in range(len(out) // 4):
        for c in range(4):
            i = 8 * x + c
            a, b, d, e = upper[i], upper[i + 4], lower[i], lower[i + 4]
            out[4 * x + c] = ((a + b) + (d + e)) * quarter if c < 3 else min(min(a, b), min(d, e))


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
