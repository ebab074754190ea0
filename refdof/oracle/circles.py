"""Circles: bounds of what a right port makes of depth in float32, by interval arithmetic, and of sizes made of circles.

coc_scale (1 / focus - 1 / depth) cancels near the focal plane, so that no number of units in the last place bounds it.
"""

import numpy as np

from refdof._check import Float
from refdof.oracle.pictures import Picture

__all__ = ["circle_bounds", "size_bounds"]

_ULP = 2.0**-23
# An inverse: 2.5 units in the last place is what Vulkan and OpenGL ES allow for a division; its argument has 1/2.
_INVERSE = 3.0 * _ULP
_ROUNDED = 0.5 * _ULP


def circle_bounds(picture: Picture) -> tuple[Float, Float]:
    """Least and greatest circle (H, W) float64 [px]: inverses within 3 units, difference, product and scale rounded."""
    near, far = 1.0 / picture.depth.astype(np.float64), 1.0 / picture.focus
    least = far * (1.0 - _INVERSE) - near * (1.0 + _INVERSE)
    greatest = far * (1.0 + _INVERSE) - near * (1.0 - _INVERSE)
    wide = 1.0 + 3.0 * _ROUNDED  # of the difference, of coc_scale itself and of the product
    low = picture.coc_scale * np.where(least < 0.0, least * wide, least / wide)
    high = picture.coc_scale * np.where(greatest > 0.0, greatest * wide, greatest / wide)
    return np.minimum(low, picture.coc), np.maximum(high, picture.coc)


def size_bounds(low: Float, high: Float, largest: float) -> tuple[Float, Float]:
    """Bounds of min(|c|, largest) for c within low .. high."""
    least = np.where((low <= 0.0) & (high >= 0.0), 0.0, np.minimum(np.abs(low), np.abs(high)))
    return np.minimum(least, largest), np.minimum(np.maximum(np.abs(low), np.abs(high)), largest)
