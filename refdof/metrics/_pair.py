"""Validation for metrics: a reference and an image that may be compared."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof._check import Float, as_image
from refdof.image.display import display

__all__ = ["Shown", "display_pair", "linear", "linear_pair", "shown"]


class Shown(np.ndarray):
    """A linear image (H, W, 3) float64 with its display image, which several metrics need; see `shown`."""

    display: Float | None = None


def shown(name: str, value: Any, shape: Sequence[int | None] = (None, None, 3)) -> Shown:
    """`linear`, encoded once for all metrics that get it."""
    image = linear(name, value, shape).view(Shown)
    image.display = display(image)
    return image


def linear_pair(reference: Any, image: Any) -> tuple[Float, Float]:
    """Both as (H, W, 3) float64; see `linear` for what is refused."""
    first = linear("reference", reference)
    return first, linear("image", image, first.shape)


def display_pair(reference: Any, image: Any) -> tuple[Float, Float]:
    """Display images of both: (H, W, 3) float32, C order, in [0, 1]; see `linear` for what is refused."""
    first, second = linear_pair(reference, image)
    return _display(first), _display(second)


def linear(name: str, value: Any, shape: Sequence[int | None] = (None, None, 3)) -> Float:
    """`value` as float64 of `shape`.

    Raises
    ------
    InputError
        If the shape is wrong, there is no pixel, a value is not finite or beyond 1e33, or pixels have 8 or 16
        bits (those are display values, not linear ones).
    """
    if isinstance(value, Shown) and value.display is not None and shape in ((None, None, 3), value.shape):
        return value
    return as_image(name, value, shape, dtype=np.float64)


def _display(image: Float) -> Float:
    seen = image.display if isinstance(image, Shown) else None
    return display(image) if seen is None else seen
