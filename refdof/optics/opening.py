"""The lens opening for kernels: a lens point from a point of the unit square, keeping areas in proportion to the light.

An image aperture is sampled by its transmission (row, then texel of the row), and a Gaussian one by the
light inside a radius, so every point has the same weight.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline
from refdof.optics.aperture import Aperture
from refdof.optics.lens_maps import concentric_disc, fan_point, gaussian_stretch, image_point

__all__ = ["Opening", "borrow_opening", "is_plain_disc", "lens_point", "opening_of"]


class Opening(NamedTuple):
    """An `Aperture` for kernels: boundary (K, 2), cumulated rows (h + 1,) and texels (h, w + 1), scale (2,)."""

    boundary: Float
    row_sums: Float
    texel_sums: Float
    scale: Float
    deviation: float


def opening_of(aperture: Aperture) -> Opening:
    """Flatten `aperture`; the cumulated transmissions run from 0 to 1."""
    return Opening(
        np.ascontiguousarray(aperture.boundary), *aperture.cumulated(), np.array(aperture.scale), aperture.deviation
    )


@inline
def borrow_opening(o):
    """`Opening` whose arrays are borrowed, for a tile kernel's inner loops."""
    return Opening(borrow(o.boundary), borrow(o.row_sums), borrow(o.texel_sums), borrow(o.scale), o.deviation)


@inline
def is_plain_disc(opening):
    """Whether `concentric_disc` says it all: a loop over it alone is compiled to vector instructions."""
    round_ = opening.scale[0] == 1.0 and opening.scale[1] == 1.0
    return round_ and opening.deviation == np.inf and opening.boundary.shape[0] == 0 and opening.row_sums.shape[0] == 0


@inline
def lens_point(opening, u, v):
    """Lens point (x, y) of the opening, x right, y up, in units of the lens radius."""
    if opening.boundary.shape[0] > 0:
        x, y = fan_point(opening.boundary, u, v)
    elif opening.row_sums.shape[0] > 0:
        x, y = image_point(opening.row_sums, opening.texel_sums, u, v)
    else:
        x, y = concentric_disc(u, v)
        if opening.deviation < np.inf:
            stretch = gaussian_stretch(x, y, opening.deviation)
            x, y = x * stretch, y * stretch
    return x * opening.scale[0], y * opening.scale[1]
