"""Colours of layers: triangles shaded at the pixel centres, as the pinhole sees them."""

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline, kernel, prange
from refdof.optics.projection import Projection, pixel_ray
from refdof.raster.materials.cutouts import borrow_cutouts, may_blend
from refdof.raster.rays.exact_layers import Layers
from refdof.raster.rays.shading import shade
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces, intersect

__all__ = ["colors_of", "pinhole_hit", "show_through"]


def colors_of(surfaces: Surfaces, projection: Projection, triangle: Index, seen: Layers | None = None) -> Float:
    """Colours of triangles at the pixel centres.

    Parameters
    ----------
    surfaces, shot
    triangle : (N, H, W) int32
        The triangle that the ray of each pixel meets; -1 is empty.
    seen : Layers
        All surfaces, where some are transparent, of `View.seen_through`. A transparent triangle has its colour
        there.

    Returns
    -------
    (N, H, W, 3) float32
        Linear RGB; zeros where empty.
    """
    out = np.zeros((*triangle.shape, 3), dtype=np.float32)
    _fill(surfaces, projection, triangle, out)
    if seen is not None:
        show_through(surfaces, seen, triangle, out)
    return out


def show_through(surfaces: Surfaces, seen: Layers, triangle: Index, out: Float) -> Index:
    """Give transparent triangles (N, H, W) in out (N, H, W, 3) the colours of `seen`; where, as (N, H, W) bool.

    A triangle that a rasteriser draws where no ray meets it keeps its own colour.
    """
    shown: Index = np.zeros(triangle.shape, dtype=np.bool_)
    _copy_seen(surfaces.cutouts, seen, triangle, out, shown)
    return shown


@kernel
def _copy_seen(cutouts, seen, triangle, out, shown):
    """Fill out (N, H, W, 3) and shown (N, H, W)."""
    for y in prange(triangle.shape[1]):
        borrowed = borrow_cutouts(cutouts)
        for n in range(triangle.shape[0]):
            for x in range(triangle.shape[2]):
                face = triangle[n, y, x]
                if face < 0 or not may_blend(borrowed, face):
                    continue
                for k in range(len(seen.triangle)):
                    if seen.triangle[k, y, x] == face:
                        shown[n, y, x] = True
                        for c in range(3):
                            out[n, y, x, c] = seen.color[k, y, x, c]
                        break


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
