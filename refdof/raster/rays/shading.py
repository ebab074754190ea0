"""Shading: the light that leaves a surface point towards a ray, for kernels. Formulas: `refdof.scene.material`.

References
----------
.. [1] Phong (1975), Illumination for Computer Generated Pictures, Communications of the ACM 18(6).
.. [2] Cigolle et al. (2014), A Survey of Efficient Representations for Independent Unit Vectors (octahedral map).
"""

import math

from refdof._jit import inline
from refdof.image.bilinear import bilinear
from refdof.raster.materials.texel import texel_weights
from refdof.scene.material import SHADINGS

__all__ = ["emitted", "lit", "shade", "shading_normal", "surface_color"]

_UNLIT, _PHONG = SHADINGS.index("unlit"), SHADINGS.index("phong")


@inline
def shade(surfaces, face, u, v, dx, dy, dz):
    """Linear RGB that leaves barycentrics (u, v) of a triangle against the ray direction (dx, dy, dz)."""
    material, w = surfaces.face_material[face], 1.0 - u - v
    red, green, blue = surface_color(surfaces, face, w, u, v)
    if surfaces.shading[material] != _UNLIT:
        nx, ny, nz = shading_normal(surfaces, face, w, u, v, dx, dy, dz)
        shininess = surfaces.shininess[material]
        sr = sg = sb = 0.0
        if surfaces.shading[material] == _PHONG:
            sr, sg, sb = surfaces.specular[material, 0], surfaces.specular[material, 1], surfaces.specular[material, 2]
        red, green, blue = lit(surfaces, (nx, ny, nz), (dx, dy, dz), (red, green, blue), (sr, sg, sb), shininess)
    er, eg, eb = emitted(surfaces, face, w, u, v)
    return red + er, green + eg, blue + eb


@inline
def surface_color(surfaces, face, w, u, v):
    """Albedo at barycentrics (w, u, v): base colour times vertex colour times texture."""
    material, a = surfaces.face_material[face], surfaces.attribute
    red = surfaces.base_color[material, 0] * (w * a[face, 0] + u * a[face, 3] + v * a[face, 6])
    green = surfaces.base_color[material, 1] * (w * a[face, 1] + u * a[face, 4] + v * a[face, 7])
    blue = surfaces.base_color[material, 2] * (w * a[face, 2] + u * a[face, 5] + v * a[face, 8])
    if surfaces.texture[material, 1] > 0:
        tr, tg, tb = _texel(surfaces, surfaces.texture[material], face, w, u, v)
        red, green, blue = red * tr, green * tg, blue * tb
    return red, green, blue


@inline
def emitted(surfaces, face, w, u, v):
    """Emission at barycentrics (w, u, v): the material's times its texture."""
    material = surfaces.face_material[face]
    red, green, blue = surfaces.emission[material, 0], surfaces.emission[material, 1], surfaces.emission[material, 2]
    if surfaces.emission_texture[material, 1] > 0:
        tr, tg, tb = _texel(surfaces, surfaces.emission_texture[material], face, w, u, v)
        red, green, blue = red * tr, green * tg, blue * tb
    return red, green, blue


@inline
def shading_normal(surfaces, face, w, u, v, dx, dy, dz):
    """Unit normal at barycentrics (w, u, v), on the side of the triangle that the ray meets.

    The triangle decides, not the interpolated normal: near a silhouette that may lean away from the viewer.
    """
    a, c = surfaces.attribute, surfaces.corner
    ex, ey, ez = c[face, 3] - c[face, 0], c[face, 4] - c[face, 1], c[face, 5] - c[face, 2]
    fx, fy, fz = c[face, 6] - c[face, 0], c[face, 7] - c[face, 1], c[face, 8] - c[face, 2]
    gx, gy, gz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    nx = w * a[face, 15] + u * a[face, 18] + v * a[face, 21]
    ny = w * a[face, 16] + u * a[face, 19] + v * a[face, 22]
    nz = w * a[face, 17] + u * a[face, 20] + v * a[face, 23]
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length == 0.0:  # opposite corner normals cancel
        nx, ny, nz, length = -dx, -dy, -dz, math.sqrt(dx * dx + dy * dy + dz * dz)
    away = (gx * dx + gy * dy + gz * dz > 0.0) == (gx * nx + gy * ny + gz * nz > 0.0)
    flip = -1.0 / length if away else 1.0 / length
    return nx * flip, ny * flip, nz * flip


@inline
def lit(surfaces, normal, direction, albedo, specular, shininess):
    """Linear RGB: albedo times irradiance, plus what `specular` mirrors of a ray's direction; `normal` has length 1."""
    (nx, ny, nz), (dx, dy, dz), (red, green, blue), (sr, sg, sb) = normal, direction, albedo, specular
    light = surfaces.light
    cosine = max(0.0, nx * light[0, 0] + ny * light[0, 1] + nz * light[0, 2])
    dome = 0.5 + 0.5 * (nx * light[4, 0] + ny * light[4, 1] + nz * light[4, 2])
    red *= light[1, 0] * cosine + light[3, 0] + (light[2, 0] - light[3, 0]) * dome
    green *= light[1, 1] * cosine + light[3, 1] + (light[2, 1] - light[3, 1]) * dome
    blue *= light[1, 2] * cosine + light[3, 2] + (light[2, 2] - light[3, 2]) * dome
    if sr > 0.0 or sg > 0.0 or sb > 0.0:
        twice = -2.0 * (nx * dx + ny * dy + nz * dz)
        rx, ry, rz = dx + twice * nx, dy + twice * ny, dz + twice * nz
        largest = max(abs(rx), abs(ry), abs(rz))
        if largest > 1e100:  # before squaring: rays of a huge lens are that steep
            rx, ry, rz = rx / largest, ry / largest, rz / largest
        length = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz)
        rx, ry, rz = rx * length, ry * length, rz * length
        lobe = max(0.0, rx * light[0, 0] + ry * light[0, 1] + rz * light[0, 2]) ** shininess
        er, eg, eb = _environment(surfaces, rx, ry, rz)
        red += sr * (light[1, 0] * lobe + er)
        green += sg * (light[1, 1] * lobe + eg)
        blue += sb * (light[1, 2] * lobe + eb)
    return red, green, blue


@inline
def _environment(surfaces, x, y, z):
    """What a mirror sees in camera-space direction (x, y, z): octahedral map, bilinear, [2]."""
    m, light, image = surfaces.world_from_camera, surfaces.light, surfaces.environment
    wx = m[0, 0] * x + m[0, 1] * y + m[0, 2] * z
    wy = m[1, 0] * x + m[1, 1] * y + m[1, 2] * z
    wz = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z
    size = image.shape[0]
    if size == 0:
        dome = 0.5 + 0.5 * wy
        return (
            light[3, 0] + (light[2, 0] - light[3, 0]) * dome,
            light[3, 1] + (light[2, 1] - light[3, 1]) * dome,
            light[3, 2] + (light[2, 2] - light[3, 2]) * dome,
        )
    total = abs(wx) + abs(wy) + abs(wz)
    p, q = wx / total, wz / total
    if wy < 0.0:  # the lower half folds over the edges
        p, q = (1.0 - abs(q)) * (1.0 if p >= 0.0 else -1.0), (1.0 - abs(p)) * (1.0 if q >= 0.0 else -1.0)
    fx = _inside((p * 0.5 + 0.5) * size - 0.5, size - 1.0)
    fy = _inside((q * 0.5 + 0.5) * size - 0.5, size - 1.0)
    i, j = int(fx), int(fy)
    k, n = min(i + 1, size - 1), min(j + 1, size - 1)
    a, b = fx - i, fy - j
    return (
        bilinear(image[j, i, 0], image[j, k, 0], image[n, i, 0], image[n, k, 0], a, b),
        bilinear(image[j, i, 1], image[j, k, 1], image[n, i, 1], image[n, k, 1], a, b),
        bilinear(image[j, i, 2], image[j, k, 2], image[n, i, 2], image[n, k, 2], a, b),
    )


@inline
def _inside(place, last):
    """A place cut to 0 .. last, so that it is an index whatever the numbers were; 0 if it is none."""
    return min(place, last) if place > 0.0 else 0.0


@inline
def _texel(surfaces, texture, face, w, u, v):
    """Bilinear lookup of a texture at barycentrics (w, u, v)."""
    a, texels = surfaces.attribute, surfaces.texels
    s = w * a[face, 9] + u * a[face, 11] + v * a[face, 13]
    t = w * a[face, 10] + u * a[face, 12] + v * a[face, 14]
    p, q, r, o, right, down = texel_weights(texture, s, t)
    return (
        bilinear(texels[p, 0], texels[q, 0], texels[r, 0], texels[o, 0], right, down),
        bilinear(texels[p, 1], texels[q, 1], texels[r, 1], texels[o, 1], right, down),
        bilinear(texels[p, 2], texels[q, 2], texels[r, 2], texels[o, 2], right, down),
    )
