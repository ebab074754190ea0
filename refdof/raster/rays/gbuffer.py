"""G-buffer: what a layer stores so that its surfaces can be shaded later, against rays other than the pinhole's.

One formula shades every material (`refdof.scene.material`): albedo E(n) + emission + specular (...). An unlit surface
has its colour as emission, and only phong ones have a specular colour, so that attributes of different materials can be
averaged, as mipmaps do.

References
----------
.. [1] Deering et al. (1988), The Triangle Processor and Normal Vector Shader, SIGGRAPH (deferred shading).
"""

import math

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline, kernel, prange
from refdof.optics.projection import Projection
from refdof.raster.rays.exact_layers import Layers
from refdof.raster.rays.layer_color import pinhole_hit, show_through
from refdof.raster.rays.shading import emitted, lit, shading_normal, surface_color
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces
from refdof.scene.material import SHADINGS

__all__ = ["GBUFFER_CHANNELS", "gbuffer_of", "shade_gbuffer"]

# Channels: albedo (3), emission (3), normal (3, camera space, towards the viewer), specular (3), shininess.
GBUFFER_CHANNELS = 13
_ALBEDO, _EMISSION, _NORMAL, _SPECULAR, _SHININESS = 0, 3, 6, 9, 12
_UNLIT, _PHONG = SHADINGS.index("unlit"), SHADINGS.index("phong")


def gbuffer_of(surfaces: Surfaces, projection: Projection, triangle: Index, seen: Layers | None = None) -> Float:
    """Attributes of triangles at the pixel centres.

    Parameters
    ----------
    surfaces, shot
    triangle : (N, H, W) int32
        The triangle that the ray of each pixel meets; -1 is empty.
    seen : Layers
        As in `refdof.raster.rays.layer_color.colors_of`; what is transparent gives off the light that it has there.

    Returns
    -------
    (N, H, W, 13) float32
        Zeros where empty.
    """
    out = np.zeros((*triangle.shape, GBUFFER_CHANNELS), dtype=np.float32)
    _fill(surfaces, projection, triangle, out)
    if seen is not None:
        colors = np.zeros((*triangle.shape, 3), dtype=np.float32)
        shown = show_through(surfaces, seen, triangle, colors)
        out[shown, _ALBEDO : _ALBEDO + 3] = 0.0
        out[shown, _EMISSION : _EMISSION + 3] = colors[shown]
        out[shown, _SPECULAR : _SPECULAR + 3] = 0.0
    return out


@kernel
def _fill(surfaces, projection, triangle, out):
    """Fill out (N, H, W, 13)."""
    for y in prange(triangle.shape[1]):
        borrowed = borrow_surfaces(surfaces)
        for n in range(triangle.shape[0]):
            for x in range(triangle.shape[2]):
                face = triangle[n, y, x]
                if face < 0:
                    continue
                a, material = out[n, y, x], borrowed.face_material[face]
                u, v, dx, dy = pinhole_hit(borrowed, projection, face, x, y)
                w = 1.0 - u - v
                color = _EMISSION if borrowed.shading[material] == _UNLIT else _ALBEDO
                a[color], a[color + 1], a[color + 2] = surface_color(borrowed, face, w, u, v)
                a[_NORMAL], a[_NORMAL + 1], a[_NORMAL + 2] = shading_normal(borrowed, face, w, u, v, dx, dy, -1.0)
                red, green, blue = emitted(borrowed, face, w, u, v)
                a[_EMISSION] += red
                a[_EMISSION + 1] += green
                a[_EMISSION + 2] += blue
                for c in range(3):
                    if borrowed.shading[material] == _PHONG:
                        a[_SPECULAR + c] = borrowed.specular[material, c]
                a[_SHININESS] = borrowed.shininess[material]


@inline
def shade_gbuffer(surfaces, a, dx, dy, dz):
    """Linear RGB of a surface with attributes `a` (13,) against the ray direction (dx, dy, dz).

    The normal may have any length, as averages have.
    """
    nx, ny, nz = a[_NORMAL], a[_NORMAL + 1], a[_NORMAL + 2]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length == 0.0:  # averaged normals cancel
        nx, ny, nz, length = -dx, -dy, -dz, math.sqrt(dx * dx + dy * dy + dz * dz)
    scale = 1.0 / length
    nx, ny, nz = nx * scale, ny * scale, nz * scale
    red, green, blue = a[_ALBEDO], a[_ALBEDO + 1], a[_ALBEDO + 2]
    sr, sg, sb, shininess = a[_SPECULAR], a[_SPECULAR + 1], a[_SPECULAR + 2], a[_SHININESS]
    red, green, blue = lit(surfaces, (nx, ny, nz), (dx, dy, dz), (red, green, blue), (sr, sg, sb), shininess)
    return red + a[_EMISSION], green + a[_EMISSION + 1], blue + a[_EMISSION + 2]
