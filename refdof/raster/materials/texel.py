"""Texels: where a bilinear lookup of a material's texture reads, inside 0 .. 1 and outside.

All textures of a scene lie in flat lists, one behind the other. A texture is a row of a table, `TEXTURE_COLUMNS`.
"""

import math

import numpy as np

from refdof._jit import inline
from refdof.scene.material import WRAPS

__all__ = ["TEXTURE_COLUMNS", "texel_weights"]

TEXTURE_COLUMNS = 5  # first texel, width, height, and how it goes on along u and v; width 0: none
_CLAMP, _MIRROR = WRAPS.index("clamp"), WRAPS.index("mirror")


@inline
def texel_weights(texture, s, t):
    """The four texels p, q (a row), r, o (the next one) of a lookup at (s, t), and its shares a along u, b along v.

    (0, 0) is the lower left corner, row 0 the top row.
    """
    first, width, height = int(texture[0]), int(texture[1]), int(texture[2])
    along, down = int(texture[3]), int(texture[4])
    fx = _inside(s, along) * width - 0.5
    fy = (1.0 - _inside(t, down)) * height - 0.5
    i, j = math.floor(fx), math.floor(fy)  # -1 .. size - 1
    a, b = fx - i, fy - j
    x0, x1 = _neighbours(i, width, along)
    y0, y1 = _neighbours(j, height, down)
    upper, lower = first + y0 * width, first + y1 * width
    return upper + x0, upper + x1, lower + x0, lower + x1, a, b


@inline
def _inside(place, wrap):
    """A coordinate brought into 0 .. 1: of floats, since whole numbers of 64 bits do not hold every coordinate."""
    if wrap == _CLAMP:
        return min(place, 1.0) if place > 0.0 else 0.0
    if wrap == _MIRROR:
        place *= 0.5
    part = place - np.floor(place)
    part = part if part > 0.0 else 0.0
    if wrap == _MIRROR:
        return 2.0 * (part if part <= 0.5 else 1.0 - part)
    return part


@inline
def _neighbours(index, size, wrap):
    """Texels `index` and `index` + 1, -1 .. size - 1, in their row: the first follows the last where it repeats."""
    last = size - 1
    if wrap in (_CLAMP, _MIRROR):  # a mirrored texture shows its rim twice
        return max(index, 0), min(index + 1, last)
    return (index if index >= 0 else last), (index + 1 if index < last else 0)
