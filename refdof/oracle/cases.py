"""Cases of packs: which input, at which size, with which parameters, by level.

"core" is small enough to live beside code; it has full widths and full heights of sizes with ties as strips. "full"
has every input at every size of `SIZES`. "extreme" has numbers at the ends of what float32 and a shader can do.

A method has a module here with

    cases(level)                          its cases
    GUIDE                                 its section of the pack's README
    STAGES                                the stages that packs hold: what is determined, or has bounds
    FILTER                                tolerance of weighted sums of values in 0 .. 1, and its reason
    numbers(params, rows)                 lines of `params.txt` beside its parameters
    of_circles(stage, low, high, params)  bounds of a stage that a formula makes of circles within low .. high, or None
"""

from types import ModuleType

from refdof._check import as_choice
from refdof.methods import METHODS
from refdof.oracle import poisson_cases, singlepass_cases
from refdof.oracle.case import LEVELS, SIZES, Case

__all__ = ["LEVELS", "SIZES", "Case", "cases_of", "module_of", "with_cases"]

_MODULES: dict[str, ModuleType] = {"singlepass": singlepass_cases, "poisson": poisson_cases}


def with_cases() -> list[str]:
    """The methods that packs have cases for: each declares its stages."""
    return [name for name in METHODS if name in _MODULES]


def module_of(method: str) -> ModuleType:
    """What a method has here."""
    return _MODULES[method]


def cases_of(level: str, methods: list[str] | None = None) -> list[Case]:
    """All cases of a level, by method.

    Raises
    ------
    InputError
        If the level or a method is not known, or has no cases.
    """
    as_choice("level", level, LEVELS)
    names = with_cases() if methods is None else [as_choice("method", name, with_cases()) for name in methods]
    return [case for name in dict.fromkeys(names) for case in _MODULES[name].cases(level)]
