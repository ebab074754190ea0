"""Cost: how a method's time grows, fitted to a sweep, and what it will be elsewhere.

    t = N^a (c + k q^b ... r^g)

N: pixels, q ...: the parameters that were varied, r: the mean circle of confusion [px]. Of what a sweep does not vary,
N has the exponent 1 and the others have 0. c >= 0 is what every pixel costs whatever they are; c and k have a value for
each scene. The fit makes relative errors least; the error told is that of points left out of it, one at a time.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from refdof._check import Float
from refdof.sweep.measured import Measured

__all__ = ["CostModel", "fitted", "lack"]

_LEAST_TIME = 1e-6  # s; a clock shows no less
_STEEPEST = 4.0  # of exponents
_MOST_LEFT_OUT = 20  # points that are left out one at a time; of more points every n-th
_LEAST_SHARE = 0.01  # of the time, for c to be told


@dataclass(frozen=True)
class CostModel:
    """A method's time.

    Attributes
    ----------
    method : str
    exponents : {name: exponent}
        Of "pixels", each parameter and "circle": those that the sweep varied.
    per_pixel : {scene: c}, in seconds
    factors : {scene: k}
    fixed : float
        The share of c in the time, in the middle of the points.
    error, worst : float
        Relative, of points left out of the fit: the median, and the largest.
    points : how many there were
    """

    method: str
    exponents: Mapping[str, float]
    per_pixel: Mapping[str, float]
    factors: Mapping[str, float]
    fixed: float
    error: float
    worst: float
    points: int

    def predict(self, point: Measured, pixels: float, circle: float | None = None) -> float:
        """Seconds of a point at so many pixels, and with this mean circle of confusion [px]; None: as it has."""
        values = {**_values_of(point), "pixels": float(pixels)}
        if circle is not None:
            values["circle"] = circle
        grown = self.factors[point.scene]
        for name, exponent in self.exponents.items():
            if name != "pixels":
                grown *= values[name] ** exponent
        return float(values["pixels"] ** self.exponents.get("pixels", 1.0) * (self.per_pixel[point.scene] + grown))

    def __str__(self) -> str:
        grows = " ".join(f"{name}^{exponent:.2f}" for name, exponent in self.exponents.items())
        fixed = f", {self.fixed:.0%} of it whatever they are" if self.fixed >= _LEAST_SHARE else ""
        told = f"error {self.error:.0%}, at worst {self.worst:.0%}; {self.points} points"
        return f"{self.method}: time grows as {grows}{fixed} ({told})"


def fitted(points: Sequence[Measured]) -> CostModel | None:
    """The cost of one method, whose points may be of several scenes; None where too little was varied."""
    if lack(points):
        return None
    names = _names_of(points)
    scenes = list(dict.fromkeys(point.scene for point in points))
    at_scene = np.array([scenes.index(point.scene) for point in points])
    logs = np.log([[_values_of(point)[name] for name in names] for point in points])
    times = np.log([max(point.time_s, _LEAST_TIME) for point in points])
    if "pixels" not in names:
        times = times - np.log([point.width * point.height for point in points])
    model = _Model(names, len(scenes))
    values = model.fit(logs, at_scene, times)
    left_out = []
    for k in range(0, len(points), -(-len(points) // _MOST_LEFT_OUT)):
        others = np.arange(len(points)) != k
        if at_scene[k] in at_scene[others]:
            found = model.fit(logs[others], at_scene[others], times[others])
            miss = model.log_time(found, logs[k : k + 1], at_scene[k : k + 1])[0] - times[k]
            left_out.append(abs(math.expm1(float(miss))))
    constants = np.exp(model.log_constants(values))
    grown = np.exp(model.log_grown(values, logs, at_scene))
    return CostModel(
        points[0].method,
        dict(zip(names, values[: len(names)].tolist(), strict=True)),
        dict(zip(scenes, constants.tolist(), strict=True)),
        dict(zip(scenes, np.exp(values[-len(scenes) :]).tolist(), strict=True)),
        float(np.median(constants[at_scene] / (constants[at_scene] + grown))),
        float(np.median(left_out)) if left_out else math.nan,
        max(left_out, default=math.nan),
        len(points),
    )


def lack(points: Sequence[Measured]) -> str:
    """What the points of a method lack to be fitted, in words; empty if nothing."""
    names = _names_of(points)
    if not names:
        return "neither the size nor a number of it was varied"
    least = 2 * len({point.scene for point in points}) + len(names) + 1
    if len(points) >= least:
        return ""
    return f"with {' and '.join(names)} varied, at least {least} points are needed, and there are {len(points)}"


class _Model:
    """Values are the exponents, and log c and log k of each scene; c is 0 where only pixels are varied."""

    def __init__(self, names: Sequence[str], scenes: int) -> None:
        self.count, self.scenes = len(names), scenes
        self.has_pixels = "pixels" in names
        self.has_constant = self.count > self.has_pixels

    def log_constants(self, values: Float) -> Float:
        """log c of each scene."""
        if not self.has_constant:
            return np.full(self.scenes, -np.inf)
        return np.asarray(values[self.count : self.count + self.scenes])

    def log_grown(self, values: Float, logs: Float, at_scene: Any) -> Float:
        first = int(self.has_pixels)
        return np.asarray(logs[:, first:] @ values[first : self.count] + values[-self.scenes :][at_scene])

    def log_time(self, values: Float, logs: Float, at_scene: Any) -> Float:
        result = self.log_grown(values, logs, at_scene)
        if self.has_constant:
            result = np.logaddexp(result, self.log_constants(values)[at_scene])
        return result + logs[:, 0] * values[0] if self.has_pixels else result

    def fit(self, logs: Float, at_scene: Any, times: Float) -> Float:
        """The values of least error. Single slow runs of a busy machine count less than their square."""
        exponents = np.ones(self.count)
        level = float(np.median(times - logs @ exponents))
        per_pixel = float(np.median(times - (logs[:, 0] if self.has_pixels else 0.0)))
        start = [*exponents, *([per_pixel - 2.0] * self.scenes * self.has_constant), *([level] * self.scenes)]
        loss = {"loss": "soft_l1", "f_scale": 0.1, "x_scale": "jac"}
        bound = [_STEEPEST] * self.count + [np.inf] * (len(start) - self.count)
        result = least_squares(
            lambda values: self.log_time(values, logs, at_scene) - times,
            start,
            bounds=(-np.array(bound), np.array(bound)),
            **loss,
        )
        return np.asarray(result.x)


def _names_of(points: Sequence[Measured]) -> list[str]:
    """What was varied, and is a positive number everywhere: pixels, parameters, circles where the lens was varied."""
    names = ["pixels", *dict.fromkeys(name for point in points for name in point.varied if name in point.params)]
    if any("lens_radius" in point.varied for point in points):
        names.append("circle")
    values = [_values_of(point) for point in points]
    return [
        name
        for name in names
        if all(one.get(name, 0.0) > 0.0 for one in values) and len({one[name] for one in values}) > 1
    ]


def _values_of(point: Measured) -> dict[str, float]:
    numbers = {
        name: float(value)
        for name, value in point.varied.items()
        if isinstance(value, int | float) and not isinstance(value, bool)
    }
    return {**numbers, "pixels": float(point.width * point.height), "circle": point.mean_coc_px}
