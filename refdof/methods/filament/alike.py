"""Alike: where all circles around are one, the mean of taps that are read bilinearly.

All taps of a pixel are placed first, then read eight at a time.
"""

import numpy as np

from refdof._jit import inline
from refdof._jit.texel_lanes import LANES, add_reads
from refdof.image.bilinear import add_read
from refdof.methods.filament.rings import clipped, level_of

__all__ = ["alike"]


@inline
def alike(picture, pixels, circle, rings, scratch, row):
    """Write colours times alpha, and alpha, of pixels x = begin .. end of row y, whose rings are alike, to row (w, 4).

    scratch: (2, 80) int32, (2, 80), and (1, 4).
    """
    (source, levels, table, moved), (begin, end, y), kind = picture, pixels, picture[0].dtype.type
    places, shares, sums = scratch
    upper, lower, across, down = places[0], places[1], shares[0], shares[1]
    half, taps, apart = kind(0.5), 4 * rings * (rings - 1), circle / (kind(rings) - kind(0.5))
    level = level_of(apart)
    start, width, height = levels[0, level], levels[1, level], levels[2, level]
    scale = kind(1) / kind(np.int32(1 << level))
    step, alpha = half * apart * scale, clipped(circle - kind(1))
    for x in range(begin, end):
        u = (kind(np.int32(x)) + half + half * apart * moved[x, 0]) * scale
        v = (kind(y) + half + half * apart * moved[x, 1]) * scale
        _place(u - half, v - half, step, table, taps, (start, width, height), (upper, lower, across, down))
        for c in range(4):
            sums[0, c] = kind(0)
        add_read(source[start : start + width * height], (height, width), u, v, kind(1), sums, 0)
        for k in range(0, taps, LANES):
            add_reads(source, upper, lower, across, down, k, sums, 0)
        for c in range(3):
            row[x, c] = sums[0, c] / kind(taps + 1) * alpha
        row[x, 3] = alpha


@inline
def _place(u, v, step, table, taps, level, out):
    """Texels and weights of all taps around (u, v) [texels from the first one's centre]."""
    (start, width, height), (upper, lower, across, down) = level, out
    kind = type(u)
    zero, right, bottom, below = kind(0), kind(width - 1), kind(height - 1), np.int32(width)
    for k in range(taps):
        i, j = min(max(u + step * table[0, k], zero), right), min(max(v + step * table[1, k], zero), bottom)
        column, line = np.floor(i), np.floor(j)
        across[k], down[k] = i - column, j - line
        upper[k] = np.int32(start) + np.int32(line) * below + np.int32(column)
        lower[k] = upper[k] + (below if line < bottom else np.int32(0))
