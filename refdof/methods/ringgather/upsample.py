"""Upsample: the soft picture over the sharp one, by circle."""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import texels_around
from refdof.methods.ringgather.taken import FARTHEST
from refdof.raster.filters.resize import places_along, read_run

__all__ = ["upsampled"]


def upsampled(
    color: Float, soft: Float, circle: Float, depth: Float, greatest: Float, nearest: Float, side: int
) -> Float:
    """The soft picture (h, w, 4) over color (H, W, 3); circle and depth (H, W), and those around tiles of `side` px."""
    out = np.empty_like(color)  # of NumPy, whose large arrays are on large pages
    _upsample(color, soft, circle, depth, greatest, nearest, side, out)
    return out


@kernel
def _upsample(color, soft, circle, depth, greatest, nearest, side, out):
    (height, width), scalar = circle.shape, color.dtype.type
    rows, columns = soft.shape[:2]
    down, half = scalar(rows / height), scalar(0.5)
    first, share = np.empty(width, dtype=np.int64), np.empty(width, dtype=color.dtype)
    places_along(columns, first, share)
    flat = soft.reshape(rows, 4 * columns)
    sharp, picture = color.reshape(height, 3 * width), out.reshape(height, 3 * width)
    for y in prange(height):
        texels, row, source = borrow(flat), borrow(picture)[y], borrow(sharp)[y]
        reads, between = np.empty((side, 4), dtype=color.dtype), np.empty((columns, 4), dtype=color.dtype)
        shares = np.empty(side, dtype=color.dtype)
        radius, far, places = borrow(circle)[y], borrow(depth)[y], (borrow(first), borrow(share))
        lines = texels_around((scalar(y) + half) * down, rows)
        for tile in range(greatest.shape[1]):
            start, end = tile * side, min((tile + 1) * side, width)
            read_run(texels, lines, places, (start, end), borrow(between), reads)
            around, pixels = (greatest[y // side, tile], nearest[y // side, tile]), slice(3 * start, 3 * end)
            _over(source[pixels], reads.reshape(-1), radius[start:end], far[start:end], around, shares, row[pixels])


@inline
def _over(source, soft, circle, depth, around, shares, out):
    """Read pixels of the soft picture (4 X,) over those of the sharp one (3 X,); shares (X,) is overwritten."""
    zero, one, far, (greatest, nearest) = out.dtype.type(0), out.dtype.type(1), out.dtype.type(FARTHEST), around
    for x in range(len(circle)):
        shares[x] = soft[4 * x + 3]
    for x in range(len(circle)):
        alpha, near = shares[x], min(max(one - (min(depth[x], far) - nearest), zero), one)
        reach = greatest * (one - near) + circle[x] * near
        shares[x] = min(max(circle[x] * (one - alpha) + reach * alpha, zero), one)
    for x in range(len(circle)):
        share, rest = shares[x], one - shares[x]
        out[3 * x] = source[3 * x] * rest + soft[4 * x] * share
        out[3 * x + 1] = source[3 * x + 1] * rest + soft[4 * x + 1] * share
        out[3 * x + 2] = source[3 * x + 2] * rest + soft[4 * x + 2] * share
