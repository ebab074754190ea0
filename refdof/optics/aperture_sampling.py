"""The lens aperture for kernels: a lens point from a point of the unit square, areas in proportion to the light.

An image aperture is sampled by its transmission (row, then texel of the row), and a Gaussian one by the
light inside a radius, so every point has the same weight.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline
from refdof.optics.aperture import Aperture
from refdof.optics.lens_maps import concentric_disc, fan_point, gaussian_stretch, image_point

__all__ = ["ApertureSampler", "aperture_sampler_of", "borrow_aperture_sampler", "is_plain_disc", "lens_point"]


class ApertureSampler(NamedTuple):
    """An `Aperture` for kernels: boundary (K, 2), cumulated rows (h + 1,) and texels (h, w + 1), scale (2,)."""

    boundary: Float
    row_sums: Float
    texel_sums: Float
    scale: Float
    deviation: float


def aperture_sampler_of(aperture: Aperture) -> ApertureSampler:
    """Flatten `aperture`; the cumulated transmissions run from 0 to 1."""
    return ApertureSampler(
        np.ascontiguousarray(aperture.boundary), *aperture.cumulated(), np.array(aperture.scale), aperture.deviation
    )


@inline
def borrow_aperture_sampler(o):
    """`ApertureSampler` whose arrays are borrowed, for a tile kernel's inner loops."""
    return ApertureSampler(borrow(o.boundary), borrow(o.row_sums), borrow(o.texel_sums), borrow(o.scale), o.deviation)


@inline
def is_plain_disc(aperture_sampler):
    """Whether `concentric_disc` says it all: a loop over it alone is compiled to vector instructions."""
    round_ = aperture_sampler.scale[0] == 1.0 and aperture_sampler.scale[1] == 1.0
    return (
        round_
        and aperture_sampler.deviation == np.inf
        and aperture_sampler.boundary.shape[0] == 0
        and aperture_sampler.row_sums.shape[0] == 0
    )


@inline
def lens_point(aperture_sampler, u, v):
    """Lens point (x, y) of the aperture, x right, y up, in units of the lens radius."""
    if aperture_sampler.boundary.shape[0] > 0:
        x, y = fan_point(aperture_sampler.boundary, u, v)
    elif aperture_sampler.row_sums.shape[0] > 0:
        x, y = image_point(aperture_sampler.row_sums, aperture_sampler.texel_sums, u, v)
    else:
        x, y = concentric_disc(u, v)
        if aperture_sampler.deviation < np.inf:
            stretch = gaussian_stretch(x, y, aperture_sampler.deviation)
            x, y = x * stretch, y * stretch
    return x * aperture_sampler.scale[0], y * aperture_sampler.scale[1]
