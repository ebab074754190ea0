"""Measures of time: ratios of warm runs in turn, their medians over rounds, on this machine.

A part is "blur", the method itself, or "total", with the layers that it needs, peeled or drawn.
"""

from collections.abc import Mapping, Sequence
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
    seconds = bench.seconds([(shot, render), (beside_shot or shot, beside)], part)
    return float(np.median(seconds[:, 0] / seconds[:, 1]))


def time_power(bench: Bench, shot: Shot, render: Render, name: str, values: Sequence[float]) -> float:
    """The power of a parameter that a render's time grows with, between two values."""
    seconds = bench.seconds([(shot, {**render, name: value}) for value in values])
    return float(np.log(np.median(seconds[:, 1] / seconds[:, 0])) / np.log(values[1] / values[0]))


def time_order(bench: Bench, shot: Shot, renders: Mapping[str, Render], part: str = "blur") -> dict[str, float]:
    """Times of renders by name, over the least."""
    seconds = bench.seconds([(shot, render) for render in renders.values()], part)
    ratios = np.median(seconds / seconds[:, :1], axis=0)
    return dict(zip(renders, (ratios / ratios.min()).tolist(), strict=True))


TIMES: dict[str, Any] = {function.__name__: function for function in (time_ratio, time_power, time_order)}
