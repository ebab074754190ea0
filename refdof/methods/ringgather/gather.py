"""Gather: the sums over rings of taps at half the size, near over far. Circles are in pixels of that size.

Runs of tiles whose greatest circle is the same spread their taps alike, so that a tap reads a shifted part of rows.
"""

import math

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.order import fair_step
from refdof.methods.ringgather.prefilter import BEFORE, BEHIND, CIRCLE, LEAST_AREA

__all__ = ["rings"]

_LEAST_WEIGHT = 1e-5
_TAPS = 49  # of all rings, with the centre
_RUN = 128  # px: at most, whose sums stay in the nearest cache
_SHARP, _LIKE, _SORTED = 0, 1, 2  # kinds of tiles: hardly any blur, circles that hardly differ, all else
# Where a run's sums begin: colours and weights of what is behind and before; then the weights of one tap.
_FAR, _NEAR, _TAP, _END = 0, 4 * _RUN, 8 * _RUN, 10 * _RUN


@kernel
def rings(planes, margin, greatest, least, side, taps, gain):
    """Sums over rings: `prefilter`'s planes, greatest and least circle of tiles and those around -> (h, w, 4).

    side: of a tile; taps (48, 2); gain: opacity of the near taps. Alpha is last.
    """
    (height, width), scalar = (len(planes), planes.shape[2] - 2 * margin), planes.dtype.type
    out = np.empty((height, width, 4), dtype=planes.dtype)
    step = fair_step(len(greatest))
    for turn in prange(len(greatest)):
        band = turn * step % len(greatest)
        most, lowest, source, picture = borrow(greatest)[band], borrow(least)[band], borrow(planes), borrow(out)
        sums, offsets = np.empty(_END, dtype=planes.dtype), np.empty((_TAPS, 4), dtype=np.int64)
        weights, table, first = np.empty((_TAPS, 6), dtype=planes.dtype), borrow(taps), 0
        while first < len(most):
            end = _end_of_run(most, lowest, first, _RUN // side)
            kind, start, used = _kind_of(most[first], lowest[first]), first * side, _rings_of(most[first])
            _place(table, most[first], used, offsets, weights)
            for y in range(band * side, min((band + 1) * side, height)):
                row = picture[y, start : min(end * side, width)]
                if kind == _SHARP:
                    _copy(source[y, :, margin + start :], row)
                    continue
                sums[:] = scalar(0)
                count = 4 * used * (used + 1) + 1
                scale = scalar(used) / most[first]
                _add_taps(source, (margin + start, y), len(row), (offsets[:count], weights[:count], scale), kind, sums)
                if kind == _LIKE:
                    _divide(sums, count, row)
                else:
                    _lay(sums, count, most[first], gain, row)
            first = end
    return out


@inline
def _kind_of(most, least):
    if most < type(most)(1):
        return _SHARP
    return _LIKE if most - least < type(most)(1) else _SORTED


@inline
def _end_of_run(most, least, first, longest):
    """The tile after those, from `first` on, that are of one kind and have one greatest circle."""
    tile, kind = first + 1, _kind_of(most[first], least[first])
    while tile < min(first + longest, len(most)) and kind == _kind_of(most[tile], least[tile]):
        if most[tile] != most[first]:
            break
        tile += 1
    return tile


@inline
def _rings_of(most):
    """How many rings are used."""
    return min(max(int(np.ceil(type(most)(3) * np.sqrt(most))), 1), 3)


@inline
def _place(taps, most, used, offsets, weights):
    """The centre and the taps of `used` rings: offsets (x, y) of the first of four texels and of the nearest one.

    weights: of the four texels, then rings from the first one on, and the least of what that is multiplied by.
    """
    scalar = taps.dtype.type
    reach, half, one, k = scalar(used) / scalar(3) * most, scalar(0.5), scalar(1), 0
    for ring in range(used + 1):
        for _ in range(max(8 * ring, 1)):
            dx, dy = (reach * taps[k - 1, 0], reach * taps[k - 1, 1]) if k > 0 else (scalar(0), scalar(0))
            offsets[k, 0], offsets[k, 1] = _floor(dx), _floor(dy)
            offsets[k, 2], offsets[k, 3] = _floor(dx + half), _floor(dy + half)
            across, down = dx - np.floor(dx), dy - np.floor(dy)
            weights[k, 0], weights[k, 1] = (one - across) * (one - down), across * (one - down)
            weights[k, 2], weights[k, 3] = (one - across) * down, across * down
            weights[k, 4], weights[k, 5] = scalar(ring) - one, scalar(0) if ring == 1 else one
            k += 1


@inline
def _add_taps(planes, corner, count, taps, kind, sums):
    """Add taps, as `_place` has them, of `count` pixels from `corner` (x, y) of the planes on. Rings per pixel last."""
    (left, y), (offsets, weights, scale), last = corner, taps, len(planes) - 1
    rows, pitch = planes.reshape(len(planes), -1), planes.shape[2]
    for k in range(len(offsets)):
        if kind == _SORTED:
            row, start = min(max(y + offsets[k, 3], 0), last), left + offsets[k, 2]
            _weigh(rows[row], pitch, start, count, (scale, weights[k, 4], weights[k, 5]), sums)
        first, start = y + offsets[k, 1], left + offsets[k, 0]
        pair = rows[min(max(first, 0), last)], rows[min(max(first + 1, 0), last)]
        four = weights[k, 0], weights[k, 1], weights[k, 2], weights[k, 3]
        if kind == _SORTED:
            _add_weighed(pair, pitch, start, count, four, sums)
        else:
            _add(pair, pitch, start, count, four, sums)


@inline
def _floor(x):
    return np.int64(np.floor(x))


@inline
def _weigh(row, pitch, start, count, ring, sums):
    """Weights of a tap that pixels in a row read: by how far its circle reaches into its ring, the first one's squared.

    ring: rings per pixel, and as `_place` has it.
    """
    zero, one, (scale, inner, least) = sums.dtype.type(0), sums.dtype.type(1), ring
    circle, behind = np.uintp(CIRCLE * pitch + start), np.uintp(BEHIND * pitch + start)
    before = np.uintp(BEFORE * pitch + start)
    for x in range(count):
        covers = min(max(row[circle + np.uintp(x)] * scale - inner, zero), one)
        covers *= max(covers, least)
        far, near = covers * row[behind + np.uintp(x)], covers * row[before + np.uintp(x)]
        sums[_TAP + x], sums[_TAP + _RUN + x] = far, near
        sums[_FAR + 3 * _RUN + x] += far
        sums[_NEAR + 3 * _RUN + x] += near


@inline
def _add_weighed(rows, pitch, start, count, four, sums):
    """Add colours read between two rows to both sums by the tap's weights."""
    red, green, blue = np.uintp(start), np.uintp(pitch + start), np.uintp(2 * pitch + start)
    for x in range(count):
        far, near = sums[_TAP + x], sums[_TAP + _RUN + x]
        r, g, b = _read(rows, red, x, four), _read(rows, green, x, four), _read(rows, blue, x, four)
        sums[_FAR + x] += far * r
        sums[_FAR + _RUN + x] += far * g
        sums[_FAR + 2 * _RUN + x] += far * b
        sums[_NEAR + x] += near * r
        sums[_NEAR + _RUN + x] += near * g
        sums[_NEAR + 2 * _RUN + x] += near * b


@inline
def _add(rows, pitch, start, count, four, sums):
    """Add colours read between two rows to the first sums."""
    red, green, blue = np.uintp(start), np.uintp(pitch + start), np.uintp(2 * pitch + start)
    for x in range(count):
        sums[_FAR + x] += _read(rows, red, x, four)
        sums[_FAR + _RUN + x] += _read(rows, green, x, four)
        sums[_FAR + 2 * _RUN + x] += _read(rows, blue, x, four)


@inline
def _read(rows, start, x, four):
    """Of texels x and x + 1 from `start` on of two rows. Unsigned places spare the test for negative ones."""
    (upper, lower), k = rows, start + np.uintp(x)
    m = k + np.uintp(1)
    return (upper[k] * four[0] + upper[m] * four[1]) + (lower[k] * four[2] + lower[m] * four[3])


@inline
def _copy(planes, row):
    for x in range(len(row)):
        row[x, 0], row[x, 1], row[x, 2], row[x, 3] = planes[0, x], planes[1, x], planes[2, x], row.dtype.type(1)


@inline
def _divide(sums, count, row):
    """The mean of all taps, alpha 0."""
    whole = row.dtype.type(count)
    for x in range(len(row)):
        row[x, 0], row[x, 1] = sums[_FAR + x] / whole, sums[_FAR + _RUN + x] / whole
        row[x, 2], row[x, 3] = sums[_FAR + 2 * _RUN + x] / whole, row.dtype.type(0)


@inline
def _lay(sums, count, most, gain, row):
    """The near sum over the far one, by its weight beside that of full cover."""
    scalar = row.dtype.type
    least, one, strength = scalar(_LEAST_WEIGHT), scalar(1), scalar(gain) / scalar(count)
    area = max(scalar(math.pi) * most * most, scalar(LEAST_AREA))
    for x in range(len(row)):
        behind, before = sums[_FAR + 3 * _RUN + x], sums[_NEAR + 3 * _RUN + x]
        alpha = min(max(strength * before * area, scalar(0)), one)
        behind, before = max(least, behind), max(least, before)
        for c in range(3):
            far, near = sums[_FAR + c * _RUN + x] / behind, sums[_NEAR + c * _RUN + x] / before
            row[x, c] = far * (one - alpha) + near * alpha
        row[x, 3] = alpha
