"""Planar padded images: taps at one offset for all pixels become contiguous loads.

A tap whose offset is the same for every pixel reads a shifted copy of the whole image. With planes (C, H, W), padded
by repeating the border (clamp to edge), the inner loop over x has no bounds, no branches and unit stride.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["Tap", "pad_planes", "tap_of"]


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


def pad_planes(image: Float, margin: int) -> Float:
    """Planes (C, H + 2 margin, W + 2 margin) of an image (H, W, C) or (H, W), borders repeated."""
    planes = image[None] if image.ndim == 2 else np.moveaxis(image, -1, 0)
    return np.ascontiguousarray(np.pad(planes, ((0, 0), (margin, margin), (margin, margin)), mode="edge"))
