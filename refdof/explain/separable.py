"""Separable: the taps of both passes: how much of each row the column's pass takes, and of each pixel the row's."""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import Explanation
from refdof.explain.linear import SOURCE_COLUMNS, begin, sources, weigh
from refdof.explain.pictures import Pictures

__all__ = ["explain"]

_WHAT = (
    "pixels of the pinhole picture; across: the weight in the first pass, at the pixel's own column; down: the weight "
    "of that row in the second pass; both as the method gives them for a single pixel of colour 1"
)


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every tap of both passes."""
    begun, (x, y) = begin("separable", given, params, pixel), pixel

    def answer(image: Float, stages: dict[str, Float]) -> list[Float]:
        return [image[y, x], stages["across"][:, x].sum(axis=0)]  # of one row only

    places, weights = weigh("separable", given, params, answer, True)
    down = weights[:, 0] / weights[:, 1]
    rows = np.column_stack([sources(given, places), weights[:, 1], down, weights[:, 0]])
    return Explanation(**begun.about, what=_WHAT, columns=(*SOURCE_COLUMNS, "across", "down", "weight"), rows=rows)
