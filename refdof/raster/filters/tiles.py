"""Tiles: least and greatest values of squares of pixels, and of what is around. Methods choose by them what to do."""

from typing import NamedTuple

import numpy as np
from scipy import ndimage

from refdof._check import Float

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
    rows, columns = (np.arange(0, n, side) for n in values.shape)
    least, greatest = (
        reduce(reduce(values, rows, axis=0), columns, axis=1) for reduce in (np.minimum.reduceat, np.maximum.reduceat)
    )
    return Tiles(least, greatest)
