"""Filter: a user's function, called as it wants to be, whose results are held to what every filter owes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.testing.picture import Picture

__all__ = ["INPUTS", "BrokenCall", "Filter"]

INPUTS = ("color", "depth", "coc", "camera", "lens")
_LONGEST_MESSAGE = 200


class BrokenCall(Exception):
    """A call that does not end in a picture; its text says how, in one line."""


class Filter:
    """`function` on pictures; `inputs` names its arguments in their order."""

    def __init__(self, function: Callable[..., Any], inputs: tuple[str, ...]) -> None:
        self.function, self.inputs = function, inputs

    def __call__(self, picture: Picture, finite: bool = True) -> Float:
        """The function's result (H, W, C) as float64.

        Raises
        ------
        BrokenCall
            If the function raises, writes to its input, or returns anything but floats of the picture's shape; with
            `finite` also if one is not finite.
        """
        given = [getattr(picture, name) for name in self.inputs]
        handed = [value.copy() if isinstance(value, np.ndarray) else value for value in given]
        try:
            returned = self.function(*handed)
        except Exception as error:
            words = " ".join(f"{type(error).__name__}: {error}".split())
            raise BrokenCall(f"raised {words[:_LONGEST_MESSAGE]}") from error
        try:
            result = np.array(returned)
        except Exception:
            raise BrokenCall(f"returned a {type(returned).__name__}; allowed is an array") from None
        for name, value, after in zip(self.inputs, given, handed, strict=True):
            if isinstance(value, np.ndarray) and value.tobytes() != after.tobytes():
                raise BrokenCall(f"wrote to its input {name}; allowed is to leave it alone")
        if result.dtype.kind != "f":
            raise BrokenCall(f"returned values of type {result.dtype}; allowed are floats")
        if result.shape != picture.color.shape:
            raise BrokenCall(f"returned shape {result.shape}; allowed is {picture.color.shape}, that of color")
        bad = int(result.size - np.isfinite(result).sum())
        if finite and bad:
            raise BrokenCall(f"returned {bad} of {result.size} values that are not finite; allowed are finite ones")
        return result.astype(np.float64)
