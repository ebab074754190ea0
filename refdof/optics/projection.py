"""Projection: camera and lens as plain numbers for kernels, in the unit of length of `Surfaces`."""

import sys
from typing import NamedTuple

import numpy as np

from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

__all__ = ["Projection", "projection_of"]


class Projection(NamedTuple):
    """Picture size [px], P [px], lens radius [2^exponent scene units] and 1 / focus distance."""

    width: int
    height: int
    pixels_per_tangent: float
    lens_radius: float
    inverse_focus: float


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
