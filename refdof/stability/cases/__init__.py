"""Cases: the extremes, one module for each kind."""

from refdof.stability.cases import depth, geometry, lens, light, size, stored
from refdof.stability.cases.case import GROUPS, Case

__all__ = ["CASES", "GROUPS", "Case"]

CASES: tuple[Case, ...] = (
    *depth.CASES,
    *lens.CASES,
    *light.CASES,
    *size.CASES,
    *geometry.CASES,
    *stored.CASES,
)
