"""Anisotropic mip chains: a blurred background takes nothing from what is sharp in front of it.

0. copy the picture and its circles into level 0                             `begin`
1. downsample circles of confusion with a 3 x 3 Gaussian                     `downsample`
2. downsample colour with the same one, without taps that are sharper        `downsample`
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
from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._jit.texel_registers import weigh_texels
from refdof.image.bilinear import bilinear

__all__ = ["Chain", "begin", "depth_of_chain", "downsample", "foreground_blur", "new_chain"]

_SIDE = math.exp(-0.5)  # the Gaussian at one texel, with a standard deviation of one texel, which [1] leaves open
_SHARES = np.array([_SIDE, 1.0, _SIDE]) / (1.0 + 2.0 * _SIDE)


_SMALL = 16384  # texels of a level: less work than to wake other threads


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


class Columns(NamedTuple):
    """Of a coarse level's w columns: places (4, w) of finer texels, their weights (4, w), right (w,): the weight of the
    second texel of a tap.
    """

    places: Index
    weights: Float
    right: Float


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


def begin(color: Float, coc: Float, colors: Float, circles: Float) -> None:
    """Fill level 0 (H, W, 4) and (H, W, 2) from color (H, W, 3) and coc (H, W) [px]."""
    _begin(color, coc, colors, circles)


def downsample(color: Float, circles: Float, delta: float, coarse_color: Float, coarse_circles: Float) -> None:
    """Fill the next level (h, w, 4), its last channel with 0, and (h, w, 2).

    `delta` [px]: how much sharper than the centre a tap may be; inf is equation (1).
    """
    function = _downsample_small if coarse_circles[..., 0].size < _SMALL else _downsample
    function(color, circles, circles.dtype.type(delta), _SHARES.astype(circles.dtype), coarse_color, coarse_circles)


def foreground_blur(circles: Float, height: int, width: int) -> Float:
    """Equation (10): the largest blur among the taps in front of the focal plane and nearer than the centre (h, w)."""
    out = np.empty((height, width), dtype=circles.dtype)
    (_foreground_small if out.size < _SMALL else _foreground_blur)(circles, out)
    return out


@kernel
def _begin(color, coc, colors, circles):
    height, width = coc.shape
    for y in prange(height):
        source, sizes, texels, pairs = color[y], coc[y], colors[y], circles[y]
        zero = color.dtype.type(0)
        for x in range(width):
            texels[x, 0], texels[x, 1], texels[x, 2], texels[x, 3] = source[x, 0], source[x, 1], source[x, 2], zero
        for x in range(width):
            pairs[x, 0], pairs[x, 1] = sizes[x], abs(sizes[x])


@kernel
def _downsample(color, circles, delta, shares, coarse_color, coarse_circles):
    places, weights, right = _columns(circles.shape[1], coarse_circles.shape[1], shares)
    for y in prange(len(coarse_circles)):
        columns = Columns(places, weights, right)  # one made outside cannot enter the parallel loop
        _downsample_row(y, color, circles, columns, delta, shares, coarse_color, coarse_circles)


@tile_kernel
def _downsample_small(color, circles, delta, shares, coarse_color, coarse_circles):
    columns = _columns(circles.shape[1], coarse_circles.shape[1], shares)
    for y in range(len(coarse_circles)):
        _downsample_row(y, color, circles, columns, delta, shares, coarse_color, coarse_circles)


@inline
def _columns(fine, coarse, shares):
    """`Columns` of a coarse level's w columns."""
    columns, along = np.empty((4, coarse), dtype=np.int64), np.empty((4, coarse), dtype=shares.dtype)
    right = np.empty(coarse, dtype=shares.dtype)
    for x in range(coarse):
        column, right[x] = _centre(x, fine, coarse)
        along[0, x], along[1, x], along[2, x], along[3, x] = _four(shares[0], shares[1], shares[2], right[x])
        for i in range(4):
            columns[i, x] = _inside(column - 1 + i, fine)
    return Columns(columns, along, right)


@inline
def _downsample_row(y, color, circles, columns, delta, shares, coarse_color, coarse_circles):
    """Four rows are weighed into one, then its columns; or 16 texels where some are left out."""
    colors, sizes = borrow(color), borrow(circles)
    places, weights, rights = borrow(columns.places), borrow(columns.weights), borrow(columns.right)
    height, (fine_height, fine_width) = coarse_circles.shape[0], circles.shape[:2]
    all_texels = colors.reshape(fine_height * fine_width, 4)
    scalar = circles.dtype.type
    row, share = _centre(y, fine_height, height)
    h, zero = scalar(share), scalar(0)
    rows = (
        _inside(row - 1, fine_height),
        _inside(row, fine_height),
        _inside(row + 1, fine_height),
        _inside(row + 2, fine_height),
    )
    down = _four(shares[0], shares[1], shares[2], h)
    line = np.empty((fine_width, 4), dtype=color.dtype)
    pairs, centre = np.empty((fine_width, 2), dtype=color.dtype), np.empty((fine_width, 2), dtype=color.dtype)
    least = np.empty(fine_width, dtype=color.dtype)
    a, b, c, d = rows
    _weigh_rows(colors[a].ravel(), colors[b].ravel(), colors[c].ravel(), colors[d].ravel(), down, line.ravel())
    one, two, three, four = sizes[a], sizes[b], sizes[c], sizes[d]
    _weigh_rows(one.ravel(), two.ravel(), three.ravel(), four.ravel(), down, pairs.ravel())
    _blend_rows(two.ravel(), three.ravel(), h, centre.ravel())
    for x in range(fine_width):
        least[x] = min(min(one[x, 1], two[x, 1]), min(three[x, 1], four[x, 1]))
    for x in range(coarse_circles.shape[1]):
        w = rights[x]
        p, q, r, s = places[0, x], places[1, x], places[2, x], places[3, x]
        e, f, g, k = weights[0, x], weights[1, x], weights[2, x], weights[3, x]
        coarse_circles[y, x, 0] = e * pairs[p, 0] + f * pairs[q, 0] + g * pairs[r, 0] + k * pairs[s, 0]
        coarse_circles[y, x, 1] = e * pairs[p, 1] + f * pairs[q, 1] + g * pairs[r, 1] + k * pairs[s, 1]
        blurred = centre[q, 1] + (centre[r, 1] - centre[q, 1]) * w
        behind = centre[q, 0] + (centre[r, 0] - centre[q, 0]) * w > zero
        sharpest = min(min(least[p], least[q]), min(least[r], least[s]))
        if behind and blurred > sharpest + delta:
            red, green, blue = _without_sharper(all_texels, sizes, rows, (p, q, r, s), w, h, shares, blurred, delta)
        else:
            red, green, blue, _ = weigh_texels(line, (p, q, r, s), (e, f, g, k))  # Eq. (1)
        coarse_color[y, x, 0], coarse_color[y, x, 1] = red, green
        coarse_color[y, x, 2], coarse_color[y, x, 3] = blue, zero


@inline
def _without_sharper(texels, circles, rows, columns, w, h, shares, blurred, delta):
    """Equation (9): the taps that are no sharper than the centre, as weights of their 16 texels."""
    width = circles.shape[1]
    first = _taps(circles[rows[0]], circles[rows[1]], columns, w, h, shares[0], shares, blurred, delta)
    second = _taps(circles[rows[1]], circles[rows[2]], columns, w, h, shares[1], shares, blurred, delta)
    third = _taps(circles[rows[2]], circles[rows[3]], columns, w, h, shares[2], shares, blurred, delta)
    a, b, c, d = _four(first[0], second[0], third[0], h)
    e, f, g, k = _four(first[1], second[1], third[1], h)
    m, n, o, p = _four(first[2], second[2], third[2], h)
    q, r, s, t = _four(first[3], second[3], third[3], h)
    one, two, three, four = rows[0] * width, rows[1] * width, rows[2] * width, rows[3] * width
    i, j, u, v = columns
    red, green, blue, _ = weigh_texels(
        texels,
        (
            *(one + i, one + j, one + u, one + v, two + i, two + j, two + u, two + v),
            *(three + i, three + j, three + u, three + v, four + i, four + j, four + u, four + v),
        ),
        (a, e, m, q, b, f, n, r, c, g, o, s, d, k, p, t),
    )
    total = first[4] + second[4] + third[4]
    return red / total, green / total, blue / total


@inline
def _taps(top, bottom, columns, w, h, weight, shares, blurred, delta):
    """Weights of four columns in a row of three taps, without those that are sharper, and the sum of the taps'."""
    zero = type(w)(0)
    p = top[columns[0], 1] + (bottom[columns[0], 1] - top[columns[0], 1]) * h
    q = top[columns[1], 1] + (bottom[columns[1], 1] - top[columns[1], 1]) * h
    r = top[columns[2], 1] + (bottom[columns[2], 1] - top[columns[2], 1]) * h
    s = top[columns[3], 1] + (bottom[columns[3], 1] - top[columns[3], 1]) * h
    a = zero if blurred > p + (q - p) * w + delta else weight * shares[0]
    b = zero if blurred > q + (r - q) * w + delta else weight * shares[1]
    c = zero if blurred > r + (s - r) * w + delta else weight * shares[2]
    e, f, g, k = _four(a, b, c, w)
    return e, f, g, k, a + b + c


@inline
def _four(a, b, c, w):
    """Weights of four texels from those of three reads between them, each `w` of a texel on."""
    rest = type(w)(1) - w
    return a * rest, a * w + b * rest, b * w + c * rest, c * w


@inline
def _weigh_rows(a, b, c, d, weights, out):
    e, f, g, h = weights
    for x in range(len(out)):
        out[x] = a[x] * e + b[x] * f + c[x] * g + d[x] * h


@inline
def _blend_rows(top, bottom, w, out):
    for x in range(len(out)):
        out[x] = top[x] + (bottom[x] - top[x]) * w


@kernel
def _foreground_blur(circles, out):
    for y in prange(len(out)):
        _foreground_row(y, borrow(circles), out)


@tile_kernel
def _foreground_small(circles, out):
    for y in range(len(out)):
        _foreground_row(y, circles, out)


@inline
def _foreground_row(y, circles, out):
    """Fill row y of out (h, w) from the finer level's circles (H, W, 2)."""
    height, width = out.shape
    fine_height, fine_width = circles.shape[:2]
    scalar = circles.dtype.type
    row, wy = _centre(y, fine_height, height)
    for x in range(width):
        column, wx = _centre(x, fine_width, width)
        here = _tap(circles, column, row, scalar(wx), scalar(wy), 0)
        largest = scalar(0)
        for j in range(-1, 2):
            for i in range(-1, 2):
                tap = _tap(circles, column + i, row + j, scalar(wx), scalar(wy), 0)
                if tap < scalar(0) and tap < here:
                    largest = max(largest, _tap(circles, column + i, row + j, scalar(wx), scalar(wy), 1))
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
def _tap(image, x, y, wx, wy, c):
    """A bilinear read, rows first."""
    left, right = _inside(x, image.shape[1]), _inside(x + 1, image.shape[1])
    top, bottom = _inside(y, image.shape[0]), _inside(y + 1, image.shape[0])
    return bilinear(image[top, left, c], image[bottom, left, c], image[top, right, c], image[bottom, right, c], wy, wx)
