"""Keys: pairs (place, value) in growing order of places, such as keyframes, or controls of a curve."""

from typing import Any

import numpy as np

from refdof._check import InputError, as_float, as_number

__all__ = ["as_keys", "as_number_or_keys"]

_FARTHEST, _STEP = 1e6, 1e-6  # of places: a curve through keys divides by their steps, twice

Keys = tuple[tuple[float, float], ...]


def as_number_or_keys(name: str, given: Any, limits: dict[str, Any]) -> float | Keys:
    """A number, or keyframes (frame, value)."""
    if not isinstance(given, list | tuple | np.ndarray) or (isinstance(given, np.ndarray) and given.ndim == 0):
        return as_number(name, given, **limits)
    return as_keys(name, given, limits, "keyframes", "frames", 1000)


def as_keys(name: str, given: Any, limits: dict[str, Any], what: str, place: str, most: int) -> Keys:
    """Pairs (place, value), such as `what` at a `place`; `limits` are those of `as_number` for values.

    Raises
    ------
    InputError
        If there are none or too many, places do not grow by 1e-6 or more, or a number is out of range.
    """
    keys = as_float(name, given, (None, 2), dtype=np.float64)
    if not 1 <= len(keys) <= most:
        raise InputError(f"{name}: got {len(keys)} {what}; allowed are 1 to {most}")
    if np.abs(keys[:, 0]).max() > _FARTHEST:
        raise InputError(
            f"{name}: {place} of {what} are beyond {_FARTHEST:g}; allowed are -{_FARTHEST:g} to {_FARTHEST:g}"
        )
    if not (np.diff(keys[:, 0]) > 0.0).all():
        raise InputError(f"{name}: {place} of {what} do not grow; allowed are {place} in growing order")
    if not (np.diff(keys[:, 0]) >= _STEP).all():
        raise InputError(f"{name}: {place} of {what} are too close; allowed are steps of {_STEP:g} or more")
    for value in keys[:, 1]:
        as_number(name, float(value), **limits)
    return tuple((float(at), float(value)) for at, value in keys)
