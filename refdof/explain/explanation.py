"""Explanation: what made one pixel, as a table whose weighted sum is the pixel.

Every row is one contribution: a tap, a source pixel, a ray or what a ray sees of one layer. Its colour times its weight
is what it adds. The sum over all rows is the method's value, but for roundings: `Explanation.agrees`.
"""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["COLOR", "Explanation", "Part"]

COLOR = ("red", "green", "blue")
_STEPS = 32  # roundings of a value that is read, blended and divided; each row adds one, and one for its own weight


class Part(NamedTuple):
    """A further table: what is not a contribution, such as layers with their opacity; rows (N, C) float64."""

    title: str
    columns: tuple[str, ...]
    rows: Float


@dataclass(frozen=True, eq=False)
class Explanation:
    """What made a pixel.

    Attributes
    ----------
    method, stage : str
        What gave the value; stage "image" is the method's picture.
    pixel, size : (int, int)
        Column and row, 0 at the top left, and width and height of the picture [px].
    value : (C,) float64
        The method's own value.
    what : str
        What a row is, and which code told it.
    columns : names
        With a colour: "red", "green", "blue" and "weight" are among them. "x" and "y" are places [px] from the
        picture's corner: the centre of the first pixel is at 0.5. Empty: the value is no sum.
    rows : (N, C) float64
        NaN: does not apply.
    epsilon : float
        Rounding of the type that the method computes in, relative.
    notes : sentences
    parts : further tables
    picture : (H, W, 3)
        What the places lie in.
    """

    method: str
    stage: str
    pixel: tuple[int, int]
    size: tuple[int, int]
    value: Float
    what: str
    columns: tuple[str, ...] = ()
    rows: Float = field(default_factory=lambda: np.zeros((0, 0)))
    epsilon: float = float(np.finfo(np.float32).eps)
    notes: tuple[str, ...] = ()
    parts: tuple[Part, ...] = ()
    picture: Float | None = None

    @property
    def is_sum(self) -> bool:
        """Whether the value is the sum of the table."""
        return "weight" in self.columns

    def column(self, name: str) -> Float:
        """One column (N,)."""
        return self.rows[:, self.columns.index(name)]

    @property
    def terms(self) -> Float:
        """What each row adds: (N, 3)."""
        weight = self.column("weight")[:, None]
        color = np.stack([self.column(name) for name in COLOR], axis=1)
        return np.where(weight != 0.0, weight * color, 0.0)

    @property
    def running(self) -> Float:
        """The sum after each row: (N, 3)."""
        return np.cumsum(self.terms, axis=0)

    @property
    def sum(self) -> Float:
        """The sum of the table: (3,)."""
        return self.terms.sum(axis=0)

    @property
    def difference(self) -> Float:
        """The sum less the method's value: (3,)."""
        return self.sum - self.value

    @property
    def tolerance(self) -> Float:
        """What roundings may make of the difference: (3,). Two a row and some more, of the sum of all terms' sizes."""
        size = np.maximum(np.abs(self.terms).sum(axis=0), np.abs(self.value))
        return 2.0 * self.epsilon * (len(self.rows) + _STEPS) * size

    @property
    def agrees(self) -> bool:
        """Whether the table explains the value."""
        return not self.is_sum or bool((np.abs(self.difference) <= self.tolerance).all())

    def as_json(self) -> dict[str, Any]:
        """Plain data with all rows; what is not a number is null."""
        about: dict[str, Any] = {
            "schema": "refdof-explanation-1",
            "method": self.method,
            "stage": self.stage,
            "pixel": list(self.pixel),
            "size": list(self.size),
            "value": _numbers(self.value),
            "what": self.what,
            "notes": list(self.notes),
        }
        if self.is_sum:
            about |= {
                "sum": _numbers(self.sum),
                "difference": _numbers(self.difference),
                "tolerance": _numbers(self.tolerance),
                "agrees": self.agrees,
                "columns": list(self.columns),
                "rows": [_numbers(row) for row in self.rows],
            }
        about["parts"] = [
            {"title": part.title, "columns": list(part.columns), "rows": [_numbers(row) for row in part.rows]}
            for part in self.parts
        ]
        return about


def _numbers(values: Float) -> list[float | str | None]:
    """Numbers that JSON can hold: infinities as text, NaN as null."""
    return [None if np.isnan(v) else (float(v) if np.isfinite(v) else str(float(v))) for v in values]
