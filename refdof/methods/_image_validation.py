"""Validation for filters: a pinhole image, its depth and its circles of confusion that belong together."""

import numpy as np

from refdof._check import Float, as_depth, as_float, as_image

__all__ = ["as_images", "depth_in_range", "within"]


def as_images(color: Float, depth: Float, coc: Float) -> tuple[Float, Float, Float]:
    """Return color (H, W, 3), depth (H, W) and coc (H, W) [px], all of the type of `color`.

    Circles are cut where the difference of two would leave the type. Depths of a wider type than colour's are given in
    a unit in which they fit, `depth_in_range`.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, a colour is beyond 1e33
        or of 8 or 16 bits, or a depth is not above 0.
    """
    color = as_image("color", color)
    depth = as_depth(depth, color.shape[:2])
    if color.dtype == np.float32 and depth.dtype == np.float64:
        depth = depth_in_range(depth)
    coc = as_float("coc", coc, color.shape[:2])
    return color, depth.astype(color.dtype, copy=False), within(color.dtype.type, coc)


def within(dtype: type, circles: Float) -> Float:
    """`circles` as `dtype`, cut at a quarter of its largest number."""
    limit = np.finfo(dtype).max / 4
    if circles.min() < -limit or circles.max() > limit:
        circles = np.clip(circles, -limit, limit)
    return circles.astype(dtype, copy=False)


def depth_in_range(depth: Float) -> Float:
    """`depth` as float32 [units of a power of two], infinite where it is, or is beyond that type.

    Only ratios of depths count: the nearest is brought to 0.5 .. 1, which changes no bit of a mantissa.
    """
    nearest = depth.min(initial=np.inf, where=np.isfinite(depth))
    with np.errstate(over="ignore"):
        scaled = np.ldexp(depth, -int(np.frexp(nearest)[1])) if np.isfinite(nearest) else depth
        return scaled.astype(np.float32)
