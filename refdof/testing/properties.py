"""Properties: for each promise the check, and the pictures that can tell."""

import math
from collections.abc import Callable
from typing import NamedTuple

from refdof.testing import metamorphic, pointwise
from refdof.testing.compared import Compared, Room
from refdof.testing.filter import Filter
from refdof.testing.picture import FOCUS, Case

__all__ = ["PROPERTIES", "Property"]

_LENS_UNITS = 39  # 2^20 is the last


class Property(NamedTuple):
    """A check and its cases.

    check : (filter, case, room) -> Compared, or None where the case has nothing to tell
    numbers : largest of each of the case's numbers
    across, along : sides of the picture in margins, across the axis of the first number and along it
    wall : one depth, out of focus
    lamp : a black picture with lights in its middle
    plain : one colour
    base : depth of most pixels, if it matters
    """

    check: Callable[[Filter, Case, Room], Compared | None]
    numbers: tuple[int, ...] = ()
    across: int = 0
    along: int = 0
    wall: bool = False
    lamp: bool = False
    plain: bool = False
    base: float | None = None


PROPERTIES: dict[str, Property] = {
    "call": Property(pointwise.call),
    "constant": Property(pointwise.constant, plain=True),
    "pinhole": Property(pointwise.pinhole),
    "focus": Property(pointwise.focus, (1,), along=1, base=FOCUS),
    "behind": Property(pointwise.behind, base=FOCUS),
    "convexity": Property(pointwise.convexity),
    "energy": Property(pointwise.energy, across=4, along=4, wall=True, lamp=True),
    "radius": Property(pointwise.radius, across=4, along=4, wall=True, lamp=True),
    "aperture": Property(pointwise.aperture, across=4, along=4, wall=True, lamp=True),
    "symmetry": Property(metamorphic.symmetry),
    "flip": Property(metamorphic.flip),
    "transpose": Property(metamorphic.transpose),
    "translation": Property(metamorphic.translation, (1, 2), along=2),
    "crop": Property(metamorphic.crop, (1, 3, 3), along=2),
    "tile": Property(metamorphic.tile, (1, 2), along=2),
    "pad": Property(metamorphic.pad, (1, 3, 3), along=2),
    "locality": Property(metamorphic.locality, (63, 63, 4), along=2),
    "nan": Property(metamorphic.nan, (63, 63, 1), along=2),
    "linearity": Property(metamorphic.linearity, (2, 2, 3)),
    "channels": Property(metamorphic.channels, (22,)),
    "units": Property(metamorphic.units, (_LENS_UNITS,)),
    "sides": Property(metamorphic.sides, wall=True),
    "far": Property(metamorphic.far, base=math.inf),
}
