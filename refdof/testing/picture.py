"""Picture: a small picture with its depth, seen through a lens, and a case: a picture and what is done to it.

The focal plane is at `FOCUS`. Depths are `FOCUS` times a power of two, or infinite. So, with the background's circle c,
circles are -c at half of that distance, 0 at it, c / 2 at its double, and their values have no roundings.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["DEPTHS", "FOCUS", "NEAR", "WALLS", "Case", "Picture", "axis_of", "circles_up_to"]

FOCUS, NEAR = 4.0, 2.0
DEPTHS = (FOCUS, math.inf, NEAR, 2.0 * FOCUS, 4.0 * FOCUS)
WALLS = (math.inf, NEAR)  # c on either side
_PIXELS_PER_TANGENT = 64.0  # the pictures are small: their angles, too


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture, its depth and its lens.

    Parameters
    ----------
    color : (H, W, C) float32
        Linear light.
    depth : (H, W) float32
        Planar depth; inf is background.
    circle : float
        Circle of confusion of the background, radius [px].
    unit : float
        A power of two: depth, lens radius and focus are as often as large.
    """

    color: Float
    depth: Float
    circle: float
    unit: float = 1.0

    @property
    def camera(self) -> Camera:
        """A camera of the picture's size, with always as many pixels per unit tangent."""
        height, width = self.depth.shape
        angle = 2.0 * math.degrees(math.atan(height / (2.0 * _PIXELS_PER_TANGENT)))
        return Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=angle, size=(width, height))

    @property
    def lens(self) -> ThinLens:
        """The thin lens that gives the background its circle."""
        return ThinLens(self.unit * self.circle * FOCUS / _PIXELS_PER_TANGENT, self.unit * FOCUS)

    @cached_property
    def coc(self) -> Float:
        """(H, W) float32: signed circles of confusion, radius [px]."""
        return self.lens.coc_px(self.depth, self.camera)

    @property
    def largest(self) -> float:
        """The largest circle of the picture [px]."""
        return float(np.abs(self.coc).max())

    @property
    def brightest(self) -> float:
        """The largest value of the picture."""
        return float(np.abs(self.color).max())

    @property
    def blurred(self) -> Any:
        """(H, W) bool: what is out of focus."""
        return self.depth != self.unit * FOCUS

    def with_(self, **changes: Any) -> "Picture":
        """The picture with other arrays, circle or unit."""
        return replace(self, **changes)

    def moved(self, change: Any) -> "Picture":
        """The picture with colour and depth after a function of arrays that acts on rows and columns."""
        return replace(
            self, color=np.ascontiguousarray(change(self.color)), depth=np.ascontiguousarray(change(self.depth))
        )

    def unlike(self) -> list[tuple[int, int]]:
        """(row, column) of the pixels that are not as most are, or, of as many, as the first is."""
        height, width, _ = self.color.shape
        rows = np.concatenate([self.color, self.depth[..., None]], axis=2).reshape(height * width, -1)
        _, first, inverse, counts = np.unique(rows, axis=0, return_index=True, return_inverse=True, return_counts=True)
        common = max(range(len(counts)), key=lambda k: (counts[k], -first[k]))
        return [(int(k) // width, int(k) % width) for k in np.flatnonzero(inverse.ravel() != common)]

    def usual(self) -> tuple[int, int]:
        """(row, column) of the first pixel that is as most are."""
        rest = set(self.unlike())
        return next(place for place in np.ndindex(self.depth.shape) if place not in rest)


@dataclass(frozen=True, eq=False)
class Case:
    """A picture, and whole numbers >= 0 that say what is done to it; their meaning is the property's."""

    picture: Picture
    numbers: tuple[int, ...]


def axis_of(number: int) -> int:
    """The axis that a case's number means: 0 is columns, 1 is rows, and so on."""
    return 1 - number % 2


def circles_up_to(largest: float) -> tuple[float, ...]:
    """The circles of the background that pictures have [px], from small to large."""
    return tuple(largest * step / 4 for step in (1, 2, 3, 4))
