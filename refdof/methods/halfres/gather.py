"""Gather: the two discs of the half-resolution method, and its composite.

Pictures are (H, W, 4), of which three are a colour.
"""

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.order import fair_step
from refdof._jit.texel_registers import blend_to
from refdof._jit.texel_sums import add_blend
from refdof.image.bilinear import first_of_two, four_around, read_to, texels_around
from refdof.raster.filters.resize import places_along, read_run

__all__ = ["brightest", "composite", "means"]

_MOST = 64  # points of a disc, at most
_RUN = 64  # px, whose reads stay in the nearest cache


@kernel
def means(picture, circles, points, reach):
    """Means over discs: picture (H, W, 4), circles (h, w) of `reach` px, points (2, N) -> (h, w, 4), circle last."""
    size, (height, width) = picture.shape[:2], circles.shape
    scalar, texels = picture.dtype.type, picture.reshape(size[0] * size[1], 4)
    right, down, half = scalar(size[1] / width), scalar(size[0] / height), scalar(0.5)
    out = np.zeros((height, width, 4), dtype=picture.dtype)
    step = fair_step(height)
    for turn in prange(height):
        y = turn * step % height
        row, source, taps, v = borrow(out)[y], borrow(texels), borrow(points), (scalar(y) + half) * down
        places, shares = _scratch(points)
        for x in range(width):
            u, radius = (scalar(np.int32(x)) + half) * right, circles[y, x] * scalar(reach)
            if radius == scalar(0):  # all reads are the same one
                read_to(source, size, u, v, row, x)
            else:
                _find(taps, (u, v), (radius, radius), size, places, shares)
                for k in range(taps.shape[1]):
                    a, b, c, d = four_around(0, size[1], size[0], np.int64(places[k]), np.int64(places[_MOST + k]))
                    add_blend(row, x, scalar(1), source, a, b, c, d, shares[k], shares[_MOST + k])
                for c in range(3):
                    row[x, c] /= scalar(taps.shape[1])
            row[x, 3] = circles[y, x]
    return out


@kernel
def brightest(picture, points, reach_x, reach_y):
    """Greatest values over discs: picture (h, w, 4), circle last, of (reach_x, reach_y) texels -> (h, w, 4)."""
    height, width = picture.shape[:2]
    scalar, texels = picture.dtype.type, picture.reshape(height * width, 4)
    half = scalar(0.5)
    out = picture.copy()
    step = fair_step(height)
    for turn in prange(height):
        y = turn * step % height
        reads = np.empty((points.shape[1], 4), dtype=picture.dtype)
        row, source, found, taps = borrow(out)[y], borrow(texels), borrow(reads), borrow(points)
        places, shares = _scratch(points)
        for x in range(width):
            u, v, circle = scalar(np.int32(x)) + half, scalar(y) + half, row[x, 3]
            if circle > scalar(0):
                radii = circle * scalar(reach_x), circle * scalar(reach_y)
                _find(taps, (u, v), radii, (height, width), places, shares)
                for k in range(taps.shape[1]):
                    a, b, c, d = four_around(0, width, height, np.int64(places[k]), np.int64(places[_MOST + k]))
                    blend_to(source, a, b, c, d, shares[k], shares[_MOST + k], found, k)
                for c in range(3):
                    for k in range(taps.shape[1]):
                        row[x, c] = max(row[x, c], found[k, c])
    return out


@inline
def _scratch(points):
    """For `_find`: columns and rows of the first of two texels, and the second ones' weights."""
    return np.empty(2 * _MOST, dtype=np.int32), np.empty(2 * _MOST, dtype=points.dtype)


@inline
def _find(points, center, radii, size, places, shares):
    """Where the points (2, N) of a disc around a place [texels from the corner] are read."""
    for k in range(points.shape[1]):
        places[k], shares[k] = first_of_two(center[0] + points[0, k] * radii[0], size[1])
        places[_MOST + k], shares[_MOST + k] = first_of_two(center[1] + points[1, k] * radii[1], size[0])


def composite(color: Float, far: Float, near: Float, blurs: Float, added: bool) -> Float:
    """Far, then near over the picture: color (H, W, 3), far and near (h, w, 4) -> (H, W, 3).

    Where `added`, the far picture is black where it does not blur, and is added: blurs (2, H, W) are how much of the
    picture goes in each step. Else these are twice the circles, up to 1.
    """
    out = np.empty_like(color)  # of NumPy, whose large arrays are on large pages
    _composite(color, far, near, blurs, added, out)
    return out


@kernel
def _composite(color, far, near, blurs, added, out):
    (height, width), scalar, (rows, columns) = color.shape[:2], color.dtype.type, far.shape[:2]
    down, half = scalar(rows / height), scalar(0.5)
    first, share = np.empty(width, dtype=np.int64), np.empty(width, dtype=color.dtype)
    places_along(columns, first, share)
    behind, before = far.reshape(rows, 4 * columns), near.reshape(rows, 4 * columns)
    sharp, picture = color.reshape(height, 3 * width), out.reshape(height, 3 * width)
    for y in prange(height):
        two, places = np.empty((2, _RUN, 4), dtype=color.dtype), (borrow(first), borrow(share))
        between = np.empty((columns, 4), dtype=color.dtype)
        lines = texels_around((scalar(y) + half) * down, rows)
        for start in range(0, width, _RUN):
            end = min(start + _RUN, width)
            read_run(borrow(behind), lines, places, (start, end), borrow(between), two[0])
            read_run(borrow(before), lines, places, (start, end), borrow(between), two[1])
            source, row = borrow(sharp)[y, 3 * start : 3 * end], borrow(picture)[y, 3 * start : 3 * end]
            if added:
                kept = blurs[0, y, start:end], blurs[1, y, start:end]
                _lay_added(source, two[0].reshape(-1), two[1].reshape(-1), kept, row)
            else:
                _lay(source, two[0].reshape(-1), two[1].reshape(-1), row)


@inline
def _lay(source, far, near, out):
    """Far, then near pixels (4 X,) over a run's (3 X,), each by twice its circle."""
    two, half = out.dtype.type(2), out.dtype.type(0.5)
    for x in range(len(out) // 3):
        first, second = two * min(far[4 * x + 3], half), two * min(near[4 * x + 3], half)
        for c in range(3):
            out[3 * x + c] = _mix(_mix(source[3 * x + c], far[4 * x + c], first), near[4 * x + c], second)


@inline
def _lay_added(source, far, near, blurs, out):
    """The same where far pixels are added to what is left of the run's."""
    one = out.dtype.type(1)
    for x in range(len(out) // 3):
        for c in range(3):
            kept = source[3 * x + c] * (one - blurs[0][x]) + far[4 * x + c]
            out[3 * x + c] = _mix(kept, near[4 * x + c], blurs[1][x])


@inline
def _mix(a, b, t):
    return a * (type(t)(1) - t) + b * t
