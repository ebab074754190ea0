"""Measures of time: ratios of medians of warm runs, on this machine.

A part is "blur", the method itself, or "total", with the layers that it needs, peeled or drawn.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from refdof.claims.bench import Bench

__all__ = ["TIMES"]

Shot = Mapping[str, Any]
Render = Mapping[str, Any]


def time_ratio(
    bench: Bench, shot: Shot, render: Render, beside: Render, part: str = "blur", beside_shot: Shot | None = None
) -> float:
    """Time of a render over that of another, of the same shot or of its own."""
    return bench.seconds(shot, render, part) / bench.seconds(beside_shot or shot, beside, part)


def time_power(bench: Bench, shot: Shot, render: Render, name: str, values: tuple[float, float]) -> float:
    """The power of a parameter that a render's time grows with, between two values."""
    first, last = (bench.seconds(shot, {**render, name: value}) for value in values)
    return float(np.log(last / first) / np.log(values[1] / values[0]))


def time_order(bench: Bench, shot: Shot, renders: Mapping[str, Render], part: str = "blur") -> dict[str, float]:
    """Times of renders by name, over the least."""
    found = {name: bench.seconds(shot, render, part) for name, render in renders.items()}
    return {name: seconds / min(found.values()) for name, seconds in found.items()}


TIMES: dict[str, Any] = {function.__name__: function for function in (time_ratio, time_power, time_order)}
