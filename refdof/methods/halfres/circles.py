"""Circles: how much each pixel blurs, in front and behind, 0 .. 1; and the near one spread over its neighbours."""

import math
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from refdof._check import Float
from refdof.methods.halfres.params import Params
from refdof.raster.filters.resize import corner_means, resize

__all__ = ["Circles", "circles_of", "kept_shares"]

_GAUSSIAN = np.exp([-i * i / (2.0 * (7.0 / 3.0) ** 2) for i in range(-6, 7)])
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
    if params.circles == "smoothstep":
        behind = depth >= kind(params.focus_plane)
        t = np.minimum(np.abs(depth - kind(params.focus_plane)) / kind(params.focus_range), kind(1))
        blur, before = t * t * (kind(3) - kind(2) * t), depth <= kind(params.focus_plane)
    else:
        behind, before = coc >= 0, coc <= 0
        wide = np.abs(coc.astype(np.float64))  # a largest circle may be smaller than any float32
        blur = wide / params.largest_px if params.largest_px > 0 else np.zeros_like(wide)
        blur = np.minimum(blur, 1.0).astype(coc.dtype)
    near, far = np.where(before, blur, kind(0)), np.where(behind, blur, kind(0))
    size = max(1, round_half_up(coc.shape[0] / 2)), max(1, round_half_up(coc.shape[1] / 2))
    if params.variant == "pmndrs":
        near, far = _in_8_bits(near), _in_8_bits(far)
        spread = _kawase(_packed(near, far), size)
        return Circles(near, far, spread[..., 0].copy(), resize(_packed(near, far), *size)[..., 1].copy())
    weights = _GAUSSIAN / _GAUSSIAN.sum()
    smooth = near
    for axis in (1, 0):
        smooth = ndimage.correlate1d(smooth, weights, axis, mode="nearest")
    half = resize(_packed(smooth, far), *size)
    return Circles(near, far, half[..., 0].copy(), half[..., 1].copy())


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
