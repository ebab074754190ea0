"""Verdicts: what a cell's figures make of it.

A figure is a number that must not be above its bound, for a reason that stands beside it. A bound may be exceeded where
that lies in the method as it was published; then a wider bound and a sentence say so (`refdof.stability.degraded`).

    pass        no figure is above its bound, or the input is refused with one clear line, as documented
    degraded    one is, but not above the wider bound that is documented
    broken      all else: also a number that is NaN, a crash, or an input that should be refused and is not
    -           the case says nothing about this method
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

__all__ = ["BROKEN", "DEGRADED", "NOT_APPLICABLE", "PASS", "VERDICTS", "Cell", "Figure", "verdict_of"]

PASS, DEGRADED, BROKEN, NOT_APPLICABLE = "pass", "degraded", "broken", "-"
VERDICTS = (PASS, DEGRADED, BROKEN, NOT_APPLICABLE)


@dataclass(frozen=True)
class Figure:
    """A measured number and what it may be at most.

    Attributes
    ----------
    name : what is measured
    value, bound : in `unit`; NaN is above every bound
    reason : why the bound is where it is
    """

    name: str
    value: float
    bound: float
    unit: str
    reason: str

    @property
    def holds(self) -> bool:
        """Whether the value is not above the bound."""
        return self.value <= self.bound


def verdict_of(figures: Sequence[Figure], documented: Mapping[str, float]) -> str:
    """The worst verdict of the figures; `documented` has wider bounds by a figure's name."""
    found = PASS
    for figure in figures:
        if figure.holds:
            continue
        if not figure.value <= documented.get(figure.name, -1.0):
            return BROKEN
        found = DEGRADED
    return found


class Cell(NamedTuple):
    """What was found of a method in a case.

    verdict : one of `VERDICTS`; note : why, in a sentence
    error : worst error of float32 against float64 of the same kernels [units in the last place of the brightest
    value], None: the method has no float64 twin
    non_finite : pixels that are NaN or infinite
    first_stage : the first stage that errs by more than its room; "": none does
    """

    case: str
    method: str
    verdict: str
    note: str = ""
    figures: tuple[Figure, ...] = ()
    error: float | None = None
    non_finite: int = 0
    first_stage: str = ""
