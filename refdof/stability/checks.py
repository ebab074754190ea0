"""Checks: what must hold in a case, each a figure with its bound and the reason for it.

A check is a function of a `Run` that gives a `Figure`, or None where it says nothing about the method. None compares a
method only with itself: pictures are held against colours that the case was made of, exact fractions, closed forms,
float64, or the same scene in another unit.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from refdof._check import Float
from refdof.stability.run import LEAST, ROOM, ULP, Run, bright
from refdof.stability.verdict import Figure
from refdof.view import View

__all__ = [
    "FLIPS",
    "Check",
    "constant",
    "convex",
    "dark",
    "exact_circles",
    "finite",
    "mirrored",
    "near_pinhole",
    "one_precision",
    "pinhole",
    "same_as",
    "same_bits",
    "scaled_by",
    "shows",
]

Check = Callable[[Run], Figure | None]

_SUM = "a few hundred terms, each rounded by half a unit"
_PLACES = f"{_SUM}; places round by the picture's width"
FLIPS = 8
"""Rays of a pixel that a rounding may send past an edge to the other side."""


def finite(run: Run) -> Figure:
    """All that goes in is finite, so must be what comes out."""
    return Figure("non-finite", float(run.non_finite()), 0.0, "px", "finite in, finite out")


def one_precision(run: Run) -> Figure | None:
    """float32 errs by roundings only."""
    error = run.error()
    if error is None:
        return None
    return Figure("float32", error, _room_of_places(run), "ulp of the brightest", _PLACES)


def convex(low: Float | Sequence[float] | float, high: Float | Sequence[float] | float) -> Check:
    """No channel is below `low` or above `high`."""

    def check(run: Run) -> Figure:
        image = run.image.astype(np.float64)
        scale = max(float(np.abs(high).max()), LEAST)
        beyond = np.maximum(np.asarray(low) - image, image - np.asarray(high)) / (scale * ULP)
        return Figure("convexity", max(float(beyond.max()), 0.0), ROOM, "ulp of the brightest", _SUM)

    return check


def constant(color: Sequence[float]) -> Check:
    """One colour goes in, and comes out in every pixel."""
    return shows("constant", lambda run: np.broadcast_to(np.asarray(color, dtype=np.float64), run.image.shape))


def shows(name: str, picture: Callable[[Run], Float], bound: float = ROOM, reason: str = _SUM) -> Check:
    """The picture is `picture(run)`, within `bound` units of the brightest value."""

    def check(run: Run) -> Figure:
        exact = picture(run).astype(np.float64)
        error = np.abs(run.image - exact).max() / (bright(exact) * ULP)
        return Figure(name, float(error), bound, "ulp of the brightest", reason)

    return check


def dark(run: Run) -> Figure:
    """No light goes in, none comes out."""
    return Figure("light", float(np.abs(run.image).max()), 0.0, "", "sums of zeros are 0")


def pinhole(run: Run) -> Figure:
    """A lens of radius 0 shows what the pinhole sees."""
    color = run.view.pinhole().color.astype(np.float64)
    error = float(np.abs(run.image - color).max()) / (bright(color) * ULP)
    return Figure("pinhole", error, ROOM, "ulp of the brightest", "nothing is blurred; weighted means may round")


def near_pinhole(contrast: float, reach: int = 2) -> Check:
    """Small circles change little: a pixel by 4 px^-1 of the contrast for each px of the largest circle near it."""

    def check(run: Run) -> Figure:
        picture = run.view.pinhole()
        circle = np.abs(run.view.coc_px())
        for axis in (0, 1):
            rolled = [np.roll(circle, step, axis) for step in range(-reach, reach + 1)]
            circle = np.max(rolled, axis=0)
        moved = np.abs(run.image - picture.color.astype(np.float64)).max(axis=-1)
        room = 4.0 * contrast * circle + ROOM * ULP * bright(picture.color)
        return Figure(
            "sharpness",
            float((moved / room).max()),
            1.0,
            "of the room",
            "a kernel as wide as its circle moves an edge by no more than 4 circles",
        )

    return check


def exact_circles(run: Run) -> Figure:
    """Circles of confusion are those of exact fractions."""
    view = run.view
    scale = Fraction(view.camera.pixels_per_tangent) * Fraction(view.lens.radius)
    focus = view.lens.focus_distance
    worst = 0.0
    for depth, circle in zip(view.pinhole().depth.ravel().tolist(), view.coc_px().ravel().tolist(), strict=True):
        inverse_focus = Fraction(0) if focus == np.inf else 1 / Fraction(focus)
        inverse_depth = Fraction(0) if depth == np.inf else 1 / Fraction(depth)
        exact = scale * (inverse_focus - inverse_depth)
        error = abs(Fraction(circle) - exact)
        unit = Fraction(float(np.spacing(abs(float(exact))))) if exact else Fraction(2) ** -1074
        worst = max(worst, float(error / unit))
    return Figure("circles", worst, 4.0, "ulp of float64", "P E, over focus, times a ratio, and the ratio: 4 roundings")


def same_bits(name: str, other: Callable[[], View]) -> Check:
    """Another view has the same picture, bit for bit."""

    def check(run: Run) -> Figure:
        differ = float((run.image != run.of(other())).any(axis=-1).sum())
        return Figure(name, differ, 0.0, "px", "a power of two changes no mantissa")

    return check


def same_as(name: str, other: Callable[[], View], contrast: float, reason: str) -> Check:
    """Another view has the same picture but for roundings; of rays, `FLIPS` of N may change sides of an edge."""

    def check(run: Run) -> Figure:
        image = run.of(other()).astype(np.float64)
        error = float(np.abs(run.image - image).max()) / bright(image)
        room = ROOM * ULP + (FLIPS / run.rays * contrast if run.traces else 0.0)
        return Figure(name, error / room, 1.0, "of the room", reason)

    return check


def scaled_by(factor: float, other: Callable[[], View]) -> Check:
    """The picture is `factor` times that of another view: light adds up."""
    return shows("linear", lambda run: factor * run.of(other()).astype(np.float64), ROOM)


def mirrored(other: Callable[[], View]) -> Check:
    """The mirrored view has the mirrored picture, where the method promises it and rounds rays to no other texel."""

    def check(run: Run) -> Figure | None:
        if run.traces or "symmetry" not in run.promises:
            return None
        image = run.of(other())[:, ::-1].astype(np.float64)
        error = float(np.abs(run.image - image).max()) / (bright(image) * ULP)
        return Figure("symmetry", error, _room_of_places(run), "ulp of the brightest", f"another order; {_PLACES}")

    return check


def _room_of_places(run: Run) -> float:
    """`ROOM`, and half a unit of a place's rounding for each pixel of the width, in two pictures or two passes."""
    return ROOM + float(run.image.shape[1])
