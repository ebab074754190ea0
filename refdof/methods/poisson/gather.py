"""Gather: the loop of the Poisson disc filter, all taps of a pixel in both pictures."""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.tap_registers import add_two_taps
from refdof.image.bilinear import first_of_two
from refdof.methods.poisson.params import SMALL_RADIUS, SMALL_SIZE

__all__ = ["gather"]

_PIECE = 256  # pixels of a row at a time, even: what is kept of them fits the nearest cache
_REACH = SMALL_RADIUS * SMALL_SIZE


def gather(coded: Float, small: Float, taps: Float, max_radius: float, reach: float = _REACH) -> Float:
    """The shader's loop: coded (H, W, 4), small (h, w, 4), taps (N, 2) -> (H, W, 3).

    max_radius [px] is that of full blur; `reach` times as far [px] are taps in the small picture.
    """
    out = np.empty((*coded.shape[:2], 3), dtype=coded.dtype)  # of NumPy, whose large arrays are on large pages
    _gather(_edged(coded), _edged(small), taps, max_radius, reach, out)
    return out


def _edged(image: Float) -> Float:
    """A picture (H, W, 4) with its last column and row once more: every texel has one to its right and one below."""
    height, width = image.shape[:2]
    out = np.empty((height + 1, width + 1, 4), dtype=image.dtype)
    out[:-1, :-1], out[:-1, -1] = image, image[:, -1]
    out[-1] = out[-2]
    return out


@kernel
def _gather(coded, small, taps, max_radius, reach, out):
    """Pictures as `_edged` makes them."""
    flat, low_flat = coded.reshape(-1, 4), small.reshape(-1, 4)
    size, small_size = (out.shape[0], out.shape[1]), (small.shape[0] - 1, small.shape[1] - 1)
    for y in prange(size[0]):
        sums, firsts = np.empty((_PIECE, 4), dtype=out.dtype), np.empty((2, _PIECE), dtype=np.int64)
        weights, radii = np.empty((4, _PIECE), dtype=out.dtype), np.empty((3, _PIECE), dtype=out.dtype)
        work = (borrow(sums), borrow(firsts), borrow(weights), borrow(radii))
        pictures = (borrow(flat), borrow(low_flat))
        for first in range(0, size[1], _PIECE):
            row = borrow(out)[y, first : min(first + _PIECE, size[1])]
            _gather_piece(pictures, size, small_size, borrow(taps), (max_radius, reach), (first, y), work, row)


@inline
def _gather_piece(pictures, size, small_size, taps, reaches, corner, work, out):
    """Pixels of a row from `corner` on: out (n, 3). Taps outside, pixels inside: loops over pixels vectorise."""
    (sharp, soft), (first, y), scalar = pictures, corner, out.dtype.type
    sums, firsts, weights, (columns, radii, wide) = work
    half, strides, count = scalar(0.5), (size[1] + 1, small_size[1] + 1), len(out)
    right, down = scalar(small_size[1] / size[1]), scalar(small_size[0] / size[0])
    start, pairs = y * strides[0] + first, count + (count & 1)  # pixels come in pairs: one more may be done
    for x in range(pairs):
        columns[x] = scalar(np.int32(first + x)) + half
        radii[x] = abs(scalar(2) * sharp[np.uint64(start + x), 3] - scalar(1)) * scalar(reaches[0])
        wide[x] = radii[x] * scalar(reaches[1])
        for c in range(4):
            sums[x, c] = scalar(0)
    for k in range(len(taps)):
        v, a, b = scalar(y) + half, taps[k, 0], taps[k, 1]
        for x in range(pairs):
            u, radius, far = columns[x], radii[x], wide[x]
            column, weights[0, x] = first_of_two(u + a * radius, size[1])
            row, weights[1, x] = first_of_two(v + b * radius, size[0])
            firsts[0, x] = _number(column, row, strides[0])
            column, weights[2, x] = first_of_two((u + a * far) * right, small_size[1])
            row, weights[3, x] = first_of_two((v + b * far) * down, small_size[0])
            firsts[1, x] = _number(column, row, strides[1])
        for x in range(0, pairs, 2):
            add_two_taps(sharp, soft, strides, firsts, weights, start + x, sums, x)
    for x in range(count):
        for c in range(3):
            total = sums[x, 3]
            out[x, c] = sums[x, c] / total if total > scalar(0) else sharp[np.uint64(start + x), c]


@inline
def _number(column, row, stride):
    """Where the numbers of texel (column, row) begin, in steps that vectorise."""
    return 4 * (np.int64(row) * np.int64(np.int32(stride)) + np.int64(column))
