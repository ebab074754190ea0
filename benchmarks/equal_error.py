"""Time to equal error: what a renderer's error is against a long reference, and when it reaches a given error.

A long reference has noise of its own. It is independent of the picture under test, so the two variances add, and
the known one is taken off: RMSE^2 = mean (picture - reference)^2 - mean variance of the reference.
"""

import math
from dataclasses import dataclass

import numpy as np

__all__ = ["LongReference", "Run", "at_rmse", "combine", "rmse"]


@dataclass(frozen=True, eq=False)
class Run:
    """One picture: samples per pixel, wall and CPU seconds."""

    image: np.ndarray
    samples: float
    seconds: float
    cpu_seconds: float
    tolerance: float | None = None


@dataclass(frozen=True, eq=False)
class LongReference:
    """The weighted mean of two renderers' long runs, its mean variance, and how well the two agree.

    `agreement` is mean (a - b)^2 over the sum of both mean variances: 1 if the two differ by noise alone.
    """

    image: np.ndarray
    variance: float
    weight_of_first: float
    agreement: float


def combine(first: np.ndarray, first_variance: float, second: np.ndarray, second_variance: float) -> LongReference:
    """Weigh two long runs (H, W, 3) by the inverse of their mean variances."""
    total = first_variance + second_variance
    weight = second_variance / total
    image = weight * first.astype(np.float64) + (1.0 - weight) * second.astype(np.float64)
    difference = first.astype(np.float64) - second
    variance = first_variance * second_variance / total
    return LongReference(image, variance, weight, float(np.mean(difference**2)) / total)


def rmse(image: np.ndarray, long: LongReference) -> float:
    """Root of the mean squared error of `image`, linear, without the reference's own noise."""
    measured = float(np.mean((image.astype(np.float64) - long.image) ** 2))
    return math.sqrt(max(measured - long.variance, 0.05 * measured))


def at_rmse(errors: list[float], costs: list[float], wanted: float) -> tuple[float, bool]:
    """Cost at which the error is `wanted`, and whether that lies outside the runs.

    Straight lines between the runs in log error against log cost; beyond them the nearest line goes on.
    """
    order = np.argsort(errors)[::-1]
    x, y = np.log(np.asarray(errors)[order]), np.log(np.asarray(costs)[order])
    goal = math.log(wanted)
    k = int(np.clip(np.searchsorted(-x, -goal) - 1, 0, len(x) - 2))
    slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
    return float(np.exp(y[k] + slope * (goal - x[k]))), not x[-1] <= goal <= x[0]
