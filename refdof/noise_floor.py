"""Noise floor: the PSNR that even a perfect image gets against a reference that still has noise.

Against a noisy reference the squared error is the method's own plus the reference's variance. A score within
a few decibels of this floor measures the reference, not the method.
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, as_image
from refdof.display import display_slope

__all__ = ["noise_floor_psnr"]


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


def _share_below_white(value: Float, error: Float) -> Float:
    """Part of the variance that the clip at 1 leaves: E[(min(x, 1) - min(value, 1))^2] / error^2, x Gaussian.

    With t = |value - 1| / error, upper tail Q and density p it is (1 + t^2) Q - t p above white and
    1 - Q - t p + t^2 Q below.
    """
    from scipy.special import ndtr  # 0.1 s to import

    noisy = error > 0.0
    t = np.minimum(np.abs(value - 1.0) / np.where(noisy, error, 1.0), 40.0)  # the tails underflow beyond
    tail = ndtr(-t)
    density = np.exp(-0.5 * t * t) / math.sqrt(2.0 * math.pi)
    above = np.maximum(0.0, (1.0 + t * t) * tail - t * density)
    below = 1.0 - tail - t * density + t * t * tail
    return np.where(noisy, np.where(value >= 1.0, above, below), 0.0)
