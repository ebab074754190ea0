"""Error bars: mean, standard error and interval of every pixel of a tile, and which pixels need more samples.

Only the replicates are independent, so only their spread enters. Where all of them agree although the picture is
blurred around, R M samples can have missed a share of 1 / (R M) of what the neighbours see: the standard error of such
a pixel is that share of the contrast around it.

Few estimates of a pixel that sees a little of something are skewed: most see none of it. The interval is therefore the
union of Student's and of Wilson's [1], which treats a pixel as a share between its least and its greatest estimate. A
pixel whose estimates agree may still have missed what estimates of its neighbours show, up to Wilson's share of no hit.

References
----------
.. [1] Wilson (1927), Probable Inference, the Law of Succession, and Statistical Inference, JASA 22(158).
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline, tile_kernel

__all__ = ["Estimate", "excess", "grid_of", "student_quantile", "summarise", "unfinished"]

_REACH = 2  # px: how far the neighbours are that tell a pixel what it may have missed
_NORMAL = 1.959964  # 97.5 % quantile of the normal distribution, of which Wilson's interval is made
_AGREE = 1e-12  # standard errors below this are roundings of equal estimates


def grid_of(pixels: Index) -> Index:
    """Where each pixel of a tile, (N, 2), stands in the list: (h, w)."""
    x, y = (pixels - pixels.min(axis=0)).T
    grid = np.empty((y.max() + 1, x.max() + 1), dtype=np.int64)
    grid[y, x] = np.arange(len(pixels))
    return grid


class Estimate(NamedTuple):
    """N pixels: mean, standard error and interval, (N, 3) float64 each."""

    mean: Float
    error: Float
    low: Float
    high: Float


def student_quantile(replicates: int) -> float:
    """Half-width of a 95 % interval in standard errors, of a normal sample of so many replicates; inf for one."""
    from scipy.special import stdtrit

    return float(stdtrit(replicates - 1, 0.975)) if replicates > 1 else math.inf


def summarise(sums: Float, spent: Index, grid: Index) -> Estimate:
    """What the estimates of a tile say, from sums (R, N, 3) over `spent` (N,) points per replicate."""
    return Estimate(*_summarise(sums, spent, grid, student_quantile(len(sums))))


@tile_kernel
def _summarise(sums, spent, grid, quantile):
    """The fields of an `Estimate`."""
    replicates, count = sums.shape[0], sums.shape[1]
    mean, error = np.empty((count, 3)), np.zeros((count, 3))
    low, high = np.empty((count, 3)), np.empty((count, 3))
    certain = np.ones(count, dtype=np.bool_)
    for p in range(count):
        for c in range(3):
            # Deviations from the first estimate: equal estimates give an error of exactly 0.
            first, total, squares = sums[0, p, c] / spent[p], 0.0, 0.0
            low[p, c], high[p, c] = first, first
            for r in range(1, replicates):
                estimate = sums[r, p, c] / spent[p]
                total += estimate - first
                low[p, c], high[p, c] = min(low[p, c], estimate), max(high[p, c], estimate)
            total /= replicates
            for r in range(replicates):
                deviation = sums[r, p, c] / spent[p] - first - total
                squares += deviation * deviation
            mean[p, c] = first + total
            if replicates > 1:
                error[p, c] = np.sqrt(squares / (replicates - 1) / replicates)
            certain[p] = certain[p] and error[p, c] < _AGREE
    least, most = low.copy(), high.copy()
    height, width = grid.shape
    for y in range(height):
        for x in range(width):
            p = grid[y, x]
            if not certain[p]:
                for c in range(3):
                    low[p, c], high[p, c] = _score_interval(mean[p, c], error[p, c], least[p, c], most[p, c], quantile)
                continue
            # All estimates agree: what the neighbours' estimates show may have been missed.
            near = grid[max(0, y - _REACH) : y + _REACH + 1, max(0, x - _REACH) : x + _REACH + 1]
            next_to = grid[max(0, y - 1) : y + 2, max(0, x - 1) : x + 2]
            for c in range(3):
                unseen_low, unseen_high = mean[p, c], mean[p, c]
                for q in near.flat:
                    if not certain[q]:
                        unseen_low = min(unseen_low, least[q, c])
                        unseen_high = max(unseen_high, most[q, c])
                share = _unseen_share(replicates)
                low[p, c] -= share * (mean[p, c] - unseen_low)
                high[p, c] += share * (unseen_high - mean[p, c])
            blurred = False
            for q in next_to.flat:
                blurred = blurred or not certain[q]
            if blurred:
                for c in range(3):
                    darkest, brightest = np.inf, -np.inf
                    for q in next_to.flat:
                        darkest, brightest = min(darkest, mean[q, c]), max(brightest, mean[q, c])
                    error[p, c] = (brightest - darkest) / (replicates * spent[p])
    return mean, error, low, high


@inline
def _score_interval(mean, error, least, most, quantile):
    """The wider ends of Student's interval and of Wilson's, [1], for a share between the extreme estimates."""
    low, high = mean - quantile * error, mean + quantile * error
    span = most - least
    share, spread = (mean - least) / span if span > 0.0 else 0.0, error / span if span > 0.0 else 0.0
    if share > 0.0 and share < 1.0 and spread > 0.0:
        trials = share * (1.0 - share) / (spread * spread)  # of a coin with the same mean and spread
        pull = _NORMAL * _NORMAL / trials
        middle = (share + 0.5 * pull) / (1.0 + pull)
        half = _NORMAL / (1.0 + pull) * np.sqrt(spread * spread + 0.25 * pull / trials)
        low = min(low, least + span * (middle - half))
        high = max(high, least + span * (middle + half))
    return low, high


@inline
def _unseen_share(replicates):
    """The largest share that so many estimates may all have missed: Wilson's interval of no hit, [1]."""
    square = _NORMAL * _NORMAL
    return square / (replicates + square) if replicates > 1 else 1.0


def excess(found: Estimate, tolerance: float) -> Float:
    """Error of each pixel (N,), largest channel, over what is allowed: tolerance * max(1, its brightest channel)."""
    allowed = tolerance * np.maximum(1.0, np.abs(found.mean).max(axis=1))
    with np.errstate(over="ignore"):  # of a tolerance near the smallest number
        share: Float = found.error.max(axis=1) / allowed
    return share


@tile_kernel
def unfinished(mean, error, spent, grid, tolerance, most):
    """Which pixels (N,) need twice the points: above the tolerance, or within 2 px of one that is; the least sampled.

    A pixel is above it if its `excess` is above 1. A pixel whose few samples all missed a
    small bright thing looks finished; its neighbours tell.
    """
    count = len(mean)
    above = np.zeros(count, dtype=np.bool_)
    for p in range(count):
        allowed = tolerance * max(1.0, abs(mean[p, 0]), abs(mean[p, 1]), abs(mean[p, 2]))
        above[p] = max(error[p, 0], error[p, 1], error[p, 2]) > allowed
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
