"""Verdict: whether values are within bounds, and where they are worst.

1. How far a value is beyond its bounds, in tolerances   `excess`
2. Whether that is allowed, how often, and on average    `judge`

Infinities match where they are expected, and nowhere else. NaN matches NaN where the tolerance says so.
"""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float
from refdof.oracle.goldens import Tolerance

__all__ = ["FAIL", "PASS", "WAIVED", "WARNING", "Finding", "excess", "judge"]

PASS, WARNING, WAIVED, FAIL = "pass", "quality warning", "waived", "fail"


@dataclass(frozen=True)
class Finding:
    """What a comparison found.

    Attributes
    ----------
    status : PASS, WARNING or FAIL
    worst : float
        In units of the tolerance; NaN if a value is none.
    failing : int
        How many values are beyond the tolerance.
    pixel, got, low, high
        Place (x, y) of the worst value, in rows of the files, the value, and its bounds.
    box : (left, top, right, bottom) or None
        What holds all pixels with failing values.
    rms, max_rms : float, and float or None
        Root of the mean square of the distance from the bounds, and what is allowed.
    """

    status: str
    worst: float
    failing: int
    pixel: tuple[int, int]
    got: float
    low: float
    high: float
    box: tuple[int, int, int, int] | None
    rms: float = 0.0
    max_rms: float | None = None

    def words(self) -> str:
        """One line."""
        place = f"at ({self.pixel[0]}, {self.pixel[1]}) got {self.got:.7g}, allowed {self.low:.7g} .. {self.high:.7g}"
        mean = ""
        if self.max_rms is not None and not self.rms <= self.max_rms:
            mean = f"; RMS {self.rms:.3g}, allowed {self.max_rms:.3g}"
        if not self.failing:
            return f"worst {self.worst:.3g} of its tolerance, {place}{mean}"
        left, top, right, bottom = self.box or (0, 0, 0, 0)
        many = f"{self.failing} values off, in x {left} .. {right}, y {top} .. {bottom}"
        return f"worst {self.worst:.3g} times its tolerance, {place}; {many}{mean}"


def judge(values: Float, low: Float, high: Float, tolerance: Tolerance) -> Finding:
    """Compare values (H, W) or (H, W, C) with their bounds, of the same shape."""
    with np.errstate(invalid="ignore"):  # signalling NaN
        values, low, high = (part.astype(np.float64) for part in (values, low, high))
    ratio = excess(values, low, high, tolerance)
    bad, awful = ~(ratio <= 1.0), ~(ratio <= tolerance.hard_factor)
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.where(ratio == 0.0, 0.0, np.maximum(low - values, values - high))
        rms = float(np.sqrt(np.mean(off * off)))
    status = PASS
    if bad.any():
        few = bad.mean() <= tolerance.max_failing_fraction
        status = WARNING if few and not awful.any() else FAIL
    if tolerance.max_rms is not None and not rms <= tolerance.max_rms:
        status = FAIL
    place = np.unravel_index(int(np.argmax(np.where(np.isnan(ratio), np.inf, ratio))), ratio.shape)
    rows, columns = np.nonzero(bad.reshape(*bad.shape[:2], -1).any(axis=-1))
    box = (int(columns.min()), int(rows.min()), int(columns.max()), int(rows.max())) if len(rows) else None
    got, least, most = (float(part[place]) for part in (values, low, high))
    pixel, worst = (int(place[1]), int(place[0])), float(ratio[place])
    return Finding(status, worst, int(bad.sum()), pixel, got, least, most, box, rms, tolerance.max_rms)


def excess(values: Float, low: Float, high: Float, tolerance: Tolerance) -> Float:
    """How far values are beyond their bounds, in tolerances: 0 within, NaN where a value is none. All float64."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        ratio = np.maximum(_beyond(low - values, low, tolerance), _beyond(values - high, high, tolerance))
    ratio[np.isnan(values) | np.isnan(low) | np.isnan(high)] = np.nan
    if tolerance.nan == "match":
        ratio[np.isnan(values) & np.isnan(low) & np.isnan(high)] = 0.0
    return ratio


def _beyond(gap: Float, bound: Float, tolerance: Tolerance) -> Float:
    """`excess` over one bound."""
    allowed = tolerance.max_abs + tolerance.max_rel * np.abs(bound)
    ratio: Float = np.where(gap > 0.0, gap / allowed, 0.0)
    ratio[np.isinf(bound) & (gap > 0.0)] = np.inf
    return ratio
