"""Ties: what correct programs may give where a tap's code is that of its pixel but for roundings.

Such a tap counts in full or by its blur. That is all that is tied: places are read between texels, so that a tap which
is moved a little reads as little else.

1. Read every tap in both pictures and blend them                  `_taps`
2. Find the least and the greatest weight that each may have       `_weights`
3. Find the least and the greatest mean that such weights give     `_greatest`

The greatest mean of colours c whose weights are within a .. b takes b where c is above it and a elsewhere: Dinkelbach's
iteration begins at any mean and does so until it stays, after as many steps as there are taps at most.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, as_instance, as_number
from refdof.methods._image_validation import as_images
from refdof.methods.poisson.coding import depth_for_coding
from refdof.methods.poisson.method import coded_and_small
from refdof.methods.poisson.params import Params
from refdof.stages import Bounds

__all__ = ["bounds", "bounds_of_coded"]

_NOTHING = 1e-4  # a sum of weights below this may be 0 for others, whose pixel then keeps its colour


class _Taps(NamedTuple):
    """All taps of some rows: colours (N, h, W, 3), codes (N, h, W)."""

    color: Float
    code: Float


def bounds(color: Float, depth: Float, coc: Float, params: Params = Params(), hair: float = 1e-4) -> Bounds:
    """Bounds of what correct programs make of a picture: its `blur` is between them but for roundings.

    Parameters
    ----------
    color, depth, coc, params
        As for `blur`.
    hair : float
        Codes within this of the pixel's own may count to either side, 0 .. 0.25; equal ones, too, since means of equal
        codes round. Codes are 0 .. 1; texture coordinates in float32 are up to 4e-5 px off in
        pictures of 320 px, neighbours differ by 1 at most, and the blend of two pictures doubles that. Hardware that
        keeps 8 bits of a place within a texel needs 1/256.

    Returns
    -------
    Bounds
        low, high (H, W, 3) float64 and ambiguity (H, W) bool.

    Raises
    ------
    InputError
        As `blur`, or if hair is not as stated.
    """
    as_instance("params", params, Params)
    hair = as_number("hair", hair, minimum=0.0, maximum=0.25)
    color, depth, coc = as_images(color, depth, coc)
    depth = depth_for_coding(color.dtype.type, depth, params)
    color, depth, coc = (image.astype(np.float64) for image in (color, depth, coc))
    return bounds_of_coded(*coded_and_small(color, depth, coc, params), params, hair)


def bounds_of_coded(coded: Float, small: Float, params: Params, hair: float = 3e-5) -> Bounds:
    """`bounds`, after validation and in float64, of a picture with its code (H, W, 4) and a small one (h, w, 4)."""
    color = coded[..., :3]
    low, high = np.empty_like(color), np.empty_like(color)
    for y in range(len(color)):  # a row at a time: all taps of it fit a cache
        rows = slice(y, y + 1)
        taps = _taps(coded, small, params, rows)
        lightest, heaviest = _weights(taps.code, coded[rows, :, 3], hair)
        own = color[rows]
        high[rows] = _greatest(taps.color, lightest, heaviest, own)
        low[rows] = -_greatest(-taps.color, lightest, heaviest, -own)
    low = np.where(high - low <= 1e-12 * np.abs(high), high, low)  # roundings of the iteration
    return Bounds(low, high, np.asarray((low < high).any(axis=-1)))


def _taps(coded: Float, small: Float, params: Params, rows: slice) -> _Taps:
    """Every tap of some rows, blended between the two pictures by the blur of the sharp one."""
    y, x = np.indices(coded.shape[:2])[:, rows] + 0.5
    radius = np.abs(2.0 * coded[rows, :, 3] - 1.0) * params.max_radius
    wide = radius * (params.small_radius * params.small_size)
    down, right = (s / c for s, c in zip(small.shape[:2], coded.shape[:2], strict=True))
    found = []
    for dx, dy in params.table:
        sharp = _read(coded, x + dx * radius, y + dy * radius)
        soft = _read(small, (x + dx * wide) * right, (y + dy * wide) * down)
        found.append(sharp + (soft - sharp) * np.abs(2.0 * sharp[..., 3:] - 1.0))
    taps = np.stack(found)
    return _Taps(taps[..., :3], taps[..., 3])


def _read(image: Float, x: Float, y: Float) -> Float:
    """Bilinear, clamped to the edge; places in texels from the corner."""
    (first_x, last_x, wx), (first_y, last_y, wy) = (
        _around(p, s) for p, s in ((x, image.shape[1]), (y, image.shape[0]))
    )
    top = image[first_y, first_x] + (image[first_y, last_x] - image[first_y, first_x]) * wx
    bottom = image[last_y, first_x] + (image[last_y, last_x] - image[last_y, first_x]) * wx
    return top + (bottom - top) * wy


def _around(place: Float, size: int) -> tuple[np.ndarray, np.ndarray, Float]:
    """The two texels around each place, and the second's weight."""
    centred = np.clip(place - 0.5, 0.0, size - 1.0)
    first = np.floor(centred).astype(np.int64)
    return first, np.minimum(first + 1, size - 1), (centred - first)[..., None]


def _weights(code: Float, own: Float, hair: float) -> tuple[Float, Float]:
    """The least and the greatest weight of every tap: (N, h, W) each."""
    blur = np.minimum(np.abs(2.0 * code - 1.0), 1.0)
    spreads, close = code >= own, np.abs(code - own) <= hair
    return np.where(spreads & ~close, 1.0, blur), np.where(spreads | close, 1.0, blur)


def _greatest(color: Float, lightest: Float, heaviest: Float, own: Float) -> Float:
    """The greatest mean of colours (N, h, W, 3) under weights (N, h, W) within bounds; `own` where all may be 0."""
    least, most = lightest[..., None], heaviest[..., None]
    nothing = lightest.sum(axis=0)[..., None] <= _NOTHING
    mean = np.full(own.shape, -np.inf)
    for _ in range(len(color) + 1):
        weights = np.where(color > mean, most, least)
        total = weights.sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            found = np.where(total > 0.0, (weights * color).sum(axis=0) / total, own)
        if not (found > mean).any():
            break
        mean = np.maximum(mean, found)
    return np.where(nothing, np.maximum(np.maximum(mean, own), color.max(axis=0)), mean)
