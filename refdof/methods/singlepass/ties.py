"""Ties: what correct programs may give where a tap lies on a border of texels, or an order is decided by a hair.

1. Find the texels that each tap may read                       `_texels_near`
2. Take the least and the greatest weight that they give         `_reaches`
3. Run the loop twice, each step to the least and the greatest   `_least_and_greatest`

After k taps the mean moves by m (s - mean) / (k + 1), for a tap of colour s and weight m. That grows with the mean and
with s, and is linear in m: so the least mean comes of the least mean before, the least colour and one end of the
weights, and the bounds of a channel are met by some choices. No choice is tied to another's, as a program's may be.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from refdof._check import Float, as_instance, as_number
from refdof.methods._image_validation import as_images, depth_in_range
from refdof.methods.singlepass.params import Params
from refdof.methods.singlepass.planar import window
from refdof.methods.singlepass.trace import cover_of
from refdof.methods.singlepass.walk import NEAREST, Walk, bands, read_color, read_guides, sizes_of, spiral, walk_of
from refdof.stages import Bounds

__all__ = ["Start", "bounds", "bounds_from"]


class Start(NamedTuple):
    """Where a loop is taken up that another program has begun.

    Attributes
    ----------
    limit : (H, W) or None
        What the sizes of taps from behind are cut at [px]. None: the factor for them times the pixel's own size.
    mean : (H, W, 3) or None
        The mean after the first `taps` taps. None: the pixel's own colour.
    taps : int
    """

    limit: Float | None = None
    mean: Float | None = None
    taps: int = 0

    def rows(self, rows: slice) -> "Start":
        """Of some rows."""
        limit, mean = (None if part is None else part[rows] for part in self[:2])
        return Start(limit, mean, self.taps)


def bounds(
    color: Float,
    depth: Float,
    coc: Float,
    params: Params = Params(),
    epsilon: float = 1e-3,
    hair: float = 1e-6,
) -> Bounds:
    """Bounds of what correct programs make of a picture: its `blur` is between them but for roundings.

    Parameters
    ----------
    color, depth, coc, params
        As for `blur`.
    epsilon : float
        A tap within this of a border of texels, or a radius within this of the loop's bound, may count to either side
        [px], 0 .. 0.25. Angles added up in float32 are up to 0.0007 px off by default, and texture coordinates in
        float32 by 2^-23 of the picture's width; hardware that keeps 8 bits of a place within a texel needs 1/256.
    hair : float
        Depths, or signed sizes, within this share of the pixel's own may be in either order, 0 .. 0.25. Equal ones are
        not read in another order, unless they are blended.

    Returns
    -------
    Bounds
        low, high (H, W, 3) float64 and ambiguity (H, W) bool. Filters that blend have no ties of place: a tap moved by
        epsilon moves them by as little, which is for a tolerance.

    Raises
    ------
    InputError
        As `blur`, or if epsilon or hair is not as stated.
    """
    as_instance("params", params, Params)
    epsilon = as_number("epsilon", epsilon, minimum=0.0, maximum=0.25)
    hair = as_number("hair", hair, minimum=0.0, maximum=0.25)
    color, depth, coc = as_images(color, depth, coc)
    depth = depth_in_range(color.dtype.type, depth)
    color, depth, coc = (image.astype(np.float64) for image in (color, depth, coc))
    return bounds_from(color, depth, coc, params, Start(), epsilon, hair)


def bounds_from(
    color: Float, depth: Float, coc: Float, params: Params, start: Start, epsilon: float = 1e-3, hair: float = 1e-6
) -> Bounds:
    """`bounds`, after validation and in float64, of what correct programs make of `start`."""
    walk, shift = walk_of(color, depth, coc, params, beyond=epsilon), (params.shift_x, params.shift_y)
    places = spiral(params, beyond=epsilon)[:, :2] + shift
    fewest = len(spiral(params, beyond=-epsilon))
    low, high = np.full(color.shape, np.inf), np.full(color.shape, -np.inf)
    for rows, band in bands(walk):
        begun = start.rows(rows)
        for center in _centers(band, np.array(shift), params, epsilon, begun):
            later = range(start.taps, len(places))
            taps = (_tap(band, k, places[k], center, params, epsilon, hair) for k in later)
            for least, greatest in _least_and_greatest(center, taps, fewest, start.taps):
                low[rows] = np.minimum(low[rows], np.moveaxis(least, 0, -1))
                high[rows] = np.maximum(high[rows], np.moveaxis(greatest, 0, -1))
    return Bounds(low, high, np.asarray((low < high).any(axis=-1)))


class _Center(NamedTuple):
    """What pixels read of themselves: least and greatest colour (3, H, W), what is compared, and the limit."""

    least: Float
    greatest: Float
    order: Float
    limit: Float


class _Tap(NamedTuple):
    """What a tap may be: least and greatest colour (3, H, W), and weight (H, W)."""

    least: Float
    greatest: Float
    lightest: Float
    heaviest: Float


def _centers(walk: Walk, place: Float, params: Params, epsilon: float, start: Start) -> Iterator[_Center]:
    """The pixels themselves: as often as there are texels that their depth may be read from."""
    factor, largest = walk.numbers[:2]
    own = window(walk.center, walk.margin, 0, 0)
    least, greatest = own[:3], own[:3]
    if params.color_filter == "nearest":
        least, greatest = _extremes(walk.planes[:3], walk.margin, place, epsilon)
    if start.mean is not None:
        least = greatest = np.moveaxis(start.mean, -1, 0)
    guides = [own[3:]]
    if walk.mode == NEAREST:
        guides = [window(walk.planes[3:], walk.margin, x, y) for x, y in _texels_near(place, epsilon)]
    for order, size in guides:
        compared = own[3] if params.order == "always" else order
        limit = factor * sizes_of(size, largest) if start.limit is None else start.limit
        yield _Center(least, greatest, compared, limit)


def _tap(walk: Walk, k: int, place: Float, center: _Center, params: Params, epsilon: float, hair: float) -> _Tap:
    """Tap `k`, whose offset is `place` [px]."""
    if params.color_filter == "nearest":
        least, greatest = _extremes(walk.planes[:3], walk.margin, place, epsilon)
    else:
        least = greatest = read_color(walk, walk.offsets[k], walk.weights[k])
    if walk.mode == NEAREST:
        guides = [window(walk.planes[3:], walk.margin, x, y) for x, y in _texels_near(place, epsilon)]
    else:
        guides = [read_guides(walk, walk.offsets[k], walk.weights[k])]
    reaches = []
    for order, circle in guides:
        size = sizes_of(circle, walk.numbers[1])
        reaches += _reaches(order, size, center, hair, walk.mode != NEAREST)
    lightest = cover_of(np.minimum.reduce(reaches), walk.inner[k])
    heaviest = cover_of(np.maximum.reduce(reaches), walk.inner[k]) if len(reaches) > 1 else lightest
    return _Tap(least, greatest, lightest, heaviest)


def _reaches(order: Float, size: Float, center: _Center, hair: float, blended: bool) -> list[Float]:
    """The sizes after the cut that one reading may have: with the order as it is, and by a hair the other one."""
    behind, cut = order < center.order, np.minimum(size, center.limit)
    with np.errstate(invalid="ignore"):  # background before background
        gap = np.abs(order - center.order)
        close = np.isfinite(center.order) & (gap <= hair * np.abs(center.order))
    if not blended:
        close &= gap > 0.0
    reach = np.where(behind, cut, size)
    return [reach, np.where(behind ^ close, cut, size)] if close.any() else [reach]


def _least_and_greatest(
    center: _Center, taps: Iterator[_Tap], fewest: int, first: int
) -> Iterator[tuple[Float, Float]]:
    """The least and the greatest means (3, H, W) after every number of taps, from the fewest on; `first` are done."""
    low, high = center.least, center.greatest
    if fewest <= first:
        yield low, high
    for k, tap in enumerate(taps, first):
        ends = [tap.lightest] if tap.heaviest is tap.lightest else [tap.lightest, tap.heaviest]
        low = np.minimum.reduce([low + m * (tap.least - low) / (k + 2) for m in ends])
        high = np.maximum.reduce([high + m * (tap.greatest - high) / (k + 2) for m in ends])
        if k + 1 >= fewest:
            yield low, high


def _extremes(planes: Float, margin: int, place: Float, epsilon: float) -> tuple[Float, Float]:
    """Least and greatest of the texels that a place may be read from."""
    read = [window(planes, margin, x, y) for x, y in _texels_near(place, epsilon)]
    return np.minimum.reduce(read), np.maximum.reduce(read)


def _texels_near(place: Float, epsilon: float) -> list[tuple[int, int]]:
    """The nearest texels of all places within epsilon: one, two beside a border, or four at a corner."""
    columns, rows = (sorted({math.floor(c + 0.5 - epsilon), math.floor(c + 0.5 + epsilon)}) for c in place)
    return [(x, y) for y in rows for x in columns]
