"""Levels of an N-buffer: squares of pixels and their extremes, each from the one before.

1. extremes of every pixel or block over all layers    `bottom_lowest`, `bottom_highest`
2. squares of twice the side                           `double_lowest`, `double_highest`
3. extremes of two by two squares                      `extremes_of_four`
"""

import numpy as np

from refdof._jit import inline, kernel, prange

__all__ = ["bottom_highest", "bottom_lowest", "double_highest", "double_lowest", "extremes_of_four"]


@kernel
def bottom_lowest(stack, block, infinity, out):
    """Least value of every block over all layers: stack (N, H, W) -> out (ceil(H / block), ceil(W / block))."""
    for y in prange(len(out)):
        row = out[y]
        row[:] = infinity
        for layer in range(len(stack)):
            for source in range(y * block, min((y + 1) * block, stack.shape[1])):
                for dx in range(min(block, stack.shape[2])):
                    taps = stack[layer, source, dx::block]
                    for x in range(len(taps)):
                        value = taps[x] if abs(taps[x]) < infinity else infinity
                        row[x] = value if value < row[x] else row[x]


@kernel
def bottom_highest(stack, block, infinity, out):
    """Greatest value of every block over all layers, as `bottom_lowest`."""
    for y in prange(len(out)):
        row = out[y]
        row[:] = -infinity
        for layer in range(len(stack)):
            for source in range(y * block, min((y + 1) * block, stack.shape[1])):
                for dx in range(min(block, stack.shape[2])):
                    taps = stack[layer, source, dx::block]
                    for x in range(len(taps)):
                        value = taps[x] if abs(taps[x]) < infinity else -infinity
                        row[x] = value if value > row[x] else row[x]


@kernel
def double_lowest(level, side, out):
    """Squares of 2 `side` from squares of `side`: (H, W) -> (H, W).

    A square that reaches the border has no right or lower neighbour that could add to it.
    """
    height, width = level.shape
    for y in prange(height):
        upper, lower, row = level[y], level[min(y + side, height - 1)], out[y]
        for x in range(width):
            row[x] = upper[x] if upper[x] < lower[x] else lower[x]
        upper_right, lower_right = upper[side:], lower[side:]
        for x in range(len(upper_right)):
            right = upper_right[x] if upper_right[x] < lower_right[x] else lower_right[x]
            row[x] = right if right < row[x] else row[x]


@kernel
def double_highest(level, side, out):
    """As `double_lowest`, for the greatest values."""
    height, width = level.shape
    for y in prange(height):
        upper, lower, row = level[y], level[min(y + side, height - 1)], out[y]
        for x in range(width):
            row[x] = upper[x] if upper[x] > lower[x] else lower[x]
        upper_right, lower_right = upper[side:], lower[side:]
        for x in range(len(upper_right)):
            right = upper_right[x] if upper_right[x] > lower_right[x] else lower_right[x]
            row[x] = right if right > row[x] else row[x]


@inline
def extremes_of_four(near, far, places, least, greatest):
    """Least and greatest of the values at four places; unsigned ones spare the test for negative ones."""
    corner, across, down = places[0], places[1], places[2]
    for k in range(len(corner)):
        a = np.uintp(corner[k])
        b, c = a + np.uintp(across[k]), a + np.uintp(down[k])
        d = c + np.uintp(across[k])
        if len(least):
            least[k] = min(min(near[a], near[b]), min(near[c], near[d]))
        if len(greatest):
            greatest[k] = max(max(far[a], far[b]), max(far[c], far[d]))
