"""Half: colour and nearest circle at half the size, their mip levels, tiles, and the noise of the taps."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, kernel, prange
from refdof.raster.filters.tiles import Tiles, tiles_of

__all__ = ["LEVELS", "TILE", "Half", "half_of", "noise"]

LEVELS = 4
TILE = 8  # texels of half the size
_SHAPE = 2 * TILE  # pixels: sides are filled up to whole tiles


class Half(NamedTuple):
    """Levels of colour and circle in one array, (T, 4), each of which begins at `starts` and is `widths` wide.

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
    levels = [_halved(color, coc, height, width, coc.dtype.type(largest_px))]
    tiles = tiles_of(levels[0][..., 3], TILE).dilated(2)
    while len(levels) < LEVELS:
        levels.append(_coarser(levels[-1]))
    heights, widths = (np.array([level.shape[axis] for level in levels]) for axis in (0, 1))
    starts = np.concatenate([[0], np.cumsum(heights * widths)])
    return Half(np.concatenate([level.reshape(-1, 4) for level in levels]), starts, widths, heights, tiles)


@kernel
def _halved(color, coc, height, width, largest):
    """Weighted means of four colours, and their nearest circle, 0 below a pixel: (height, width, 4)."""
    out, scalar = np.empty((height, width, 4), dtype=color.dtype), color.dtype.type
    one, last_row, last_column = scalar(1), coc.shape[0] - 1, coc.shape[1] - 1
    for y in prange(height):
        row, upper, lower = borrow(out)[y], min(2 * y, last_row), min(2 * y + 1, last_row)
        for x in range(width):
            left, right = min(2 * x, last_column), min(2 * x + 1, last_column)
            total, nearest = scalar(0), scalar(largest)
            for c in range(3):
                row[x, c] = scalar(0)
            for k in range(4):
                j, i = (upper if k < 2 else lower), (left if k % 2 == 0 else right)
                texel = borrow(color)[j, i]
                weight = one / (one + max(max(texel[0], texel[1]), max(texel[2], scalar(0))))
                for c in range(3):
                    row[x, c] += weight * texel[c]
                total += weight
                nearest = min(nearest, coc[j, i])
            for c in range(3):
                row[x, c] /= total
            nearest = max(nearest, -scalar(largest))
            row[x, 3] = scalar(0) if abs(nearest) < one else nearest
    return out


@kernel
def _coarser(finer):
    """The next mip level of (h, w, 4): mean colours, nearest circles."""
    height, width, scalar = finer.shape[0] // 2, finer.shape[1] // 2, finer.dtype.type
    out = np.empty((height, width, 4), dtype=finer.dtype)
    for y in prange(height):
        row, upper, lower = borrow(out)[y], borrow(finer)[2 * y], borrow(finer)[2 * y + 1]
        for x in range(width):
            i = 2 * x
            for c in range(3):
                row[x, c] = ((upper[i, c] + upper[i + 1, c]) + (lower[i, c] + lower[i + 1, c])) * scalar(0.25)
            row[x, 3] = min(min(upper[i, 3], upper[i + 1, 3]), min(lower[i, 3], lower[i + 1, 3]))
    return out


def noise(height: int, width: int, dtype: np.dtype) -> Float:
    """Where each pixel's taps are moved, (h, w, 2), in half distances of rings: interleaved gradient noise."""
    y, x = np.indices((height, width)) + 0.5
    angle, square = 2.0 * np.pi * _gradient(x, y), _gradient(5099.0 * x, 3499.0 * y)
    return (0.5 * np.sqrt(square) * np.stack([np.cos(angle), np.sin(angle)])).transpose(1, 2, 0).astype(dtype)


def _gradient(x: Float, y: Float) -> Float:
    return (52.9829189 * ((0.06711056 * x + 0.00583715 * y) % 1.0)) % 1.0
