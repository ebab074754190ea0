"""Pointwise errors: what can be said pixel by pixel, in float64.

A noisy reference adds its own variance to every squared error. With two independent references A and B of
the same truth the product of the two differences, mean((X - A)(X - B)), has the expectation of the error
against the truth.
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.image.display import levels
from refdof.metrics._pair import display_pair, linear, linear_pair

__all__ = ["max_abs", "psnr", "psnr_8bit", "rel_mse", "rmse"]

_REL_EPSILON = 0.01  # of rel_mse, as in Rousselle et al. (2011), Adaptive Sampling and Reconstruction


def rmse(reference: Any, image: Any, second_reference: Any = None) -> float:
    """Root of the mean squared error of linear values.

    Parameters
    ----------
    reference, image : (H, W, 3)
        Linear RGB.
    second_reference : (H, W, 3), optional
        Independent of the first. The mean of the product of both differences is then free of the references'
        noise; where chance makes it negative it counts as 0: sqrt(max(0, mean((X - A)(X - B)))).

    Raises
    ------
    InputError
        If shapes differ, a value is not finite or beyond 1e33, or pixels have 8 or 16 bits. So do all metrics.
    """
    first, second = _differences(reference, image, second_reference)
    return math.sqrt(max(0.0, float(np.mean(first * second))))


def rel_mse(reference: Any, image: Any, second_reference: Any = None) -> float:
    """Mean of d^2 / (r^2 + 0.01) over all linear values.

    No value is left out: light that leaks into black counts, with the weight 1 / 0.01. With a
    `second_reference`, d^2 is the product of both differences and r the mean of both references. That
    removes the references' variance s^2 from the numerator, not the denominator's part in it. What is left per
    value is, to the order of s^2,

        s^2 (2 r d / (r^2 + 0.01)^2 + d^2 (1.5 r^2 - 0.005) / (r^2 + 0.01)^3).

    The result may be negative by chance.
    """
    first, second = _differences(reference, image, second_reference)
    base = linear("reference", reference)
    if second_reference is not None:
        base = (base + linear("second_reference", second_reference)) / 2.0
    return float(np.mean(first * second / (base * base + _REL_EPSILON)))


def max_abs(reference: Any, image: Any) -> float:
    """Largest absolute difference of linear values."""
    first, second = linear_pair(reference, image)
    return float(np.abs(second - first).max())


def psnr(reference: Any, image: Any) -> float:
    """Peak signal-to-noise ratio of the display image [dB]: 10 log10(1 / MSE), peak 1, inf if identical.

    Taken before any rounding to 8 bits; `psnr_8bit` is what most papers print.
    """
    first, second = display_pair(reference, image)
    return _decibel(1.0, second.astype(np.float64) - first)


def psnr_8bit(reference: Any, image: Any) -> float:
    """PSNR of the display images rounded to 8 bits [dB]: 10 log10(255^2 / MSE), inf if they are identical."""
    first, second = (levels(seen) for seen in display_pair(reference, image))
    return _decibel(255.0, second.astype(np.float64) - first)


def _differences(reference: Any, image: Any, second_reference: Any) -> tuple[Float, Float]:
    first, second = linear_pair(reference, image)
    difference = second - first
    if second_reference is None:
        return difference, difference
    return difference, second - linear("second_reference", second_reference, first.shape)


def _decibel(peak: float, difference: Float) -> float:
    mean_square = float(np.mean(difference * difference))
    return 10.0 * math.log10(peak * peak / mean_square) if mean_square > 0.0 else math.inf
