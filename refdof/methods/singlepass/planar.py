"""Planar padded images: taps at one offset for all pixels become contiguous loads.

A tap whose offset is the same for every pixel reads a shifted copy of the whole image. With planes (C, H, W), padded
by repeating the border (clamp to edge), the inner loop over x has no bounds, no branches and unit stride.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["Tap", "blend_of_four", "mix_of_four", "pad_each", "pad_planes", "tap_of", "window"]

_PADDING = {"clamp": "edge", "repeat": "wrap", "mirror": "symmetric"}  # OpenGL's wrap modes as NumPy calls them


class Tap(NamedTuple):
    """A constant offset: whole texels and the bilinear weights of the next texel right and below."""

    x: int
    y: int
    weight_x: float
    weight_y: float


def tap_of(dx: float, dy: float) -> Tap:
    """Split an offset [px], y down, into texels and weights in [0, 1]."""
    x, y = math.floor(dx), math.floor(dy)
    return Tap(x, y, dx - x, dy - y)


def pad_planes(image: Float, margin: int, border: str = "clamp") -> Float:
    """Planes (C, H + 2 margin, W + 2 margin) of an image (H, W, C) or (H, W), borders repeated."""
    return pad_each([image] if image.ndim == 2 else list(np.moveaxis(image, -1, 0)), margin, border)


def pad_each(planes: Sequence[Float], margin: int, border: str = "clamp") -> Float:
    """`pad_planes` of planes (H, W) that are apart."""
    height, width = planes[0].shape
    out = np.empty((len(planes), height + 2 * margin, width + 2 * margin), dtype=planes[0].dtype)
    for padded, plane in zip(out, planes, strict=True):
        padded[...] = np.pad(plane, margin, mode=_PADDING[border])  # type: ignore[call-overload]
    return out


def window(planes: Float, margin: int, x: int, y: int) -> Float:
    """What all pixels read at an offset of whole texels: a view (C, H, W) of planes with a margin."""
    height, width = planes.shape[1] - 2 * margin, planes.shape[2] - 2 * margin
    return planes[:, margin + y : margin + y + height, margin + x : margin + x + width]


def blend_of_four(planes: Float, margin: int, x: int, y: int, weights: Float) -> Float:
    """What all pixels read between texels (x, y) and (x + 1, y + 1): (C, H, W), blended along x first."""
    first, second = (
        left + (right - left) * weights[0] for left, right in (_pair(planes, margin, x, row) for row in (y, y + 1))
    )
    return first + (second - first) * weights[1]


def mix_of_four(planes: Float, margin: int, x: int, y: int, weights: Float) -> Float:
    """`blend_of_four` for numbers of any ratio: a weight of 1 gives the second one, to the bit."""
    one = weights.dtype.type(1)
    first, second = (
        left * (one - weights[0]) + right * weights[0]
        for left, right in (_pair(planes, margin, x, row) for row in (y, y + 1))
    )
    return first * (one - weights[1]) + second * weights[1]


def _pair(planes: Float, margin: int, x: int, y: int) -> tuple[Float, Float]:
    return window(planes, margin, x, y), window(planes, margin, x + 1, y)
