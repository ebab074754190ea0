"""Goldens: what a correct implementation makes of a case, how far it may be off, and why.

1. Make the input, and the picture with its stages in float64            `golden_of`
2. Bounds at ties, by the method's own `bounds`, of picture and means    `_tie_bounds`
3. Bounds of circles and of what is made of them                         `_circle_bounds`
4. A tolerance by what is rounded                                        `tolerance_of`
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof.methods import METHODS
from refdof.oracle.case import in_file_order
from refdof.oracle.cases import Case, module_of
from refdof.oracle.circles import circle_bounds
from refdof.oracle.inputs import INPUTS, Picture
from refdof.rendering import make_params
from refdof.stages import Stage

__all__ = ["Expected", "Golden", "Tolerance", "golden_of", "tolerance_of"]

_ULP = 2.0**-23
_LEAST = 2.0**-126  # denormal numbers may be taken for 0


@dataclass(frozen=True)
class Tolerance:
    """How far a value may lie outside of its bounds.

    A value is off by its distance from low .. high, in units of max_abs + max_rel |bound|. Up to 1 passes. Up to
    `hard_factor` is a quality warning where at most `max_failing_fraction` of all values are above 1. The root of the
    mean square of all distances may be up to `max_rms`, if it is given. `nan`: "forbid", NaN never passes; "match", it
    does where NaN is expected. Infinities pass where they are expected.
    """

    max_abs: float
    max_rel: float
    hard_factor: float
    max_failing_fraction: float
    reason: str
    max_rms: float | None = None
    nan: str = "forbid"


class Expected(NamedTuple):
    """An array, its bounds (float32, rounded outwards), where they are apart, and the tolerance beyond them.

    `ambiguity` is of ties only: where a choice is not determined.
    """

    values: Float
    low: Float
    high: Float
    ambiguity: np.ndarray
    tolerance: Tolerance
    meaning: str


class Golden(NamedTuple):
    """A case's input, its parameters, all of them, and what is expected: "image" and stages. Rows as in files."""

    picture: Picture
    params: Any
    expected: dict[str, Expected]


def golden_of(case: Case) -> Golden:
    """Make a case."""
    module, picture = METHODS[case.method], INPUTS[case.input](*case.size)
    given = make_params(case.method, dict(case.params))
    params = in_file_order(given, case.rows)
    if case.rows == "up":
        picture = picture._replace(**{name: getattr(picture, name)[::-1] for name in ("color", "depth", "coc")})
    images = tuple(image.astype(np.float64) for image in picture[:3])
    stages: dict[str, Float] = {}
    if case.stages is None:
        image = module.blur(*images, params)
    else:
        image, stages = module.blur(*images, params, stages=case.stages)
    final = Stage("image", "H W 3", "linear RGB", "the method's picture", "filter")
    expected = {"image": _expected(case, image, picture, params, final)}
    for name, values in stages.items():
        stage = next(stage for stage in module.METHOD.stages if stage.names(name))
        if stage.name in module_of(case.method).STAGES:
            expected[name.replace(" ", "_")] = _expected(case, values, picture, params, stage, name)
    return Golden(picture, given, expected)


def _expected(case: Case, values: Float, picture: Picture, params: Any, stage: Stage, name: str = "image") -> Expected:
    single = values.astype(np.float32)
    low, high, ambiguity = single, single, np.zeros(values.shape[:2], dtype=bool)
    tolerance = tolerance_of(case.method, stage, max(1.0, float(np.abs(picture.color).max())))
    if stage.comparison == "filter":
        least, greatest, ambiguity = _tie_bounds(case.method, values, picture, params, name)
        tied = ambiguity[..., None] if values.ndim == 3 else ambiguity
        low, high = np.where(tied, _outward(least, -np.inf), single), np.where(tied, _outward(greatest, np.inf), single)
    circles = _circle_bounds(case.method, picture, params, name)
    if circles is not None:
        low, high = (_outward(bound, towards) for bound, towards in zip(circles, (-np.inf, np.inf), strict=True))
        low, high = np.minimum(low, single), np.maximum(high, single)
        reason = "within what inverses of 3 and other steps of 1/2 units in the last place give; then 8 units"
        tolerance = Tolerance(_LEAST, 8 * _ULP, 1.0, 0.0, reason)
    return Expected(single, low, high, ambiguity, tolerance, stage.meaning)


def _tie_bounds(
    method: str, values: Float, picture: Picture, params: Any, name: str
) -> tuple[Float, Float, np.ndarray]:
    """Bounds of the picture, or of the mean after some taps, which is the picture of a shorter loop."""
    bounds = getattr(METHODS[method], "bounds", None)
    word, _, step = name.partition(" ")
    if bounds is None or word not in ("image", "mean"):
        return values, values, np.zeros(values.shape[:2], dtype=bool)
    changed = replace(params, max_taps=int(step)) if word == "mean" else params
    low, high, ambiguity = bounds(*picture[:3], changed)
    return low, high, ambiguity


def _circle_bounds(method: str, picture: Picture, params: Any, name: str) -> tuple[Float, Float] | None:
    """Bounds of circles, and of stages that a formula makes of them."""
    circles = circle_bounds(picture)
    return circles if name == "coc" else module_of(method).of_circles(name, *circles, params)


def tolerance_of(method: str, stage: Stage, scale: float) -> Tolerance:
    """The tolerance of a method's stage of values up to `scale`, by how it is compared."""
    if stage.comparison == "exact":
        return Tolerance(0.0, 0.0, 1.0, 0.0, "nothing is rounded")
    if stage.comparison == "formula":
        return Tolerance(8 * _ULP, 8 * _ULP, 1.0, 0.0, "a few roundings of float32: 8 units in the last place")
    share, reason = module_of(method).FILTER
    return Tolerance(share * scale, 0.0, 10.0, 1e-3, f"{share:g} of the largest colour, {scale:g}: {reason}")


def _outward(values: Float, towards: float) -> Float:
    """`values` as float32, rounded towards one side only."""
    single = values.astype(np.float32)
    wrong = (single > values) if towards < 0 else (single < values)
    return np.where(wrong, np.nextafter(single, np.float32(towards)), single).astype(np.float32)
