"""Measures: what a claim can be held against, by name, and of which kind each is.

=========  ===========================================================================================
formula    numbers only: seconds, even without compiling
picture    pictures and patterns: the same figure on every run
time       seconds on this machine, as ratios
=========  ===========================================================================================
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from refdof.claims.artefacts import ARTEFACTS
from refdof.claims.filters import FILTER_TIMES, FILTERS
from refdof.claims.formulas import FORMULAS
from refdof.claims.occlusion import OCCLUSION
from refdof.claims.pictures import PICTURES
from refdof.claims.times import TIMES

__all__ = ["MEASURES", "Measure"]


class Measure(NamedTuple):
    """A function of a `Bench` and a claim's arguments, which gives a figure, and its kind."""

    function: Callable[..., Any]
    kind: str


_BY_KIND = {
    "formula": FORMULAS,
    "picture": {**ARTEFACTS, **FILTERS, **OCCLUSION, **PICTURES},
    "time": {**FILTER_TIMES, **TIMES},
}
MEASURES: dict[str, Measure] = {
    name: Measure(function, kind) for kind, functions in _BY_KIND.items() for name, function in functions.items()
}
