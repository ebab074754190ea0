"""Prefilter: a small ring's mean at half the size, and how much light a pixel there has in front and behind.

Planes have margins in which their first and last columns go on, so that taps at one offset are contiguous in a row.
Circles are in pixels of half the size.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.texel_sums import add_blend
from refdof.image.bilinear import first_of_two, four_around

__all__ = ["BEFORE", "BEHIND", "CIRCLE", "LEAST_AREA", "circles", "prefilter"]

CIRCLE, BEHIND, BEFORE = 3, 4, 5  # planes, after three of colour
LEAST_AREA = math.pi * 0.7071**2  # of a circle that a tap shares its light over
_POINTS = 8  # of the first ring
_RUN = 128  # px, whose sums stay in the nearest cache


@kernel
def circles(coc, largest_px):
    """Circles of confusion (H, W) px without sign, cut, in pixels of half the size."""
    scalar, out = coc.dtype.type, np.empty_like(coc)
    largest, half = scalar(largest_px), scalar(0.5)
    for y in prange(len(coc)):
        row, source = borrow(out)[y], borrow(coc)[y]
        for x in range(len(row)):
            row[x] = min(abs(source[x]), largest) * half
    return out


def prefilter(
    picture: Float, circle: Float, nearest: Float, taps: Float, side: int, margin: int, foreground: float
) -> Float:
    """Rows of planes (h, 6, margin + w + margin), half the size: colour, circle, weights of a tap behind and before.

    picture (H, W, 4): colour and depth; circle (H, W); nearest depth of tiles, whose side is `side` at half the size,
    and those around; taps (48, 2) of the rings; foreground as in `Params`.
    """
    height, width = ((n + 1) // 2 for n in circle.shape)
    out = np.empty((height, 6, width + 2 * margin), dtype=picture.dtype)
    _prefilter(picture, circle, nearest, taps, side, margin, foreground, out)
    return out


@kernel
def _prefilter(picture, circle, nearest, taps, side, margin, foreground, out):
    (height, width), (rows, columns) = circle.shape, (len(out), out.shape[2] - 2 * margin)
    place = (2 * np.arange(columns) + 1) * width // (2 * columns)
    for y in prange(rows):
        texels, planes = borrow(picture.reshape(height * width, 4)), borrow(out)[y]
        inside = slice(margin, margin + columns)
        radius, behind, before = planes[CIRCLE, inside], planes[BEHIND, inside], planes[BEFORE, inside]
        depth = np.empty(columns, dtype=picture.dtype)
        own = (2 * y + 1) * height // (2 * rows)
        for x in range(columns):
            radius[x], depth[x] = circle[own, place[x]], texels[own * width + place[x], 3]
        for tile in range(nearest.shape[1]):
            run = slice(tile * side, min((tile + 1) * side, columns))
            _sort(depth[run], radius[run], nearest[y // side, tile], foreground, behind[run], before[run])
        sums, kept = np.empty((_RUN, 4), dtype=picture.dtype), np.empty(_RUN, dtype=picture.dtype)
        texel, share = np.empty(4 * _RUN, dtype=np.int32), np.empty(2 * _RUN, dtype=picture.dtype)
        for start in range(0, columns, _RUN):
            run, count = slice(start, min(start + _RUN, columns)), min(_RUN, columns - start)
            sums[:], kept[:] = picture.dtype.type(0), picture.dtype.type(1)
            for k in range(_POINTS + 1):
                tap = (taps[k, 0], taps[k, 1]) if k < _POINTS else (picture.dtype.type(0), picture.dtype.type(0))
                _find(radius[run], (start, y), tap, (height, width), (rows, columns), texel, share)
                if k < _POINTS:
                    _add_tap(texels, (height, width), depth[run], texel, share, kept, sums)
                else:
                    _add_own(texels, (height, width), texel, share, kept[:count], sums)
            for n in range(3):
                _divide(sums[:count], n, planes[n, margin + start : margin + start + count])
        for n in range(6):
            plane = planes[n]
            plane[:margin], plane[margin + columns :] = plane[margin], plane[margin + columns - 1]


@inline
def _sort(depth, circle, nearest, foreground, behind, before):
    """Share a tap's light per area out: behind the nearest surface around it, and before."""
    scalar = depth.dtype.type
    for x in range(len(depth)):
        light = scalar(1) / max(scalar(math.pi) * circle[x] * circle[x], scalar(LEAST_AREA))
        t = scalar(min(max(np.float64(depth[x] - nearest) / foreground, 0.0), 1.0))
        behind[x] = light * (t * t * (scalar(3) - scalar(2) * t))
        before[x] = light - behind[x]


@inline
def _find(circle, corner, tap, size, half_size, texel, share):
    """Places of a tap at half of each pixel's circle: columns and rows of the first of two texels and of the nearest.

    corner: x and y of the first pixel; texel (4 runs) has the four, share (2 runs) the weights of the second ones.
    """
    scalar, half = circle.dtype.type, circle.dtype.type(0.5)
    right, down = scalar(size[1] / half_size[1]), scalar(size[0] / half_size[0])
    v = scalar(corner[1]) + half
    for x in range(len(circle)):
        reach = half * circle[x]
        i, j = (scalar(np.int32(corner[0] + x)) + half + reach * tap[0]) * right, (v + reach * tap[1]) * down
        texel[x], share[x] = first_of_two(i, size[1])
        texel[_RUN + x], share[_RUN + x] = first_of_two(j, size[0])
        texel[2 * _RUN + x], texel[3 * _RUN + x] = _texel(i, size[1]), _texel(j, size[0])


@inline
def _add_tap(texels, size, depth, texel, share, kept, sums):
    """Add a tap to sums (X, 4) by how near in depth it is; what it leaves is added to what the pixel itself counts."""
    scalar = texels.dtype.type
    for x in range(len(depth)):
        nearest = np.int64(texel[3 * _RUN + x]) * size[1] + np.int64(texel[2 * _RUN + x])
        other = min(scalar(2) * abs(texels[nearest, 3] - depth[x]), scalar(1))
        kept[x] += other
        _read(texels, size, texel, share, x, scalar(1) - other, sums)


@inline
def _add_own(texels, size, texel, share, kept, sums):
    """Add the pixel itself as often as it counts."""
    for x in range(len(kept)):
        _read(texels, size, texel, share, x, kept[x], sums)


@inline
def _read(texels, size, texel, share, x, weight, sums):
    column, row = np.int64(texel[x]), np.int64(texel[_RUN + x])
    a, b, c, d = four_around(0, size[1], size[0], column, row)
    add_blend(sums, x, weight, texels, a, b, c, d, share[x], share[_RUN + x])


@inline
def _divide(sums, n, plane):
    for x in range(len(plane)):
        plane[x] = sums[x, n] / plane.dtype.type(_POINTS + 1)


@inline
def _texel(place, size):
    """The texel at a place [texels from the corner], cut at the border."""
    scalar = type(place)
    return np.int32(min(max(place, scalar(0)), scalar(np.int32(size - 1))))
