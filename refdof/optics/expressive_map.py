"""Expressive map: rays of a thin lens whose focus, aperture and aberrations are what an artist says, for kernels.

For a place in the image [px], a point of the unit square and a wavelength, `expressive_block`:

1. pick the point of the aperture, at the share r of the lens radius from the middle       `lens_point`
2. bend the ray to where it meets the pixel's chief ray: at the inverse distance of the pixel, which the focal surface
   and the image plane's offset set, plus what the lens's power at r adds                   `_at`, `_spline`
3. weigh it by the spline of ray weights at r                                               `_spline`

A ray starts at E (vx, vy, 0), where E is the lens radius at the pixel and v the aperture's point, and runs along
(right - E vx k, up - E vy k, -1), where (right, up, -1) is the chief ray and k the inverse distance.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, sections 5.2 and 5.3.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline
from refdof.image.bilinear import bilinear
from refdof.optics.aperture_sampling import ApertureSampler, borrow_aperture_sampler, lens_point
from refdof.optics.projection import Projection

__all__ = ["ExpressiveMap", "borrow_expressive_map", "expressive_block"]


class ExpressiveMap(NamedTuple):
    """An expressive lens before a camera's picture; W wavelengths. Lengths are in the unit of `Projection`.

    Splines are rows of four: value, slope, curvature and so on at the beginning of equal parts of r = 0 .. 1.
    """

    projection: Projection
    aperture_sampler: ApertureSampler
    inverse_focus: Float  # (H, W), at the pixels' centres
    aperture_scale: Float  # (H, W), or (1, 1) for all
    power: Float  # (W, parts, 4): what is added to the inverse focus
    weight: Float  # (parts, 4), 1 on average over the aperture


@inline
def borrow_expressive_map(o):
    """`ExpressiveMap` whose arrays are borrowed, for a tile kernel's inner loops."""
    return ExpressiveMap(
        o.projection,
        borrow_aperture_sampler(o.aperture_sampler),
        borrow(o.inverse_focus),
        borrow(o.aperture_scale),
        borrow(o.power),
        borrow(o.weight),
    )


@inline
def expressive_block(expressive_map, wavelength, columns, rows, x, y, dx, dy, weights):
    """Rays for arrays (N,): x and y hold points of the unit square, and then where rays start; dx and dy their slopes.

    dx and dy may be the memory of columns and rows.
    """
    projection, power = expressive_map.projection, expressive_map.power[wavelength]
    scale, radius = 1.0 / projection.pixels_per_tangent, projection.lens_radius
    for k in range(len(x)):
        lens_x, lens_y = lens_point(expressive_map.aperture_sampler, x[k], y[k])
        part = min(np.sqrt(lens_x * lens_x + lens_y * lens_y), 1.0)
        bend = _at(expressive_map.inverse_focus, columns[k] - 0.5, rows[k] - 0.5) + _spline(power, part)
        wide = radius * _at(expressive_map.aperture_scale, columns[k] - 0.5, rows[k] - 0.5)
        x[k], y[k] = wide * lens_x, wide * lens_y
        right, up = (columns[k] - 0.5 * projection.width) * scale, (0.5 * projection.height - rows[k]) * scale
        dx[k], dy[k] = right - x[k] * bend, up - y[k] * bend
        weights[k] = _spline(expressive_map.weight, part)


@inline
def _spline(parts, place):
    """Value of a spline at 0 .. 1."""
    scaled = place * len(parts)
    k = min(int(scaled), len(parts) - 1)
    t = scaled - k
    return parts[k, 0] + t * (parts[k, 1] + t * (parts[k, 2] + t * parts[k, 3]))


@inline
def _at(picture, x, y):
    """Bilinear value of a picture (H, W) at a place whose whole numbers are pixel centres; linear beyond its border."""
    height, width = picture.shape
    i, j = min(max(int(x), 0), max(width - 2, 0)), min(max(int(y), 0), max(height - 2, 0))
    right, below = min(i + 1, width - 1), min(j + 1, height - 1)
    return bilinear(picture[j, i], picture[j, right], picture[below, i], picture[below, right], x - i, y - j)
