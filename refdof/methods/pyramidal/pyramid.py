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

_CHANNELS = 4  # colour, and a circle of confusion or an opacity


def level_count(width: int, height: int) -> int:
    """Halvings until one texel is left."""
    return (max(width, height) - 1).bit_length()


def blurred(image: Float, levels: int) -> Float:
    """Downsample `levels` times by 4 x 4 means, then double as often, blending bilinearly: (H, W, 4)."""
    shapes = []
    for _ in range(levels):
        shapes.append(image.shape)
        coarse = np.empty((*_half(image), _CHANNELS), dtype=image.dtype)
        _mean_of_16(_flat(image), _flat(coarse))
        image = coarse
    for shape in reversed(shapes):
        fine = np.empty(shape, dtype=image.dtype)
        _double(_flat(image), _flat(fine))
        image = fine
    return image


def filled(image: Float, known: Mask) -> Float:
    """Give pixels that are not `known` (H, W) bool a blend of those that are, from ever coarser levels: (H, W, 4).

    Where nothing is known, everything is 0.
    """
    images, masks = [np.empty_like(image)], [known]
    _keep(_flat(image), known, _flat(images[0]))
    while max(images[-1].shape[:2]) > 1:
        shape = _half(images[-1])
        coarse, mask = np.empty((*shape, _CHANNELS), dtype=image.dtype), np.empty(shape, dtype=np.bool_)
        _mean_of_known(_flat(images[-1]), masks[-1], _flat(coarse), mask)
        images.append(coarse)
        masks.append(mask)
    for k in range(len(images) - 2, -1, -1):
        _fill(_flat(images[k + 1]), masks[k], _flat(images[k]))
    return images[0]


def _half(image: Float) -> tuple[int, int]:
    return (image.shape[0] + 1) // 2, (image.shape[1] + 1) // 2


def _flat(image: Float) -> Float:
    """The same memory, a texel's channels side by side in its row: (H, W C). Fixed steps let loops vectorise."""
    return image.reshape(image.shape[0], -1)


@kernel
def _keep(image, known, kept):
    """Copy texels that are known; 0 for others."""
    for y in prange(len(image)):
        source, valid, row = image[y], known[y], kept[y]
        for x in range(len(valid)):
            for c in range(_CHANNELS):
                value = source[_CHANNELS * x + c]
                row[_CHANNELS * x + c] = value if valid[x] else image.dtype.type(0)


@kernel
def _mean_of_16(fine, coarse):
    """4 x 4 texels around a coarse texel's centre."""
    height, length = fine.shape
    for y in prange(len(coarse)):
        source, row, j = borrow(fine), coarse[y], 2 * y
        a, b = source[max(j - 1, 0)], source[j]
        d, e = source[min(j + 1, height - 1)], source[min(j + 2, height - 1)]
        column = np.empty(length + 3 * _CHANNELS, dtype=fine.dtype)  # one texel more on the left, two on the right
        for k in range(length):
            column[_CHANNELS + k] = ((a[k] + b[k]) + d[k]) + e[k]
        for c in range(_CHANNELS):
            column[c] = column[_CHANNELS + c]
            column[length + _CHANNELS + c] = column[length + 2 * _CHANNELS + c] = column[length + c]
        for x in range(len(row) // _CHANNELS):
            first = 2 * _CHANNELS * x
            for c in range(_CHANNELS):
                left = column[first + c] + column[first + _CHANNELS + c]
                right = column[first + 2 * _CHANNELS + c] + column[first + 3 * _CHANNELS + c]
                row[_CHANNELS * x + c] = (left + right) / fine.dtype.type(16)


@kernel
def _mean_of_known(fine, known, coarse, mask):
    """2 x 2 texels, of those that are known. Those that are not are 0."""
    height, length = fine.shape
    width = length // _CHANNELS
    for y in prange(len(coarse)):
        source, valid, row = borrow(fine), borrow(known), coarse[y]
        two = 2 * y + 1 < height
        top, low = source[2 * y], source[min(2 * y + 1, height - 1)]
        top_valid, low_valid = valid[2 * y], valid[min(2 * y + 1, height - 1)]
        for x in range(width // 2):
            count = int(top_valid[2 * x]) + int(top_valid[2 * x + 1])
            if two:
                count += int(low_valid[2 * x]) + int(low_valid[2 * x + 1])
            mask[y, x] = count > 0
            some, first = fine.dtype.type(max(count, 1)), 2 * _CHANNELS * x
            for c in range(_CHANNELS):
                total = top[first + c] + top[first + _CHANNELS + c]
                if two:
                    total = (total + low[first + c]) + low[first + _CHANNELS + c]
                row[_CHANNELS * x + c] = total / some
        if width % 2:
            x = width - 1
            count = int(top_valid[x]) + (int(low_valid[x]) if two else 0)
            mask[y, x // 2] = count > 0
            for c in range(_CHANNELS):
                total = top[_CHANNELS * x + c] + (low[_CHANNELS * x + c] if two else fine.dtype.type(0))
                row[_CHANNELS * (x // 2) + c] = total / fine.dtype.type(max(count, 1))


@kernel
def _double(coarse, fine):
    """Fill fine."""
    for y in prange(len(fine)):
        line, row = _between_rows(borrow(coarse), y), fine[y]
        width = len(row) // _CHANNELS
        for x in range(width // 2):
            k, first = _CHANNELS * (x + 1), 2 * _CHANNELS * x
            for c in range(_CHANNELS):
                row[first + c] = _blend(line[k + c], line[k - _CHANNELS + c])
                row[first + _CHANNELS + c] = _blend(line[k + c], line[k + _CHANNELS + c])
        if width % 2:
            k = _CHANNELS * (width // 2 + 1)
            for c in range(_CHANNELS):
                row[_CHANNELS * (width - 1) + c] = _blend(line[k + c], line[k - _CHANNELS + c])


@kernel
def _fill(coarse, known, fine):
    """Fill texels of fine that are not known."""
    for y in prange(len(fine)):
        row, valid = fine[y], known[y]
        if valid.all():
            continue
        line = _between_rows(borrow(coarse), y)
        for x in range(len(valid)):
            near, other = _CHANNELS * (1 + x // 2), _CHANNELS * (x // 2 + (2 if x % 2 else 0))
            for c in range(_CHANNELS):
                value = _blend(line[near + c], line[other + c])
                row[_CHANNELS * x + c] = row[_CHANNELS * x + c] if valid[x] else value


@inline
def _between_rows(coarse, y):
    """The blend of the two coarse rows nearest to fine row y, with a texel more at both ends that repeats the edge."""
    height, length = coarse.shape
    j = y // 2
    near, other = coarse[j], coarse[min(max(j + (1 if y % 2 else -1), 0), height - 1)]
    line = np.empty(length + 2 * _CHANNELS, dtype=coarse.dtype)
    for k in range(length):
        line[_CHANNELS + k] = _blend(near[k], other[k])
    for c in range(_CHANNELS):
        line[c], line[length + _CHANNELS + c] = line[_CHANNELS + c], line[length + c]
    return line


@inline
def _blend(near, other):
    """Bilinear along one axis: a fine texel's centre lies a quarter of a coarse one from the nearer."""
    return (type(near)(3) * near + other) / type(near)(4)
