"""Gaussian blur of planar images, separable and in place; outside the image its border goes on, or all is transparent.

1. sample the Gaussian and scale the taps to a sum of 1    `gaussian_taps`
2. convolve every row, taps outside, pixels inside         `_convolve_rows`
3. convolve every column, whole rows at a time             `_convolve_columns`

Taps on either side of the middle are added before they are weighed, so that a mirrored image gives mirrored bits.
Memory: one scratch copy of the image, whatever the blur.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["TRUNCATION", "convolve", "gaussian_blur", "gaussian_taps"]

TRUNCATION = 3.0  # standard deviations that a kernel reaches; the tails beyond hold 0.27 % of it


def gaussian_taps(deviation: float) -> Float:
    """The middle and one side of a symmetric kernel: (ceil(3 deviation) + 1,) float64; the whole kernel sums to 1."""
    x = np.arange(math.ceil(TRUNCATION * deviation) + 1)
    taps = np.exp(-0.5 * (x / deviation) ** 2) if deviation > 0.0 else np.ones(1)
    return taps / (taps[0] + 2.0 * taps[1:].sum())


def gaussian_blur(planes: Float, deviation: float, scratch: Float, clamp: bool = False) -> None:
    """Blur planes (C, H, W) in place with a Gaussian of this standard deviation [px]; 0 changes nothing.

    `scratch` has the shape and type of `planes`. Colours must be premultiplied by the alpha plane that goes with them.
    Outside the image is its nearest pixel if `clamp`, else 0.
    """
    if deviation > 0.0:
        convolve(planes, gaussian_taps(deviation), scratch, clamp)


def convolve(planes: Float, taps: Float, scratch: Float, clamp: bool = False) -> None:
    """Convolve planes (C, H, W) in place, along x and along y, with a symmetric kernel: middle and one side."""
    taps = taps.astype(planes.dtype)
    _convolve_rows(planes, taps, clamp, scratch)
    _convolve_columns(scratch, taps, clamp, planes)


@kernel
def _convolve_rows(planes, taps, clamp, out):
    """Convolve along x: (C, H, W) -> out (C, H, W)."""
    count, height, width = planes.shape
    reach = len(taps) - 1
    for i in prange(count * height):
        weight = borrow(taps)
        source, target = borrow(planes)[i // height, i % height], borrow(out)[i // height, i % height]
        row = np.zeros(width + 2 * reach, dtype=planes.dtype)
        row[reach : reach + width] = source
        if clamp:
            row[:reach] = source[0]
            row[reach + width :] = source[width - 1]
        middle = row[reach : reach + width]
        for x in range(width):
            target[x] = weight[0] * middle[x]
        for k in range(1, reach - 2, 4):
            _add_four_pairs(
                (row[reach - k :], row[reach - k - 1 :], row[reach - k - 2 :], row[reach - k - 3 :]),
                (row[reach + k :], row[reach + k + 1 :], row[reach + k + 2 :], row[reach + k + 3 :]),
                (weight[k], weight[k + 1], weight[k + 2], weight[k + 3]),
                target,
            )
        for k in range(1 + reach // 4 * 4, reach + 1):
            _add_pair(row[reach - k :], row[reach + k :], weight[k], target)


@kernel
def _convolve_columns(planes, taps, clamp, out):
    """Convolve along y: (C, H, W) -> out (C, H, W)."""
    count, height, width = planes.shape
    reach = len(taps) - 1
    empty = np.zeros(width, dtype=planes.dtype)
    for i in prange(count * height):
        weight, outside = borrow(taps), borrow(empty)
        source, y = borrow(planes)[i // height], i % height
        above, below = (source[0], source[height - 1]) if clamp else (outside, outside)
        target = borrow(out)[i // height, y]
        middle = source[y]
        for x in range(width):
            target[x] = weight[0] * middle[x]
        # Past the farther border all rows are alike, on both sides.
        last = min(reach, max(y, height - 1 - y))
        for k in range(1, last - 2, 4):
            _add_four_pairs(
                _four_rows(source, y - k, -1, above, below),
                _four_rows(source, y + k, 1, above, below),
                (weight[k], weight[k + 1], weight[k + 2], weight[k + 3]),
                target,
            )
        for k in range(1 + last // 4 * 4, last + 1):
            _add_pair(_row(source, y - k, above, below), _row(source, y + k, above, below), weight[k], target)
        if clamp and last < reach:
            _add_pair(above, below, weight[last + 1 :].sum(), target)


@inline
def _row(plane, y, above, below):
    """Row y of a plane, or what lies outside it."""
    if y < 0:
        return above
    return plane[y] if y < len(plane) else below


@inline
def _four_rows(plane, y, step, above, below):
    """Rows y, y + step and so on."""
    return (
        _row(plane, y, above, below),
        _row(plane, y + step, above, below),
        _row(plane, y + 2 * step, above, below),
        _row(plane, y + 3 * step, above, below),
    )


@inline
def _add_pair(a, b, weight, out):
    """Out += weight (a + b)."""
    for x in range(len(out)):
        out[x] += weight * (a[x] + b[x])


@inline
def _add_four_pairs(before, after, weights, out):
    """Four times `_add_pair` with one read and one write of `out`."""
    (a0, a1, a2, a3), (b0, b1, b2, b3), (w0, w1, w2, w3) = before, after, weights
    for x in range(len(out)):
        near = w0 * (a0[x] + b0[x]) + w1 * (a1[x] + b1[x])
        far = w2 * (a2[x] + b2[x]) + w3 * (a3[x] + b3[x])
        out[x] += near + far
