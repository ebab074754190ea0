"""Gather: the sums over rings of taps at half the size, near over far. Circles are in pixels of that size.

Runs of tiles whose greatest circle is the same spread their taps alike, so that a tap reads a shifted part of rows.
"""

import math

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof.methods.ringgather.prefilter import BEFORE, BEHIND, CIRCLE, LEAST_AREA

__all__ = ["rings"]

_LEAST_WEIGHT = 1e-5
_RUN = 128  # px: at most, whose sums stay in the nearest cache
_SHARP, _LIKE, _SORTED = 0, 1, 2  # kinds of tiles: hardly any blur, circles that hardly differ, all else
# Where a run's sums begin: colours and weights of what is behind and before; then the weights of one tap.
_FAR, _NEAR, _TAP, _END = 0, 4 * _RUN, 8 * _RUN, 10 * _RUN


@kernel
def rings(planes, margin, greatest, least, side, taps, gain):
    """Sums over rings: `prefilter`'s planes, greatest and least circle of tiles and those around -> (h, w, 4).

    side: of a tile; taps (48, 2); gain: opacity of the near taps. Alpha is last.
    """
    height, width = len(planes), planes.shape[2] - 2 * margin
    out = np.empty((height, width, 4), dtype=planes.dtype)
    for band in prange(len(greatest)):
        most, lowest, source, picture = borrow(greatest)[band], borrow(least)[band], borrow(planes), borrow(out)
        sums, table = np.empty(_END, dtype=planes.dtype), borrow(taps)
        first = 0
        while first < len(most):
            end = _end_of_run(most, lowest, first, _RUN // side)
            kind, start = _kind_of(most[first], lowest[first]), first * side
            for y in range(band * side, min((band + 1) * side, height)):
                row = picture[y, start : min(end * side, width)]
                if kind == _SHARP:
                    _copy(source[y, :, margin + start :], row)
                    continue
                sums[:] = planes.dtype.type(0)
                _add_rings(source, (margin + start, y), len(row), table, most[first], kind, sums)
                if kind == _LIKE:
                    _divide(sums, _count_of(_rings_of(most[first])), row)
                else:
                    _lay(sums, _rings_of(most[first]), most[first], gain, row)
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
def _count_of(used):
    """Taps of so many rings, with the centre."""
    return (2 * used + 1) * (2 * used + 1)


@inline
def _add_rings(planes, corner, count, taps, most, kind, sums):
    """Add the centre and all taps of `count` pixels from `corner` (x, y) of the planes on."""
    scalar, (left, y) = planes.dtype.type, corner
    used, last, k = _rings_of(most), len(planes) - 1, 0
    rows = planes.reshape(len(planes), -1)
    reach, half = scalar(used) / scalar(3) * most, scalar(0.5)
    for ring in range(used + 1):
        for _ in range(max(8 * ring, 1)):
            dx, dy = (reach * taps[k, 0], reach * taps[k, 1]) if ring > 0 else (scalar(0), scalar(0))
            if ring > 0:
                k += 1
            if kind == _SORTED:
                row, start = min(max(y + _floor(dy + half), 0), last), left + _floor(dx + half)
                _weigh(rows[row], planes.shape[2], start, count, scalar(used) / most, ring, sums)
            first, start = y + _floor(dy), left + _floor(dx)
            pair = rows[min(max(first, 0), last)], rows[min(max(first + 1, 0), last)]
            shares = dx - np.floor(dx), dy - np.floor(dy)
            if kind == _SORTED:
                _add_weighed(pair, planes.shape[2], start, count, shares, sums)
            else:
                _add(pair, planes.shape[2], start, count, shares, sums)


@inline
def _floor(x):
    return np.int64(np.floor(x))


@inline
def _weigh(row, pitch, start, count, scale, ring, sums):
    """Weights of a tap in `ring` that pixels in a row read; the centre's ring is 0. Scale: rings per pixel."""
    zero, one = sums.dtype.type(0), sums.dtype.type(1)
    inner, least = sums.dtype.type(ring) - one, zero if ring == 1 else one
    circle, behind = np.uintp(CIRCLE * pitch + start), np.uintp(BEHIND * pitch + start)
    before = np.uintp(BEFORE * pitch + start)
    for x in range(count):
        covers = min(max(row[circle + np.uintp(x)] * scale - inner, zero), one)
        covers *= max(covers, least)  # the first ring's are squared
        far, near = covers * row[behind + np.uintp(x)], covers * row[before + np.uintp(x)]
        sums[_TAP + x], sums[_TAP + _RUN + x] = far, near
        sums[_FAR + 3 * _RUN + x] += far
        sums[_NEAR + 3 * _RUN + x] += near


@inline
def _add_weighed(rows, pitch, start, count, shares, sums):
    """Add colours read between two rows to both sums by the tap's weights."""
    red, green, blue = np.uintp(start), np.uintp(pitch + start), np.uintp(2 * pitch + start)
    for x in range(count):
        far, near = sums[_TAP + x], sums[_TAP + _RUN + x]
        r, g, b = _read(rows, red, x, shares), _read(rows, green, x, shares), _read(rows, blue, x, shares)
        sums[_FAR + x] += far * r
        sums[_FAR + _RUN + x] += far * g
        sums[_FAR + 2 * _RUN + x] += far * b
        sums[_NEAR + x] += near * r
        sums[_NEAR + _RUN + x] += near * g
        sums[_NEAR + 2 * _RUN + x] += near * b


@inline
def _add(rows, pitch, start, count, shares, sums):
    """Add colours read between two rows to the first sums."""
    red, green, blue = np.uintp(start), np.uintp(pitch + start), np.uintp(2 * pitch + start)
    for x in range(count):
        sums[_FAR + x] += _read(rows, red, x, shares)
        sums[_FAR + _RUN + x] += _read(rows, green, x, shares)
        sums[_FAR + 2 * _RUN + x] += _read(rows, blue, x, shares)


@inline
def _read(rows, start, x, shares):
    """Between texels x and x + 1 from `start` on of two rows. Unsigned places spare the test for negative ones."""
    (upper, lower), (across, down), k = rows, shares, start + np.uintp(x)
    m = k + np.uintp(1)
    left, right = upper[k] + (lower[k] - upper[k]) * down, upper[m] + (lower[m] - upper[m]) * down
    return left + (right - left) * across


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
def _lay(sums, used, most, gain, row):
    """The near sum over the far one, by its weight beside that of full cover."""
    scalar = row.dtype.type
    least, one, strength = scalar(_LEAST_WEIGHT), scalar(1), scalar(gain) / scalar(_count_of(used))
    area = max(scalar(math.pi) * most * most, scalar(LEAST_AREA))
    for x in range(len(row)):
        behind, before = sums[_FAR + 3 * _RUN + x], sums[_NEAR + 3 * _RUN + x]
        alpha = min(max(strength * before * area, scalar(0)), one)
        behind, before = max(least, behind), max(least, before)
        for c in range(3):
            far, near = sums[_FAR + c * _RUN + x] / behind, sums[_NEAR + c * _RUN + x] / before
            row[x, c] = far * (one - alpha) + near * alpha
        row[x, 3] = alpha
