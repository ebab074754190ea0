"""Colours of layers: triangles shaded at the pixel centres, as the pinhole sees them."""

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline, kernel, prange
from refdof.optics.projection import Projection, pixel_ray
from refdof.raster.rays.shading import shade
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces, intersect

__all__ = ["colors_of", "pinhole_hit"]


def colors_of(surfaces: Surfaces, projection: Projection, triangle: Index) -> Float:
    """Colours of triangles at the pixel centres.

    Parameters
    ----------
    surfaces, shot
    triangle : (N, H, W) int32
        The triangle that the ray of each pixel meets; -1 is empty.

    Returns
    -------
    (N, H, W, 3) float32
        Linear RGB; zeros where empty.
    """
    out = np.zeros((*triangle.shape, 3), dtype=np.float32)
    _fill(surfaces, projection, triangle, out)
    return out


@kernel
def _fill(surfaces, projection, triangle, out):
    """Fill out (N, H, W, 3)."""
    for y in prange(triangle.shape[1]):
        borrowed = borrow_surfaces(surfaces)
        for n in range(triangle.shape[0]):
            for x in range(triangle.shape[2]):
                face = triangle[n, y, x]
                if face < 0:
                    continue
                u, v, dx, dy = pinhole_hit(borrowed, projection, face, x, y)
                red, green, blue = shade(borrowed, face, u, v, dx, dy, -1.0)
                out[n, y, x, 0], out[n, y, x, 1], out[n, y, x, 2] = red, green, blue


@inline
def pinhole_hit(surfaces, projection, face, x, y):
    """Barycentrics u, v where the ray (dx, dy, -1) of a pixel's centre meets a triangle, and dx, dy.

    They are brought back into the triangle: a rasteriser covers centres a little outside, and edge-on far so.
    """
    dx, dy = pixel_ray(projection, x, y)
    _, u, v = intersect(surfaces.corner, face, 0.0, 0.0, 0.0, dx, dy, -1.0)
    u, v = max(u, 0.0), max(v, 0.0)
    total = max(u + v, 1.0)
    return u / total, v / total, dx, dy
