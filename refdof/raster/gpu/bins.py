"""Bins: which snapped triangles touch which tile of the picture, in order of their number."""

from typing import NamedTuple

import numpy as np

from refdof._check import Index
from refdof._jit import tile_kernel
from refdof.raster.gpu.clip import Pieces

__all__ = ["TILE_PX", "Bins", "bins_of"]

TILE_PX = 32


class Bins(NamedTuple):
    """Tile t, counted row by row, holds piece[first[t] : first[t + 1]], ascending.

    first (tiles + 1,) int64; piece (N,) int32; columns: tiles in a row.
    """

    first: Index
    piece: Index
    columns: int


def bins_of(pieces: Pieces, width: int, height: int) -> Bins:
    """Sort pieces into tiles of a picture [px]."""
    columns, rows = -(-width // TILE_PX), -(-height // TILE_PX)
    counts = np.zeros(columns * rows + 1, dtype=np.int64)
    _count(pieces.box, columns, counts)
    first = np.cumsum(counts)
    piece = np.empty(int(first[-1]), dtype=np.int32)
    _fill(pieces.box, columns, first.copy(), piece)
    return Bins(first, piece, columns)


@tile_kernel
def _count(box, columns, counts):
    """Count, at t + 1, the pieces whose box touches tile t."""
    for n in range(len(box)):
        if box[n, 0] <= box[n, 1]:
            for row in range(box[n, 2] // TILE_PX, box[n, 3] // TILE_PX + 1):
                for column in range(box[n, 0] // TILE_PX, box[n, 1] // TILE_PX + 1):
                    counts[row * columns + column + 1] += 1


@tile_kernel
def _fill(box, columns, free, piece):
    """Write every piece to the next free place of each tile that its box touches."""
    for n in range(len(box)):
        if box[n, 0] <= box[n, 1]:
            for row in range(box[n, 2] // TILE_PX, box[n, 3] // TILE_PX + 1):
                for column in range(box[n, 0] // TILE_PX, box[n, 1] // TILE_PX + 1):
                    tile = row * columns + column
                    piece[free[tile]] = n
                    free[tile] += 1
