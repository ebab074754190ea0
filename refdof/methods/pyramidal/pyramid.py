"""Pyramids that start at a whole picture and come back to it: box analysis, bilinear synthesis, holes filled between.

Sides are halved rounding up, so that every finer texel has a coarser one. Edges repeat.

References
----------
.. [1] Strengert, Kraus & Ertl (2006), Pyramid Methods in GPU-Based Image Processing, Vision, Modeling, and
   Visualization.
"""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["blurred", "filled", "level_count"]

Mask: TypeAlias = npt.NDArray[np.bool_]


def level_count(width: int, height: int) -> int:
    """Halvings until one texel is left."""
    return (max(width, height) - 1).bit_length()


def blurred(image: Float, levels: int) -> Float:
    """Downsample `levels` times by 4 x 4 means, then double as often, blending bilinearly: (H, W, C)."""
    shapes = []
    for _ in range(levels):
        shapes.append(image.shape)
        coarse = np.empty((*_half(image), image.shape[2]), dtype=image.dtype)
        _mean_of_16(image, coarse)
        image = coarse
    for shape in reversed(shapes):
        fine = np.empty(shape, dtype=image.dtype)
        _double(image, fine)
        image = fine
    return image


def filled(image: Float, known: Mask) -> Float:
    """Give pixels that are not `known` (H, W) bool a blend of those that are, from ever coarser levels: (H, W, C).

    Where nothing is known, everything is 0.
    """
    images, masks = [np.where(known[..., None], image, image.dtype.type(0))], [known]
    while max(images[-1].shape[:2]) > 1:
        shape = _half(images[-1])
        coarse, mask = np.empty((*shape, image.shape[2]), dtype=image.dtype), np.empty(shape, dtype=np.bool_)
        _mean_of_known(images[-1], masks[-1], coarse, mask)
        images.append(coarse)
        masks.append(mask)
    for k in range(len(images) - 2, -1, -1):
        _fill(images[k + 1], masks[k], images[k])
    return images[0]


def _half(image: Float) -> tuple[int, int]:
    return (image.shape[0] + 1) // 2, (image.shape[1] + 1) // 2


@kernel
def _mean_of_16(fine, coarse):
    """4 x 4 texels around a coarse texel's centre."""
    height, width, channels = fine.shape
    for y in prange(coarse.shape[0]):
        source = borrow(fine)
        rows = np.empty((width, channels), dtype=fine.dtype)
        rows[:] = fine.dtype.type(0)
        for j in range(2 * y - 1, 2 * y + 3):
            row = source[min(max(j, 0), height - 1)]
            for x in range(width):
                for c in range(channels):
                    rows[x, c] += row[x, c]
        for x in range(coarse.shape[1]):
            for c in range(channels):
                a, b = rows[max(2 * x - 1, 0), c], rows[min(2 * x, width - 1), c]
                d, e = rows[min(2 * x + 1, width - 1), c], rows[min(2 * x + 2, width - 1), c]
                coarse[y, x, c] = ((a + b) + (d + e)) / fine.dtype.type(16)


@kernel
def _mean_of_known(fine, known, coarse, mask):
    """2 x 2 texels, of those that are known."""
    height, width, channels = fine.shape
    for y in prange(coarse.shape[0]):
        source, valid = borrow(fine), borrow(known)
        total = np.empty(channels, dtype=fine.dtype)
        for x in range(coarse.shape[1]):
            count = 0
            total[:] = fine.dtype.type(0)
            for j in range(2 * y, min(2 * y + 2, height)):
                for i in range(2 * x, min(2 * x + 2, width)):
                    if valid[j, i]:
                        count += 1
                        for c in range(channels):
                            total[c] += source[j, i, c]
            mask[y, x] = count > 0
            for c in range(channels):
                coarse[y, x, c] = total[c] / fine.dtype.type(max(count, 1))


@kernel
def _double(coarse, fine):
    """Fill fine (H, W, C)."""
    for y in prange(fine.shape[0]):
        line, row = _between_rows(borrow(coarse), y), fine[y]
        for x in range(len(row)):
            near, other = 1 + x // 2, x // 2 + (2 if x % 2 else 0)
            for c in range(row.shape[1]):
                row[x, c] = _blend(line[near, c], line[other, c])


@kernel
def _fill(coarse, known, fine):
    """Fill texels of fine (H, W, C) that are not known."""
    for y in prange(fine.shape[0]):
        row, valid = fine[y], known[y]
        if valid.all():
            continue
        line = _between_rows(borrow(coarse), y)
        for x in range(len(row)):
            if not valid[x]:
                near, other = 1 + x // 2, x // 2 + (2 if x % 2 else 0)
                for c in range(row.shape[1]):
                    row[x, c] = _blend(line[near, c], line[other, c])


@inline
def _between_rows(coarse, y):
    """The blend of the two coarse rows nearest to fine row y: (w + 2, C), with the edge repeated on both sides."""
    height, width, channels = coarse.shape
    j = y // 2
    near, other = coarse[j], coarse[min(max(j + (1 if y % 2 else -1), 0), height - 1)]
    line = np.empty((width + 2, channels), dtype=coarse.dtype)
    for x in range(width):
        for c in range(channels):
            line[x + 1, c] = _blend(near[x, c], other[x, c])
    for c in range(channels):
        line[0, c], line[width + 1, c] = line[1, c], line[width, c]
    return line


@inline
def _blend(near, other):
    """Bilinear along one axis: a fine texel's centre lies a quarter of a coarse one from the nearer."""
    return (type(near)(3) * near + other) / type(near)(4)
