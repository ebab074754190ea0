"""Cases of depth: near the focal plane, at the lens, at infinity, all alike or none."""

import math

import numpy as np

from refdof.optics.lens import ThinLens
from refdof.stability.cases.case import FEW_LAYERS, Case, Skip
from refdof.stability.checks import constant, convex, exact_circles, near_pinhole, pinhole, same_as
from refdof.stability.subjects import frame, mosaic, random_picture
from refdof.view import View

__all__ = ["CASES"]

_SIZE = (33, 25)
_LENS = ThinLens(0.123, 2.0)  # a background of 2 px, but not whole ones
_COLOR = random_picture(1, _SIZE)
_ONE = (0.3, 0.6, 0.9)
_EVEN = np.broadcast_to(np.array(_ONE), (25, 33, 3))


def _near_focus(ulps: float) -> View:
    """Depths off focus by 1 .. `ulps` units of float32, column by column, in front of it and behind it in turn."""
    steps = np.geomspace(1.0, ulps, _SIZE[0]).round() * 2.0**-23
    sign = np.where(np.arange(_SIZE[1]) % 2 == 0, 1.0, -1.0)
    return mosaic(_COLOR, _LENS.focus_distance * (1.0 + sign[:, None] * steps), _LENS)


def _towards_lens(nearest: float) -> View:
    """Depths from focus down to `nearest`, column by column."""
    depth = np.broadcast_to(np.geomspace(nearest, 1.0, _SIZE[0]) * 2.0, (25, 33))
    return mosaic(_COLOR, depth, _LENS)


def _frame_towards_lens(nearest: float) -> View:
    depth = np.broadcast_to(np.geomspace(nearest, 2.0, _SIZE[0]), (25, 33)).copy()
    return frame(_COLOR, depth, _LENS)


def _half_far(far: float) -> View:
    """The right half is far, of one colour, which the background has, too."""
    depth = np.full((25, 33), 2.0)
    depth[:, 16:] = far
    color = _COLOR.copy()
    color[:, 16:] = 0.5
    return mosaic(color, depth, _LENS)


def _one_depth(depth: float) -> View:
    return mosaic(_COLOR, np.full((25, 33), depth), _LENS)


def _random_depths() -> np.ndarray:
    random = np.random.default_rng(4)
    depth = 10.0 ** random.uniform(-1.0, 3.0, (25, 33))
    return np.where(random.random((25, 33)) < 0.1, np.inf, depth)


CASES = (
    Case(
        "focus-ulps",
        "depth",
        "depths off focus by 1 to 1e6 units in the last place of float32, on both sides",
        lambda: _near_focus(1e6),
        (exact_circles, near_pinhole(0.8), convex(0.1, 0.9)),
    ),
    Case(
        "focus-hair",
        "depth",
        "depths off focus by 1 to 1000 units in the last place of float32: no picture shows it",
        lambda: _near_focus(1e3),
        (exact_circles, near_pinhole(0.8), convex(0.1, 0.9)),
    ),
    Case(
        "depth-small",
        "depth",
        "depths down to 1e-6 of the focus distance, circles up to a million px",
        lambda: _towards_lens(1e-6),
        (exact_circles, convex(0.1, 0.9)),
        params=FEW_LAYERS,
    ),
    Case(
        "depth-tiny",
        "depth",
        "depths down to 1e-30: circles beyond what float32 can square",
        lambda: _frame_towards_lens(1e-30),
        (exact_circles, convex(0.1, 0.9)),
        skip=Skip.NO_TRIANGLES,
    ),
    Case(
        "depth-zero",
        "depth",
        "a depth of 0, for which no circle is defined",
        lambda: frame(_COLOR, np.zeros((25, 33)), _LENS),
        refused="depth: smallest value is 0; allowed are values > 0",
    ),
    Case(
        "depth-infinite",
        "depth",
        "half of the picture at infinity, without any surface",
        lambda: _half_far(math.inf),
        (
            exact_circles,
            convex(0.1, 0.9),
            same_as("far as infinite", lambda: _half_far(1e12), 0.8, "1e12 and infinity differ by 1e-12 px"),
        ),
    ),
    Case(
        "background-only",
        "depth",
        "no surface at all",
        lambda: mosaic(_EVEN, np.full((25, 33), np.inf), _LENS, _ONE),
        (constant(_ONE),),
    ),
    Case("one-depth-focus", "depth", "all at the depth in focus", lambda: _one_depth(2.0), (exact_circles, pinhole)),
    Case(
        "one-depth",
        "depth",
        "all at one depth out of focus: layers without thickness, ramps without length",
        lambda: _one_depth(1.0),
        (exact_circles, convex(0.1, 0.9)),
    ),
    Case(
        "one-colour",
        "depth",
        "random depths from 0.1 to 1000 and infinity, all of one colour",
        lambda: mosaic(_EVEN, _random_depths(), _LENS, _ONE),
        (exact_circles, constant(_ONE)),
    ),
)
