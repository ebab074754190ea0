"""The metrics' gate: a reference and an image that may be compared."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_float
from refdof.display import display

__all__ = ["display_pair", "linear", "linear_pair"]


def linear_pair(reference: Any, image: Any) -> tuple[Float, Float]:
    """Both as (H, W, 3) float64; see `linear` for what is refused."""
    first = linear("reference", reference)
    return first, linear("image", image, first.shape)


def display_pair(reference: Any, image: Any) -> tuple[Float, Float]:
    """Display images of both: (H, W, 3) float32, C order, in [0, 1]; see `linear` for what is refused."""
    first, second = linear_pair(reference, image)
    return display(first), display(second)


def linear(name: str, value: Any, shape: Sequence[int | None] = (None, None, 3)) -> Float:
    """`value` as float64 of `shape`.

    Raises
    ------
    InputError
        If the shape is wrong, there is no pixel, a value is not finite, or an array holds integers (8-bit
        pixels are display values, not linear ones).
    """
    if isinstance(value, np.ndarray) and value.dtype.kind != "f":
        raise InputError(f"{name}: got {value.dtype} values; allowed are floats that hold linear RGB")
    array = as_float(name, value, shape, dtype=np.float64)
    if array.size == 0:
        raise InputError(f"{name}: got shape {array.shape}; allowed is at least one pixel")
    return array
