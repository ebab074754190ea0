"""Bilinear and trilinear reads of many points, for textures of floats.

1. find the four texels around a point, and weights     `refdof.raster.filters.split`
2. blend them by plain arithmetic                       `_blend`
3. once more by the model's rules where they differ     `refdof.raster.filters.bilinear_at`
4. blend two levels                                     `read_levels`

Plain arithmetic differs from the strict rules only where it gives infinities or NaN, or a weight is rounded to 1.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._vectors import blend_texels
from refdof.raster.filters import bilinear_at, lerp, split

__all__ = ["read_levels", "read_points"]

_CHUNK = 1024  # points that one iteration reads


@kernel
def read_points(image, x, y, scale_x, scale_y, rounded, border, bordered, rules):
    """Bilinear reads (N, C) of an image of floats at x, y (N,), which times the scales are in texels."""
    height, width, channels = image.shape
    out = np.empty((len(x), channels), dtype=image.dtype)
    flat = image.reshape(-1, channels)
    for chunk in prange((len(x) + _CHUNK - 1) // _CHUNK):
        texels, reads, how = borrow(flat), borrow(out), (rounded, borrow(border), bordered, rules)
        for k in range(chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(x))):
            _read(texels, 0, height, width, x[k] * scale_x, y[k] * scale_y, x.dtype.type, how, k, reads)
    return out


@kernel
def read_levels(flat, starts, sizes, first, u, v, lod, rounded, border, bordered, rules, out):
    """Trilinear reads out (N, C) at u, v, lod (N,) of levels that lie one after the other in flat (T, C).

    starts (L,): the levels' first texels; sizes (L, 2): their heights and widths; `first`: the first one's number.
    """
    for chunk in prange((len(u) + _CHUNK - 1) // _CHUNK):
        begin, end = chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(u))
        places, how = (borrow(u), borrow(v), borrow(lod)), (rounded, borrow(border), bordered, rules)
        levels = borrow(flat), borrow(starts), borrow(sizes), first
        coarser = np.empty((end - begin, flat.shape[1]), dtype=flat.dtype)
        _read_chunk(levels, places, how, begin, end, coarser, borrow(out))


@inline
def _read_chunk(levels, places, how, begin, end, coarser, out):
    """Points begin .. end - 1 of `read_levels`: first the finer levels of all, for one read after the other waits."""
    flat, starts, sizes, first = levels
    u, v, lod = places
    own, real, coarser = flat.dtype.type, u.dtype.type, borrow(coarser)
    for k in range(begin, end):
        level = int(np.floor(lod[k])) - first
        height, width = sizes[level, 0], sizes[level, 1]
        x, y = u[k] * real(width), v[k] * real(height)
        _read(flat, starts[level], height, width, x, y, real, how, k, out)
    for k in range(begin, end):
        below = int(np.floor(lod[k]))
        weight, level = own(lod[k] - real(below)), below + 1 - first
        if weight > 0:
            height, width = sizes[level, 0], sizes[level, 1]
            x, y = u[k] * real(width), v[k] * real(height)
            _read(flat, starts[level], height, width, x, y, real, how, k - begin, coarser)
            for c in range(flat.shape[1]):
                out[k, c] = lerp(out[k, c], coarser[k - begin, c], weight, how[3])


@inline
def _read(flat, start, height, width, x, y, real, how, k, out):
    """Row k of out: a bilinear read at x, y [texels from the corner; type `real`] of the image from texel `start`."""
    rounded, border, bordered, rules = how
    own = flat.dtype.type
    column, right = split(x, width, rounded, bordered, real)
    row, below = split(y, height, rounded, bordered, real)
    across, down = own(right), own(below)
    if not (bordered or rules.fused or rules.flush) and max(across, down) < 1:
        corner, stride = start + row * width + column, width if row + 1 < height else 0
        if _blend(flat, corner, 1 if column + 1 < width else 0, stride, across, down, k, out):
            return
    image = flat[start : start + height * width]
    _read_by_rules(image, width, column, row, across, down, border, bordered, rules, k, out)


@tile_kernel
def _read_by_rules(flat, width, column, row, across, down, border, bordered, rules, k, out):
    image = flat.reshape(len(flat) // width, width, flat.shape[1])
    for c in range(flat.shape[1]):
        out[k, c] = bilinear_at(image, column, row, across, down, c, border, bordered, rules)


@inline
def _blend(flat, corner, step, stride, across, down, k, out):
    """Row k of out by plain arithmetic, and whether its sum is finite."""
    a, b, c, d = corner, corner + step, corner + stride, corner + step + stride
    total = flat.dtype.type(0)
    if flat.shape[1] == 4:
        red, green, blue, alpha = blend_texels(flat, a, b, c, d, across, down)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = red, green, blue, alpha
        total = red + green + blue + alpha
    else:
        for n in range(flat.shape[1]):
            upper = flat[a, n] + (flat[b, n] - flat[a, n]) * across
            lower = flat[c, n] + (flat[d, n] - flat[c, n]) * across
            out[k, n] = upper + (lower - upper) * down
            total += out[k, n]
    return np.isfinite(total)
