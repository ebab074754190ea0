"""Background: rings from outside in; what an inner ring's nearer taps hide of the outer ones is taken away."""

from refdof._jit import inline
from refdof.methods.filament.lanes import distances, fetch_pair
from refdof.methods.filament.rings import clipped, light_of, pairs

__all__ = ["background"]

# Rows of sums: three colours, weight, weighted circle, of all rings outside; then the same of one ring.
_WEIGHT, _CIRCLE, _OWN = 3, 4, 5
_TINY = 1e-30


@inline
def background(source, lanes, count, rings, table, scratch):
    """Leave colours times alpha, and alpha, of `count` lanes in the first rows of sums."""
    places, taps, sums, distance, border, missed = scratch
    scalar = source.dtype.type
    for k in range(_OWN):
        for n in range(count):
            sums[k, n] = scalar(0)
    for inward in range(rings):
        ring = rings - 1 - inward
        first, many = pairs(ring)
        share = scalar(0.5 if ring == 0 else 1.0)
        distances(lanes, count, table[0, first], table[1, first], distance)
        for n in range(count):
            border[n], missed[n] = lanes.apart[n] * (scalar(ring) + scalar(0.5)), scalar(0)
        for k in range(_OWN, 2 * _OWN):
            for n in range(count):
                sums[k, n] = scalar(0)
        for k in range(first, first + many):
            fetch_pair(source, lanes, count, table[0, k], table[1, k], places, taps)
            if inward == 0:
                _add_outermost(lanes, count, share, taps, distance, sums)
            else:
                _add(lanes, count, share, taps, distance, border, sums, missed)
        if inward > 0:
            _lay(count, scalar(2 * many), missed, sums)
    _weigh(lanes, count, rings, sums)


@inline
def _add_outermost(lanes, count, share, taps, distance, sums):
    """Add a pair of taps of the outermost ring."""
    for n in range(count):
        a = share * _weight(taps[3, n], distance[n], lanes.scale[n], lanes.least[n])
        b = share * _weight(taps[7, n], distance[n], lanes.scale[n], lanes.least[n])
        sums[0, n] += a * taps[0, n] + b * taps[4, n]
        sums[1, n] += a * taps[1, n] + b * taps[5, n]
        sums[2, n] += a * taps[2, n] + b * taps[6, n]
        sums[3, n] += a + b
        sums[4, n] += a * taps[3, n] + b * taps[7, n]


@inline
def _add(lanes, count, share, taps, distance, border, sums, missed):
    """Add a pair of taps: what is behind the ring to the rings outside, the rest to the ring's own."""
    half, zero = taps.dtype.type(0.5), taps.dtype.type(0)
    for n in range(count):
        a = share * _weight(taps[3, n], distance[n], lanes.scale[n], lanes.least[n])
        b = share * _weight(taps[7, n], distance[n], lanes.scale[n], lanes.least[n])
        before_a, before_b = clipped(taps[3, n] - border[n] + half), clipped(taps[7, n] - border[n] + half)
        outer_a, outer_b = a * before_a, b * before_b
        own_a, own_b = a - outer_a, b - outer_b
        missed[n] += (before_a if taps[3, n] > zero else zero) + (before_b if taps[7, n] > zero else zero)
        sums[0, n] += outer_a * taps[0, n] + outer_b * taps[4, n]
        sums[1, n] += outer_a * taps[1, n] + outer_b * taps[5, n]
        sums[2, n] += outer_a * taps[2, n] + outer_b * taps[6, n]
        sums[3, n] += outer_a + outer_b
        sums[4, n] += outer_a * taps[3, n] + outer_b * taps[7, n]
        sums[5, n] += own_a * taps[0, n] + own_b * taps[4, n]
        sums[6, n] += own_a * taps[1, n] + own_b * taps[5, n]
        sums[7, n] += own_a * taps[2, n] + own_b * taps[6, n]
        sums[8, n] += own_a + own_b
        sums[9, n] += own_a * taps[3, n] + own_b * taps[7, n]


@inline
def _weight(circle, distance, scale, least):
    """Of a tap that is behind what is in focus, and reaches the pixel, softly: its light."""
    kind = type(circle)
    weight = clipped((circle - distance) * scale + kind(0.5)) * light_of(circle, least)
    return weight if circle > kind(0) else kind(0)


@inline
def _lay(count, taps, missed, sums):
    """Lay a ring over the rings outside, of which it hides what its own taps are nearer than."""
    one, tiny = sums.dtype.type(1), sums.dtype.type(_TINY)
    for n in range(count):
        outer, own = sums[_WEIGHT, n], sums[_OWN + _WEIGHT, n]
        nearer = clipped(sums[_CIRCLE, n] / max(outer, tiny) - sums[_OWN + _CIRCLE, n] / max(own, tiny))
        kept = one - (one - missed[n] / taps) * nearer if own >= tiny else one
        for k in range(_OWN):
            sums[k, n] = sums[k, n] * kept + sums[_OWN + k, n]


@inline
def _weigh(lanes, count, rings, sums):
    """Weighted colours to colours times alpha."""
    kind = sums.dtype.type
    one = kind(1)
    for n in range(count):
        circle, weight = lanes.circle[n], sums[_WEIGHT, n]
        share = clipped(circle - one)
        full = light_of(circle * (kind(rings) + kind(0.5)) / kind(rings), lanes.least[n])
        alpha = clipped(weight / full) * share * share * (kind(3) - kind(2) * share)
        scale = alpha / max(weight, kind(_TINY))
        for c in range(3):
            sums[c, n] *= scale
        sums[3, n] = alpha
