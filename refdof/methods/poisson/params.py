"""Params of the Poisson disc filter: what its listing leaves open, and what ports of it change.

References
----------
.. [1] Scheuermann (2004), as in `method`.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from refdof._check import Float, InputError, as_choice, as_integer, as_number

__all__ = ["CODES", "MAX_RADIUS", "ROW_ORDERS", "SMALL_RADIUS", "SMALL_SIZE", "TAPS", "TAP_TABLES", "Params"]

CODES = ("linear", "thin_lens")
ROW_ORDERS = ("down", "up")
MAX_RADIUS = 5.0  # px, [1]
SMALL_SIZE = 4  # [1]: the small picture's texels are this many pixels wide
SMALL_RADIUS = 0.4  # [1]: radius in its texels, of the radius in pixels
_MOST_TAPS = 256
_LARGEST_SMALL = 64
_LARGEST = 65536.0

Table: TypeAlias = tuple[tuple[float, float], ...]

# Unit disc, y down. All are in use under the name of [1].
TAP_TABLES: dict[str, Table] = {
    "twelve": (
        (-0.326212, -0.40581),
        (-0.840144, -0.07358),
        (-0.695914, 0.457137),
        (-0.203345, 0.620716),
        (0.96234, -0.194983),
        (0.473434, -0.480026),
        (0.519456, 0.767022),
        (0.185461, -0.893124),
        (0.507431, 0.064425),
        (0.89642, 0.412458),
        (-0.32194, -0.932615),
        (-0.791559, -0.59771),
    ),
    "eight": (
        (0.0, 0.0),
        (0.527837, -0.085868),
        (-0.040088, 0.536087),
        (-0.670445, -0.179949),
        (-0.419418, -0.616039),
        (0.440453, -0.639399),
        (-0.757088, 0.349334),
        (0.574619, 0.685879),
    ),
    "twelve_close": (
        (0.0, 0.0),
        (0.07, -0.45),
        (-0.15, -0.33),
        (0.35, -0.32),
        (-0.39, -0.26),
        (0.1, -0.23),
        (0.36, -0.12),
        (-0.31, -0.01),
        (-0.38, 0.22),
        (0.36, 0.23),
        (-0.13, 0.29),
        (0.14, 0.41),
    ),
    "nine_grid": (
        (0.0, 0.0),
        (0.67, 0.0),
        (-0.67, 0.0),
        (0.0, -0.67),
        (0.67, -0.67),
        (-0.67, -0.67),
        (0.0, 0.67),
        (0.67, 0.67),
        (-0.67, 0.67),
    ),
}
TAPS = np.array(TAP_TABLES["twelve"])


@dataclass(frozen=True)
class Params:
    """What the listing leaves open, and its constants.

    Parameters
    ----------
    code : "linear" or "thin_lens"
        Blur grows with distance from the focal plane [1], or as the circle of confusion does.
    max_radius : float > 0
        Radius of full blur [px]; [1] has 5.
    taps : a name in `refdof.methods.poisson.TAP_TABLES`, or pairs (x, y)
        The tap table, of radius 1, y down. Pairs: 1 .. 256, within -4 .. 4.
    max_taps : int or None
        Only the first taps, 1 .. 256. None: all of the table.
    near_plane, focus_plane, far_plane : float > 0 or None
        Depths of full blur in front, of none, and of full blur behind [unit of depth], where `code` is "linear". None:
        the nearest and the farthest surface of the picture, and the plane that its circles tell.
    far_limit : float
        Blur behind the focal plane is cut here, 0 .. 1; [1] has it as a parameter.
    small_size : 1, 2, 4 .. 64
        Pixels across a texel of the small picture.
    small_radius : float
        Radius in texels of the small picture, of the radius in pixels, 0 .. 64.
    row_order : one of `refdof.methods.poisson.params.ROW_ORDERS`
        Where the listing's second texture coordinate grows to: "up" mirrors the taps, as OpenGL's rows do.
    """

    code: str = "linear"
    max_radius: float = MAX_RADIUS
    taps: str | Table = "twelve"
    max_taps: int | None = None
    near_plane: float | None = None
    focus_plane: float | None = None
    far_plane: float | None = None
    far_limit: float = 1.0
    small_size: int = SMALL_SIZE
    small_radius: float = SMALL_RADIUS
    row_order: str = "down"

    def __post_init__(self) -> None:
        as_choice("code", self.code, CODES)
        as_choice("row_order", self.row_order, ROW_ORDERS)
        self._set("max_radius", as_number("max_radius", self.max_radius, above=0.0, maximum=_LARGEST))
        self._set("taps", _as_taps(self.taps))
        if self.max_taps is not None:
            self._set("max_taps", as_integer("max_taps", self.max_taps, minimum=1, maximum=_MOST_TAPS))
        for name in ("near_plane", "focus_plane", "far_plane"):
            if getattr(self, name) is not None:
                self._set(name, as_number(name, getattr(self, name), above=0.0))
        self._check_order()
        self._set("far_limit", as_number("far_limit", self.far_limit, minimum=0.0, maximum=1.0))
        small = as_integer("small_size", self.small_size, minimum=1, maximum=_LARGEST_SMALL)
        if small & (small - 1):
            raise InputError(f"small_size: got {small}; allowed are 1, 2, 4 .. {_LARGEST_SMALL}")
        self._set("small_size", small)
        self._set("small_radius", as_number("small_radius", self.small_radius, minimum=0.0, maximum=64.0))

    @property
    def table(self) -> Float:
        """The taps (N, 2) float64 as they are used: y down, of radius 1."""
        table = np.array(TAP_TABLES[self.taps] if isinstance(self.taps, str) else self.taps)[: self.max_taps]
        return table if self.row_order == "down" else table * (1.0, -1.0)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def _check_order(self) -> None:
        """Planes that are given are in order: near, focus, far."""
        given = [(name, getattr(self, name)) for name in ("near_plane", "focus_plane", "far_plane")]
        given = [(name, value) for name, value in given if value is not None]
        for (before, low), (after, high) in pairwise(given):
            if low >= high:
                raise InputError(f"{after}: got {high:g}; allowed is more than {before}, {low:g}")


def _as_taps(taps: Any) -> str | Table:
    if isinstance(taps, str):
        return as_choice("taps", taps, TAP_TABLES)
    try:
        table = tuple((float(x), float(y)) for x, y in taps)
    except (TypeError, ValueError):
        table = ()
    if not 1 <= len(table) <= _MOST_TAPS or not all(abs(c) <= 4.0 and math.isfinite(c) for tap in table for c in tap):
        said = " ".join(str(taps).split())[:60]
        raise InputError(
            f"taps: got {said}; allowed are {', '.join(TAP_TABLES)}, or 1 .. {_MOST_TAPS} pairs in -4 .. 4"
        )
    return table
