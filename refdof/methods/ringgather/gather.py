"""Gather: prefilter and rings of the ring gather, at half the size, and its last pass. Circles are in half pixels."""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import add_read, add_read_twice, read_to

__all__ = ["Sorted", "prefilter", "rings", "upsampled"]

_LEAST_AREA = math.pi * 0.7071**2  # of a circle that a tap shares its light over
_LEAST_WEIGHT = 1e-5


class Sorted(NamedTuple):
    """(h, w) each: circle, light per area, of which a share is behind.

    light * behind and light * (1 - behind) are the taps' weights in the two sums.
    """

    circle: Float
    light: Float
    behind: Float

    @classmethod
    def of(cls, circle: Float, depth: Float, nearest: Float, foreground: float) -> "Sorted":
        """From circle, depth, and the nearest depth around, (h, w) each."""
        kind = circle.dtype.type
        with np.errstate(divide="ignore", over="ignore"):
            light = np.minimum(kind(1) / (kind(math.pi) * circle * circle), kind(1.0 / _LEAST_AREA))
        t = np.clip((depth - nearest).astype(np.float64) / foreground, 0.0, 1.0).astype(circle.dtype)
        return cls(circle, light, t * t * (kind(3) - kind(2) * t))


@kernel
def prefilter(picture, depth, circle, half_depth, taps):
    """Means of a pixel and the first ring at half its circle: picture (H, W, 4), depth (H, W) -> (h, w, 4), 1 last."""
    size, (height, width) = depth.shape, circle.shape
    scalar, texels = picture.dtype.type, picture.reshape(size[0] * size[1], 4)
    right, down, half, one = scalar(size[1] / width), scalar(size[0] / height), scalar(0.5), scalar(1)
    out = np.empty((height, width, 4), dtype=picture.dtype)
    for y in prange(height):
        pair = np.empty((2, 4), dtype=picture.dtype)
        row, source, reads, far, table = borrow(out)[y], borrow(texels), borrow(pair), borrow(depth), borrow(taps)
        for x in range(width):
            u, v = scalar(np.int32(x)) + half, scalar(y) + half
            read_to(source, size, u * right, v * down, reads, 0)
            for c in range(4):
                row[x, c] = reads[0, c]
            for k in range(8):
                i = (u + half * circle[y, x] * table[k, 0]) * right
                j = (v + half * circle[y, x] * table[k, 1]) * down
                read_to(source, size, i, j, reads, 1)
                apart = scalar(2) * abs(far[_texel(j, size[0]), _texel(i, size[1])] - half_depth[y, x])
                other = min(apart, one)
                for c in range(4):
                    row[x, c] += reads[1, c] * (one - other) + reads[0, c] * other
            for c in range(3):
                row[x, c] /= scalar(9)
            row[x, 3] = one
    return out


@inline
def _texel(place, size):
    """The texel at a place [texels from the corner], cut at the border."""
    return min(max(int(np.floor(place)), 0), size - 1)


@kernel
def rings(filtered, circle, light, behind, greatest, least, taps, gain):
    """Sums over rings: filtered (h, w, 4), others (h, w), greatest and least circle around -> (h, w, 4), alpha last."""
    size = circle.shape
    scalar, texels = filtered.dtype.type, filtered.reshape(size[0] * size[1], 4)
    out = np.empty_like(filtered)
    for y in prange(size[0]):
        sums = np.empty((2, 4), dtype=filtered.dtype)
        row, source, totals, table = borrow(out)[y], borrow(texels), borrow(sums), borrow(taps)
        planes = borrow(circle), borrow(light), borrow(behind)
        for x in range(size[1]):
            most = greatest[y, x]
            if most < scalar(1):
                for c in range(4):
                    row[x, c] = filtered[y, x, c]
            else:
                used = min(max(int(np.ceil(scalar(3) * np.sqrt(most))), 1), 3)
                reach = scalar(used) / scalar(3) * most
                if most - least[y, x] < scalar(1):
                    _plain(source, size, (x, y), table, (used, reach), row)
                else:
                    _sorted_sums(source, size, (x, y), planes, table, (used, reach, most), totals)
                    _lay(totals, (used, most), gain, row, x)
    return out


@inline
def _plain(source, size, pixel, table, rings, row):
    """The mean of the taps, alpha 0."""
    scalar, (x, y) = source.dtype.type, pixel
    count, half = 4 * rings[0] * (rings[0] + 1), scalar(0.5)
    for c in range(4):
        row[x, c] = source[y * size[1] + x, c]
    for k in range(count):
        u = scalar(np.int32(x)) + half + rings[1] * table[k, 0]
        v = scalar(np.int32(y)) + half + rings[1] * table[k, 1]
        add_read(source, size, u, v, scalar(1), row, x)
    for c in range(3):
        row[x, c] /= scalar(count + 1)
    row[x, 3] = scalar(0)


@inline
def _sorted_sums(source, size, pixel, planes, table, rings, totals):
    """Taps that reach the pixel, behind in totals[0] and before in totals[1], weights last."""
    scalar, (x, y), (circle, light, behind) = source.dtype.type, pixel, planes
    half, one, k = scalar(0.5), scalar(1), 0
    for c in range(4):
        far = light[y, x] * behind[y, x]
        totals[0, c] = far * source[y * size[1] + x, c]
        totals[1, c] = (light[y, x] - far) * source[y * size[1] + x, c]
    for ring in range(1, rings[0] + 1):
        for _ in range(8 * ring):
            u = scalar(np.int32(x)) + half + rings[1] * table[k, 0]
            v = scalar(np.int32(y)) + half + rings[1] * table[k, 1]
            i, j = _texel(u, size[1]), _texel(v, size[0])
            covers = circle[j, i] * (scalar(rings[0]) / rings[2]) - scalar(np.int32(ring)) + one
            covers = min(max(covers, scalar(0)), one)
            if ring == 1:
                covers *= covers
            weight = light[j, i] * covers
            if weight > scalar(0):
                far = weight * behind[j, i]
                add_read_twice(source, size, u, v, (far, weight - far), totals, 0)
            k += 1


@inline
def _lay(totals, rings, gain, row, x):
    """The near sum over the far one, by its weight beside that of full cover."""
    scalar = totals.dtype.type
    used, most = rings
    count = scalar((2 * used + 1) * (2 * used + 1))
    area = max(scalar(math.pi) * most * most, scalar(_LEAST_AREA))
    alpha = min(max(scalar(gain) / count * totals[1, 3] * area, scalar(0)), scalar(1))
    behind, before = max(scalar(_LEAST_WEIGHT), totals[0, 3]), max(scalar(_LEAST_WEIGHT), totals[1, 3])
    for c in range(3):
        row[x, c] = totals[0, c] / behind * (scalar(1) - alpha) + totals[1, c] / before * alpha
    row[x, 3] = alpha


@kernel
def upsampled(color, soft, circle, depth, greatest, nearest):
    """The soft picture (h, w, 4) over color (H, W, 3) by circle; (H, W) each: circle, depth, and those around."""
    height, width = circle.shape
    scalar, size = color.dtype.type, soft.shape[:2]
    right, down, half, one = scalar(size[1] / width), scalar(size[0] / height), scalar(0.5), scalar(1)
    texels = soft.reshape(size[0] * size[1], 4)
    out = np.empty_like(color)
    for y in prange(height):
        read = np.empty((1, 4), dtype=color.dtype)
        row, source, blurred, over = borrow(out)[y], borrow(color)[y], borrow(texels), borrow(read)
        for x in range(width):
            read_to(blurred, size, (scalar(np.int32(x)) + half) * right, (scalar(y) + half) * down, over, 0)
            near = min(max(one - (depth[y, x] - nearest[y, x]), scalar(0)), one)
            own = circle[y, x]
            reach = greatest[y, x] * (one - near) + own * near
            share = min(max(own * (one - over[0, 3]) + reach * over[0, 3], scalar(0)), one)
            for c in range(3):
                row[x, c] = source[x, c] * (one - share) + over[0, c] * share
    return out
