"""Regions: how large the error is in a part of the picture, without the reference's noise.

E (X - A)^2 of an image X and a noisy reference A is the squared error against the truth plus the variance of A. The
square of a standard error is an unbiased estimate of that variance, so it is taken off.
"""

import math

import numpy as np

from refdof._check import Float
from refdof.metrics.artefacts.maps import Mask

__all__ = ["region_rmse"]


def region_rmse(error: Float, standard_error: Float | None, region: Mask) -> float:
    """Root mean squared error over a region; where chance makes the mean negative it is 0; NaN of no pixel.

    error, standard_error (H, W, 3); region (H, W).
    """
    if not region.any():
        return math.nan
    square = float(np.mean(error[region] ** 2))
    noise = 0.0 if standard_error is None else float(np.mean(standard_error[region] ** 2))
    return math.sqrt(max(0.0, square - noise))
