"""Poisson disc: the weight of every pixel, straight from the picture and by way of the small one."""

from typing import Any

from refdof.explain.explanation import Explanation
from refdof.explain.linear import begin, explain_linear
from refdof.explain.pictures import Pictures

__all__ = ["explain"]


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every pixel."""
    stages, (x, y) = begin("poisson", given, params, pixel).stages, pixel
    code = float(stages["code"][y, x])
    notes = (
        f"code of the pixel, 0 in front, 1/2 sharp, 1 behind: {code:.6g}; its taps lie within "
        f"{abs(2.0 * code - 1.0) * params.max_radius:.6g} px",
        f"weights hold what comes by way of the small picture of {stages['small'].shape[1]} x "
        f"{stages['small'].shape[0]} texels",
    )
    return explain_linear("poisson", given, params, pixel, notes=notes)
