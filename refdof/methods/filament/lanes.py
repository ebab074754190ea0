"""Lanes: pixels of one row that take as many rings, so that each tap is taken for all of them at once.

Circles and distances are in pixels of the picture. Rings are numbered from the centre, ring i of 8 i taps in pairs that
are opposite to each other; odd rings begin at half a step. The centre is a pair, too, of one tap that counts half.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof._jit.texel_lanes import LANES, fetch_lanes

__all__ = [
    "MOST_LANES", "MOST_RINGS", "Lanes", "clipped", "distances", "fetch_pair", "lanes_of", "light_of", "pairs",
    "place_taps", "ring_pairs",
]  # fmt: skip

MOST_RINGS = 5
MOST_LANES = 8 * LANES  # what a tap touches stays in the nearest cache
_AREA = 32.0 * 32.0
# From these distances of rings [px] on, texels of levels 1, 2 and 3 are as far apart; halves of a level are rounded up.
_FIRST, _SECOND, _THIRD = 2.0**1.5, 2.0**2.5, 2.0**3.5


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


def ring_pairs() -> Float:
    """The first tap of each pair of rings 0 .. 4, (41, 2) [distances of rings]; y down."""
    found = [np.zeros((1, 2))]
    for ring in range(1, MOST_RINGS):
        angles = (np.arange(4 * ring) + 0.5 * (ring % 2)) * (2.0 * np.pi / (8 * ring))
        found.append(ring * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.concatenate(found)


@inline
def pairs(ring):
    """The first pair of a ring, and how many there are."""
    return (1 + 2 * ring * (ring - 1), 4 * ring) if ring > 0 else (0, 1)


@inline
def place_taps(lanes, count, rings, y, moved, levels):
    """From column and circle of `count` pixels of row y: all other numbers. moved (w, 2); levels (3, 4) int32."""
    kind = lanes.circle.dtype.type
    half, one, v = kind(0.5), kind(1), kind(y) + kind(0.5)
    first, second, third = kind(_FIRST), kind(_SECOND), kind(_THIRD)
    for n in range(count):
        apart, column = lanes.circle[n] / (kind(rings) - half), lanes.column[n]
        level = (1 if apart >= first else 0) + (1 if apart >= second else 0) + (1 if apart >= third else 0)
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


@inline
def light_of(circle, least):
    """Light of a tap by the area that it spreads over."""
    return type(circle)(_AREA) / max(circle * circle, least)


@inline
def clipped(number):
    """Cut to [0, 1]."""
    kind = type(number)
    return min(max(number, kind(0)), kind(1))
