"""Upsample: the soft picture over the sharp one, by circle."""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import first_of_two, texels_around

__all__ = ["upsampled"]


@kernel
def upsampled(color, soft, circle, depth, greatest, nearest, side):
    """The soft picture (h, w, 4) over color (H, W, 3); circle and depth (H, W), and those around tiles of `side` px."""
    (height, width), scalar = circle.shape, color.dtype.type
    rows, columns = soft.shape[:2]
    right, down, half = scalar(columns / width), scalar(rows / height), scalar(0.5)
    first, share = np.empty(width, dtype=np.int32), np.empty(width, dtype=color.dtype)
    for x in range(width):
        first[x], share[x] = first_of_two((scalar(np.int32(x)) + half) * right, columns)
    flat, out = soft.reshape(rows, 4 * columns), np.empty_like(color)
    for y in prange(height):
        upper, lower, between = texels_around((scalar(y) + half) * down, rows)
        line = np.empty(4 * columns + 4, dtype=color.dtype)
        _blend(borrow(flat)[upper], borrow(flat)[lower], between, line)
        texels, shares, radius, far = borrow(first), borrow(share), borrow(circle)[y], borrow(depth)[y]
        row, source = borrow(out)[y], borrow(color)[y]
        for tile in range(greatest.shape[1]):
            run, around = slice(tile * side, min((tile + 1) * side, width)), (y // side, tile)
            _over(
                source[run], line, texels[run], shares[run], radius[run], far[run], greatest[around], nearest[around],
                row[run],
            )  # fmt: skip
    return out


@inline
def _blend(upper, lower, share, line):
    """A row between two of texels, its last one twice."""
    last = len(upper)
    for k in range(last):
        line[k] = upper[k] + (lower[k] - upper[k]) * share
    for k in range(4):
        line[last + k] = line[last - 4 + k]


@inline
def _over(source, line, first, share, circle, depth, greatest, nearest, out):
    zero, one = out.dtype.type(0), out.dtype.type(1)
    for x in range(len(circle)):
        k, t = np.uintp(4 * first[x]), share[x]
        red, green, blue, alpha = (
            _between(line, k, t),
            _between(line, k + np.uintp(1), t),
            _between(line, k + np.uintp(2), t),
            _between(line, k + np.uintp(3), t),
        )
        near = min(max(one - (depth[x] - nearest), zero), one)
        reach = greatest * (one - near) + circle[x] * near
        soft = min(max(circle[x] * (one - alpha) + reach * alpha, zero), one)
        out[x, 0] = source[x, 0] * (one - soft) + red * soft
        out[x, 1] = source[x, 1] * (one - soft) + green * soft
        out[x, 2] = source[x, 2] * (one - soft) + blue * soft


@inline
def _between(line, k, share):
    return line[k] + (line[k + np.uintp(4)] - line[k]) * share
