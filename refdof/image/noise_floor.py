"""Noise floor: the PSNR that even a perfect image gets against a reference that still has noise.

Against a noisy reference the squared error is the method's own plus the reference's. A score within a few decibels of
this floor measures the reference, not the method.

`noise_floor_psnr` takes the noise for normal. The noise of small bright lamps is not: most pixels that should show
some of a lamp show none of it, with an error bar of none. A `refdof.Reference` therefore measures its floor by its R
independent estimates, without any model of their distribution:

1. Show means of 1, 2, 4 and 8 of 16 disjoint groups of estimates on the display curve, or of
   1 and 2 of 4, if there are fewer than 16                                                      `noise_moments`
2. Their variance, and how far their expected values move when n doubles (their bias)           `noise_moments`
3. Both go on as they did before, up to the mean of all                                         `floor_of_moments`
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, as_image
from refdof._jit import inline, tile_kernel
from refdof.image.display import display, display_slope, encode_one

__all__ = ["LEAST_GROUPS", "floor_of_moments", "noise_floor_of_pair", "noise_floor_psnr", "noise_moments"]

LEAST_GROUPS = 4  # of estimates
_MOST_LEVELS = 4  # means of 1, 2, 4, 8 groups of 16
_LEAST_RATIO = 0.35  # of variances of twice as many groups: 0.5 for normal noise, less where white clips it


def noise_floor_psnr(reference: Any, standard_error: Any) -> float:
    """PSNR ceiling of the display image [dB]: 10 log10(1 / mean(SE_display^2)); inf without noise.

    The standard error passes the display curve by its slope at the reference value clipped to [0, 1]. Near
    white the clip itself removes noise: with Gaussian noise of width SE, only the part that falls below 1 is
    seen. At a value of 1 that is half the variance, two SE above it 0.6 %, far above it nothing. Near black
    no such care is needed: the mean of replicates that are >= 0 is never smaller than its own standard
    error, so the noise stays inside the range where the slope was taken.

    Parameters
    ----------
    reference : (H, W, 3)
        Linear RGB.
    standard_error : (H, W, 3)
        Of each reference value, >= 0, same unit.

    Raises
    ------
    InputError
        If shapes differ, a value is not finite, or a standard error is negative.
    """
    value = as_image("reference", reference, dtype=np.float64)
    error = as_image("standard_error", standard_error, value.shape, dtype=np.float64, minimum=0.0)
    seen = display_slope(value) * error
    mean_square = float(np.mean(seen * seen * _share_below_white(value, error)))
    return 10.0 * math.log10(1.0 / mean_square) if mean_square > 0.0 else math.inf


def noise_floor_of_pair(reference: Any, second: Any) -> float:
    """PSNR ceiling of the display image [dB] from two independent references of as many samples; inf if they agree.

    The squared difference of two independent values is twice the variance of one. No model of the noise is needed.

    Parameters
    ----------
    reference, second : (H, W, 3)
        Linear RGB.

    Raises
    ------
    InputError
        If shapes differ, or a value is not finite.
    """
    first = as_image("reference", reference, dtype=np.float64)
    other = as_image("second", second, first.shape, dtype=np.float64)
    difference = display(first).astype(np.float64) - display(other)
    mean_square = float(np.mean(difference * difference)) / 2.0
    return 10.0 * math.log10(1.0 / mean_square) if mean_square > 0.0 else math.inf


def _share_below_white(value: Float, error: Float) -> Float:
    """Part of the variance that the clip at 1 leaves: E[(min(x, 1) - min(value, 1))^2] / error^2, x Gaussian.

    With t = |value - 1| / error, upper tail Q and density p it is (1 + t^2) Q - t p above white and
    1 - Q - t p + t^2 Q below.
    """
    from scipy.special import ndtr  # slow to import

    noisy = error > 0.0
    t = np.minimum(np.abs(value - 1.0) / np.where(noisy, error, 1.0), 40.0)  # the tails underflow beyond
    tail = ndtr(-t)
    density = np.exp(-0.5 * t * t) / math.sqrt(2.0 * math.pi)
    above = np.maximum(0.0, (1.0 + t * t) * tail - t * density)
    below = 1.0 - tail - t * density + t * t * tail
    return np.where(noisy, np.where(value >= 1.0, above, below), 0.0)


@tile_kernel
def noise_moments(sums, spent):
    """Display noise of pixels, summed over N pixels and 3 channels.

    Parameters
    ----------
    sums : (R, N, 3) float64
        Over `spent` (N,) points per replicate, R >= 4. Replicates beyond a multiple of 16, or 4, are left out.

    Returns
    -------
    (2 L - 1,) float64, L = 4 of 16 groups or 2 of 4
        Variance of means of 1, 2, 4 and 8 groups; squared change of the expected value from 1 to 2, 2 to 4 and 4 to 8
        groups, products of independent estimates of the change, so that both are unbiased; L and L - 1 of them.
    """
    levels = _levels_of(sums.shape[0])
    count = 1 << levels
    size = sums.shape[0] // count
    moments, groups, shown = np.zeros(2 * levels - 1), np.zeros((2, count)), np.zeros((levels, count))
    for p in range(sums.shape[1]):
        for c in range(3):
            same = True
            for g in range(count):
                groups[0, g] = 0.0
                for r in range(g * size, (g + 1) * size):
                    groups[0, g] += sums[r, p, c]
                groups[0, g] /= size * spent[p]
                same = same and groups[0, g] == groups[0, 0]
            if not same:
                for g in range(count):
                    groups[1, g] = encode_one(groups[0, g])
                for order in range(levels):
                    _add_moments(groups, order, shown, moments)
    for k in range(len(moments)):
        moments[k] /= levels
    return moments


@inline
def _add_moments(groups, order, shown, moments):
    """Add one value's moments, from halves of halves: the first half are the groups whose number has bit `order` 0.

    groups (2, G): linear and display values.
    """
    levels, all_groups = shown.shape
    for g in range(all_groups):
        shown[0, _place(g, order, levels)] = groups[0, g]
    # shown[j, k]: mean of 2^j groups, k = 0 .. G / 2^j - 1; then its display value.
    for j in range(1, levels):
        for k in range(all_groups >> j):
            shown[j, k] = 0.5 * (shown[j - 1, 2 * k] + shown[j - 1, 2 * k + 1])
    for g in range(all_groups):
        shown[0, _place(g, order, levels)] = groups[1, g]
    for j in range(1, levels):
        for k in range(all_groups >> j):
            shown[j, k] = encode_one(shown[j, k])
    for j in range(levels):
        count = all_groups >> j
        total, squares, change, changes = 0.0, 0.0, 0.0, 0.0
        for k in range(count):
            deviation = shown[j, k] - shown[j, 0]
            total, squares = total + deviation, squares + deviation * deviation
            if j > 0:
                step = shown[j, k] - 0.5 * (shown[j - 1, 2 * k] + shown[j - 1, 2 * k + 1])
                change, changes = change + step, changes + step * step
        moments[j] += (squares - total * total / count) / (count - 1)
        if j > 0:
            moments[levels + j - 1] += (change * change - changes) / (count * (count - 1))


@inline
def _levels_of(replicates):
    """How many sizes of groups: 2^levels groups of replicates."""
    return _MOST_LEVELS if replicates >> _MOST_LEVELS else 2


@inline
def _place(g, order, levels):
    """Where group g stands: its number's bits rotated by `order`."""
    return ((g >> order) | (g << (levels - order))) & ((1 << levels) - 1)


def floor_of_moments(moments: Float, values: int, replicates: int) -> float:
    """PSNR ceiling [dB] from summed `noise_moments` of so many values; inf without noise.

    While most groups miss a lamp, neither variance nor bias falls with n; then both fall ever faster, until variance
    about halves as n doubles. So the ratio of neighbours goes on changing, half as much, and bias falls by half at
    least. Of 4 groups there is one ratio only: the next is taken half-way to a half. On the built-in scenes the floor
    is met within half a decibel: by 16 estimates from 64 samples on, by 4 from 256 on. Where a single jump decides the
    whole picture, one decibel was seen.
    """
    levels = (len(moments) + 1) // 2
    groups, variance, change = 1 << levels, moments[:levels], np.maximum(moments[levels:], 0.0)
    if not variance.all():
        return math.inf
    last = variance[-1] / variance[-2]
    onward = math.sqrt(last * variance[-3] / variance[-2]) if levels > 2 else math.sqrt(0.5 / last)
    rest = variance[-1] * min(max(last * onward, _LEAST_RATIO), 1.0)
    rest *= groups * (replicates // groups) / replicates
    ratio = min(change[-1] / change[-2], 0.5) if levels > 2 and change[-2] > 0.0 else 0.5
    bias = change[-1] * ratio * ratio / (1.0 - ratio)  # without the step up to all groups, which is made
    return 10.0 * math.log10(values / (rest + bias))
