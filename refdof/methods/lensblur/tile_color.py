"""Tile colour: what the rays of a tile see where all four texels to be blended are of the first layer and one surface.

That is so for nearly all rays; `refdof.methods.lensblur.texel_walk.neighbours` knows the rest, and gives the same.

1. the places of the four texels, and whether they are one surface's    `look_beside`
2. add their blend                                                          `add_beside`
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline
from refdof._jit.texel_sums import add_blend
from refdof.methods.lensblur.texel_walk import SAME_SURFACE
from refdof.methods.lensblur.tile_walk import part

__all__ = ["Beside", "add_beside", "look_beside", "new_beside"]


class Beside(NamedTuple):
    """For every ray of a tile, (TILE,) each: weights fx, fy; the first samples own, across, along and corner of the
    hit's texel and of those beside it; `same`: whether all are of one surface. Numbers of these texels, uint32.
    """

    fx: Float
    fy: Float
    own: Float
    across: Float
    along: Float
    corner: Float
    same: Float
    at_own: Index
    at_across: Index
    at_along: Index
    at_corner: Index


@inline
def new_beside(numbers, places):
    """`Beside` in the same memory as `Lanes`."""
    return Beside(
        part(numbers, 22),
        part(numbers, 23),
        part(numbers, 24),
        part(numbers, 25),
        part(numbers, 26),
        part(numbers, 27),
        part(numbers, 28),
        part(places, 1),
        part(places, 2),
        part(places, 3),
        part(places, 4),
    )


@inline
def look_beside(tops, lanes, beside, count):
    """Fill `Beside` for rays whose hits are in `lanes`; tops (H, W): the first layer."""
    scalar = lanes.x.dtype.type
    flat, width = tops.reshape(-1), np.int32(tops.shape[1])
    right, bottom = scalar(tops.shape[1] - 1), scalar(tops.shape[0] - 1)
    zero, half, one, reach = scalar(0.0), scalar(0.5), scalar(1.0), scalar(SAME_SURFACE)
    for k in range(count):
        x, y, u = lanes.hit_x[k], lanes.hit_y[k], lanes.best[k]
        over_x = lanes.ax[k] + u * lanes.wx[k] - x - half
        over_y = lanes.ay[k] + u * lanes.wy[k] - y - half
        beside.fx[k], beside.fy[k] = min(abs(over_x), half), min(abs(over_y), half)
        side_x = x + (one if over_x > zero else -one)
        side_y = y + (one if over_y > zero else -one)
        side_x, side_y = min(max(side_x, zero), right), min(max(side_y, zero), bottom)
        row, side_row = np.int32(y) * width, np.int32(side_y) * width
        beside.at_own[k] = np.uint32(row + np.int32(x))
        beside.at_across[k] = np.uint32(row + np.int32(side_x))
        beside.at_along[k] = np.uint32(side_row + np.int32(x))
        beside.at_corner[k] = np.uint32(side_row + np.int32(side_x))
    for k in range(count):
        beside.own[k] = flat[beside.at_own[k]]
        beside.across[k] = flat[beside.at_across[k]]
        beside.along[k] = flat[beside.at_along[k]]
        beside.corner[k] = flat[beside.at_corner[k]]
    for k in range(count):
        low, high = beside.own[k] - reach, beside.own[k] + reach
        across, along, corner = beside.across[k], beside.along[k], beside.corner[k]
        same = (across >= low) & (across <= high) & (along >= low) & (along <= high)
        same = same & (corner >= low) & (corner <= high) & (lanes.layer[k] == zero)
        beside.same[k] = one if same else zero


@inline
def add_beside(sums, k, weight, texels, beside):
    """Add to row k of sums (TILE, 4) the blend of texels (T, 4) that the k-th ray sees, times its weight."""
    own, across = np.int64(beside.at_own[k]), np.int64(beside.at_across[k])
    along, corner = np.int64(beside.at_along[k]), np.int64(beside.at_corner[k])
    add_blend(sums, k, weight, texels, own, across, along, corner, beside.fx[k], beside.fy[k])
