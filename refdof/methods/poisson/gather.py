"""Gather: the loop of the Poisson disc filter, all taps of a pixel in both pictures."""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.tap_registers import add_tap
from refdof.image.bilinear import first_of_two, four_around
from refdof.methods.poisson.params import SMALL_RADIUS, SMALL_SIZE

__all__ = ["gather"]

_PIECE = 256  # pixels of a row at a time: what is kept of them fits the nearest cache
_REACH = SMALL_RADIUS * SMALL_SIZE


def gather(coded: Float, small: Float, taps: Float, max_radius: float, reach: float = _REACH) -> Float:
    """The shader's loop: coded (H, W, 4), small (h, w, 4), taps (N, 2) -> (H, W, 3).

    max_radius [px] is that of full blur; `reach` times as far [px] are taps in the small picture.
    """
    return _gather(coded, small, taps, max_radius, reach)


@kernel
def _gather(coded, small, taps, max_radius, reach):
    height, width = coded.shape[:2]
    flat, low_flat = coded.reshape(height * width, 4), small.reshape(small.shape[0] * small.shape[1], 4)
    out = np.empty((height, width, 3), dtype=coded.dtype)
    for y in prange(height):
        sums, around = np.empty((_PIECE, 4), dtype=coded.dtype), np.empty((8, _PIECE), dtype=np.int64)
        weights, radii = np.empty((4, _PIECE), dtype=coded.dtype), np.empty(_PIECE, dtype=coded.dtype)
        work = (borrow(sums), borrow(around), borrow(weights), borrow(radii))
        pictures = (borrow(flat), borrow(low_flat))
        for first in range(0, width, _PIECE):
            row = borrow(out)[y, first : min(first + _PIECE, width)]
            _gather_piece(
                pictures, (height, width), small.shape, borrow(taps), (max_radius, reach), (first, y), work, row
            )
    return out


@inline
def _gather_piece(pictures, size, small_size, taps, reaches, corner, work, out):
    """Pixels of a row from `corner` on: out (n, 3). Taps outside, pixels inside: loops over pixels vectorise."""
    (sharp, soft), (first, y), scalar = pictures, corner, out.dtype.type
    sums, radii, half, count = work[0], work[3], scalar(0.5), len(out)
    right, down = scalar(small_size[1] / size[1]), scalar(small_size[0] / size[0])
    for x in range(count):
        radii[x] = abs(scalar(2) * sharp[y * size[1] + first + x, 3] - scalar(1)) * scalar(reaches[0])
        for c in range(4):
            sums[x, c] = scalar(0)
    for k in range(len(taps)):
        around, weights, v = work[1], work[2], scalar(y) + half
        for x in range(count):
            u, radius = scalar(np.int32(first + x)) + half, radii[x]
            wide = radius * scalar(reaches[1])
            places = u + taps[k, 0] * radius, v + taps[k, 1] * radius
            _look(places, size, 0, around, weights, x)
            places = (u + taps[k, 0] * wide) * right, (v + taps[k, 1] * wide) * down
            _look(places, small_size, 4, around, weights, x)
        for x in range(count):
            near = around[0, x], around[1, x], around[2, x], around[3, x]
            far = around[4, x], around[5, x], around[6, x], around[7, x]
            shares, low_shares = (weights[0, x], weights[1, x]), (weights[2, x], weights[3, x])
            add_tap(sharp, near, shares, soft, far, low_shares, sharp[y * size[1] + first + x, 3], sums, x)
    for x in range(count):
        for c in range(3):
            total = sums[x, 3]
            out[x, c] = sums[x, c] / total if total > scalar(0) else sharp[y * size[1] + first + x, c]


@inline
def _look(places, size, n, around, weights, x):
    """Texels n .. n + 3 of pixel x, and their weights: around places[0], places[1] [texels from the corner]."""
    column, weights[n // 2, x] = first_of_two(places[0], size[1])
    row, weights[n // 2 + 1, x] = first_of_two(places[1], size[0])
    a, b, c, d = four_around(0, np.int32(size[1]), np.int32(size[0]), column, row)
    around[n, x], around[n + 1, x], around[n + 2, x], around[n + 3, x] = a, b, c, d
