"""Upsampling of mip levels with a circular filter: a blur of any width from a few reads of a coarse level.

1. upsample the blur of nearer neighbours, and read blur as coarse as that     `smooth_blur`
2. read nine points of a circle between two levels of colour                  `upsample`

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), equations (5) to (8) and (11).
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.texel_registers import INWARD, read_circle
from refdof.image.bilinear import bilinear, texels_around
from refdof.methods.mipmap.anisotropic import Chain

__all__ = ["CIRCLE", "K_SIGMA", "SmoothedBlur", "smooth_blur", "upsample"]

_ROOT_HALF = int(np.sqrt(0.5).view(np.int64))
_LOG2_E2 = 2.0 / np.log(2.0)
K_SIGMA = 2.0 / 3.0  # [1], equations (5) and (6)
# Centre, axes, diagonals: figure 4a for G(q - p), which diagonals keep, and figure 4b for the places of reads.
_SQUARE = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, 1), (1, -1), (-1, -1)], dtype=float)
_GAUSSIAN = np.exp(-0.5 * (_SQUARE**2).sum(axis=1))
CIRCLE = np.where(np.abs(_SQUARE).sum(axis=1, keepdims=True) > 1, INWARD, 1.0) * _SQUARE
_OFFSETS = np.array([0.0, 1.0, -1.0, INWARD, -INWARD])
_COLUMN = np.array([0, 1, 2, 0, 0, 3, 4, 3, 4])  # each point's place in _OFFSETS
_ROW = np.array([0, 0, 0, 1, 2, 3, 3, 4, 4])


class SmoothedBlur(NamedTuple):
    """(H, W) each: blur of nearer neighbours [px], degree of blur read as coarse as that [px], its level."""

    neighbours: Float
    smoothed: Float
    levels: Float


def smooth_blur(circles: Chain, nearer: Float, points: int) -> SmoothedBlur:
    """Equation (11): circles (T, 2), nearer (h, w) at the last level; no `points`: blur stays as it is."""
    dtype = circles.texels.dtype
    weights = _GAUSSIAN[: max(points, 1)] / _GAUSSIAN[: max(points, 1)].sum()
    shape = (int(circles.heights[0]), int(circles.widths[0]))
    blur = SmoothedBlur(*np.empty((3, *shape), dtype=dtype))
    _smooth(circles, _scales(circles), nearer, weights.astype(dtype), blur)
    return blur


def upsample(colors: Chain, blur: SmoothedBlur, geometric: bool) -> Float:
    """Equation (8): colors (T, 4) -> (H, W, 3)."""
    dtype = colors.texels.dtype
    weights = (_GAUSSIAN / _GAUSSIAN.sum()).astype(dtype)
    if geometric:
        return _upsample_geometric(colors, _scales(colors), blur, CIRCLE.astype(dtype), weights)
    out = np.empty((*blur.smoothed.shape, 3), dtype=dtype)
    _upsample(colors, _scales(colors), blur, weights, out)
    return out


class _Scales(NamedTuple):
    """Texels of each level per pixel of the picture, (L,) each."""

    down: Float
    right: Float


def _scales(chain: Chain) -> _Scales:
    dtype = chain.texels.dtype
    return _Scales(*((sides / sides[0]).astype(dtype) for sides in (chain.heights, chain.widths)))


@kernel
def _smooth(circles, scales, nearer, weights, blur):
    """Fill `blur`.

    Points in one column share where they read: their rows are weighted and added before the row's pixels are met.
    """
    starts, heights, widths, down, right = circles.starts, circles.heights, circles.widths, scales.down, scales.right
    height, width, last = heights[0], widths[0], len(starts) - 1
    scalar = circles.texels.dtype.type
    reach, half = scalar(2.0**last), scalar(0.5)
    left, beside = np.empty((5, width), dtype=np.uint32), np.empty((5, width), dtype=np.uint32)
    across = np.empty((5, width), dtype=circles.texels.dtype)
    for i in range(5):
        for x in range(width):
            place = (scalar(x) + half + scalar(_OFFSETS[i]) * reach) * right[last]
            left[i, x], beside[i, x], across[i, x] = texels_around(place, nearer.shape[1])
    texel, aside = np.empty((last + 1, width), dtype=np.uint32), np.empty((last + 1, width), dtype=np.uint32)
    share = np.empty((last + 1, width), dtype=circles.texels.dtype)
    for k in range(last + 1):
        for x in range(width):
            texel[k, x], aside[k, x], share[k, x] = texels_around((scalar(x) + half) * right[k], widths[k])
    for y in prange(height):
        texels, front = borrow(circles.texels), borrow(nearer)
        firsts, seconds, shares = borrow(texel), borrow(aside), borrow(share)
        sums = np.zeros((5, front.shape[1]), dtype=circles.texels.dtype)
        rho, sigma, lod = blur.neighbours[y], blur.smoothed[y], blur.levels[y]
        rho[:] = scalar(0)
        for k in range(len(weights) if len(weights) > 1 else 0):
            v, v1, wy = texels_around(
                (scalar(y) + half + scalar(_OFFSETS[_ROW[k]]) * reach) * down[last], front.shape[0]
            )
            for x in range(front.shape[1]):
                sums[_COLUMN[k], x] += weights[k] * (front[v, x] + (front[v1, x] - front[v, x]) * wy)
        for i in range(5):
            if sums[i].any():
                _add_line(rho, sums[i], left[i], beside[i], across[i])
        top, bottom = np.empty(last + 1, dtype=np.int64), np.empty(last + 1, dtype=np.int64)
        sink = np.empty(last + 1, dtype=circles.texels.dtype)
        for k in range(last + 1):
            first, second, sink[k] = texels_around((scalar(y) + half) * down[k], heights[k])
            top[k], bottom[k] = starts[k] + first * widths[k], starts[k] + second * widths[k]
        _levels_of(rho, scalar(last), lod)  # Eq. (11)
        for x in range(width):
            n = lod[x]
            if n <= scalar(0):
                sigma[x] = texels[top[0] + x, 1]
                continue
            k = int(n)
            rest = n - scalar(k)
            p, q, upper, lower = firsts[k, x], seconds[k, x], top[k], bottom[k]
            fine = bilinear(
                texels[upper + p, 1],
                texels[upper + q, 1],
                texels[lower + p, 1],
                texels[lower + q, 1],
                shares[k, x],
                sink[k],
            )
            k = min(k + 1, last)
            p, q, upper, lower = firsts[k, x], seconds[k, x], top[k], bottom[k]
            coarse = bilinear(
                texels[upper + p, 1],
                texels[upper + q, 1],
                texels[lower + p, 1],
                texels[lower + q, 1],
                shares[k, x],
                sink[k],
            )
            sigma[x] = fine + (coarse - fine) * rest
        _levels_of(sigma, scalar(np.inf), lod)


@inline
def _add_line(total, line, left, beside, across):
    for x in range(len(total)):
        a = line[left[x]]
        total[x] += a + (line[beside[x]] - a) * across[x]


@inline
def _levels_of(sigmas, largest, out):
    for x in range(len(out)):
        out[x] = min(_level_of(sigmas[x]), largest)


@kernel
def _upsample(colors, scales, blur, weights, out):
    """Nine weighted reads of two levels; the nine points lie in five columns and five rows."""
    height, width, last = colors.heights[0], colors.widths[0], len(colors.starts) - 1
    scalar = colors.texels.dtype.type
    widest = scalar(2.0**last)
    for y in prange(height):
        texels, sizes, lods = borrow(colors.texels), borrow(blur.smoothed), borrow(blur.levels)
        shares = (weights[0], weights[1], weights[5])
        begin, tall, broad = borrow(colors.starts), borrow(colors.heights), borrow(colors.widths)
        downward, rightward = borrow(scales.down), borrow(scales.right)
        for x in range(width):
            m = lods[y, x]
            if m <= scalar(0):
                for c in range(3):
                    out[y, x, c] = texels[y * width + x, c]
                continue
            radius, level, beta = _circle_of(m, sizes[y, x], last, widest)
            u, v = scalar(x) + scalar(0.5), scalar(y) + scalar(0.5)
            a, b = rightward[level], downward[level]
            fine = read_circle(
                texels, begin[level], broad[level], tall[level], u * a, v * b, radius * a, radius * b, shares
            )
            if beta > scalar(0):
                k = level + np.uint32(1)
                a, b = rightward[k], downward[k]
                coarse = read_circle(texels, begin[k], broad[k], tall[k], u * a, v * b, radius * a, radius * b, shares)
                out[y, x, 0] = fine[0] + (coarse[0] - fine[0]) * beta
                out[y, x, 1] = fine[1] + (coarse[1] - fine[1]) * beta
                out[y, x, 2] = fine[2] + (coarse[2] - fine[2]) * beta
            else:
                out[y, x, 0], out[y, x, 1], out[y, x, 2] = fine


@kernel
def _upsample_geometric(colors, scales, blur, circle, weights):
    """The same with the blend of levels that [1] prints: a^(1 - beta) b^beta at each point."""
    height, width, last = colors.heights[0], colors.widths[0], len(colors.starts) - 1
    scalar = colors.texels.dtype.type
    widest = scalar(2.0**last)
    out = np.zeros((height, width, 3), dtype=colors.texels.dtype)
    for y in prange(height):
        texels, sizes = borrow(colors.texels), borrow(blur.smoothed)
        for x in range(width):
            m = blur.levels[y, x]
            if m <= scalar(0):
                for c in range(3):
                    out[y, x, c] = texels[y * width + x, c]
                continue
            radius, level, beta = _circle_of(m, sizes[y, x], last, widest)
            for k in range(9):
                u, v = scalar(x) + scalar(0.5) + circle[k, 0] * radius, scalar(y) + scalar(0.5) + circle[k, 1] * radius
                fine = _color_at(texels, colors, scales, level, u, v)
                if beta > scalar(0):
                    coarse = _color_at(texels, colors, scales, level + 1, u, v)
                    for c in range(3):
                        out[y, x, c] += weights[k] * _power(fine[c], coarse[c], beta)
                else:
                    for c in range(3):
                        out[y, x, c] += weights[k] * fine[c]
    return out


@inline
def _circle_of(m, sigma, last, widest):
    """Radius of the circle [px], the level one below `m` > 0, and the weight of the next.

    Below m = 1 there is no lower level: the circle shrinks instead. Above, 2^(m - 1) is K_SIGMA sigma.
    """
    scalar = type(m)
    radius = min(scalar(K_SIGMA) * sigma, widest) if m > scalar(1) else m
    lod = min(max(m - scalar(1), scalar(0)), scalar(last))
    level = np.uint32(lod)
    return radius, level, lod - scalar(level)


@inline
def _level_of(sigma):
    """Equation (6): the continuous level of a degree of blur [px]."""
    scaled = K_SIGMA * np.float64(sigma)
    return type(sigma)(1.0 + _log2(scaled)) if scaled > 0.5 else type(sigma)(0)


@inline
def _log2(value):
    """Logarithm of a float64 > 0, correct to 2^-52 and without a branch, so that a row takes it in vectors."""
    bits = np.float64(value).view(np.int64)
    exponent = (bits - _ROOT_HALF) >> 52
    mantissa = np.int64(bits - (exponent << 52)).view(np.float64)  # sqrt(1/2) .. sqrt(2)
    s = (mantissa - 1.0) / (mantissa + 1.0)
    t = s * s  # below 0.0295; the first term left out is 2e-17 of the sum
    series = 1.0 / 19.0
    for k in (17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0):
        series = series * t + 1.0 / k
    return np.float64(np.int32(exponent)) + _LOG2_E2 * (s + s * t * series)


@inline
def _power(a, b, beta):
    """a^(1 - beta) b^beta of numbers >= 0."""
    return type(a)(np.float64(a) ** (1.0 - np.float64(beta)) * np.float64(b) ** np.float64(beta))


@inline
def _color_at(texels, chain, scales, level, u, v):
    """A bilinear read of one level at u, v [px of the picture]: a tuple of three."""
    x, x1, wx = texels_around(u * scales.right[level], chain.widths[level])
    y, y1, wy = texels_around(v * scales.down[level], chain.heights[level])
    first = chain.starts[level] + y * chain.widths[level]
    second = chain.starts[level] + y1 * chain.widths[level]
    p, q, r, s = first + x, first + x1, second + x, second + x1
    return (
        bilinear(texels[p, 0], texels[q, 0], texels[r, 0], texels[s, 0], wx, wy),
        bilinear(texels[p, 1], texels[q, 1], texels[r, 1], texels[s, 1], wx, wy),
        bilinear(texels[p, 2], texels[q, 2], texels[r, 2], texels[s, 2], wx, wy),
    )
