"""Lanes: pixels of one row that take as many rings, so that each tap is taken for all of them at once."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof._jit.texel_lanes import LANES, fetch_lanes
from refdof.methods.filament.rings import level_of

__all__ = ["MOST_LANES", "Lanes", "distances", "fetch_pair", "lanes_of", "place_taps"]

MOST_LANES = 8 * LANES  # what a tap touches stays in the nearest cache


class Lanes(NamedTuple):
    """A number of every pixel each, (MOST_LANES,).

    column : of the pixel
    start, width : where its level begins, and how wide that is
    circle : radius of the rings
    apart : distance of rings
    across, down : how far the rings' centre is moved
    u, v : where it is [texels of the level]
    step : half the distance of rings, which is as much at half the size [texels of the level]
    scale, least : one over the side of the level's texels, and the least square of a circle there
    right, bottom : the level's last column and row
    """

    column: Index
    start: Index
    width: Index
    circle: Float
    apart: Float
    across: Float
    down: Float
    u: Float
    v: Float
    step: Float
    scale: Float
    least: Float
    right: Float
    bottom: Float


@inline
def lanes_of(whole, numbers):
    """Lanes in rows of whole (3, MOST_LANES) int32 and numbers (11, MOST_LANES)."""
    i, f = borrow(whole), borrow(numbers)
    return Lanes(i[0], i[1], i[2], f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10])


@inline
def place_taps(lanes, count, rings, y, moved, levels):
    """From column and circle of `count` pixels of row y: all other numbers. moved (w, 2); levels (3, 4) int32."""
    kind = lanes.circle.dtype.type
    half, one, v = kind(0.5), kind(1), kind(y) + kind(0.5)
    for n in range(count):
        apart, column = lanes.circle[n] / (kind(rings) - half), lanes.column[n]
        level = level_of(apart)
        lanes.start[n], lanes.width[n] = levels[0, level], levels[1, level]
        lanes.right[n], lanes.bottom[n] = kind(levels[1, level] - 1), kind(levels[2, level] - 1)
        scale = one / kind(np.int32(1 << level))
        lanes.apart[n], lanes.scale[n], lanes.least[n] = apart, scale, kind(np.int32(2 << level))
        lanes.across[n], lanes.down[n] = apart * moved[column, 0], apart * moved[column, 1]
        lanes.u[n] = (kind(column) + half + half * lanes.across[n]) * scale
        lanes.v[n] = (v + half * lanes.down[n]) * scale
        lanes.step[n] = half * apart * scale


@inline
def fetch_pair(source, lanes, count, across, down, places, taps):
    """Read a pair at (across, down) [distances of rings] and opposite: rows 0 .. 3 and 4 .. 7 of taps (8, N).

    The nearest texels are read; places (2, N) int32 is overwritten.
    """
    zero = taps.dtype.type(0)
    for n in range(count):
        i, j = lanes.step[n] * across, lanes.step[n] * down
        column = np.int32(min(max(lanes.u[n] + i, zero), lanes.right[n]))
        row = np.int32(min(max(lanes.v[n] + j, zero), lanes.bottom[n]))
        places[0, n] = lanes.start[n] + row * lanes.width[n] + column
        column = np.int32(min(max(lanes.u[n] - i, zero), lanes.right[n]))
        row = np.int32(min(max(lanes.v[n] - j, zero), lanes.bottom[n]))
        places[1, n] = lanes.start[n] + row * lanes.width[n] + column
    for n in range(0, count, LANES):
        fetch_lanes(source, places[0], n, taps[:4])
        fetch_lanes(source, places[1], n, taps[4:])


@inline
def distances(lanes, count, across, down, out):
    """How far a ring is from each pixel, by its first tap."""
    for n in range(count):
        u, v = lanes.apart[n] * across + lanes.across[n], lanes.apart[n] * down + lanes.down[n]
        out[n] = np.sqrt(u * u + v * v)
