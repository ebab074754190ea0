"""Anisotropic mip chains: a blurred background takes nothing from what is sharp in front of it.

1. halve circles of confusion with a 3 x 3 Gaussian                          `halve`
2. halve colour with the same one, without taps that are sharper             `halve`
3. find the largest blur among nearer neighbours, for the last level         `foreground_blur`

Circles are (H, W, 2): signed radius, for the order in depth, and its size, the degree of blur [px]. Each level has half
the size of the one before, rounded down. The nine bilinear reads lie one finer texel apart around a coarse texel.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), equations (1), (9) and (10).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from refdof._check import Float, Index
from refdof._jit import borrow, inline, kernel, prange

__all__ = ["Chain", "depth_of_chain", "foreground_blur", "halve", "new_chain"]

_SIDE = math.exp(
    -0.5
)  # the Gaussian of [1] at one texel, with a standard deviation of one texel, which [1] leaves open
_SHARES = np.array([_SIDE, 1.0, _SIDE]) / (1.0 + 2.0 * _SIDE)


class Chain(NamedTuple):
    """Mip levels in one array (T, C), row by row, and a texel for reads of two; starts, heights, widths: (L,) int64."""

    texels: Float
    starts: Index
    heights: Index
    widths: Index

    def level(self, k: int) -> Float:
        """Level k: (h, w, C), to read or to fill."""
        first, height, width = int(self.starts[k]), int(self.heights[k]), int(self.widths[k])
        return self.texels[first : first + height * width].reshape(height, width, -1)


def depth_of_chain(width: int, height: int) -> int:
    """The level at which a picture is a single texel."""
    return max(width, height).bit_length() - 1


def new_chain(shape: tuple[int, int, int], last: int, dtype: npt.DTypeLike) -> Chain:
    """A chain with levels 0 .. `last` of a picture (H, W, C), to be filled, and one more texel of 0."""
    heights, widths = ([max(1, side >> k) for k in range(last + 1)] for side in shape[:2])
    starts = np.cumsum([0] + [h * w for h, w in zip(heights, widths, strict=True)])
    texels = np.empty((int(starts[-1]) + 1, shape[2]), dtype=dtype)
    texels[-1] = 0
    return Chain(
        texels,
        starts[:-1].astype(np.int64),
        np.array(heights, dtype=np.int64),
        np.array(widths, dtype=np.int64),
    )


def halve(color: Float, circles: Float, delta: float, coarse_color: Float, coarse_circles: Float) -> None:
    """Fill the next level (h, w, 4), its last channel with 0, and (h, w, 2).

    `delta` [px]: how much sharper than the centre a tap may be; inf is equation (1).
    """
    _halve(color, circles, circles.dtype.type(delta), _SHARES.astype(circles.dtype), coarse_color, coarse_circles)


def foreground_blur(circles: Float, height: int, width: int) -> Float:
    """Equation (10): the largest blur among the taps in front of the focal plane and nearer than the centre (h, w)."""
    out = np.empty((height, width), dtype=circles.dtype)
    _foreground_blur(circles, out)
    return out


@kernel
def _halve(color, circles, delta, shares, coarse_color, coarse_circles):
    """One level: rows blended first, then columns."""
    height, width = coarse_circles.shape[:2]
    fine_height, fine_width = circles.shape[:2]
    for y in prange(height):
        colors, sizes, weights = borrow(color), borrow(circles), borrow(shares)
        own = circles.dtype.type
        row, share = _centre(y, fine_height, height)
        across, around = (
            np.empty((3, fine_width, 3), dtype=color.dtype),
            np.empty((3, fine_width, 2), dtype=color.dtype),
        )
        for j in range(3):
            top, bottom = _inside(row - 1 + j, fine_height), _inside(row + j, fine_height)
            _blend_rows(colors[top], colors[bottom], own(share), across[j])
            _blend_rows(sizes[top], sizes[bottom], own(share), around[j])
        for x in range(width):
            column, share = _centre(x, fine_width, width)
            w = own(share)
            left, right = _inside(column, fine_width), _inside(column + 1, fine_width)
            blurred = around[1, left, 1] + (around[1, right, 1] - around[1, left, 1]) * w
            behind = around[1, left, 0] + (around[1, right, 0] - around[1, left, 0]) * w > own(0)
            red, green, blue, total, signed, size = own(0), own(0), own(0), own(0), own(0), own(0)
            for j in range(3):
                for i in range(3):
                    left, right = _inside(column - 1 + i, fine_width), _inside(column + i, fine_width)
                    weight = weights[j] * weights[i]
                    tap = around[j, left, 1] + (around[j, right, 1] - around[j, left, 1]) * w
                    signed += weight * (around[j, left, 0] + (around[j, right, 0] - around[j, left, 0]) * w)
                    size += weight * tap
                    if behind and blurred > tap + delta:  # Eq. (9)
                        continue
                    total += weight
                    red += weight * (across[j, left, 0] + (across[j, right, 0] - across[j, left, 0]) * w)
                    green += weight * (across[j, left, 1] + (across[j, right, 1] - across[j, left, 1]) * w)
                    blue += weight * (across[j, left, 2] + (across[j, right, 2] - across[j, left, 2]) * w)
            coarse_color[y, x, 0], coarse_color[y, x, 1] = red / total, green / total  # Eq. (1)
            coarse_color[y, x, 2], coarse_color[y, x, 3] = blue / total, own(0)
            coarse_circles[y, x, 0], coarse_circles[y, x, 1] = signed, size


@kernel
def _foreground_blur(circles, out):
    """Fill out (h, w) from the finer level's circles (H, W, 2)."""
    height, width = out.shape
    fine_height, fine_width = circles.shape[:2]
    for y in prange(height):
        own = circles.dtype.type
        row, wy = _centre(y, fine_height, height)
        for x in range(width):
            column, wx = _centre(x, fine_width, width)
            here = _tap(circles, column, row, own(wx), own(wy), 0)
            largest = own(0)
            for j in range(-1, 2):
                for i in range(-1, 2):
                    tap = _tap(circles, column + i, row + j, own(wx), own(wy), 0)
                    if tap < own(0) and tap < here:
                        largest = max(largest, _tap(circles, column + i, row + j, own(wx), own(wy), 1))
            out[y, x] = largest


@inline
def _centre(x, fine, coarse):
    """Where a coarse texel's centre lies: the first of two finer texels, and the weight of the second."""
    place = (x + 0.5) * fine / coarse - 0.5
    first = np.floor(place)
    return int(first), place - first


@inline
def _inside(x, size):
    return min(max(x, 0), size - 1)


@inline
def _blend_rows(top, bottom, w, out):
    for x in range(len(out)):
        for c in range(out.shape[1]):
            out[x, c] = top[x, c] + (bottom[x, c] - top[x, c]) * w


@inline
def _tap(image, x, y, wx, wy, c):
    """A bilinear read, rows first."""
    left, right = _inside(x, image.shape[1]), _inside(x + 1, image.shape[1])
    top, bottom = _inside(y, image.shape[0]), _inside(y + 1, image.shape[0])
    a = image[top, left, c] + (image[bottom, left, c] - image[top, left, c]) * wy
    b = image[top, right, c] + (image[bottom, right, c] - image[top, right, c]) * wy
    return a + (b - a) * wx
