"""Cases of the lens: where it is focused, how large it is, its samples, and lenses with surfaces."""

import math
from dataclasses import replace

import numpy as np

from refdof.methods import METHODS
from refdof.optics.lens import ThinLens
from refdof.optics.systems.glass import glass_of
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.system_lens import SystemLens
from refdof.stability.cases.case import FEW_LAYERS, Case, Skip
from refdof.stability.checks import constant, convex, exact_circles, near_pinhole, pinhole, same_as
from refdof.stability.lens_checks import edge_of_half_plane, lensmaker, no_more_light, one_ray
from refdof.stability.subjects import depth_of, mosaic, random_picture, view_of_parts, wall
from refdof.view import View

__all__ = ["CASES"]

_SIZE = (33, 25)
_COLOR = random_picture(2, _SIZE)
_ONE = (0.3, 0.6, 0.9)
_EVEN = np.broadcast_to(np.array(_ONE), (25, 33, 3))
_DEPTH = np.random.default_rng(3).choice([1.03, 1.57, 2.0, 4.1, 16.3, np.inf], (25, 33))
_SAMPLED = ("accumulation", "lensblur", "multiview")


def _mosaic(lens: ThinLens) -> View:
    return mosaic(_COLOR, _DEPTH, lens)


def _even(lens: ThinLens) -> View:
    return mosaic(_EVEN, _DEPTH, lens, _ONE)


def _above_focal_length(steps: int) -> View:
    """A photographer's lens of 50 mm, focused at so many float64 beyond its focal length."""
    focus = 0.05
    for _ in range(steps):
        focus = math.nextafter(focus, 1.0)
    return _even(ThinLens.from_f_number(0.05, 8.0, focus))


def _half_plane() -> View:
    """White from the middle to the left, before a black wall that is in focus; circles of 4 px, edge at x = 16 px."""
    lens = ThinLens(0.25, 2.0)
    depth = depth_of(-4.0, lens)
    card = wall(depth, (1.0, 1.0, 1.0))
    left = replace(card, vertices=np.where(card.vertices[:, :1] > 0, [0.0, 1.0, 1.0], 1.0) * card.vertices)
    return view_of_parts([left, wall(2.0, (0.0, 0.0, 0.0))], (32, 5), lens, (0.0, 0.0, 0.0))


def _system(front: float, back: float, thickness: float) -> View:
    """One colour through a single lens of two surfaces [mm], focused at twenty focal lengths, which are 2 units."""
    system = ThickLens(front, back, thickness, 20.0, glass_of("N-BK7")).system("single")
    focal = 1.0 / _power(front, back, thickness)
    return _even(SystemLens(system, 2.0, mm_per_unit=10.0 * focal))


def _power(front: float, back: float, thickness: float) -> float:
    n = glass_of("N-BK7").index(0.5875618)
    return (n - 1.0) * (1.0 / front - 1.0 / back + (n - 1.0) * thickness / (n * front * back))


def _rim(radius: float) -> float:
    """How much a surface's rim, 10 mm from the axis, lies behind its vertex [mm]."""
    return 100.0 / (radius + math.sqrt(radius * radius - 100.0))


CASES = (
    Case(
        "focus-infinite",
        "lens",
        "focused at infinity: no difference of inverse distances, no ratio of distances to it",
        lambda: _mosaic(ThinLens(0.0625, math.inf)),
        (
            exact_circles,
            convex(0.1, 0.9),
            same_as(
                "far as infinite", lambda: _mosaic(ThinLens(0.0625, 1e300)), 0.8, "1e300 and infinity differ by nothing"
            ),
        ),
    ),
    Case(
        "focus-near",
        "lens",
        "focused at 1e-6 of the scene's distance: circles of a million px",
        lambda: _even(ThinLens(0.0625, 2e-6)),
        (exact_circles, constant(_ONE)),
        params=FEW_LAYERS,
    ),
    Case(
        "focus-above-focal",
        "lens",
        "a photographer's lens focused one float64 beyond its focal length",
        lambda: _above_focal_length(1),
        (exact_circles, constant(_ONE)),
    ),
    Case(
        "focus-at-focal",
        "lens",
        "a photographer's lens focused at its focal length, where it has no image",
        lambda: _above_focal_length(0),
        refused="focus_distance: got 0.05; allowed is a distance above the focal length 0.05",
    ),
    Case("radius-zero", "lens", "a pinhole", lambda: _mosaic(ThinLens(0.0, 2.0)), (exact_circles, pinhole)),
    Case(
        "radius-denormal",
        "lens",
        "a radius of 1e-310, a denormal float64; circles are 0 in float32",
        lambda: _mosaic(ThinLens(1e-310, 2.0)),
        (pinhole, convex(0.1, 0.9)),
    ),
    Case(
        "circle-denormal",
        "lens",
        "circles that are denormal float32, which hardware may take for 0",
        lambda: _mosaic(ThinLens(1e-40, 2.0)),
        (exact_circles, pinhole, convex(0.1, 0.9)),
    ),
    Case(
        "radius-small",
        "lens",
        "a lens smaller than what a pixel sees of the scene: no umbra ends",
        lambda: _mosaic(ThinLens(1e-4, 2.0)),
        (exact_circles, near_pinhole(0.8), convex(0.1, 0.9)),
    ),
    Case(
        "radius-huge",
        "lens",
        "circles of a thousand px, larger than the picture; nothing hides anything",
        lambda: _mosaic(ThinLens(100.0, 2.0)),
        (exact_circles, convex(0.1, 0.9)),
        params=FEW_LAYERS,
    ),
    Case(
        "radius-huge-even",
        "lens",
        "circles of 1e9 px before one colour",
        lambda: _even(ThinLens(1e8, 2.0)),
        (exact_circles, constant(_ONE)),
        params=FEW_LAYERS,
    ),
    Case(
        "radius-beyond",
        "lens",
        "a radius of 1e300: circles beyond float32",
        lambda: _even(ThinLens(1e300, 2.0)),
        (constant(_ONE),),
        params=FEW_LAYERS,
    ),
    Case(
        "layers-too-many",
        "lens",
        "circles of 1e9 px in layers of 1 px",
        lambda: _even(ThinLens(1e8, 2.0)),
        refused="spacing_px: got 1 for circles of confusion of -1.",
        skip={name: "has no layers as many px apart" for name in METHODS if name != "multiview"},
    ),
    Case(
        "samples-one",
        "lens",
        "one lens sample",
        lambda: _even(ThinLens(0.25, 2.0)),
        (constant(_ONE),),
        params={name: {"samples": 1} for name in _SAMPLED},
        skip=Skip.NO_SAMPLES,
    ),
    Case(
        "samples-most",
        "lens",
        "65536 lens samples, or as many as are allowed, of a half-plane's edge",
        _half_plane,
        (edge_of_half_plane(16.0, 4.0),),
        params={"accumulation": {"samples": 65536}, "lensblur": {"samples": 4096}, "multiview": {"samples": 4096}},
        skip=Skip.NO_SAMPLES,
    ),
    Case(
        "samples-too-many",
        "lens",
        "more lens samples than a method's tables hold",
        lambda: _even(ThinLens(0.25, 2.0)),
        params={"accumulation": {"samples": 2**21}, "lensblur": {"samples": 65536}, "multiview": {"samples": 65536}},
        skip=Skip.NO_SAMPLES,
        refused="samples: got ",
    ),
    Case(
        "samples-alike",
        "lens",
        "64 lens samples in one point",
        lambda: _mosaic(ThinLens(0.25, 2.0)),
        (one_ray,),
        skip={**Skip.NO_SAMPLES, "accumulation": "chooses its samples itself"},
    ),
    Case(
        "lens-flat",
        "lens",
        "a lens of glass whose surfaces are flat but for 5 micrometres",
        lambda: _system(1e4, -1e4, 5.0),
        (lensmaker(_power(1e4, -1e4, 5.0)), no_more_light(_ONE)),
    ),
    Case(
        "lens-touching",
        "lens",
        "a lens whose surfaces touch at the rim but for 1e-9 mm",
        lambda: _system(60.0, -60.0, _rim(60.0) * 2.0 + 1e-9),
        (lensmaker(_power(60.0, -60.0, _rim(60.0) * 2.0 + 1e-9)), no_more_light(_ONE)),
    ),
    Case(
        "lens-plate",
        "lens",
        "a plane plate, which has no focal length",
        lambda: _even(SystemLens(ThickLens(math.inf, math.inf, 5.0, 20.0, glass_of("N-BK7")).system("plate"), 2.0)),
        refused="system: ",
    ),
)
