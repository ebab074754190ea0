"""Foreground: near taps that reach the pixel, in two layers, of which each pair of taps shares the nearer circle."""

from refdof._jit import inline
from refdof.methods.filament.lanes import distances, fetch_pair
from refdof.methods.filament.rings import clipped, light_of, pairs

__all__ = ["foreground"]

# Rows of sums: three colours and weight of the layer in front, then of the one behind.
_WEIGHT, _BEHIND = 3, 4
_TINY = 1e-30


@inline
def foreground(source, lanes, count, rings, table, scratch):
    """Leave colours times alpha, and alpha, of `count` lanes in the first rows of sums."""
    places, taps, sums, distance = scratch[:4]
    scalar = source.dtype.type
    for k in range(2 * _BEHIND):
        for n in range(count):
            sums[k, n] = scalar(0)
    for ring in range(rings):
        first, many = pairs(ring)
        share = scalar(0.5 if ring == 0 else 1.0)
        distances(lanes, count, table[0, first], table[1, first], distance)
        for k in range(first, first + many):
            fetch_pair(source, lanes, count, table[0, k], table[1, k], places, taps)
            _add(lanes, count, share, taps, distance, sums)
    _weigh(lanes, count, rings, sums)


@inline
def _add(lanes, count, share, taps, distance, sums):
    """Add a pair of taps to the two layers."""
    kind = taps.dtype.type
    zero, one, two, half = kind(0), kind(1), kind(2), kind(0.5)
    for n in range(count):
        circle = -min(taps[3, n], taps[7, n])
        weight = min(circle, one) * clipped((circle - distance[n]) * lanes.scale[n] + half)
        weight = share * weight * light_of(circle, lanes.least[n]) if circle > zero else zero
        behind = weight * clipped((lanes.circle[n] - circle - two) * half)
        before = weight - behind
        red, green, blue = taps[0, n] + taps[4, n], taps[1, n] + taps[5, n], taps[2, n] + taps[6, n]
        sums[0, n] += before * red
        sums[1, n] += before * green
        sums[2, n] += before * blue
        sums[3, n] += two * before
        sums[4, n] += behind * red
        sums[5, n] += behind * green
        sums[6, n] += behind * blue
        sums[7, n] += two * behind


@inline
def _weigh(lanes, count, rings, sums):
    """Weighted colours to colours times alpha, the layer in front over the one behind."""
    kind, taps = sums.dtype.type, (2 * rings - 1) * (2 * rings - 1)
    one, tiny = kind(1), kind(_TINY)
    for n in range(count):
        full = light_of(lanes.circle[n] * (kind(rings) + kind(0.5)) / kind(rings), lanes.least[n]) * kind(taps)
        before, behind = clipped(sums[_WEIGHT, n] / full), clipped(sums[_BEHIND + _WEIGHT, n] / full)
        near = before / max(sums[_WEIGHT, n], tiny)
        far = behind * (one - before) / max(sums[_BEHIND + _WEIGHT, n], tiny)
        for c in range(3):
            sums[c, n] = sums[c, n] * near + sums[_BEHIND + c, n] * far
        sums[3, n] = one - (one - before) * (one - behind)
