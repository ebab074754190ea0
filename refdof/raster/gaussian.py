"""Gaussian blur of planar images, separable and in place; what lies outside the image is 0, that is, transparent.

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


def gaussian_blur(planes: Float, deviation: float, scratch: Float) -> None:
    """Blur planes (C, H, W) in place with a Gaussian of this standard deviation [px]; 0 changes nothing.

    `scratch` has the shape and type of `planes`. Colours must be premultiplied by the alpha plane that goes with them.
    """
    if deviation > 0.0:
        convolve(planes, gaussian_taps(deviation), scratch)


def convolve(planes: Float, taps: Float, scratch: Float) -> None:
    """Convolve planes (C, H, W) in place, along x and along y, with a symmetric kernel: middle and one side."""
    taps = taps.astype(planes.dtype)
    _convolve_rows(planes, taps, scratch)
    _convolve_columns(scratch, taps, planes)


@kernel
def _convolve_rows(planes, taps, out):
    """Convolve along x: (C, H, W) -> out (C, H, W)."""
    count, height, width = planes.shape
    reach = len(taps) - 1
    for i in prange(count * height):
        weight = borrow(taps)
        source, target = borrow(planes)[i // height, i % height], borrow(out)[i // height, i % height]
        row = np.zeros(width + 2 * reach, dtype=planes.dtype)
        row[reach : reach + width] = source
        middle = row[reach : reach + width]
        for x in range(width):
            target[x] = weight[0] * middle[x]
        for k in range(1, reach - 2, 4):
            _add_four_pairs(
                row[reach - k :], row[reach + k :], row[reach - k - 1 :], row[reach + k + 1 :],
                row[reach - k - 2 :], row[reach + k + 2 :], row[reach - k - 3 :], row[reach + k + 3 :],
                weight[k], weight[k + 1], weight[k + 2], weight[k + 3], target,
            )  # fmt: skip
        for k in range(1 + reach // 4 * 4, reach + 1):
            _add_pair(row[reach - k :], row[reach + k :], weight[k], target)


@kernel
def _convolve_columns(planes, taps, out):
    """Convolve along y: (C, H, W) -> out (C, H, W)."""
    count, height, width = planes.shape
    reach = len(taps) - 1
    empty = np.zeros(width, dtype=planes.dtype)
    for i in prange(count * height):
        weight, outside = borrow(taps), borrow(empty)
        source, y = borrow(planes)[i // height], i % height
        target = borrow(out)[i // height, y]
        middle = source[y]
        for x in range(width):
            target[x] = weight[0] * middle[x]
        # Rows past the farther border add nothing.
        last = min(reach, max(y, height - 1 - y))
        for k in range(1, last - 2, 4):
            _add_four_pairs(
                _row(source, y - k, outside), _row(source, y + k, outside),
                _row(source, y - k - 1, outside), _row(source, y + k + 1, outside),
                _row(source, y - k - 2, outside), _row(source, y + k + 2, outside),
                _row(source, y - k - 3, outside), _row(source, y + k + 3, outside),
                weight[k], weight[k + 1], weight[k + 2], weight[k + 3], target,
            )  # fmt: skip
        for k in range(1 + last // 4 * 4, last + 1):
            _add_pair(_row(source, y - k, outside), _row(source, y + k, outside), weight[k], target)


@inline
def _row(plane, y, outside):
    """Row y of a plane, or `outside`."""
    return plane[y] if 0 <= y < len(plane) else outside


@inline
def _add_pair(a, b, weight, out):
    """Out += weight (a + b)."""
    for x in range(len(out)):
        out[x] += weight * (a[x] + b[x])


@inline
def _add_four_pairs(a0, b0, a1, b1, a2, b2, a3, b3, w0, w1, w2, w3, out):
    """Four times `_add_pair` with one read and one write of `out`."""
    for x in range(len(out)):
        near = w0 * (a0[x] + b0[x]) + w1 * (a1[x] + b1[x])
        far = w2 * (a2[x] + b2[x]) + w3 * (a3[x] + b3[x])
        out[x] += near + far
