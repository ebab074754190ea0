"""Channels: pictures of a colour and one more number, whose texels vector registers hold."""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, kernel, prange

__all__ = ["joined"]


def joined(color: Float, fourth: Float) -> Float:
    """Colour (H, W, 3) and a number of each pixel (H, W): (H, W, 4) of the type of `color`."""
    out = np.empty((*fourth.shape, 4), dtype=color.dtype)  # of NumPy, whose large arrays are on large pages
    _join(color, fourth, out)
    return out


@kernel
def _join(color, fourth, out):
    for y in prange(len(fourth)):
        source, row, number = borrow(color)[y], borrow(out)[y], borrow(fourth)[y]
        for x in range(len(number)):
            row[x, 0], row[x, 1], row[x, 2], row[x, 3] = source[x, 0], source[x, 1], source[x, 2], number[x]
