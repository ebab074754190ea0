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
    """Halve `levels` times by 4 x 4 means, then double as often, blending bilinearly: (H, W, C)."""
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
        source = borrow(coarse)
        for x in range(fine.shape[1]):
            for c in range(fine.shape[2]):
                fine[y, x, c] = _blend(source, x, y, c)


@kernel
def _fill(coarse, known, fine):
    """Fill texels of fine (H, W, C) that are not known."""
    for y in prange(fine.shape[0]):
        source, valid = borrow(coarse), borrow(known)
        for x in range(fine.shape[1]):
            if not valid[y, x]:
                for c in range(fine.shape[2]):
                    fine[y, x, c] = _blend(source, x, y, c)


@inline
def _blend(coarse, x, y, c):
    """The four coarse texels nearest to a fine one's centre, with weights (9, 3, 3, 1) / 16."""
    three, four = coarse.dtype.type(3), coarse.dtype.type(4)
    i, j = x // 2, y // 2
    i1 = min(max(i + (1 if x % 2 else -1), 0), coarse.shape[1] - 1)
    j1 = min(max(j + (1 if y % 2 else -1), 0), coarse.shape[0] - 1)
    near = (three * coarse[j, i, c] + coarse[j, i1, c]) / four
    other = (three * coarse[j1, i, c] + coarse[j1, i1, c]) / four
    return (three * near + other) / four
