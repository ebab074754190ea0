"""Texture sampling: the rules by which texels are blended, one read at a time.

1. find the four texels around a point, and weights      `split`
2. blend them by the model's rules                       `bilinear_at`, `lerp`

A kernel takes `Rules` as an argument. Images, weights and colours are of one type; only the exact model has float64.
"""

from typing import NamedTuple

import numpy as np

from refdof._jit import inline
from refdof.raster.gpu.gpu_model import GpuModel

__all__ = [
    "Rules",
    "bilinear_at",
    "fused_multiply_add",
    "lerp",
    "rules_of",
    "split",
    "texel_at",
]


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
