"""Log ticks: few ticks of a logarithmic axis, in words that stand side by side, whatever the axis spans."""

import math
from collections.abc import Callable
from typing import Any

__all__ = ["name_ticks", "second_in_words", "ticks_between"]

_FACTORS = ((1.0, 1.5, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0), (1.0, 3.0), (1.0,))  # of a decade, from many to few
_MOST, _FEWEST = 6, 2  # ticks: so many words stand side by side; an axis of fewer shows no scale


def name_ticks(axis: Any, words: Callable[[float], str]) -> None:
    """Give an axis, logarithmic and of final limits, its ticks."""
    axis.set_ticks(ticks_between(*sorted(axis.get_view_interval())))
    axis.set_ticklabels([words(tick) for tick in axis.get_majorticklocs()])
    axis.set_ticks([], minor=True)


def second_in_words(seconds: float) -> str:
    """A round time with its unit, all digits."""
    for unit, factor in (("s", 1.0), ("ms", 1e3)):
        if seconds * factor > 0.9999:
            return f"{seconds * factor:.5g} {unit}"
    return f"{seconds * 1e6:.5g} us"


def ticks_between(low: float, high: float) -> list[float]:
    """Round numbers in low .. high, some two to six."""
    first, last = math.floor(math.log10(low)), math.floor(math.log10(high))
    for factors in _FACTORS:
        found = [factor * 10.0**power for power in range(first, last + 1) for factor in factors]
        found = [tick for tick in found if low <= tick <= high]
        if _FEWEST <= len(found) <= _MOST:
            return found
    if len(found) > _MOST:  # decades
        return found[:: -(-len(found) // _MOST)]
    half = 0.5 * (high - low)  # less than a factor of two: evenly
    power = 10.0 ** math.floor(math.log10(half))
    step = max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= half)
    return [k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1)]
