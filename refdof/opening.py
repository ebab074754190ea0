"""The lens opening for kernels: a lens point from a point of the unit square, keeping areas in proportion to the light.

An image aperture is sampled by its transmission (row, then texel of the row), and a Gaussian one by the
light inside a radius, so every point has the same weight.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline
from refdof.aperture import Aperture, concentric_disc, gaussian_stretch

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
    weights = aperture.weights
    row_sums, texel_sums = np.zeros(0), np.zeros((0, 0))
    if aperture.is_image:
        row_sums = np.concatenate([[0.0], np.cumsum(weights.sum(axis=1))])
        row_sums /= row_sums[-1]
        texel_sums = np.concatenate([np.zeros((len(weights), 1)), np.cumsum(weights, axis=1)], axis=1)
        texel_sums /= np.maximum(texel_sums[:, -1:], np.finfo(float).tiny)
    return Opening(
        np.ascontiguousarray(aperture.boundary), row_sums, texel_sums, np.array(aperture.scale), aperture.deviation
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
    corners = opening.boundary.shape[0]
    if corners > 0:
        sector = u * corners
        k = min(int(sector), corners - 1)
        following = k + 1 if k + 1 < corners else 0
        along, r = sector - k, np.sqrt(v)
        x = r * ((1.0 - along) * opening.boundary[k, 0] + along * opening.boundary[following, 0])
        y = r * ((1.0 - along) * opening.boundary[k, 1] + along * opening.boundary[following, 1])
    elif opening.row_sums.shape[0] > 0:
        height, width = opening.texel_sums.shape[0], opening.texel_sums.shape[1] - 1
        row, down = _invert(opening.row_sums, v)
        column, right = _invert(opening.texel_sums[row], u)
        x = (column + right) / width * 2.0 - 1.0
        y = 1.0 - (row + down) / height * 2.0
    else:
        x, y = concentric_disc(u, v)
        if opening.deviation < np.inf:
            stretch = gaussian_stretch(x, y, opening.deviation)
            x, y = x * stretch, y * stretch
    return x * opening.scale[0], y * opening.scale[1]


@inline
def _invert(sums, value):
    """Index and fraction at which the non-decreasing `sums` reach `value` in [0, 1)."""
    low = min(max(np.searchsorted(sums, value, side="right") - 1, 0), len(sums) - 2)
    return low, (value - sums[low]) / (sums[low + 1] - sums[low])
