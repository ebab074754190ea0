"""Validation for filters: a pinhole image, its depth and its circles of confusion that belong together."""

import numpy as np

from refdof._check import Float, as_depth, as_float, as_image

__all__ = ["as_images", "depth_in_range", "depth_in_unit", "within"]


def as_images(color: Float, depth: Float, coc: Float) -> tuple[Float, Float, Float]:
    """Return color (H, W, 3), depth (H, W) in its own type and unit, and coc (H, W) [px] of the type of `color`.

    Circles are cut where the difference of two would leave the type. What a method takes of depth tells whether that is
    made one of the type by `depth_in_range` or by `depth_in_unit`.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, a colour is beyond 1e33
        or of 8 or 16 bits, or a depth is not above 0.
    """
    color = as_image("color", color)
    depth = as_depth(depth, color.shape[:2])
    coc = as_float("coc", coc, color.shape[:2])
    return color, depth, within(color.dtype.type, coc)


def within(dtype: type, circles: Float) -> Float:
    """`circles` as `dtype`, cut at a quarter of its largest number."""
    limit = np.finfo(dtype).max / 4
    if circles.min() < -limit or circles.max() > limit:
        circles = np.clip(circles, -limit, limit)
    return circles.astype(dtype, copy=False)


def depth_in_range(dtype: type, depth: Float) -> Float:
    """`depth` as `dtype`, for methods to which only ratios count; infinite where it is, or is beyond that type.

    Where that is the narrower type, the unit is a power of two that brings the nearest to 0.5 .. 1, which changes no
    bit of a mantissa.
    """
    if depth.dtype.type is np.float64 and dtype is np.float32:
        nearest = depth.min(initial=np.inf, where=np.isfinite(depth))
        if np.isfinite(nearest):
            with np.errstate(over="ignore"):
                depth = np.ldexp(depth, -int(np.frexp(nearest)[1]))
    return depth_in_unit(dtype, depth)


def depth_in_unit(dtype: type, depth: Float) -> Float:
    """`depth` as `dtype` in its own unit, for methods that have constants in that unit; infinite beyond that type."""
    with np.errstate(over="ignore"):
        return depth.astype(dtype, copy=False)
