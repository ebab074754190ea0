"""Gather: the two discs of the half-resolution method, and its composite.

Pictures are (H, W, 4), of which three are a colour.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import add_read, read_to

__all__ = ["brightest", "composite", "means"]


@kernel
def means(picture, circles, points, reach):
    """Means over discs: picture (H, W, 4), circles (h, w) of `reach` px, points (N, 2) -> (h, w, 4), circle last."""
    size, (height, width) = picture.shape[:2], circles.shape
    scalar, texels = picture.dtype.type, picture.reshape(size[0] * size[1], 4)
    right, down, half = scalar(size[1] / width), scalar(size[0] / height), scalar(0.5)
    out = np.zeros((height, width, 4), dtype=picture.dtype)
    for y in prange(height):
        row, source, taps, v = borrow(out)[y], borrow(texels), borrow(points), (scalar(y) + half) * down
        for x in range(width):
            u, radius = (scalar(np.int32(x)) + half) * right, circles[y, x] * scalar(reach)
            if radius == scalar(0):  # all reads are the same one
                read_to(source, size, u, v, row, x)
            else:
                for k in range(len(taps)):
                    add_read(source, size, u + taps[k, 0] * radius, v + taps[k, 1] * radius, scalar(1), row, x)
                for c in range(3):
                    row[x, c] /= scalar(len(taps))
            row[x, 3] = circles[y, x]
    return out


@kernel
def brightest(picture, points, reach_x, reach_y):
    """Greatest values over discs: picture (h, w, 4), circle last, of (reach_x, reach_y) texels -> (h, w, 4)."""
    height, width = picture.shape[:2]
    scalar, texels = picture.dtype.type, picture.reshape(height * width, 4)
    half = scalar(0.5)
    out = picture.copy()
    for y in prange(height):
        read = np.empty((1, 4), dtype=picture.dtype)
        row, source, one, taps = borrow(out)[y], borrow(texels), borrow(read), borrow(points)
        for x in range(width):
            u, v, circle = scalar(np.int32(x)) + half, scalar(y) + half, row[x, 3]
            if circle > scalar(0):
                for k in range(len(taps)):
                    across, along = taps[k, 0] * (circle * scalar(reach_x)), taps[k, 1] * (circle * scalar(reach_y))
                    read_to(source, (height, width), u + across, v + along, one, 0)
                    for c in range(3):
                        row[x, c] = max(row[x, c], one[0, c])
    return out


@kernel
def composite(color, far, near, blurs, added):
    """Far, then near over the picture: color (H, W, 3), far and near (h, w, 4) -> (H, W, 3).

    Where `added`, the far picture is black where it does not blur, and is added: blurs (2, H, W) are how much of the
    picture goes in each step. Else these are twice the circles, up to 1.
    """
    height, width = color.shape[:2]
    scalar, size = color.dtype.type, far.shape[:2]
    right, down, half = scalar(size[1] / width), scalar(size[0] / height), scalar(0.5)
    one = scalar(1)
    behind, before = far.reshape(size[0] * size[1], 4), near.reshape(size[0] * size[1], 4)
    out = np.empty_like(color)
    for y in prange(height):
        reads = np.empty((2, 4), dtype=color.dtype)
        two, row, source, v = borrow(reads), borrow(out)[y], borrow(color)[y], (scalar(y) + half) * down
        for x in range(width):
            u = (scalar(np.int32(x)) + half) * right
            read_to(borrow(behind), size, u, v, two, 0)
            read_to(borrow(before), size, u, v, two, 1)
            if added:
                for c in range(3):
                    kept = source[x, c] * (one - blurs[0, y, x]) + two[0, c]
                    row[x, c] = _mix(kept, two[1, c], blurs[1, y, x])
            else:
                first, second = scalar(2) * min(two[0, 3], half), scalar(2) * min(two[1, 3], half)
                for c in range(3):
                    row[x, c] = _mix(_mix(source[x, c], two[0, c], first), two[1, c], second)
    return out


@inline
def _mix(a, b, t):
    return a * (type(t)(1) - t) + b * t
