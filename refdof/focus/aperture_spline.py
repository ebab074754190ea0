"""Aperture spline: refractive power, or the weight of rays, from the middle of the lens to its rim, by a few controls.

The controls are pairs (share of the lens radius, value). Between them the surface of `moving_least_squares` is taken in
one dimension, over the square of the radius: it runs through the controls, is level beyond a single one, and two of
them make a straight line in r^2. Of the power, this is spherical aberration of the third order.

Departures from the paper
-------------------------
- The paper speaks of a spline and no more. Here it is made by the moving least squares of its other controls, and over
  r^2: a function of a point of the lens that is smooth in the middle is even in r.
- The lens takes values at equal steps of the radius, with monotone cubics between: controls at multiples of 1/60 are
  met exactly, others nearly.
- What falls below the least value that is allowed is that.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 5.3.
"""

from typing import Any

import numpy as np

from refdof._check import InputError, as_float
from refdof.focus.keys import Keys, as_keys
from refdof.focus.moving_least_squares import moving_least_squares

__all__ = ["LEAST_POWER", "aperture_spline", "as_controls"]

LEAST_POWER = 1e-3
_STEPS = 60  # of the radius; many fractions are multiples of it
_FALLOFF = 3.0  # as of a focus point
_MOST = 64


def as_controls(name: str, given: Any, least: float) -> Keys:
    """Controls (share of the radius 0 .. 1, value); an empty tuple has none.

    Raises
    ------
    InputError
        If they are too many, radii do not grow or are outside of 0 .. 1, or a value is below the least or all are 0.
    """
    if isinstance(given, tuple) and not given:
        return ()
    controls = as_keys(name, given, {"minimum": least, "maximum": 1e6}, "controls", "radii", _MOST)
    as_float(f"{name}: radii", [radius for radius, _ in controls], (None,), minimum=0.0, maximum=1.0)
    if not any(value for _, value in controls):
        raise InputError(f"{name}: all are 0; at least one must be above 0")
    return controls


def aperture_spline(controls: Keys, least: float) -> tuple[float, ...]:
    """Values at equal steps from the middle of the lens to its rim; 1 everywhere without controls."""
    if not controls:
        return (1.0, 1.0)
    radii, values = np.transpose(controls)
    points = np.stack([radii**2, np.zeros(len(radii))], axis=1)
    places = np.stack([(np.arange(_STEPS + 1) / _STEPS) ** 2, np.zeros(_STEPS + 1)], axis=1)
    even = np.ones(len(radii))
    found = moving_least_squares(points, values[:, None], even, _FALLOFF * even, places)[:, 0]
    return tuple(np.maximum(found, least).tolist())
