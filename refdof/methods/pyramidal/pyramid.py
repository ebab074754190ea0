"""Pyramids that start at a whole picture and come back to it: box analysis, bilinear synthesis, holes filled between.

Sides are halved rounding up, so that every finer texel has a coarser one. Edges repeat.

References
----------
.. [1] Strengert, Kraus & Ertl (2006), Pyramid Methods in GPU-Based Image Processing, Vision, Modeling, and
   Visualization.
"""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["blurred", "empty_levels", "filled", "level_count"]

Mask: TypeAlias = npt.NDArray[np.bool_]

_CHANNELS = 4  # colour, and a circle of confusion or an opacity


def level_count(width: int, height: int) -> int:
    """Halvings until one texel is left."""
    return (max(width, height) - 1).bit_length()


def empty_levels(image: Float) -> list[Float]:
    """Arrays for all levels of an image's pyramid (H, W, 4), of its type: made once, used for many sub-images."""
    levels = [np.empty((*image.shape[:2], _CHANNELS), dtype=image.dtype)]
    while max(levels[-1].shape[:2]) > 1:
        levels.append(np.empty((*_half(levels[-1]), _CHANNELS), dtype=image.dtype))
    return levels


def blurred(image: Float, count: int, levels: Sequence[Float] = ()) -> Float:
    """Downsample `count` times by 4 x 4 means, then double as often, blending bilinearly: (H, W, 4).

    `levels`, as of `empty_levels`, are written to; the image may be the first of them. Below one texel they repeat it.
    """
    levels = [*(levels or empty_levels(image))]
    levels += [np.empty_like(levels[-1]) for _ in range(count + 1 - len(levels))]
    for k in range(count):
        _mean_of_16(_flat(levels[k] if k else image), _flat(levels[k + 1]))
    for k in range(count - 1, -1, -1):
        _double(_flat(levels[k + 1]), _flat(levels[k]))
    return levels[0] if count else image


def filled(image: Float, known: Mask, levels: Sequence[Float] = ()) -> Float:
    """Give pixels that are not `known` (H, W) bool a blend of those that are, from ever coarser levels: (H, W, 4).

    Where nothing is known, everything is 0. `levels`, as of `empty_levels`, are written to; the first is returned.
    """
    levels, masks = levels or empty_levels(image), [known]
    if known.all():
        levels[0][...] = image
        return levels[0]
    for k in range(len(levels) - 1):
        masks.append(np.empty(levels[k + 1].shape[:2], dtype=np.bool_))
        _mean_of_known(_flat(levels[k] if k else image), masks[k], _flat(levels[k + 1]), masks[k + 1])
    if len(levels) == 1:
        levels[0][...] = np.where(known[..., None], image, 0)
    for k in range(len(levels) - 2, -1, -1):
        _fill(_flat(levels[k + 1]), masks[k], _flat(levels[k] if k else image), _flat(levels[k]))
    return levels[0]


def _half(image: Float) -> tuple[int, int]:
    return (image.shape[0] + 1) // 2, (image.shape[1] + 1) // 2


def _flat(image: Float) -> Float:
    """The same memory, a texel's channels side by side in its row: (H, W C). Fixed steps let loops vectorise."""
    return image.reshape(image.shape[0], -1)


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
    """2 x 2 texels, of those that are known: the upper two first, 0 where none is."""
    height, length = fine.shape
    width = length // _CHANNELS
    for y in prange(len(coarse)):
        source, valid, row, some = borrow(fine), borrow(known), borrow(coarse)[y], borrow(mask)[y]
        two, zero = 2 * y + 1 < height, fine.dtype.type(0)
        top, low = source[2 * y], source[min(2 * y + 1, height - 1)]
        top_valid, low_valid = valid[2 * y], valid[min(2 * y + 1, height - 1)]
        for x in range(width // 2):
            p, q = top_valid[2 * x], top_valid[2 * x + 1]
            r, s = two and low_valid[2 * x], two and low_valid[2 * x + 1]
            count = int(p) + int(q) + int(r) + int(s)
            some[x], first = count > 0, 2 * _CHANNELS * x
            share = fine.dtype.type(max(count, 1))
            for c in range(_CHANNELS):
                total = (top[first + c] if p else zero) + (top[first + _CHANNELS + c] if q else zero)
                total += low[first + c] if r else zero
                total += low[first + _CHANNELS + c] if s else zero
                row[_CHANNELS * x + c] = total / share
        if width % 2:
            x = width - 1
            p, r = top_valid[x], two and low_valid[x]
            count = int(p) + int(r)
            some[x // 2] = count > 0
            for c in range(_CHANNELS):
                total = (top[_CHANNELS * x + c] if p else zero) + (low[_CHANNELS * x + c] if r else zero)
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
def _fill(coarse, known, source, fine):
    """Write texels that are known from the source, which may be fine itself, and others from between coarse ones."""
    for y in prange(len(fine)):
        row, kept, valid = borrow(fine)[y], borrow(source)[y], borrow(known)[y]
        if valid.all():
            for k in range(len(row)):
                row[k] = kept[k]
            continue
        line = _between_rows(borrow(coarse), y)
        width = len(valid)
        for x in range(width // 2):
            k, first, left, right = _CHANNELS * (x + 1), 2 * _CHANNELS * x, valid[2 * x], valid[2 * x + 1]
            for c in range(_CHANNELS):
                value = _blend(line[k + c], line[k - _CHANNELS + c])
                row[first + c] = kept[first + c] if left else value
            for c in range(_CHANNELS):
                value = _blend(line[k + c], line[k + _CHANNELS + c])
                row[first + _CHANNELS + c] = kept[first + _CHANNELS + c] if right else value
        if width % 2:
            k, first = _CHANNELS * (width // 2 + 1), _CHANNELS * (width - 1)
            for c in range(_CHANNELS):
                value = _blend(line[k + c], line[k - _CHANNELS + c])
                row[first + c] = kept[first + c] if valid[width - 1] else value


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
