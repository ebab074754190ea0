"""Projection: camera and lens as plain numbers for kernels, in the unit of length of `Surfaces`."""

import sys
from typing import NamedTuple

import numpy as np

from refdof._jit import inline
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["Projection", "pixel_ray", "projection_of"]


class Projection(NamedTuple):
    """Picture size [px], P [px], lens radius [2^exponent scene units] and 1 / focus distance."""

    width: int
    height: int
    pixels_per_tangent: float
    lens_radius: float
    inverse_focus: float


@inline
def pixel_ray(projection, x, y):
    """Slopes (dx, dy) of the pinhole's ray (dx, dy, -1) through the centre of pixel (x, y)."""
    scale = 1.0 / projection.pixels_per_tangent
    return (x + 0.5 - 0.5 * projection.width) * scale, (0.5 * projection.height - y - 0.5) * scale


def projection_of(camera: Camera, lens: ThinLens, exponent: int) -> Projection:
    """Camera and lens, with lengths divided by 2^exponent."""
    return Projection(
        camera.width,
        camera.height,
        camera.pixels_per_tangent,
        _scaled(lens.radius, -exponent),
        1.0 / max(_scaled(lens.focus_distance, -exponent), sys.float_info.min),
    )


def _scaled(length: float, exponent: int) -> float:
    """length 2^exponent; inf beyond the largest number."""
    with np.errstate(over="ignore"):
        return float(np.ldexp(length, exponent))
