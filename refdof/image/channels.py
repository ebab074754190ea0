"""Channels: pictures of a colour and one more number, whose texels vector registers hold."""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["join_row", "joined"]


def joined(color: Float, fourth: Float) -> Float:
    """Colour (H, W, 3) and a number of each pixel (H, W): (H, W, 4) of the type of `color`."""
    out = np.empty((*fourth.shape, 4), dtype=color.dtype)  # of NumPy, whose large arrays are on large pages
    _join(color, fourth, out)
    return out


@kernel
def _join(color, fourth, out):
    for y in prange(len(fourth)):
        join_row(borrow(color)[y], borrow(fourth)[y], borrow(out)[y])


@inline
def join_row(color, fourth, out):
    """A row (W, 3) and a number of each pixel (W,) to out (W, 4)."""
    for x in range(len(fourth)):
        out[x, 0], out[x, 1], out[x, 2], out[x, 3] = color[x, 0], color[x, 1], color[x, 2], fourth[x]
