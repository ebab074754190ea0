"""Moments: how much light a spot has, where it lies, how far it spreads and how round it is."""

import math
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, as_image, shape_of

__all__ = ["Moments", "disc_radius", "moments"]


class Moments(NamedTuple):
    """Moments of a spot of light.

    Attributes
    ----------
    energy : sum over pixels and channels
    x, y : centroid [px]
        Pixel (0, 0) has its centre at (0.5, 0.5), y down.
    radius : RMS distance from the centroid [px]
        A disc of radius r has r / sqrt(2), a Gaussian sqrt(2) deviations.
    anisotropy : 0 .. 1
        (a - b) / (a + b) of the variances along the principal axes: 0 is round, 1 a line; an ellipse of half axes p and
        q has (p^2 - q^2) / (p^2 + q^2).
    """

    energy: float
    x: float
    y: float
    radius: float
    anisotropy: float


def moments(spot: Any) -> Moments:
    """Moments of a spot, without its background.

    Parameters
    ----------
    spot : (H, W, 3) or (H, W)
        Linear light. Negative values count as they are. If the sum is not above 0, there are no other moments (NaN).

    Raises
    ------
    InputError
        If the shape is wrong, there is no pixel, or a value is not finite.
    """
    channels = (3,) if len(shape_of("spot", spot)) == 3 else ()
    light = as_image("spot", spot, (None, None, *channels), dtype=np.float64)
    return _moments(light.sum(axis=2) if channels else light)


def _moments(light: Float) -> Moments:
    energy = float(light.sum())
    if energy <= 0.0:
        return Moments(energy, math.nan, math.nan, math.nan, math.nan)
    share = light / energy
    y, x = np.indices(light.shape) + 0.5
    mean_x, mean_y = float((share * x).sum()), float((share * y).sum())
    dx, dy = x - mean_x, y - mean_y
    xx, xy, yy = (float((share * product).sum()) for product in (dx * dx, dx * dy, dy * dy))
    spread = xx + yy
    apart = math.hypot(xx - yy, 2.0 * xy)
    radius, anisotropy = (math.sqrt(spread), apart / spread) if spread > 0.0 else (0.0, 0.0)
    return Moments(energy, mean_x, mean_y, radius, min(anisotropy, 1.0))


def disc_radius(radius: float) -> float:
    """RMS radius of a disc of this radius."""
    return radius / math.sqrt(2.0)
