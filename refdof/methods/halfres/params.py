"""Params of the half-resolution method: the constants that ports change.

References
----------
.. [1], [2] as in `method`.
"""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_choice, as_number

__all__ = ["CIRCLES", "VARIANTS", "Params", "points"]

CIRCLES = ("thin_lens", "smoothstep")
VARIANTS = ("three", "pmndrs")
_POINTS = 80
_EVERY = 5  # of the points one in five takes the maximum
_GOLDEN_ANGLE = 2.39996323  # radians, as it is printed in [1]


@dataclass(frozen=True)
class Params:
    """What ports change.

    Parameters
    ----------
    largest_px : float
        Radius of the greatest blur [px of the picture], 0 .. 1024; [1]'s and [2]'s "bokehScale".
    circles : {"thin_lens", "smoothstep"}
        "thin_lens": blur grows with the circle of confusion and is cut at `largest_px`. "smoothstep": it grows with
        the distance from the plane in focus, as [1] and [2] have it, and is as large in front as behind.
    focus_plane, focus_range : float > 0
        Depth in focus, and how far from it blur is greatest [unit of depth], where `circles` is "smoothstep".
    variant : {"three", "pmndrs"}
        [1] or [2].
    """

    largest_px: float = 16.0
    circles: str = "thin_lens"
    focus_plane: float = 1.0
    focus_range: float = 1.0
    variant: str = "three"

    def __post_init__(self) -> None:
        largest = as_number("largest_px", self.largest_px, minimum=0.0, maximum=1024.0)
        object.__setattr__(self, "largest_px", largest)
        as_choice("circles", self.circles, CIRCLES)
        as_choice("variant", self.variant, VARIANTS)
        for name in ("focus_plane", "focus_range"):
            object.__setattr__(self, name, as_number(name, getattr(self, name), above=0.0))


def points() -> tuple[Float, Float]:
    """The points of the mean (64, 2) and of the maximum (16, 2), unit disc, y down."""
    angles = np.arange(_POINTS) * _GOLDEN_ANGLE
    radii = np.sqrt(np.arange(_POINTS) / _POINTS)
    table = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    largest = np.arange(_POINTS) % _EVERY == 0
    return table[~largest], table[largest]
