"""Prefilter: a small ring's mean at half the size, and how much light a pixel there has in front and behind.

Planes have margins in which their first and last columns go on, so that taps at one offset are contiguous in a row.
Circles are in pixels of half the size.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.texel_sums import add_blend
from refdof.image.bilinear import first_of_two

__all__ = ["BEFORE", "BEHIND", "CIRCLE", "LEAST_AREA", "prefilter"]

CIRCLE, BEHIND, BEFORE = 3, 4, 5  # planes, after three of colour
LEAST_AREA = math.pi * 0.7071**2  # of a circle that a tap shares its light over
_POINTS = 8  # of the first ring
_RUN = 128  # px, whose sums stay in the nearest cache
# Rows of what a tap reads: the first of four texels, and how far the next ones are from it to the right and below; the
# nearest one. Weights of the second ones across and down, of the tap, and of the pixel itself.
_FIRST, _RIGHT, _BELOW, _NEAREST = range(4)
_ACROSS, _DOWN, _WEIGHT, _KEPT = range(4)


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
        sums, texel = np.empty((_RUN, 4), dtype=picture.dtype), np.empty((4, _RUN), dtype=np.int32)
        share = np.empty((4, _RUN), dtype=picture.dtype)
        for start in range(0, columns, _RUN):
            run, count = slice(start, min(start + _RUN, columns)), min(_RUN, columns - start)
            sums[:], share[_KEPT] = picture.dtype.type(0), picture.dtype.type(1)
            for k in range(_POINTS + 1):
                tap = (taps[k, 0], taps[k, 1]) if k < _POINTS else (picture.dtype.type(0), picture.dtype.type(0))
                _find(radius[run], (start, y), tap, (height, width), (rows, columns), borrow(texel), borrow(share))
                if k < _POINTS:
                    _weigh(texels, depth[run], borrow(texel), borrow(share))
                _add(texels, count, borrow(texel), borrow(share), _WEIGHT if k < _POINTS else _KEPT, sums)
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
    """Where a tap at half of each pixel's circle is read: rows of texel (4, _RUN) and of share, as named above.

    corner: x and y of the first pixel; tap [circles]; sizes (height, width).
    """
    scalar, half = circle.dtype.type, circle.dtype.type(0.5)
    right, down = scalar(size[1] / half_size[1]), scalar(size[0] / half_size[0])
    v, wide, last = scalar(corner[1]) + half, np.int32(size[1]), (np.int32(size[1] - 1), np.int32(size[0] - 1))
    for x in range(len(circle)):
        reach = half * circle[x]
        i, j = (scalar(np.int32(corner[0] + x)) + half + reach * tap[0]) * right, (v + reach * tap[1]) * down
        column, share[_ACROSS, x] = first_of_two(i, size[1])
        row, share[_DOWN, x] = first_of_two(j, size[0])
        texel[_FIRST, x] = row * wide + column
        texel[_RIGHT, x] = np.int32(1) if column < last[0] else np.int32(0)
        texel[_BELOW, x] = wide if row < last[1] else np.int32(0)
        texel[_NEAREST, x] = _texel(j, size[0]) * wide + _texel(i, size[1])


@inline
def _weigh(texels, depth, texel, share):
    """Weigh a tap by how near in depth it is; what it leaves is added to what the pixel itself counts."""
    scalar = texels.dtype.type
    two, one = scalar(2), scalar(1)
    for x in range(len(depth)):
        share[_WEIGHT, x] = texels[texel[_NEAREST, x], 3]
    for x in range(len(depth)):
        other = min(two * abs(share[_WEIGHT, x] - depth[x]), one)
        share[_WEIGHT, x] = one - other
        share[_KEPT, x] += other


@inline
def _add(texels, count, texel, share, weight, sums):
    """Add reads to sums (X, 4), each by a row of share."""
    for x in range(count):
        first, right, below = np.int64(texel[_FIRST, x]), np.int64(texel[_RIGHT, x]), np.int64(texel[_BELOW, x])
        a, b, c, d = first, first + right, first + below, first + below + right
        add_blend(sums, x, share[weight, x], texels, a, b, c, d, share[_ACROSS, x], share[_DOWN, x])


@inline
def _divide(sums, n, plane):
    for x in range(len(plane)):
        plane[x] = sums[x, n] / plane.dtype.type(_POINTS + 1)


@inline
def _texel(place, size):
    """The texel at a place [texels from the corner], cut at the border."""
    scalar = type(place)
    return np.int32(min(max(place, scalar(0)), scalar(np.int32(size - 1))))
