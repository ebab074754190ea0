"""Verdicts: what a measured figure makes of a printed one, by a rule that stands beside the claim.

A rule of numbers has two ranges: inside `within` the claim is reproduced, inside the wider `direction` only its
direction is, beyond both it is refuted. A rule of orders names who is greatest, second and so on: the whole order
reproduces the claim; if only the one that the claim is about has its place, at either end, its direction is reproduced.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

__all__ = ["DIRECTION", "NOT_TESTABLE", "REFUTED", "REPRODUCED", "VERDICTS", "Figure", "Rule", "rounded", "verdict_of"]

REPRODUCED, DIRECTION, REFUTED = "reproduced", "direction reproduced", "refuted"
NOT_TESTABLE = "not testable on a CPU"
VERDICTS = (REPRODUCED, DIRECTION, REFUTED, NOT_TESTABLE)

Figure = float | Mapping[str, float] | None


@dataclass(frozen=True)
class Rule:
    """How a figure is judged: one of `within`, `order` and `not_testable`.

    Attributes
    ----------
    within, direction : (least, greatest), both inclusive; None: no such range
    order : names, the greatest figure first
    main : of `order`, its first or its last
    not_testable : why no figure of a CPU tells; "": one does
    """

    within: tuple[float, float] | None = None
    direction: tuple[float, float] | None = None
    order: tuple[str, ...] = ()
    main: str = ""
    not_testable: str = ""

    def in_words(self) -> str:
        """The rule as a sentence's part."""
        if self.not_testable:
            return ""
        if self.within is None:
            held = f"; its direction if {self.main} is {'first' if self.main == self.order[0] else 'last'}"
            return f"reproduced if {' > '.join(self.order)}{held if self.main else ''}"
        direction = f"; its direction {_range_in_words(self.direction)}" if self.direction is not None else ""
        return f"reproduced {_range_in_words(self.within)}{direction}"


def verdict_of(rule: Rule, figure: Figure) -> str:
    """One of `VERDICTS`; `figure` is a number, numbers by name where the rule is an order, or None."""
    if rule.not_testable:
        return NOT_TESTABLE
    if isinstance(figure, Mapping):
        values = [figure[name] for name in rule.order]
        if all(first > second for first, second in pairwise(values)):
            return REPRODUCED
        best = max if rule.main == rule.order[0] else min
        others = [value for name, value in figure.items() if name != rule.main]
        leads = bool(rule.main) and figure[rule.main] == best(figure.values()) and figure[rule.main] not in others
        return DIRECTION if leads else REFUTED
    if figure is None or math.isnan(figure):
        return REFUTED
    for found, limits in ((REPRODUCED, rule.within), (DIRECTION, rule.direction)):
        if limits is not None and limits[0] <= figure <= limits[1]:
            return found
    return REFUTED


def rounded(figure: Figure, digits: int) -> Figure:
    """The figure as it is printed: so many significant digits. A verdict is of that, so that who reads can check it."""
    if isinstance(figure, Mapping):
        return {name: float(f"{value:.{digits}g}") for name, value in figure.items()}
    return None if figure is None else float(f"{figure:.{digits}g}")


def _range_in_words(limits: tuple[float, float]) -> str:
    least, greatest = (f"{limit:.12g}" for limit in limits)
    if least == greatest:
        return f"at {least}"
    if math.isinf(limits[0]):
        return f"up to {greatest}"
    return f"from {least}" + ("" if math.isinf(limits[1]) else f" to {greatest}")
