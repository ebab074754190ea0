"""Error bars: mean and standard error of every pixel of a tile, and which pixels need more samples.

Only the replicates are independent, so only their spread enters. Where all of them agree although the picture is
blurred around, R M samples can have missed a share of 1 / (R M) of what the neighbours see: the error bar of such a
pixel is that share of the contrast around it.
"""

import numpy as np

from refdof._check import Index
from refdof._jit import tile_kernel

__all__ = ["grid_of", "summarise", "unfinished"]

_AGREE = 1e-12  # standard errors below this are roundings of equal estimates


def grid_of(pixels: Index) -> Index:
    """Where each pixel of a tile, (N, 2), stands in the list: (h, w)."""
    x, y = (pixels - pixels.min(axis=0)).T
    grid = np.empty((y.max() + 1, x.max() + 1), dtype=np.int64)
    grid[y, x] = np.arange(len(pixels))
    return grid


@tile_kernel
def summarise(sums, spent, grid):
    """Mean and standard error, (N, 3) each, of sums (R, N, 3) over `spent` (N,) points per replicate."""
    replicates, count = sums.shape[0], sums.shape[1]
    mean, error = np.empty((count, 3)), np.zeros((count, 3))
    certain = np.ones(count, dtype=np.bool_)
    for p in range(count):
        for c in range(3):
            # Deviations from the first estimate: equal estimates give an error of exactly 0.
            first, total, squares = sums[0, p, c] / spent[p], 0.0, 0.0
            for r in range(1, replicates):
                total += sums[r, p, c] / spent[p] - first
            total /= replicates
            for r in range(replicates):
                deviation = sums[r, p, c] / spent[p] - first - total
                squares += deviation * deviation
            mean[p, c] = first + total
            if replicates > 1:
                error[p, c] = np.sqrt(squares / (replicates - 1) / replicates)
            certain[p] = certain[p] and error[p, c] < _AGREE
    height, width = grid.shape
    for y in range(height):
        for x in range(width):
            p = grid[y, x]
            if not certain[p]:
                continue
            near = grid[max(0, y - 1) : y + 2, max(0, x - 1) : x + 2]
            blurred = False
            for q in near.flat:
                blurred = blurred or not certain[q]
            if not blurred:
                continue
            for c in range(3):
                low, high = np.inf, -np.inf
                for q in near.flat:
                    low, high = min(low, mean[q, c]), max(high, mean[q, c])
                error[p, c] = (high - low) / (replicates * spent[p])
    return mean, error


@tile_kernel
def unfinished(mean, error, spent, grid, tolerance, most):
    """Which pixels (N,) need twice the points: above the tolerance, or within 2 px of one that is; the least sampled.

    A pixel v is above it if a channel's error exceeds tolerance * max(1, v). A pixel whose few samples all missed a
    small bright thing looks finished; its neighbours tell.
    """
    count = len(mean)
    above = np.zeros(count, dtype=np.bool_)
    for p in range(count):
        for c in range(3):
            above[p] = above[p] or error[p, c] > tolerance * max(1.0, abs(mean[p, c]))
    todo = np.zeros(count, dtype=np.bool_)
    least = most
    height, width = grid.shape
    for y in range(height):
        for x in range(width):
            p = grid[y, x]
            if spent[p] >= most:
                continue
            for q in grid[max(0, y - 2) : y + 3, max(0, x - 2) : x + 3].flat:
                todo[p] = todo[p] or above[q]
            if todo[p]:
                least = min(least, spent[p])
    for p in range(count):
        todo[p] = todo[p] and spent[p] == least
    return todo
