"""Alike: where all circles around are one, the mean of taps that are read bilinearly."""

import numpy as np

from refdof._jit import inline
from refdof._jit.texel_sums import add_blend
from refdof.methods.filament.lanes import clipped, pairs

__all__ = ["alike"]


@inline
def alike(source, lanes, count, rings, table, scratch):
    """Leave colours times alpha, and alpha, of `count` lanes in the first rows of sums."""
    places, shares, totals, sums = scratch
    kind = source.dtype.type
    for n in range(count):
        for c in range(4):
            totals[n, c] = kind(0)
    for ring in range(rings):
        first, many = pairs(ring)
        share = kind(0.5 if ring == 0 else 1.0)
        for k in range(first, first + many):
            _add(source, lanes, count, share, (table[k, 0], table[k, 1]), places, shares, totals)
            _add(source, lanes, count, share, (-table[k, 0], -table[k, 1]), places, shares, totals)
    taps = kind((2 * rings - 1) * (2 * rings - 1))
    for n in range(count):
        alpha = clipped(lanes.circle[n] - kind(1))
        for c in range(3):
            sums[c, n] = totals[n, c] / taps * alpha
        sums[3, n] = alpha


@inline
def _add(source, lanes, count, share, tap, places, shares, totals):
    """Add a tap: places (3, N) are its first texel, and how far the next ones across and down are."""
    kind = source.dtype.type
    half, zero = kind(0.5), kind(0)
    for n in range(count):
        u = min(max(lanes.u[n] + lanes.step[n] * tap[0] - half, zero), lanes.right[n])
        v = min(max(lanes.v[n] + lanes.step[n] * tap[1] - half, zero), lanes.bottom[n])
        column, row = np.floor(u), np.floor(v)
        shares[0, n], shares[1, n] = u - column, v - row
        places[0, n] = lanes.start[n] + np.int32(row) * lanes.width[n] + np.int32(column)
        places[1, n] = np.int32(1 if column < lanes.right[n] else 0)
        places[2, n] = lanes.width[n] if row < lanes.bottom[n] else np.int32(0)
    for n in range(count):
        a = np.int64(places[0, n])
        b, c = a + places[1, n], a + places[2, n]
        add_blend(totals, n, share, source, a, b, c, c + places[1, n], shares[0, n], shares[1, n])
