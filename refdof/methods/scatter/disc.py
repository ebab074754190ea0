"""How much of each pixel a disc around a pixel's centre covers, exactly.

The disc's part in a quarter plane's rectangle [0, x] x [0, y] is x y while its corner lies inside, and else a smaller
rectangle and the area under the arc. Pixels are differences of such rectangles.
"""

import math

import numpy as np

from refdof._jit import inline

__all__ = ["LARGEST_DISC", "covered_in_row", "inner_count", "outer_count", "start_of_arc"]

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
def covered_in_row(j, radius, inner, outer, low, high, disc, arcs, disc_of_arc, areas):
    """Write the areas [px^2] of pixels inner .. outer - 1 of row j, counted from the centre's, inside the disc.

    low, high: `start_of_arc` of the row's sides. Areas under the arc from 0 to i + 0.5, which all rows share, are kept
    in arcs[i], as long as disc_of_arc[i] is the disc's number.
    """
    bottom, top = max(j - 0.5, 0.0), j + 0.5
    start_low, under_low = low
    start_high, under_high = high
    left_low = left_high = 0.0
    for i in range(inner - 1 if inner > 0 else 0, outer):
        if disc_of_arc[i] != disc:
            disc_of_arc[i], arcs[i] = disc, _under_arc(min(i + 0.5, radius), radius)
        right_low = _corner(i + 0.5, bottom, radius, start_low, under_low, arcs[i])
        right_high = _corner(i + 0.5, top, radius, start_high, under_high, arcs[i])
        area = (right_high - left_high) - (right_low - left_low)
        left_low, left_high = right_low, right_high
        twice = 4.0 if i == 0 and j == 0 else (2.0 if i == 0 or j == 0 else 1.0)  # pixels that an axis halves
        areas[i] = max(area * twice, 0.0)


@inline
def start_of_arc(y, radius):
    """Where the arc leaves the upper side of a rectangle of height y, and the area under it up to there."""
    y = min(y, radius)
    start = math.sqrt(radius * radius - y * y)
    return start, _under_arc(start, radius)


@inline
def _corner(x, y, radius, start, under_start, under_x):
    """Area of [0, x] x [0, y] inside the disc around 0."""
    if x * x + y * y <= radius * radius:
        return x * y
    x, y = min(x, radius), min(y, radius)
    if start >= x:
        return x * y
    return start * y + under_x - under_start


@inline
def _under_arc(x, radius):
    """Integral of sqrt(radius^2 - t^2) for t from 0 to x."""
    return 0.5 * (x * math.sqrt(max(radius * radius - x * x, 0.0)) + radius * radius * math.asin(min(x / radius, 1.0)))
