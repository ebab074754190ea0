"""Bilinear and trilinear reads of many points, for textures of floats.

1. find the four texels around a point, and weights      `refdof.raster.filters.split`
2. blend them by plain arithmetic, if that may do        `_blend`
3. by the model's rules, if it may not or did not        `refdof.raster.filters.bilinear_at`
4. blend two levels, one level of all points at a time   `read_level`

Plain arithmetic differs from the strict rules only where it gives infinities or NaN, or a weight is rounded to 1.
Models that fuse or flush, and borders, always take the rules.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._vectors import blend_texels
from refdof.raster.filters import bilinear_at, lerp, split

__all__ = ["read_level", "read_points"]

_CHUNK = 1024  # points that one iteration reads


@kernel
def read_points(image, x, y, scale_x, scale_y, rounded, border, bordered, rules):
    """Bilinear reads (N, C) of an image of floats at x, y (N,), which times the scales are in texels."""
    out, flat = np.empty((len(x), image.shape[2]), dtype=image.dtype), image.reshape(-1, image.shape[2])
    for chunk in prange((len(x) + _CHUNK - 1) // _CHUNK):
        texels, reads, how = (borrow(image), borrow(flat)), borrow(out), (rounded, borrow(border), bordered, rules)
        for k in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(x))):
            _read(texels, x[k] * scale_x, y[k] * scale_y, x.dtype.type, how, k, reads)
    return out


@kernel
def read_level(image, level, points, rounded, border, bordered, rules, out):
    """Write reads out (N, C) at points u, v, lod (N,) of a level that is the finer of two; blend in the coarser."""
    (u, v, lod), flat = points, image.reshape(-1, image.shape[2])
    for chunk in prange((len(u) + _CHUNK - 1) // _CHUNK):
        begin, end = chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(u))
        places, how = (borrow(u), borrow(v), borrow(lod)), (rounded, borrow(border), bordered, rules)
        coarser = np.empty((1, out.shape[1]), dtype=out.dtype)
        _read_chunk((borrow(image), borrow(flat)), level, places, how, begin, end, coarser, borrow(out))


@inline
def _read_chunk(texels, level, places, how, begin, end, coarser, out):
    """Points begin .. end - 1 of `read_level`."""
    u, v, lod = places
    own, real, coarser = out.dtype.type, u.dtype.type, borrow(coarser)
    height, width = real(texels[0].shape[0]), real(texels[0].shape[1])
    for k in range(begin, end):
        finer = int(np.floor(lod[k]))
        if finer == level:
            _read(texels, u[k] * width, v[k] * height, real, how, k, out)
        elif finer == level - 1 and lod[k] > real(finer):
            _read(texels, u[k] * width, v[k] * height, real, how, 0, coarser)
            for c in range(out.shape[1]):
                out[k, c] = lerp(out[k, c], coarser[0, c], own(lod[k] - real(finer)), how[3])


@inline
def _read(texels, x, y, real, how, k, out):
    """Row k of out: a bilinear read at x, y [texels from the corner; type `real`]; texels: image, and flattened."""
    image, flat = texels
    rounded, _, bordered, rules = how
    own = out.dtype.type
    column, right = split(x, image.shape[1], rounded, bordered, real)
    row, below = split(y, image.shape[0], rounded, bordered, real)
    across, down = own(right), own(below)
    plain = not (bordered or rules.fused or rules.flush) and max(across, down) < 1
    if not (plain and _blend(flat, image.shape, column, row, across, down, k, out)):
        _read_by_rules(image, column, row, across, down, how, out[k])


@tile_kernel
def _read_by_rules(image, column, row, across, down, how, out):
    _, border, bordered, rules = how
    for c in range(image.shape[2]):
        out[c] = bilinear_at(image, column, row, across, down, c, border, bordered, rules)


@inline
def _blend(flat, shape, column, row, across, down, k, out):
    """Row k of out by plain arithmetic, and whether its sum is finite."""
    height, width, channels = shape
    a = row * width + column
    c = a + width if row + 1 < height else a
    step = 1 if column + 1 < width else 0
    b, d = a + step, c + step
    total = out.dtype.type(0)
    if channels == 4:
        red, green, blue, alpha = blend_texels(flat, a, b, c, d, across, down)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = red, green, blue, alpha
        total = red + green + blue + alpha
    else:
        for n in range(channels):
            upper = flat[a, n] + (flat[b, n] - flat[a, n]) * across
            lower = flat[c, n] + (flat[d, n] - flat[c, n]) * across
            out[k, n] = upper + (lower - upper) * down
            total += out[k, n]
    return np.isfinite(total)
