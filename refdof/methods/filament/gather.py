"""Gather: the taps of tiles: all alike, background, and foreground. Circles and distances are in pixels of the picture.

Rings are numbered from the centre, ring i of 8 i taps; odd rings begin at half a step.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import add_read

__all__ = ["ALIKE", "MOST_RINGS", "gather"]

MOST_RINGS = 5
_MOST_LEVEL = 3
_AREA = 32.0 * 32.0
ALIKE = 0.05  # of the greatest circle


def ring_points() -> Float:
    """The taps of rings 1 .. 4 (80, 2), of radius 1 each; the second half of a ring is opposite to its first."""
    found = []
    for ring in range(1, MOST_RINGS):
        angles = (np.arange(8 * ring) + 0.5 * (ring % 2)) * (2.0 * np.pi / (8 * ring))
        found.append(np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.concatenate(found)


def gather(texels, places, least, greatest, moved, most_rings):
    """Blur at half the size: (h, w, 4), colour times alpha, and alpha; and the kind of each tile.

    texels (T, 4), places (3, levels) starts, widths and heights; least and greatest (h / 8, w / 8); moved (h, w, 2).
    """
    points, levels = ring_points().astype(texels.dtype), np.repeat(np.arange(len(places[0])), places[1] * places[2])
    area = (2 << levels).astype(texels.dtype)
    light = texels.dtype.type(_AREA) / np.maximum(texels[:, 3] * texels[:, 3], area)
    return _gather(texels, light, places, least, greatest, moved, most_rings, points)


@kernel
def _gather(texels, light, places, least, greatest, moved, most_rings, points):
    height, width = moved.shape[:2]
    out = np.empty((height, width, 4), dtype=texels.dtype)
    scalar = texels.dtype.type
    for y in prange(height):
        scratch = np.empty((4, 4), dtype=texels.dtype)
        row, source, sums, table = borrow(out)[y], borrow(texels), borrow(scratch), borrow(points)
        weighed = source, borrow(light)
        levels, offset = borrow(places), borrow(moved)[y]
        for x in range(width):
            low, high = least[y // 8, x // 8], greatest[y // 8, x // 8]
            for c in range(4):
                row[x, c] = scalar(0)
            if max(abs(low), abs(high)) >= scalar(1):
                pixel = (x, y, offset[x, 0], offset[x, 1])
                if high - low <= scalar(ALIKE) * abs(high):
                    _alike(source, levels, table, pixel, (low, high, most_rings), sums, row)
                else:
                    if high > scalar(0):
                        _background(weighed, levels, table, pixel, (high, most_rings), sums, row)
                    if low < scalar(0):
                        _foreground(weighed, levels, table, pixel, (low, most_rings), sums, row)
    return out


@inline
def _rings_of(circle, most_rings):
    """How many rings a circle takes, the centre counted."""
    return min(most_rings, int(np.ceil(circle * type(circle)(0.5) + type(circle)(0.5))))


@inline
def _level_of(circle, rings):
    """The level whose texels are as far apart as the rings."""
    apart = circle * type(circle)(0.5) / (type(circle)(rings) - type(circle)(0.5))
    if apart <= type(circle)(0):
        return 0
    return min(max(int(np.floor(np.log2(apart) + type(circle)(0.5))), 0), _MOST_LEVEL)


@inline
def _at(levels, level, kind):
    """A level's start, width and height, and one over the side of its texels, which is exact."""
    return levels[0, level], levels[1, level], levels[2, level], kind(1) / kind(1 << level)


@inline
def _nearest(at, u, v):
    """The texel of a level at (u, v) [texels of half the size]."""
    start, width, height, scale = at
    column = min(max(int(np.floor(u * scale)), 0), width - 1)
    row = min(max(int(np.floor(v * scale)), 0), height - 1)
    return start + row * width + column


@inline
def _weight(circle, level):
    """Light of a tap by the area that it spreads over."""
    kind = type(circle)
    return kind(_AREA) / max(circle * circle, kind(2 * (1 << level)))


@inline
def _within(distance, circle, at):
    """Whether a circle reaches that far, softly."""
    kind = type(circle)
    return min(max((circle - distance) * at[3] + kind(0.5), kind(0)), kind(1))


@inline
def _alike(source, levels, table, pixel, tile, sums, row):
    """Tiles of one circle: the mean of bilinear reads."""
    scalar, (x, y, across, down) = source.dtype.type, pixel
    circle, half = (abs(tile[0]) + abs(tile[1])) * scalar(0.5), scalar(0.5)
    rings = _rings_of(circle, tile[2])
    level = _level_of(circle, rings)
    apart = circle / (scalar(rings) - half)
    for c in range(4):
        sums[0, c] = scalar(0)
    size = (levels[2, level], levels[1, level])
    start = levels[0, level]
    picture = source[start : start + size[0] * size[1]]
    scale, k = scalar(1 << level), 0
    middle_u = scalar(np.int32(x)) + half + half * apart * across
    middle_v = scalar(np.int32(y)) + half + half * apart * down
    add_read(picture, size, middle_u / scale, middle_v / scale, scalar(1), sums, 0)
    for ring in range(1, rings):
        radius = half * apart * scalar(ring)
        for _ in range(8 * ring):
            u, v = middle_u + radius * table[k, 0], middle_v + radius * table[k, 1]
            add_read(picture, size, u / scale, v / scale, scalar(1), sums, 0)
            k += 1
    alpha = min(max(circle - scalar(1), scalar(0)), scalar(1))
    for c in range(3):
        row[x, c] = sums[0, c] / scalar(k + 1) * alpha
    row[x, 3] = alpha


@inline
def _background(weighed, levels, table, pixel, tile, sums, row):
    """Rings from outside in; what an inner ring's nearer taps hide of the outer ones is taken away."""
    source, (x, y, across, down) = weighed[0], pixel
    scalar = source.dtype.type
    circle, half, one = abs(source[y * levels[1, 0] + x, 3]), scalar(0.5), scalar(1)
    share = min(max(circle - one, scalar(0)), one)
    if share <= scalar(0):
        return
    rings = _rings_of(tile[0], tile[1])
    level = _level_of(circle, rings)
    apart = circle / (scalar(rings) - half)
    place = (scalar(np.int32(x)) + half + half * apart * across, scalar(np.int32(y)) + half + half * apart * down)
    moved = (apart * across, apart * down)
    for n in range(4):
        sums[0, n] = scalar(0)
    circles, at = scalar(0), _at(levels, level, scalar)
    for inward in range(rings):
        ring = rings - 1 - inward
        circles = _add_ring(weighed, at, table, place, moved, (ring, rings, apart), sums, circles)
    alpha = sums[0, 3] / _weight(circle * (scalar(rings) + half) / scalar(rings), level)
    alpha = min(max(alpha, scalar(0)), one) * share * share * (scalar(3) - scalar(2) * share)
    if sums[0, 3] > scalar(0):
        for c in range(3):
            row[x, c] = alpha * sums[0, c] / sums[0, 3]
        row[x, 3] = alpha


@inline
def _add_ring(weighed, at, table, place, moved, about, sums, circles):
    """Lay a ring over what is in sums[0], colour and weight; `circles` and the result: the weighted sum of circles."""
    (source, light), (ring, rings, apart) = weighed, about
    scalar = source.dtype.type
    half, zero, one = scalar(0.5), scalar(0), scalar(1)
    border, radius = apart * (scalar(ring) + half), apart * scalar(ring)
    first = 4 * ring * (ring - 1)
    count = max(8 * ring, 1)
    outermost = ring == rings - 1
    missed, own_circles = zero, zero
    for n in range(4):
        sums[1, n] = zero
    if ring > 0:
        distance = math.hypot(radius * table[first, 0] + moved[0], radius * table[first, 1] + moved[1])
    else:
        distance = math.hypot(moved[0], moved[1])
    for k in range(count):
        u, v = place[0], place[1]
        if ring > 0:
            u += half * radius * table[first + k, 0]
            v += half * radius * table[first + k, 1]
        texel = _nearest(at, u, v)
        tap = source[texel, 3]
        if tap > zero:
            weight = _within(scalar(distance), tap, at) * light[texel]
            before = one if outermost else min(max(tap - border + half, zero), one)
            missed += before
            if weight > zero:
                circles += weight * before * tap
                own_circles += weight * (one - before) * tap
                for c in range(3):
                    sums[0, c] += weight * before * source[texel, c]
                    sums[1, c] += weight * (one - before) * source[texel, c]
                sums[0, 3] += weight * before
                sums[1, 3] += weight * (one - before)
    if sums[1, 3] > zero:
        if sums[0, 3] > zero:
            nearer = min(max(circles / sums[0, 3] - own_circles / sums[1, 3], zero), one)
            kept = one - (one - missed / scalar(count)) * nearer
            circles *= kept
            for n in range(4):
                sums[0, n] *= kept
        circles += own_circles
        for n in range(4):
            sums[0, n] += sums[1, n]
    return circles


@inline
def _foreground(weighed, levels, table, pixel, tile, sums, row):
    """Near taps that reach the pixel, in two layers, over what `row` holds of the background."""
    source, (x, y, across, down) = weighed[0], pixel
    scalar = source.dtype.type
    half, zero, one, k = scalar(0.5), scalar(0), scalar(1), 0
    circle = -tile[0]
    rings = _rings_of(circle, tile[1])
    level = _level_of(circle, rings)
    apart = circle / (scalar(rings) - half)
    place = (scalar(np.int32(x)) + half + half * apart * across, scalar(np.int32(y)) + half + half * apart * down)
    for n in range(4):
        sums[0, n] = zero
        sums[1, n] = zero
    at = _at(levels, level, scalar)
    texel = _nearest(at, place[0], place[1])
    _add_pair(weighed, (texel, texel), (math.hypot(apart * across, apart * down), at, tile[0], half), sums)
    for ring in range(1, rings):
        radius = apart * scalar(ring)
        distance = math.hypot(radius * table[k, 0] + apart * across, radius * table[k, 1] + apart * down)
        for n in range(4 * ring):
            u, v = half * radius * table[k + n, 0], half * radius * table[k + n, 1]
            pair = (
                _nearest(at, place[0] + u, place[1] + v),
                _nearest(at, place[0] - u, place[1] - v),
            )
            _add_pair(weighed, pair, (distance, at, tile[0], one), sums)
        k += 8 * ring
    full = _weight(circle * (scalar(rings) + half) / scalar(rings), level) * scalar((2 * rings - 1) * (2 * rings - 1))
    back = min(max(sums[0, 3] / full, zero), one)
    front = min(max(sums[1, 3] / full, zero), one)
    alpha = one - (one - front) * (one - back)
    scale = one
    if zero < alpha < one and row[x, 3] == zero:
        own = min(max(abs(source[y * levels[1, 0] + x, 3]) - one, zero), one)
        scale = max(alpha, own) / alpha
    near, far = front / max(sums[1, 3], scalar(1e-30)), back * (one - front) / max(sums[0, 3], scalar(1e-30))
    alpha *= scale
    for c in range(3):
        row[x, c] = scale * (sums[1, c] * near + sums[0, c] * far) + (one - alpha) * row[x, c]
    row[x, 3] = alpha + (one - alpha) * row[x, 3]


@inline
def _add_pair(weighed, pair, about, sums):
    """Add two opposite taps, which share the nearer circle, to the layers behind, sums[0], and in front, sums[1]."""
    (source, light), (distance, at, nearest, share) = weighed, about
    scalar = source.dtype.type
    one, zero = scalar(1), scalar(0)
    nearer = pair[0] if source[pair[0], 3] <= source[pair[1], 3] else pair[1]
    signed = source[nearer, 3]
    if signed < zero:
        tap = -signed
        weight = share * min(tap, one) * _within(scalar(distance), tap, at) * light[nearer]
        if weight > zero:
            behind = min(max((signed - nearest - scalar(2)) * scalar(0.5), zero), one)
            for c in range(3):
                both = source[pair[0], c] + source[pair[1], c]
                sums[0, c] += weight * behind * both
                sums[1, c] += weight * (one - behind) * both
            sums[0, 3] += scalar(2) * weight * behind
            sums[1, 3] += scalar(2) * weight * (one - behind)
