"""Resize: a picture read bilinearly around the pixel centres of another size, as a pass over such a target does.

1. one read at the centre      `resize`: half of an even size is the mean of 2 x 2 texels
2. four at the corners of a square around it      `corner_means`
3. of the first, parts of a row, for passes that do more with them      `places_along`, `read_run`
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.row_registers import blend_pair
from refdof.image.bilinear import add_read, first_of_two, texels_around

__all__ = ["corner_means", "places_along", "read_run", "resize"]


@kernel
def resize(picture, height, width):
    """Picture (H, W, 4) -> (height, width, 4) of its type; reads beyond the edge repeat it."""
    rows, columns = picture.shape[:2]
    scalar, flat = picture.dtype.type, picture.reshape(rows, 4 * columns)
    down, half = scalar(rows / height), scalar(0.5)
    firsts, shares = np.empty(width, dtype=np.int64), np.empty(width, dtype=picture.dtype)
    places_along(columns, firsts, shares)
    out = np.empty((height, width, 4), dtype=picture.dtype)
    for y in prange(height):
        between, lines = np.empty((columns, 4), dtype=picture.dtype), texels_around((scalar(y) + half) * down, rows)
        read_run(borrow(flat), lines, (borrow(firsts), borrow(shares)), (0, width), borrow(between), borrow(out)[y])
    return out


@inline
def places_along(size, firsts, shares):
    """Of a line of `size` texels: the first of the two around each pixel's centre, and the second's weight, (X,)."""
    scalar = shares.dtype.type
    along, half = scalar(size / len(firsts)), scalar(0.5)
    for x in range(len(firsts)):
        firsts[x], shares[x] = first_of_two((scalar(np.int32(x)) + half) * along, size)


@inline
def read_run(rows, lines, places, run, between, out):
    """Read pixels begin .. end of a row, `run`, to the first rows of out (N, 4); picture (H, 4 W).

    lines are `texels_around` the row's centre, places what `places_along` found; between (W, 4) is overwritten.
    """
    (upper, lower, down), (firsts, shares), (begin, end) = lines, places, run
    last = rows.shape[1] // 4 - 1
    first, final = firsts[begin], min(firsts[end - 1] + 1, last)
    part = slice(4 * first, 4 * final + 4)
    _blend_rows(rows[upper, part], rows[lower, part], down, between.reshape(-1)[part])
    for x in range(begin, end):
        blend_pair(between, firsts[x], min(firsts[x] + 1, last), shares[x], out, x - begin)


@inline
def _blend_rows(upper, lower, share, out):
    for k in range(len(out)):
        out[k] = upper[k] + (lower[k] - upper[k]) * share


@kernel
def corner_means(picture, height, width, apart):
    """Picture (H, W, 4) -> (height, width, 4): means of reads `apart` texels of the new size to each side."""
    rows, columns = picture.shape[:2]
    scalar, texels = picture.dtype.type, picture.reshape(rows * columns, 4)
    right, down, half = scalar(columns / width), scalar(rows / height), scalar(0.5)
    far = scalar(apart)
    out = np.zeros((height, width, 4), dtype=picture.dtype)
    for y in prange(height):
        row, source = borrow(out)[y], borrow(texels)
        for x in range(width):
            for v in (-far, far):
                for u in (-far, far):
                    place = (scalar(np.int32(x)) + half + u) * right, (scalar(y) + half + v) * down
                    add_read(source, (rows, columns), place[0], place[1], scalar(0.25), row, x)
    return out
