"""Tiles: least and greatest values of squares of pixels, and of what is around. Methods choose by them what to do."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["Tiles", "reduce_row", "tiles_of"]


class Tiles(NamedTuple):
    """Least and greatest values of tiles, (h, w) each; those at the right and lower border may be cut."""

    least: Float
    greatest: Float

    @classmethod
    def empty(cls, shape: tuple[int, ...], side: int, dtype: npt.DTypeLike) -> "Tiles":
        """Of `side` x `side` pixels of a picture (H, W), to be written to."""
        tiles = tuple(-(-n // side) for n in shape)
        return cls(np.empty(tiles, dtype=dtype), np.empty(tiles, dtype=dtype))

    def dilated(self, times: int = 1) -> "Tiles":
        """Of each tile and the eight around it, so many times."""
        side = 2 * times + 1
        return Tiles(
            ndimage.minimum_filter(self.least, side, mode="nearest"),
            ndimage.maximum_filter(self.greatest, side, mode="nearest"),
        )


def tiles_of(values: Float, side: int) -> Tiles:
    """Tiles of `side` x `side` pixels of values (H, W)."""
    tiles = Tiles.empty(values.shape, side, values.dtype)
    _reduce(values, side, *tiles)
    return tiles


@kernel
def _reduce(values, side, least, greatest):
    for j in prange(len(least)):
        reduce_row(borrow(values)[j * side : min((j + 1) * side, len(values))], side, least[j], greatest[j])


@inline
def reduce_row(values, side, least, greatest):
    """Fill least and greatest (w,) of the tiles of a row (side, W): first each column, then the columns of a tile."""
    width = values.shape[1]
    low, high = np.empty(width, dtype=values.dtype), np.empty(width, dtype=values.dtype)
    for x in range(width):
        low[x] = high[x] = values[0, x]
    for y in range(1, len(values)):
        row = values[y]
        for x in range(width):
            low[x], high[x] = min(low[x], row[x]), max(high[x], row[x])
    for i in range(len(least)):
        lowest, highest = low[i * side], high[i * side]
        for x in range(i * side + 1, min((i + 1) * side, width)):
            lowest, highest = min(lowest, low[x]), max(highest, high[x])
        least[i], greatest[i] = lowest, highest
