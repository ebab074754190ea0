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
        pair = np.empty((2, 3), dtype=color.dtype)
        source, row, weights, work = borrow(color)[y], borrow(out)[y], borrow(flat), borrow(pair)
        for x in range(width):
            for n in range(3 * parts):
                row[x, n] = weights[0, n // 3] * source[x, n % 3]
            for j in range(1, len(weights)):
                away = scalar(np.int32(j)) * spacing[y, x]
                _pair(source, borrow(reach)[y], x, away, work)
                for n in range(parts):
                    for c in range(3):
                        row[x, 3 * n + c] += weights[j, n] * work[0, c]
    return out


@inline
def _pair(source, reach, x, away, work):
    """The sum of the reads `away` px to both sides of pixel x: work[0] (3,)."""
    scalar = source.dtype.type
    for c in range(3):
        work[0, c] = scalar(0)
    for side in range(2):
        first, second, share = _between(scalar(np.int32(x)) + (away if side else -away), len(source))
        away_from_focus = reach[first] > scalar(0) or reach[second] > scalar(0)
        for c in range(3):
            read = source[first, c] + (source[second, c] - source[first, c]) * share
            work[0, c] += read if away_from_focus else source[x, c]


@inline
def _between(place, size):
    """The two texels around a place [texels from the first one's centre], and the second's weight."""
    kind = type(place)
    cut = min(max(place, kind(0)), kind(np.int32(size - 1)))
    first = int(cut)
    return first, min(first + 1, size - 1), cut - kind(np.int32(first))


@kernel
def down(parts, spacing, taps, reach):
    """What `across` makes (H, W, 6 n) -> (H, W, 3), with taps (R + 1, n, 2) of the second pass."""
    height, width, count = parts.shape
    scalar = parts.dtype.type
    flat = taps.reshape(len(taps), count // 3)
    out = np.empty((height, width, 3), dtype=parts.dtype)
    for y in prange(height):
        sums = np.empty(count, dtype=parts.dtype)
        source, weights, row, total = borrow(parts), borrow(flat), borrow(out)[y], borrow(sums)
        for x in range(width):
            for n in range(count):
                total[n] = weights[0, n // 3] * source[y, x, n]
            for j in range(1, len(weights)):
                away = scalar(np.int32(j)) * spacing[y, x]
                for side in range(2):
                    first, second, share = _between(scalar(y) + (away if side else -away), height)
                    if not (reach[first, x] > scalar(0) or reach[second, x] > scalar(0)):
                        first, second = np.int64(y), np.int64(y)
                    for n in range(count):
                        read = source[first, x, n] + (source[second, x, n] - source[first, x, n]) * share
                        total[n] += weights[j, n // 3] * read
            for c in range(3):
                sum_of_parts = scalar(0)
                for n in range(c, count, 3):
                    sum_of_parts += total[n]
                row[x, c] = sum_of_parts
    return out
