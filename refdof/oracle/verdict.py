"""Verdict: whether values are within bounds, and where they are worst."""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float
from refdof.oracle.goldens import Tolerance

__all__ = ["FAIL", "PASS", "WARNING", "Finding", "judge"]

PASS, WARNING, FAIL = "pass", "quality warning", "fail"


@dataclass(frozen=True)
class Finding:
    """What a comparison found: `worst` in units of the tolerance, NaN if a value is none; its place and numbers."""

    status: str
    worst: float
    failing: int
    pixel: tuple[int, int]
    got: float
    low: float
    high: float
    box: tuple[int, int, int, int] | None

    def words(self) -> str:
        """One line."""
        place = f"at ({self.pixel[0]}, {self.pixel[1]}) got {self.got:.7g}, allowed {self.low:.7g} .. {self.high:.7g}"
        if not self.failing:
            return f"worst {self.worst:.3g} of its tolerance, {place}"
        left, top, right, bottom = self.box or (0, 0, 0, 0)
        many = f"{self.failing} values off, in x {left} .. {right}, y {top} .. {bottom}"
        return f"worst {self.worst:.3g} times its tolerance, {place}; {many}"


def judge(values: Float, low: Float, high: Float, tolerance: Tolerance) -> Finding:
    """Compare values (H, W) or (H, W, 3) with their bounds, of the same shape. NaN never passes."""
    values, low, high = (part.astype(np.float64) for part in (values, low, high))
    allowed = tolerance.max_abs + tolerance.max_rel * np.maximum(np.abs(low), np.abs(high))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        off = np.maximum(np.maximum(low - values, values - high), 0.0)
        ratio = np.where(off == 0.0, 0.0, off / allowed)
        bad, awful = ~(ratio <= 1.0), ~(ratio <= tolerance.hard_factor)
    status = PASS
    if bad.any():
        few = bad.mean() <= tolerance.max_failing_fraction
        status = WARNING if few and not awful.any() else FAIL
    place = np.unravel_index(int(np.argmax(np.where(np.isnan(ratio), np.inf, ratio))), ratio.shape)
    rows, columns = np.nonzero(bad.reshape(*bad.shape[:2], -1).any(axis=-1))
    box = (int(columns.min()), int(rows.min()), int(columns.max()), int(rows.max())) if len(rows) else None
    got, least, most = (float(part[place]) for part in (values, low, high))
    pixel = int(place[1]), int(place[0])
    return Finding(status, float(ratio[place]), int(bad.sum()), pixel, got, least, most, box)
