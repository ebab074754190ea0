"""Cases of size: of pictures, of units, and of the number of layers."""

import numpy as np

from refdof.optics.lens import ThinLens
from refdof.scene.material import Material
from refdof.scene.scene import Part
from refdof.stability.cases.case import Case
from refdof.stability.checks import constant, convex, exact_circles, mirrored, same_as, same_bits
from refdof.stability.subjects import PIXELS, depth_of, mosaic, random_picture, view_of_parts, wall
from refdof.view import View

__all__ = ["CASES"]

_LENS = ThinLens(0.0613, 2.0)
_DEPTHS = (1.03, 1.57, 2.0, 4.1, 16.3)  # none on a bound of any method but the one in focus
_ONE = (0.3, 0.6, 0.9)
_LEAK = (9.0, 0.0, 0.0)  # a background that shows wherever anything leaks


def _scaled(scale: float) -> View:
    depth = np.random.default_rng(3).choice([*_DEPTHS, np.inf], (25, 33))
    return mosaic(random_picture(2, (33, 25)), depth, _LENS, scale=scale)


def _tied(scale: float) -> View:
    """Circles of -1, 0, 0.5 and 1 px, which are bounds of several methods, and parallaxes half a px apart."""
    depth = np.random.default_rng(3).choice([1.0, 2.0, 4.0, np.inf], (25, 33))
    return mosaic(random_picture(2, (33, 25)), depth, ThinLens(0.0625, 2.0), scale=scale)


def _sized(width: int, height: int, step: int = 1) -> View:
    """Of that size; with a step of -1 mirrored."""
    depth = np.random.default_rng(8).choice(_DEPTHS, (height, width))
    return mosaic(random_picture(9, (width, height))[:, ::step], depth[:, ::step], _LENS)


def _cards(count: int) -> View:
    """So many cards, each of half of the plane, one behind the other, and a wall behind all of them, in one colour."""
    random = np.random.default_rng(10)
    circles = np.linspace(-6.0, 0.9, count)
    lens = ThinLens(0.25, 2.0)
    corners, faces = [], []
    for k, circle in enumerate(circles):
        depth = depth_of(float(circle), lens)
        angle = random.uniform(0.0, 2.0 * np.pi)
        along, away = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        start = away * random.uniform(1.0, 6.0)
        left, right = start - 99 * along, start + 99 * along
        square = [left, right, right + 99 * away, left + 99 * away]
        corners.append(np.column_stack([np.array(square) * depth / PIXELS, np.full(4, -depth)]))
        faces += [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]
    cards = Part(np.concatenate(corners), np.array(faces), Material("unlit", base_color=_ONE))
    return view_of_parts([cards, wall(4.0, _ONE)], (9, 7), lens, _LEAK)


def _two_depths() -> View:
    """Stripes at the ends of a range of 60 px of circles, and nothing between."""
    lens = ThinLens(1.0, 2.0)
    near, far = depth_of(-45.0, lens), 1e6
    depth = np.where(np.arange(33) % 8 < 4, near, far) * np.ones((25, 1))
    return mosaic(random_picture(11, (33, 25)), depth, lens)


_SIZES = (
    ("size-1x1", 1, 1, "one pixel: no level, no neighbour"),
    ("size-1xn", 1, 33, "one column"),
    ("size-nx1", 33, 1, "one row"),
    ("size-2x2", 2, 2, "two by two pixels"),
    ("size-prime", 31, 37, "prime sides"),
    ("size-odd", 33, 17, "odd sides, one more than a power of two"),
    ("size-long", 8192, 1, "8192 x 1 px"),
)

CASES = (
    *(
        Case(
            name,
            "size",
            says,
            lambda width=width, height=height: _sized(width, height),  # type: ignore[misc]
            (
                exact_circles,
                convex(0.1, 0.9),
                mirrored(lambda width=width, height=height: _sized(width, height, -1)),  # type: ignore[misc]
            ),
        )
        for name, width, height, says in _SIZES
    ),
    *(
        Case(
            f"scale-2^{power}",
            "size",
            f"all lengths times 2^{power}",
            lambda power=power: _scaled(2.0**power),  # type: ignore[misc]
            (same_bits("same bits", lambda: _scaled(1.0)),),
        )
        for power in (-20, 1, 20)
    ),
    *(
        Case(
            f"unit-{name}",
            "size",
            f"all lengths times {factor:g}",
            lambda factor=factor: _scaled(factor),  # type: ignore[misc]
            (same_as("same picture", lambda: _scaled(1.0), 0.8, "another unit rounds otherwise"),),
        )
        for name, factor in (("micro", 1e-6), ("mega", 1e6))
    ),
    Case(
        "unit-tied",
        "size",
        "circles on the bounds of layers, in another unit: roundings push them to either side",
        lambda: _tied(1e-6),
        (same_as("same picture", lambda: _tied(1.0), 0.8, "another unit rounds otherwise"),),
    ),
    Case(
        "layers-thousands",
        "size",
        "2000 half-planes, one behind the other, of one colour, before a wall of it",
        lambda: _cards(2000),
        (constant(_ONE),),
    ),
    Case(
        "layers-empty",
        "size",
        "nothing between the ends of a range of 60 px of circles: layers and sub-images without surfaces",
        _two_depths,
        (exact_circles, convex(0.1, 0.9)),
    ),
)
