"""Rings: the taps of a circle, the level that they are read from, and their light.

Circles and distances are in pixels of the picture. Rings are numbered from the centre, ring i of 8 i taps; odd rings
begin at half a step. The second half of a ring's taps is opposite to the first, so that they are taken in pairs. The
centre is a pair, too, of one tap that counts half.
"""

import numpy as np

from refdof._check import Float
from refdof._jit import inline

__all__ = ["ALIKE", "MOST_RINGS", "RING_TAPS", "clipped", "level_of", "light_of", "pairs", "ring_taps"]

MOST_RINGS = 5
ALIKE = 0.05  # how far the circles of a tile may be apart, of the greatest, to be taken for one
RING_TAPS = 4 * MOST_RINGS * (MOST_RINGS - 1)  # but for the centre
_AREA = 32.0 * 32.0
# From these distances of rings [px] on, texels of levels 1, 2 and 3 are as far apart; halves of a level are rounded up.
_FIRST, _SECOND, _THIRD = 2.0**1.5, 2.0**2.5, 2.0**3.5


def ring_taps() -> Float:
    """Rings 1 .. 4, and the centre last, (2, 81) [distances of rings]; y down."""
    found = []
    for ring in range(1, MOST_RINGS):
        angles = (np.arange(4 * ring) + 0.5 * (ring % 2)) * (2.0 * np.pi / (8 * ring))
        half = ring * np.stack([np.cos(angles), np.sin(angles)])
        found += [half, -half]
    return np.concatenate([*found, np.zeros((2, 1))], axis=1)


@inline
def pairs(ring):
    """The first tap of a ring, and how many pairs there are."""
    return (4 * ring * (ring - 1), 4 * ring) if ring > 0 else (RING_TAPS, 1)


@inline
def level_of(apart):
    """The level whose texels are as far apart as the rings."""
    kind = type(apart)
    return (
        (1 if apart >= kind(_FIRST) else 0) + (1 if apart >= kind(_SECOND) else 0) + (1 if apart >= kind(_THIRD) else 0)
    )


@inline
def light_of(circle, least):
    """Light of a tap by the area that it spreads over."""
    return type(circle)(_AREA) / max(circle * circle, least)


@inline
def clipped(number):
    """Cut to [0, 1]."""
    kind = type(number)
    return min(max(number, kind(0)), kind(1))
