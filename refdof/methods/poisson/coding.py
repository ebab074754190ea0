"""Coding: depth as blur, and the small picture, of the Poisson disc filter."""

import numpy as np

from refdof._check import Float
from refdof.methods._image_validation import depth_in_range
from refdof.methods.poisson.params import SMALL_SIZE, Params
from refdof.raster.filters.mip_chain import box_mipmaps

__all__ = ["code_of", "depth_for_coding", "shrink"]


def depth_for_coding(dtype: type, depth: Float, params: Params) -> Float:
    """Validated depth, in its own unit where planes are given in it; else as `dtype`."""
    planes = params.near_plane, params.focus_plane, params.far_plane
    return depth_in_range(dtype, depth) if planes == (None, None, None) else depth.astype(np.float64)


def code_of(depth: Float, coc: Float, params: Params) -> Float:
    """Blur and its side in 0 .. 1: (H, W) float64."""
    circles = coc.astype(np.float64)
    if params.code == "thin_lens":
        circles /= params.max_radius
        np.clip(circles, -1.0, params.far_limit, out=circles)
        circles *= 0.5
        circles += 0.5
        return circles
    distance = depth.astype(np.float64)
    if params.focus_plane is not None:
        focus, side = 1.0 / params.focus_plane, np.sign(distance - params.focus_plane)
    elif circles.min() == circles.max():
        return 0.5 + 0.5 * np.clip(np.sign(circles), -1.0, params.far_limit)
    else:
        focus, side = _focus_of(distance, circles), np.sign(circles)
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        far = distance.max(initial=0.0, where=np.isfinite(distance)) if params.far_plane is None else params.far_plane
        near = distance.min() if params.near_plane is None else params.near_plane
        behind = np.where(np.isfinite(distance), (distance * focus - 1.0) / (far * focus - 1.0), 1.0)
        before = (distance * focus - 1.0) / (1.0 - near * focus)
    behind, before = np.clip(behind, 0.0, params.far_limit), np.clip(before, -1.0, 0.0)
    return 0.5 + 0.5 * np.nan_to_num(np.where(side > 0, behind, np.where(side < 0, before, 0.0)), nan=0.0)


def _focus_of(distance: Float, circles: Float) -> float:
    """The inverse of the focal distance: where the line through the least and the greatest circle crosses 0.

    It may be 0: then all that is not at infinity is at full blur.
    """
    least, greatest = (np.unravel_index(k, circles.shape) for k in (circles.argmin(), circles.argmax()))
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        nearness = 1.0 / distance
        share = circles[least] / (circles[least] - circles[greatest])
        return max(nearness[least] * (1.0 - share) + nearness[greatest] * share, 0.0)


def shrink(coded: Float, size: int = SMALL_SIZE) -> Float:
    """Means of size x size texels, by halves, then a 3 x 3 Gaussian of weights 1, 2, 1: (h, w, 4)."""
    levels = box_mipmaps(coded)
    edged = np.pad(levels[min(size.bit_length() - 1, len(levels) - 1)], ((1, 1), (1, 1), (0, 0)), mode="edge")
    quarter, half = coded.dtype.type(0.25), coded.dtype.type(0.5)
    rows = quarter * (edged[:-2] + edged[2:]) + half * edged[1:-1]
    return np.ascontiguousarray(quarter * (rows[:, :-2] + rows[:, 2:]) + half * rows[:, 1:-1])
