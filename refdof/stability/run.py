"""Run: a method on a case's view, made once for all checks."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.methods import METHODS
from refdof.rendering import make_params
from refdof.stability.twins import Ran, narrow, wide
from refdof.view import View

__all__ = ["LEAST", "ROOM", "ULP", "Run", "bright", "first_stage"]

ULP = 2.0**-23
LEAST = float(np.finfo(np.float32).tiny)  # below it float32 has fewer digits
ROOM = 168.0
"""1e-5 in units in the last place of the brightest value: sums of some 400 terms, each rounded by half a unit."""


class Run:
    """A method on a view, lazily in float32 and float64."""

    def __init__(self, method: str, view: View, params: Mapping[str, Any]) -> None:
        self.method, self.view, self.params = method, view, params

    @property
    def traces(self) -> bool:
        """Whether it sends rays through the lens."""
        return bool(METHODS[self.method].METHOD.inputs == ("triangles",))

    @property
    def promises(self) -> tuple[str, ...]:
        """What its record promises."""
        return tuple(METHODS[self.method].METHOD.promises)

    @property
    def rays(self) -> int:
        """Lens samples of each pixel; 1 if it has none."""
        return int(getattr(make_params(self.method, dict(self.params)), "samples", 1))

    @cached_property
    def narrow(self) -> Ran:
        """As everybody gets it."""
        return narrow(self.method, self.view, self.params)

    @cached_property
    def wide(self) -> Ran | None:
        """Its twin in float64, if it has one."""
        return wide(self.method, self.view, self.params)

    @property
    def image(self) -> Float:
        """The picture (H, W, 3)."""
        return self.narrow.image

    def of(self, view: View) -> Float:
        """The picture of another view."""
        return narrow(self.method, view, self.params).image

    def error(self) -> float | None:
        """Worst error of float32 [ulp of the brightest]; NaN where one of the two is not finite and the other is."""
        if self.wide is None:
            return None
        return _error(self.image, self.wide.image) / ULP

    def non_finite(self) -> int:
        """Pixels that are NaN or infinite."""
        return int((~np.isfinite(self.image)).any(axis=-1).sum())


def bright(image: Float) -> float:
    """The largest finite value of a picture; 1 where that is 0."""
    values = np.abs(image[np.isfinite(image)])
    return float(values.max(initial=0.0)) or 1.0


def first_stage(run: Run) -> str:
    """The first stage whose error is above `ROOM` units of its largest number; "image" if none before it."""
    exact = wide(run.method, run.view, run.params, True)
    if exact is None:
        return ""
    for name, values in narrow(run.method, run.view, run.params, True).stages.items():
        other = exact.stages.get(name)
        if other is None:
            continue
        if other.shape != values.shape or not _error(values, other) <= ROOM * ULP:
            return name
    return "image" if not _error(run.image, exact.image) <= ROOM * ULP else ""


def _error(values: np.ndarray, exact: np.ndarray) -> float:
    """The largest difference over the largest number; values that are not finite must be the same."""
    first, second = values.astype(np.float64), exact.astype(np.float64)
    finite = np.isfinite(second)
    if not np.array_equal(first[~finite], second[~finite], equal_nan=True) or not np.isfinite(first[finite]).all():
        return float("nan")
    scale = max(bright(second), LEAST)
    return float(np.abs(first[finite] / scale - second[finite] / scale).max(initial=0.0))
