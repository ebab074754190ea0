"""Combine: the blurred picture, of half the size, over the sharp one, tile by tile."""

import numpy as np

from refdof._jit import borrow, kernel, prange
from refdof.image.bilinear import read_to

__all__ = ["BLURRED_ALONE", "NOT_BLURRED", "OVER", "combined"]

NOT_BLURRED, OVER, BLURRED_ALONE = 0, 1, 2


@kernel
def combined(color, soft, tiles, side):
    """Color (H, W, 3), soft (h, w, 4) of premultiplied colours and alpha, tiles of `side` pixels: what each does."""
    height, width = color.shape[:2]
    scalar, (rows, columns) = color.dtype.type, soft.shape[:2]
    half, texels = scalar(0.5), soft.reshape(rows * columns, 4)
    out = np.empty_like(color)
    for y in prange(height):
        scratch = np.empty((1, 4), dtype=color.dtype)
        row, sharp, source, read = borrow(out)[y], borrow(color)[y], borrow(texels), borrow(scratch)
        v = (scalar(y) + half) * half
        for x in range(width):
            kind = tiles[y // side, x // side]
            if kind == NOT_BLURRED:
                for c in range(3):
                    row[x, c] = sharp[x, c]
            else:
                read_to(source, (rows, columns), (scalar(np.int32(x)) + half) * half, v, read, 0)
                rest = scalar(1) - read[0, 3] if kind == OVER else scalar(0)
                for c in range(3):
                    row[x, c] = read[0, c] + rest * sharp[x, c]
    return out
