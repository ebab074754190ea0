"""Resize: a picture read bilinearly around the pixel centres of another size, as a pass over such a target does.

1. one read at the centre      `resize`: half of an even size is the mean of 2 x 2 texels
2. four at the corners of a square around it      `corner_means`
"""

import numpy as np

from refdof._jit import borrow, kernel, prange
from refdof.image.bilinear import add_read, read_to

__all__ = ["corner_means", "resize"]


@kernel
def resize(picture, height, width):
    """Picture (H, W, 4) -> (height, width, 4) of its type; reads beyond the edge repeat it."""
    rows, columns = picture.shape[:2]
    scalar, texels = picture.dtype.type, picture.reshape(rows * columns, 4)
    right, down, half = scalar(columns / width), scalar(rows / height), scalar(0.5)
    out = np.empty((height, width, 4), dtype=picture.dtype)
    for y in prange(height):
        row, source, v = borrow(out)[y], borrow(texels), (scalar(y) + half) * down
        for x in range(width):
            read_to(source, (rows, columns), (scalar(np.int32(x)) + half) * right, v, row, x)
    return out


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
