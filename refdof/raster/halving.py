"""Halving: one mip level from the finer one, row by row, for pipelines that round exactly.

Rows are flat, (H, W C): texel x of a row starts at x C. The same bits as the reads of `refdof.raster.texture` at the
coarser texels' centres, which of even sizes lie midway between four finer texels; infinite texels follow its rules.

1. means of four texels                      `halve_box`
2. bilinear reads midway between four        `halve_linear`
3. nine such reads, weighted                 `halve_gaussian`
4. least and greatest texels                 `halve_lowest`, `halve_highest`
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange

__all__ = ["halve_box", "halve_gaussian", "halve_highest", "halve_linear", "halve_lowest"]

_BAND = 16  # coarse rows that share the blends of the rows between them


@kernel
def halve_box(fine, channels, out):
    """Means of 2 x 2 texels: fine (H, W C) -> out (h, w C). A size of 1 counts twice, the last of an odd one not."""
    down, right = min(len(fine) - 1, 1), min(fine.shape[1] // channels - 1, 1)
    for y in prange(len(out)):
        upper, lower, row = borrow(fine)[2 * y], borrow(fine)[2 * y + down], borrow(out)[y]
        # A constant number of channels lets the compiler take whole texels at once.
        if channels == 4:
            _box_row(upper, lower, right, 4, row)
        elif channels == 3:
            _box_row(upper, lower, right, 3, row)
        elif channels == 1:
            _box_row(upper, lower, right, 1, row)
        else:
            _box_row(upper, lower, right, channels, row)


@kernel
def halve_linear(fine, channels, out):
    """Reads midway between 2 x 2 texels: fine (H, W C) -> out (h, w C). Sizes are even, or 1."""
    down, width = min(len(fine) - 1, 1), fine.shape[1]
    for y in prange(len(out)):
        texels, row = borrow(fine), borrow(out)[y]
        blends = np.empty(width + channels, dtype=fine.dtype)
        _midway_row(texels[2 * y], texels[2 * y + down], channels, blends)
        _second_texels(blends, 1, channels, row)


@kernel
def halve_gaussian(fine, channels, weights, out):
    """Nine reads midway between 2 x 2 texels, a texel apart: fine (H, W C) -> out (h, w C). Sizes are even.

    weights (9,) of the image's type, row by row.
    """
    for band in prange((len(out) + _BAND - 1) // _BAND):
        texels, coarse = borrow(fine), borrow(out)
        width, last, own = texels.shape[1], len(texels) - 1, fine.dtype
        blends = np.empty(width + channels, dtype=own)
        above, middle, below = np.empty_like(blends), np.empty_like(blends), np.empty_like(blends)
        first = band * _BAND
        _apart(texels[max(2 * first - 1, 0)], texels[2 * first], channels, blends, above)
        for y in range(first, min(first + _BAND, len(coarse))):
            _apart(texels[2 * y], texels[2 * y + 1], channels, blends, middle)
            _apart(texels[2 * y + 1], texels[min(2 * y + 2, last)], channels, blends, below)
            _nine_row(above, middle, below, channels, weights, coarse[y])
            above, below = below, above


@kernel
def halve_lowest(fine, out):
    """Least of the finer texels that a coarser one covers: (H, W) -> (h, w); the last of an odd size joins the last."""
    for y in prange(len(out)):
        texels, row = borrow(fine), borrow(out)[y]
        row[:] = np.inf
        for source in range(2 * y, len(texels) if y == len(out) - 1 else 2 * y + 2):
            for x in range(len(row)):
                for column in range(2 * x, texels.shape[1] if x == len(row) - 1 else 2 * x + 2):
                    row[x] = min(row[x], texels[source, column])


@kernel
def halve_highest(fine, out):
    """As `halve_lowest`, for the greatest."""
    for y in prange(len(out)):
        texels, row = borrow(fine), borrow(out)[y]
        row[:] = -np.inf
        for source in range(2 * y, len(texels) if y == len(out) - 1 else 2 * y + 2):
            for x in range(len(row)):
                for column in range(2 * x, texels.shape[1] if x == len(row) - 1 else 2 * x + 2):
                    row[x] = max(row[x], texels[source, column])


@inline
def _box_row(upper, lower, right, channels, out):
    """Means of two rows' texels. Unsigned places spare the test for negative ones."""
    quarter, n = out.dtype.type(0.25), np.uintp(channels)
    for x in range(len(out) // channels):
        for c in range(channels):
            to = np.uintp(x) * n + np.uintp(c)
            a = np.uintp(2 * x) * n + np.uintp(c)
            b = np.uintp(2 * x + right) * n + np.uintp(c)
            out[to] = ((upper[a] + upper[b]) + (lower[a] + lower[b])) * quarter


@inline
def _midway_row(upper, lower, channels, out):
    """Blends between all neighbours of two rows of W texels; W + 1, for the edges repeat."""
    half, infinity = out.dtype.type(0.5), out.dtype.type(np.inf)
    for c in range(channels):
        out[c] = _mid(upper[c], lower[c], half, infinity)
        end = len(upper) - channels + c
        out[len(upper) + c] = _mid(upper[end], lower[end], half, infinity)
    row, upper_right, lower_right = out[channels:], upper[channels:], lower[channels:]
    for i in range(len(upper_right)):
        top, bottom = _mid(upper[i], upper_right[i], half, infinity), _mid(lower[i], lower_right[i], half, infinity)
        row[i] = _mid(top, bottom, half, infinity)


@inline
def _apart(upper, lower, channels, blends, out):
    """`_midway_row`, the even ones (W / 2 + 1 texels) before the odd ones (W / 2)."""
    _midway_row(upper, lower, channels, blends)
    middle = len(upper) // 2 + channels
    _second_texels(blends, 0, channels, out[:middle])
    _second_texels(blends, 1, channels, out[middle:])


@inline
def _second_texels(row, first, channels, out):
    """Every second texel of a row. A constant number of channels lets the compiler move whole texels."""
    if channels == 4:
        _pick(row, first, 4, out)
    elif channels == 3:
        _pick(row, first, 3, out)
    elif channels == 1:
        _pick(row, first, 1, out)
    else:
        _pick(row, first, channels, out)


@inline
def _pick(row, first, channels, out):
    """`_second_texels`. Unsigned places spare the test for negative ones."""
    n = np.uintp(channels)
    for x in range(len(out) // channels):
        for c in range(channels):
            out[np.uintp(x) * n + np.uintp(c)] = row[np.uintp(2 * x + first) * n + np.uintp(c)]


@inline
def _nine_row(above, middle, below, channels, weights, out):
    """Weighted sums of 3 x 3 reads, those of each row being `_apart`."""
    size = len(out)
    for i in range(size):
        out[i] = out.dtype.type(0)
    for j in range(3):
        row = above if j == 0 else (middle if j == 1 else below)
        outer, inner = row[: size + channels], row[size + channels :]
        left, right = outer[:size], outer[channels:]
        for i in range(size):
            total = out[i] + weights[3 * j] * left[i]
            total += weights[3 * j + 1] * inner[i]
            out[i] = total + weights[3 * j + 2] * right[i]


@inline
def _mid(a, b, half, infinity):
    """`lerp` at 1/2 by the strict rules, without branches."""
    difference = b - a
    blend, wide = a + difference * half, a * half + b * half
    blend = wide if abs(difference) == infinity else blend
    return a if a == b else blend
