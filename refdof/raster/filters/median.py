"""Median: of the nine texels around each, channel by channel; removes what a gather's few taps leave single.

A network of 19 exchanges whose middle is the median, which vectorises over the row.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange

__all__ = ["median"]


@kernel
def median(picture):
    """Medians of 3 x 3 texels (H, W, C), each channel apart; beyond the edge it repeats."""
    height, width, channels = picture.shape
    flat, out = picture.reshape(height, width * channels), np.empty_like(picture)
    for y in prange(height):
        row, source = borrow(out.reshape(height, width * channels))[y], borrow(flat)
        upper, middle, lower = source[max(y - 1, 0)], source[y], source[min(y + 1, height - 1)]
        _medians(upper, middle, lower, channels, row)
        for column in (0, width - 1):
            for c in range(channels):
                left, right = max(column - 1, 0) * channels + c, min(column + 1, width - 1) * channels + c
                here = column * channels + c
                row[here] = _median(
                    (upper[left], upper[here], upper[right]),
                    (middle[left], middle[here], middle[right]),
                    (lower[left], lower[here], lower[right]),
                )
    return out


@inline
def _medians(upper, middle, lower, channels, out):
    """Medians of a row but for its first and last texel. Parts that begin at 0 are read without a test for the sign."""
    end, target = len(out) - 2 * channels, out[channels:]
    upper_here, middle_here, lower_here = upper[channels:], middle[channels:], lower[channels:]
    upper_right, middle_right, lower_right = upper_here[channels:], middle_here[channels:], lower_here[channels:]
    for k in range(end):
        target[k] = _median(
            (upper[k], upper_here[k], upper_right[k]),
            (middle[k], middle_here[k], middle_right[k]),
            (lower[k], lower_here[k], lower_right[k]),
        )


@inline
def _median(first, second, third):
    a0, a1, a2 = _sorted(first)
    b0, b1, b2 = _sorted(second)
    c0, c1, c2 = _sorted(third)
    low = max(max(a0, b0), c0)
    high = min(min(a2, b2), c2)
    _, mid, _ = _sorted((a1, b1, c1))
    _, answer, _ = _sorted((low, mid, high))
    return answer


@inline
def _sorted(three):
    a, b, c = three
    a, b = min(a, b), max(a, b)
    b, c = min(b, c), max(b, c)
    a, b = min(a, b), max(a, b)
    return a, b, c
