"""Tiles: least and greatest values of squares of pixels, and of what is around. Methods choose by them what to do."""

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from refdof._check import Float
from refdof._jit import borrow, kernel, prange

__all__ = ["Tiles", "tiles_of"]


class Tiles(NamedTuple):
    """Least and greatest values of tiles, (h, w) each; those at the right and lower border may be cut."""

    least: Float
    greatest: Float

    def dilated(self, times: int = 1) -> "Tiles":
        """Of each tile and the eight around it, so many times."""
        side = 2 * times + 1
        return Tiles(
            ndimage.minimum_filter(self.least, side, mode="nearest"),
            ndimage.maximum_filter(self.greatest, side, mode="nearest"),
        )


def tiles_of(values: Float, side: int) -> Tiles:
    """Tiles of `side` x `side` pixels of values (H, W)."""
    shape = tuple(-(-n // side) for n in values.shape)
    tiles = Tiles(np.empty(shape, dtype=values.dtype), np.empty(shape, dtype=values.dtype))
    _reduce(values, side, *tiles)
    return tiles


@kernel
def _reduce(values, side, least, greatest):
    """Fill least and greatest: first each column of a row of tiles, then the columns of a tile."""
    height, width = values.shape
    for j in prange(len(least)):
        low, high = np.empty(width, dtype=values.dtype), np.empty(width, dtype=values.dtype)
        low[:], high[:] = values[j * side], values[j * side]
        for y in range(j * side + 1, min((j + 1) * side, height)):
            row = borrow(values)[y]
            for x in range(width):
                low[x], high[x] = min(low[x], row[x]), max(high[x], row[x])
        for i in range(least.shape[1]):
            lowest, highest = low[i * side], high[i * side]
            for x in range(i * side + 1, min((i + 1) * side, width)):
                lowest, highest = min(lowest, low[x]), max(highest, high[x])
            least[j, i], greatest[j, i] = lowest, highest
