"""Box and pyramid blurs of planar images: less work than a Gaussian of the same standard deviation, and less smooth.

Both have the variance that is asked for and work in place. Outside the image is its nearest pixel if `clamp`, else 0.

- `box_blur`: a mean along x, then along y, by running sums; its rims have a weight between 0 and 1. Costs the same for
  every size.
- `pyramid_blur`: means of s x s pixels, a Gaussian on those, bilinear upsampling; s is a power of two. Block means
  have the variance (s^2 - 1) / 12 and upsampling has (2 s^2 + 1) / 12, s^2 / 4 together; the Gaussian adds the rest.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, kernel, prange
from refdof.methods.cascaded.gaussian import gaussian_blur

__all__ = ["box_blur", "box_of", "pyramid_blur", "pyramid_of"]

_STRIP = 256  # columns that are summed side by side
_LEAST_DEVIATION = 0.8  # on the coarse grid: a Gaussian sampled more thinly has too small a variance


def box_of(deviation: float) -> tuple[int, float]:
    """(m, rim): 2 m + 1 taps of weight 1 and two outer ones of weight rim < 1 have this standard deviation [px]."""
    variance = deviation * deviation
    m = int((math.sqrt(1.0 + 12.0 * variance) - 1.0) / 2.0)  # 2 m + 1 taps have the variance m (m + 1) / 3
    inner = m * (m + 1) * (2 * m + 1) / 3.0
    return m, max((variance * (2 * m + 1) - inner) / (2.0 * ((m + 1) ** 2 - variance)), 0.0)


def pyramid_of(deviation: float) -> tuple[int, float]:
    """(s, coarse): block side [px] and standard deviation [blocks] that make up this standard deviation [px]."""
    side = 1
    while (deviation / (2 * side)) ** 2 - 0.25 >= _LEAST_DEVIATION**2:
        side *= 2
    return side, math.sqrt((deviation / side) ** 2 - 0.25) if side > 1 else deviation


def box_blur(planes: Float, deviation: float, scratch: Float, clamp: bool = False) -> None:
    """As `gaussian_blur`, with a box of the same standard deviation."""
    if deviation > 0.0:
        m, rim = box_of(deviation)
        _box_rows(planes, m, rim, clamp, scratch)
        _box_columns(scratch, m, rim, clamp, planes)


def pyramid_blur(planes: Float, deviation: float, scratch: Float, clamp: bool = False) -> None:
    """As `gaussian_blur`, on block means where the standard deviation is large enough."""
    side, coarse_deviation = pyramid_of(deviation)
    if side == 1:
        gaussian_blur(planes, deviation, scratch, clamp)
        return
    count, height, width = planes.shape
    shape = (count, -(-height // side) + 2, -(-width // side) + 2)  # a margin: what lies outside
    coarse = np.zeros(shape, dtype=planes.dtype)
    _block_means(planes, side, clamp, coarse)
    gaussian_blur(coarse, coarse_deviation, np.empty_like(coarse), clamp)
    _upsample(coarse, side, planes)


@kernel
def _box_rows(planes, m, rim, clamp, out):
    """Box along x: (C, H, W) -> out (C, H, W). Sums are float64, in which adding and taking away hardly rounds."""
    count, height, width = planes.shape
    scale = 1.0 / (2 * m + 1 + 2.0 * rim)
    for i in prange(count * height):
        row, target = borrow(planes)[i // height, i % height], borrow(out)[i // height, i % height]
        padded = np.zeros(width + 2 * m + 3)
        padded[m + 1 : m + 1 + width] = row
        if clamp:
            padded[: m + 1] = row[0]
            padded[m + 1 + width :] = row[width - 1]
        total = 0.0
        for x in range(1, 2 * m + 1):
            total += padded[x]
        for x in range(width):
            total += padded[x + 2 * m + 1]
            target[x] = scale * max(total + rim * (padded[x] + padded[x + 2 * m + 2]), 0.0)
            total -= padded[x + 1]


@kernel
def _box_columns(planes, m, rim, clamp, out):
    """Box along y, strips of columns side by side."""
    count, height, width = planes.shape
    scale = 1.0 / (2 * m + 1 + 2.0 * rim)
    strips = (width + _STRIP - 1) // _STRIP
    for i in prange(count * strips):
        first = i % strips * _STRIP
        source = borrow(planes)[i // strips, :, first : min(first + _STRIP, width)]
        target = borrow(out)[i // strips, :, first : min(first + _STRIP, width)]
        empty = np.zeros(source.shape[1], dtype=planes.dtype)
        before, after = (source[0], source[height - 1]) if clamp else (empty, empty)
        total = np.zeros(source.shape[1])
        for x in range(len(total)):  # rows -m .. m - 1, of which these lie outside
            total[x] = np.float64(m) * before[x] + np.float64(max(m - height, 0)) * after[x]
        for y in range(min(m, height)):
            for x in range(len(total)):
                total[x] += source[y, x]
        for y in range(height):
            entering = source[y + m] if y + m < height else after
            leaving = source[y - m] if y >= m else before
            above = source[y - m - 1] if y >= m + 1 else before
            below = source[y + m + 1] if y + m + 1 < height else after
            for x in range(len(total)):
                total[x] += entering[x]
                target[y, x] = scale * max(total[x] + rim * (np.float64(above[x]) + below[x]), 0.0)
                total[x] -= leaving[x]


@kernel
def _block_means(planes, side, clamp, coarse):
    """Means of side x side pixels into coarse (C, h + 2, w + 2), whose margin lies outside the picture."""
    count, height, width = planes.shape
    rows, columns = coarse.shape[1], coarse.shape[2]
    scale, whole = planes.dtype.type(1.0 / (side * side)), planes.dtype.type(side)
    lacking = planes.dtype.type((columns - 2) * side - width)  # of the last block's width
    for i in prange(count * rows):
        c, row = i // rows, i % rows
        target = coarse[c, row]
        for line in range((row - 1) * side, row * side):
            if not clamp and not 0 <= line < height:
                continue
            source = planes[c, min(max(line, 0), height - 1)]
            for x in range(width):
                target[1 + x // side] += source[x]
            if clamp:
                target[0] += whole * source[0]
                target[columns - 2] += lacking * source[width - 1]
                target[columns - 1] += whole * source[width - 1]
        for x in range(columns):
            target[x] *= scale


@kernel
def _upsample(coarse, side, out):
    """Bilinear upsampling: coarse (C, h + 2, w + 2) -> out (C, H, W)."""
    count, height, width = out.shape
    one = out.dtype.type(1)
    for i in prange(count * height):
        c, y = i // height, i % height
        v = (y + 0.5) / side + 0.5
        row, down = int(v), out.dtype.type(v - int(v))
        blend = np.empty(coarse.shape[2], dtype=out.dtype)
        for x in range(len(blend)):
            blend[x] = coarse[c, row, x] * (one - down) + coarse[c, row + 1, x] * down
        for x in range(width):
            u = (x + 0.5) / side + 0.5
            column = int(u)
            right = out.dtype.type(u - column)
            out[c, y, x] = blend[column] * (one - right) + blend[column + 1] * right
