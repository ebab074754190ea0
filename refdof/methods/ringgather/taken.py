"""Taken: colour and depth together, circles without sign, and what is nearest, greatest and least around tiles.

All of a row of tiles is made while its pixels are in the cache.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof.image.channels import join_row
from refdof.methods.ringgather.params import TILE
from refdof.raster.filters.tiles import Tiles, reduce_row

__all__ = ["FARTHEST", "Taken", "taken"]

FARTHEST = 1e30  # of a depth, which may be infinite


class Taken(NamedTuple):
    """texels (H, W, 4): colour and depth; circle (H, W), px of half the size; of tiles and those around, (h, w)."""

    texels: Float
    circle: Float
    nearest: Float
    greatest: Float
    least: Float


def taken(color: Float, depth: Float, coc: Float, largest_px: float) -> Taken:
    """Of a picture (H, W, 3), depth and circles (H, W), all of one type."""
    texels, circle = np.empty((*coc.shape, 4), dtype=color.dtype), np.empty_like(coc)
    depths, circles = (Tiles.empty(coc.shape, TILE, coc.dtype) for _ in range(2))
    _take(color, depth, coc, largest_px, TILE, (texels, circle), depths, circles)
    around = circles.dilated()
    return Taken(texels, circle, depths.dilated().least, around.greatest, around.least)


@kernel
def _take(color, depth, coc, largest_px, side, out, depths, circles):
    (height, width), scalar = coc.shape, coc.dtype.type
    largest, far = scalar(largest_px), scalar(FARTHEST)
    for tile in prange(len(circles[0])):
        first, end = tile * side, min((tile + 1) * side, height)
        texels, circle, near = borrow(out[0]), borrow(out[1]), np.empty((end - first, width), dtype=coc.dtype)
        for y in range(first, end):
            _cut(borrow(depth)[y], far, near[y - first])
            join_row(borrow(color)[y], near[y - first], texels[y])
            _shrink(borrow(coc)[y], largest, circle[y])
        reduce_row(near, side, borrow(depths[0])[tile], borrow(depths[1])[tile])
        reduce_row(circle[first:end], side, borrow(circles[0])[tile], borrow(circles[1])[tile])


@inline
def _cut(depth, far, out):
    for x in range(len(depth)):
        out[x] = min(depth[x], far)


@inline
def _shrink(coc, largest, circle):
    """Circles without sign, cut, in pixels of half the size."""
    half = coc.dtype.type(0.5)
    for x in range(len(coc)):
        circle[x] = min(abs(coc[x]), largest) * half
