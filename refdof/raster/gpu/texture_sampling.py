"""Texture sampling: bilinear and trilinear reads of many points, and the rules by which texels are blended.

1. find the four texels around a point, and weights      `split`
2. blend them by plain arithmetic, if that may do        `_blend`
3. by the model's rules, if it may not or did not        `bilinear_at`
4. blend two levels, one level of all points at a time   `read_level`

Plain arithmetic differs from the strict rules only where it gives infinities or NaN, or a weight is rounded to 1.
Models that fuse or flush, and borders, always take the rules. A kernel takes `Rules` as an argument. Images, weights
and colours are of one type; only the exact model has float64.
"""

from typing import NamedTuple

import numpy as np

from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._jit.texel_registers import blend_texels
from refdof.raster.gpu.gpu_model import GpuModel

__all__ = [
    "Rules",
    "bilinear_at",
    "fused_multiply_add",
    "lerp",
    "read_level",
    "read_points",
    "rules_of",
    "split",
    "texel_at",
]

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
    scalar, real, coarser = out.dtype.type, u.dtype.type, borrow(coarser)
    height, width = real(texels[0].shape[0]), real(texels[0].shape[1])
    for k in range(begin, end):
        finer = int(np.floor(lod[k]))
        if finer == level:
            _read(texels, u[k] * width, v[k] * height, real, how, k, out)
        elif finer == level - 1 and lod[k] > real(finer):
            _read(texels, u[k] * width, v[k] * height, real, how, 0, coarser)
            for c in range(out.shape[1]):
                out[k, c] = lerp(out[k, c], coarser[0, c], scalar(lod[k] - real(finer)), how[3])


@inline
def _read(texels, x, y, real, how, k, out):
    """Row k of out: a bilinear read at x, y [texels from the corner; type `real`]; texels: image, and flattened."""
    image, flat = texels
    rounded, _, bordered, rules = how
    scalar = out.dtype.type
    column, right = split(x, image.shape[1], rounded, bordered, real)
    row, below = split(y, image.shape[0], rounded, bordered, real)
    across, down = scalar(right), scalar(below)
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


class Rules(NamedTuple):
    """What kernels need to know of a `GpuModel`."""

    strict: bool
    fused: bool
    flush: bool


def rules_of(model: GpuModel) -> Rules:
    """The rules that kernels take."""
    return Rules(model.strict_weights, model.fused_lerp, model.flush_denormals)


@inline
def lerp(a, b, w, rules):
    """a + (b - a) w, all of one type. With strict rules a texel of weight 0 has no part, and equal infinities stay.

    But for the sign of a zero: that follows the sum.
    """
    if rules.strict:
        if w == 1:
            return b
        difference = b - a
        if np.isfinite(difference):
            return a + difference * w
        if w == 0 or a == b:
            return a
        return a * (w / w - w) + b * w  # infinite texels, or a difference beyond the type; w / w: a one of that type
    if rules.flush:
        a, b, w = _flush(a), _flush(b), _flush(w)
        difference = _flush(b - a)
        if rules.fused:
            return _flush(fused_multiply_add(difference, w, a))
        return _flush(a + _flush(difference * w))
    if rules.fused:
        return fused_multiply_add(b - a, w, a)
    return a + (b - a) * w


@inline
def fused_multiply_add(x, y, z):
    """x y + z of float32, rounded once.

    The product is exact in float64. The sum is rounded to float64 and then to float32, which goes wrong only where the
    first result lies midway between two float32 and was itself rounded: then what it lost decides. (Not so midway
    between the largest float32 and 2^128, which gives infinity.)
    """
    product = np.float64(x) * np.float64(y)
    wide = product + np.float64(z)
    near = np.float32(wide)
    back = wide - product
    lost = (product - (wide - back)) + (np.float64(z) - back)
    if lost == 0 or not np.isfinite(near) or wide == np.float64(near):
        return near
    other = np.nextafter(near, np.float32(np.inf) if wide > np.float64(near) else np.float32(-np.inf))
    if 0.5 * (np.float64(near) + np.float64(other)) == wide and (lost > 0) == (other > near):
        return other
    return near


@inline
def _flush(x):
    """0 of the same sign for a float32 below 2^-126."""
    return np.float32(np.copysign(0.0, x)) if abs(x) < 1.1754943508222875e-38 else x


@inline
def split(x, size, rounded, bordered, real):
    """The first of two texels that x [texels from the corner] lies between, and the weight of the second.

    All in the type `real`; `rounded` keeps 8 bits. Without a border the first is in 0 .. size - 1: beyond the first
    centre the second texel has weight 0, but is read.
    """
    least, most = real(-1 if bordered else 0), real(size if bordered else size - 1)
    centred = min(max(x - real(0.5), least), most)
    if rounded:
        centred = real(np.floor(centred * real(256) + real(0.5))) / real(256)
    first = real(np.floor(centred))
    return np.int64(first), centred - first


@inline
def texel_at(image, x, y, c, border, bordered):
    """Channel c of texel (x, y); outside, the border's colour (C,) or the edge's."""
    height, width = image.shape[0], image.shape[1]
    if bordered and (x < 0 or y < 0 or x >= width or y >= height):
        return border[c]
    return image[min(max(y, 0), height - 1), min(max(x, 0), width - 1), c]


@inline
def bilinear_at(image, x, y, wx, wy, c, border, bordered, rules):
    """Channel c between texels (x, y) and (x + 1, y + 1); weights have the image's type."""
    a = lerp(texel_at(image, x, y, c, border, bordered), texel_at(image, x + 1, y, c, border, bordered), wx, rules)
    y = y + 1
    b = lerp(texel_at(image, x, y, c, border, bordered), texel_at(image, x + 1, y, c, border, bordered), wx, rules)
    return lerp(a, b, wy, rules)
