"""How much of each pixel a disc around a pixel's centre covers, exactly.

The disc's part in a quarter plane's rectangle [0, x] x [0, y] is x y while its corner lies inside, and else a smaller
rectangle and the area under the arc. Pixels are differences of such rectangles.
"""

import math

import numpy as np

from refdof._jit import inline

__all__ = ["LARGEST_DISC", "covered", "inner_count", "outer_count"]

LARGEST_DISC = 65536.0  # px: beyond, areas are differences of numbers that leave less than six digits


@inline
def inner_count(j, radius):
    """Pixels i = 0 .. of row j, counted from the centre's, that lie inside the disc as a whole."""
    high = j + 0.5
    return int(np.floor(np.sqrt(radius * radius - high * high) + 0.5)) if radius > high else 0


@inline
def outer_count(j, radius):
    """Pixels i = 0 .. of row j that the disc touches."""
    low = max(j - 0.5, 0.0)
    return int(np.floor(np.sqrt(radius * radius - low * low) + 0.5)) + 1 if radius > low else 0


@inline
def covered(i, j, radius):
    """Area [px^2] of pixel (i, j), both >= 0, inside a disc around the centre of pixel (0, 0)."""
    left, right, low, high = max(i - 0.5, 0.0), i + 0.5, max(j - 0.5, 0.0), j + 0.5
    area = _corner(right, high, radius) - _corner(left, high, radius)
    area -= _corner(right, low, radius) - _corner(left, low, radius)
    twice = 4.0 if i == 0 and j == 0 else (2.0 if i == 0 or j == 0 else 1.0)  # pixels that an axis halves
    return max(area * twice, 0.0)


@inline
def _corner(x, y, radius):
    """Area of [0, x] x [0, y] inside the disc around 0."""
    if x * x + y * y <= radius * radius:
        return x * y
    x, y = min(x, radius), min(y, radius)
    start = math.sqrt(radius * radius - y * y)  # where the arc leaves the upper side
    if start >= x:
        return x * y
    return start * y + _under_arc(x, radius) - _under_arc(start, radius)


@inline
def _under_arc(x, radius):
    """Integral of sqrt(radius^2 - t^2) for t from 0 to x."""
    return 0.5 * (x * math.sqrt(max(radius * radius - x * x, 0.0)) + radius * radius * math.asin(min(x / radius, 1.0)))
