"""Passes: along rows with complex taps, then along columns, where their products become colours.

Each pixel's taps are as far apart as its own circle says. A tap outside repeats the edge.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange

__all__ = ["across", "down"]


@kernel
def across(color, spacing, taps, reach):
    """Color (H, W, 3), spacing (H, W) px, taps (R + 1, n, 2) -> (H, W, 6 n): real and imaginary colours.

    reach (H, W): taps where it is 0 count as the pixel itself.
    """
    height, width = spacing.shape
    scalar, parts = color.dtype.type, 2 * taps.shape[1]
    out = np.empty((height, width, 3 * parts), dtype=color.dtype)
    flat = taps.reshape(len(taps), parts)
    for y in prange(height):
        source, row, weights, near = borrow(color)[y], borrow(out)[y], borrow(flat), borrow(reach)[y]
        for x in range(width):
            for n in range(3 * parts):
                row[x, n] = weights[0, n // 3] * source[x, n % 3]
            for j in range(1, len(weights)):
                away = scalar(np.int32(j)) * spacing[y, x]
                red, green, blue = _pair(source, near, x, away)
                for n in range(parts):
                    row[x, 3 * n] += weights[j, n] * red
                    row[x, 3 * n + 1] += weights[j, n] * green
                    row[x, 3 * n + 2] += weights[j, n] * blue
    return out


@inline
def _for_each_color(taps):
    """Each number three times (R, 3 N), so that loops over parts' colours vectorise."""
    out = np.empty((taps.shape[0], 3 * taps.shape[1]), dtype=taps.dtype)
    for j in range(out.shape[0]):
        for n in range(out.shape[1]):
            out[j, n] = taps[j, n // 3]
    return out


@inline
def _pair(source, reach, x, away):
    """The sum of the reads `away` px to both sides of pixel x: three channels."""
    scalar = source.dtype.type
    left = _read(source, reach, x, scalar(np.int32(x)) - away)
    right = _read(source, reach, x, scalar(np.int32(x)) + away)
    return left[0] + right[0], left[1] + right[1], left[2] + right[2]


@inline
def _read(source, reach, x, place):
    i, k, share = _between(place, len(source))
    if not (reach[i] > type(share)(0) or reach[k] > type(share)(0)):
        i, k = np.int64(x), np.int64(x)
    first, second = source[i], source[k]
    return (
        first[0] + (second[0] - first[0]) * share,
        first[1] + (second[1] - first[1]) * share,
        first[2] + (second[2] - first[2]) * share,
    )


@inline
def _between(place, size):
    """The two texels around a place [texels from the first one's centre], and the second's weight."""
    kind = type(place)
    cut = min(max(place, kind(0)), kind(np.int32(size - 1)))
    first = int(cut)
    return first, min(first + 1, size - 1), cut - kind(np.int32(first))


@inline
def _add_blended(first, second, share, weights, total):
    for n in range(len(total)):
        total[n] += weights[n] * (first[n] + (second[n] - first[n]) * share)


@kernel
def down(parts, spacing, taps, reach):
    """What `across` makes (H, W, 6 n) -> (H, W, 3), with taps (R + 1, n, 2) of the second pass."""
    height, width, count = parts.shape
    scalar = parts.dtype.type
    flat = _for_each_color(taps.reshape(len(taps), count // 3))
    out = np.empty((height, width, 3), dtype=parts.dtype)
    for y in prange(height):
        sums = np.empty(count, dtype=parts.dtype)
        source, weights, row, total = borrow(parts), borrow(flat), borrow(out)[y], borrow(sums)
        for x in range(width):
            for n in range(count):
                total[n] = weights[0, n] * source[y, x, n]
            for j in range(1, len(weights)):
                away = scalar(np.int32(j)) * spacing[y, x]
                for side in range(2):
                    first, second, share = _between(scalar(y) + (away if side else -away), height)
                    if not (reach[first, x] > scalar(0) or reach[second, x] > scalar(0)):
                        first, second = np.int64(y), np.int64(y)
                    _add_blended(source[first, x], source[second, x], share, weights[j], total)
            for c in range(3):
                sum_of_parts = scalar(0)
                for n in range(c, count, 3):
                    sum_of_parts += total[n]
                row[x, c] = sum_of_parts
    return out
