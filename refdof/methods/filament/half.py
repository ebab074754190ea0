"""Half: colour and nearest circle at half the size, their mip levels, tiles, and the noise of the taps."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
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
    kind = color.dtype.type
    room = [(0, -side % _SHAPE) for side in coc.shape]
    color, coc = np.pad(color, (*room, (0, 0)), "edge"), np.pad(coc, room, "edge")
    height, width = coc.shape[0] // 2, coc.shape[1] // 2
    squares = color.reshape(height, 2, width, 2, 3).swapaxes(1, 2).reshape(height, width, 4, 3)
    weights = kind(1) / (kind(1) + squares.max(axis=3, keepdims=True))
    texel = np.empty((height, width, 4), dtype=color.dtype)
    texel[..., :3] = (squares * weights).sum(axis=2) / weights.sum(axis=2)
    nearest = coc.reshape(height, 2, width, 2).min(axis=(1, 3)).clip(-largest_px, largest_px)
    texel[..., 3] = np.where(np.abs(nearest) < 1, kind(0), nearest)
    tiles = tiles_of(texel[..., 3], TILE).dilated(2)
    levels = [texel]
    while len(levels) < LEVELS:
        finer = levels[-1].reshape(levels[-1].shape[0] // 2, 2, levels[-1].shape[1] // 2, 2, 4)
        coarser = finer.mean(axis=(1, 3), dtype=color.dtype)
        coarser[..., 3] = finer[..., 3].min(axis=(1, 3))
        levels.append(coarser)
    heights, widths = (np.array([level.shape[axis] for level in levels]) for axis in (0, 1))
    starts = np.concatenate([[0], np.cumsum(heights * widths)])
    return Half(np.concatenate([level.reshape(-1, 4) for level in levels]), starts, widths, heights, tiles)


def noise(height: int, width: int, dtype: np.dtype) -> Float:
    """Where each pixel's taps are moved, (h, w, 2), in half distances of rings: interleaved gradient noise."""
    y, x = np.indices((height, width)) + 0.5
    angle, square = 2.0 * np.pi * _gradient(x, y), _gradient(5099.0 * x, 3499.0 * y)
    return (0.5 * np.sqrt(square) * np.stack([np.cos(angle), np.sin(angle)])).transpose(1, 2, 0).astype(dtype)


def _gradient(x: Float, y: Float) -> Float:
    return (52.9829189 * ((0.06711056 * x + 0.00583715 * y) % 1.0)) % 1.0
