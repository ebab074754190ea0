"""Tile bins: which snapped triangles touch which tile of the picture, in order of their number."""

from typing import NamedTuple

import numpy as np

from refdof._check import Index
from refdof._jit import tile_kernel
from refdof.raster.gpu.clip import ClippedTriangles

__all__ = ["TILE_PX", "TileBins", "bin_triangles"]

TILE_PX = 32


class TileBins(NamedTuple):
    """Tile t, counted row by row, holds triangle[first[t] : first[t + 1]], ascending.

    first (tiles + 1,) int64; triangle (N,) int32; columns: tiles in a row.
    """

    first: Index
    triangle: Index
    columns: int


def bin_triangles(clipped: ClippedTriangles, width: int, height: int) -> TileBins:
    """Sort clipped triangles into tiles of a picture [px]."""
    columns, rows = -(-width // TILE_PX), -(-height // TILE_PX)
    counts = np.zeros(columns * rows + 1, dtype=np.int64)
    _count(clipped.box, columns, counts)
    first = np.cumsum(counts)
    triangle = np.empty(int(first[-1]), dtype=np.int32)
    _fill(clipped.box, columns, first.copy(), triangle)
    return TileBins(first, triangle, columns)


@tile_kernel
def _count(box, columns, counts):
    """Count, at t + 1, the clipped triangles whose box touches tile t."""
    for n in range(len(box)):
        if box[n, 0] <= box[n, 1]:
            for row in range(box[n, 2] // TILE_PX, box[n, 3] // TILE_PX + 1):
                for column in range(box[n, 0] // TILE_PX, box[n, 1] // TILE_PX + 1):
                    counts[row * columns + column + 1] += 1


@tile_kernel
def _fill(box, columns, free, triangle):
    """Write every clipped triangle to the next free place of each tile that its box touches."""
    for n in range(len(box)):
        if box[n, 0] <= box[n, 1]:
            for row in range(box[n, 2] // TILE_PX, box[n, 3] // TILE_PX + 1):
                for column in range(box[n, 0] // TILE_PX, box[n, 1] // TILE_PX + 1):
                    tile = row * columns + column
                    triangle[free[tile]] = n
                    free[tile] += 1
