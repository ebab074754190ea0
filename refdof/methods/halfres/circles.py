"""Circles: how much each pixel blurs, in front and behind, 0 .. 1; and the near one spread over its neighbours."""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.image.bilinear import texels_around
from refdof.methods._image_validation import depth_in_unit
from refdof.methods.halfres.params import Params
from refdof.raster.filters.resize import corner_means, resize

__all__ = ["Circles", "circles_of", "kept_shares"]

_REACH = 6  # px: of the Gaussian
_GAUSSIAN = np.exp([-i * i / (2.0 * (7.0 / 3.0) ** 2) for i in range(-_REACH, _REACH + 1)])
_KAWASE = (0, 1, 1, 2)
_LEVELS = 255.0


class Circles(NamedTuple):
    """Blur 0 .. 1. near and far are the picture's, (H, W); others are of half its size, (h, w)."""

    near: Float
    far: Float
    spread_near: Float
    far_half: Float


def circles_of(depth: Float, coc: Float, params: Params) -> Circles:
    """Blur of a picture's pixels."""
    kind = coc.dtype.type
    near, far = np.zeros_like(coc), np.zeros_like(coc)
    if params.circles == "smoothstep":
        depth = depth_in_unit(kind, depth)
        t = np.minimum(np.abs(depth - kind(params.focus_plane)) / kind(params.focus_range), kind(1))
        blur = t * t * (kind(3) - kind(2) * t)
        np.copyto(near, blur, where=depth <= kind(params.focus_plane))
        np.copyto(far, blur, where=depth >= kind(params.focus_plane))
    elif params.largest_px > 0:
        _share_out(coc, params.largest_px, near, far)
    size = max(1, round_half_up(coc.shape[0] / 2)), max(1, round_half_up(coc.shape[1] / 2))
    if params.variant == "pmndrs":
        near, far = _in_8_bits(near), _in_8_bits(far)
        spread = _kawase(_packed(near, far), size)
        return Circles(near, far, spread[..., 0].copy(), resize(_packed(near, far), *size)[..., 1].copy())
    spread, half = np.empty(size, dtype=coc.dtype), np.empty(size, dtype=coc.dtype)
    weights = (_GAUSSIAN / _GAUSSIAN.sum()).astype(coc.dtype)
    _halve(_spread_along(near, weights), far, weights, spread, half)
    return Circles(near, far, spread, half)


@kernel
def _share_out(coc, largest_px, near, far):
    """Set near and far to circles over their largest, up to 1, by sign: (H, W) each."""
    scalar = coc.dtype.type
    for y in prange(len(coc)):
        before, behind, circles = borrow(near)[y], borrow(far)[y], borrow(coc)[y]
        for x in range(len(circles)):
            # In float64: a largest circle may be smaller than any float32.
            blur = scalar(min(abs(np.float64(circles[x])) / largest_px, 1.0))
            before[x] = blur if circles[x] <= scalar(0) else scalar(0)
            behind[x] = blur if circles[x] >= scalar(0) else scalar(0)


@kernel
def _spread_along(near, weights):
    """The Gaussian along rows (H, W); beyond the edge it repeats."""
    height, width = near.shape
    out = np.zeros_like(near)
    for y in prange(height):
        row, wide, source = borrow(out)[y], np.empty(width + 2 * _REACH, dtype=near.dtype), borrow(near)[y]
        wide[:_REACH], wide[_REACH : _REACH + width], wide[_REACH + width :] = source[0], source, source[width - 1]
        for k in range(len(weights)):
            _add(wide[k : k + width], weights[k], row)
    return out


@kernel
def _halve(smooth, far, weights, near_half, far_half):
    """The Gaussian along columns of smooth (H, W), and far (H, W), read around the pixel centres of half the size."""
    (height, width), (rows, columns), scalar = smooth.shape, near_half.shape, smooth.dtype.type
    half, right, down = scalar(0.5), scalar(width / columns), scalar(height / rows)
    for y in prange(rows):
        lines, first, other = np.zeros((2, width), smooth.dtype), borrow(smooth), borrow(far)
        upper, lower, between = texels_around((scalar(y) + half) * down, height)
        for k in range(-_REACH, _REACH + 1):
            weight = weights[k + _REACH]
            _add(first[min(max(upper + k, 0), height - 1)], weight * (scalar(1) - between), lines[0])
            _add(first[min(max(lower + k, 0), height - 1)], weight * between, lines[0])
        _add(other[upper], scalar(1) - between, lines[1])
        _add(other[lower], between, lines[1])
        before, behind = borrow(near_half)[y], borrow(far_half)[y]
        for x in range(columns):
            a, b, share = texels_around((scalar(np.int32(x)) + half) * right, width)
            before[x] = lines[0, a] + (lines[0, b] - lines[0, a]) * share
            behind[x] = lines[1, a] + (lines[1, b] - lines[1, a]) * share


@inline
def _add(source, weight, total):
    for x in range(len(total)):
        total[x] += weight * source[x]


def kept_shares(circles: Circles, reach: float) -> Float:
    """How much of each pixel the far and the near picture of the variant "pmndrs" replace: (2, H, W)."""
    kind = circles.far.dtype.type
    near = resize(_packed(circles.spread_near, circles.spread_near), *circles.far.shape)[..., 0]
    return np.minimum(np.stack([circles.far, near]) * kind(reach), kind(1))


def round_half_up(x: float) -> int:
    """As shading hosts round a size: halves up."""
    return math.floor(x + 0.5)


def _packed(near: Float, far: Float) -> Float:
    """Both in the first channels of a picture (H, W, 4)."""
    out = np.zeros((*near.shape, 4), dtype=near.dtype)
    out[..., 0], out[..., 1] = near, far
    return out


def _in_8_bits(values: Float) -> Float:
    """The nearest of 256 levels; half-way, which means of four often are, the upper one, whatever their roundings."""
    kind = values.dtype.type
    return np.floor(values * kind(_LEVELS) + kind(0.5 + 2.0**-10)) / kind(_LEVELS)


def _kawase(image: Float, size: tuple[int, int]) -> Float:
    """Means of four reads at the corners of ever larger squares, stored in 8 bits each time: (H, W, 4) -> (h, w, 4)."""
    for k in _KAWASE:
        image = _in_8_bits(corner_means(image, *size, k + 0.5))
    return image
