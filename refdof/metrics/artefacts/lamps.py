"""Lamps: small bright lights out of focus, and what a method makes of their discs.

1. Groups of pixels with a channel above 4, white being 1, are bright                          `_groups`
2. One is a lamp if it is smaller than its circle, and has no other bright disc in its window   `lamps`
3. Moments of its spot in both pictures, above the same background, are compared                `bokeh`

The window is a disc of 1.5 circles around the lamp, and the lamp's own size; the background is the median of the
reference in a ring of two pixels around that.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.metrics.artefacts.maps import ArtefactMaps
from refdof.metrics.artefacts.moments import Moments, moments

__all__ = ["Lamp", "bokeh", "lamps"]

_BRIGHT = 4.0  # times white: discs up to 7 px wide are then brighter than what is lit around them
_LEAST_CIRCLE = 2.0  # px: the moments of smaller discs are those of pixels
_WINDOW = 1.5  # circles
_RING = 2.0  # px


class Lamp(NamedTuple):
    """Centre [px], its radius of confusion and the radius of its window [px]."""

    x: float
    y: float
    circle: float
    window: float


def lamps(maps: ArtefactMaps) -> list[Lamp]:
    """Isolated lamps out of focus whose window and ring lie within the picture, by row and column."""
    if maps.color is None:
        return []
    found, groups = [], _groups(maps)
    height, width = maps.coc.shape
    for k, (y, x, circle) in enumerate(groups):
        size = max(np.ptp(y), np.ptp(x)) + 1.0
        radius = float(circle.mean())
        center_x, center_y = float(x.mean()), float(y.mean())
        window = float(_WINDOW * radius + size / 2.0)
        whole = window + _RING
        if circle.min() < _LEAST_CIRCLE or size > radius or not whole <= center_x <= width - whole:
            continue
        apart = whole <= center_y <= height - whole and all(
            (np.hypot(other_x - center_x, other_y - center_y) > whole + other_circle).all()
            for j, (other_y, other_x, other_circle) in enumerate(groups)
            if j != k
        )
        found += [Lamp(center_x, center_y, radius, window)] if apart else []
    return found


def bokeh(found: Sequence[Lamp], reference: Float, image: Float) -> dict[str, float]:
    """Medians over the lamps of what the image's spots have beside the reference's; NaN where there is no lamp.

    reference, image : (H, W, 3)

    Returns
    -------
    dict
        "lamps": their number; "bokeh_offset": distance of the centroids [px]; "bokeh_radius": ratio of the RMS radii;
        "bokeh_anisotropy": difference of the anisotropies; "bokeh_energy": ratio of the energies.
    """
    compared = []
    for lamp in found:
        first, second = _spots(lamp, reference, image)
        if first.energy > 0.0 and second.energy > 0.0 and first.radius > 0.0:
            compared.append(
                (
                    math.hypot(second.x - first.x, second.y - first.y),
                    second.radius / first.radius,
                    second.anisotropy - first.anisotropy,
                    second.energy / first.energy,
                )
            )
    names = "bokeh_offset", "bokeh_radius", "bokeh_anisotropy", "bokeh_energy"
    middle = np.median(compared, axis=0) if compared else np.full(len(names), math.nan)
    count = float(len(compared)) if compared else math.nan
    return {"lamps": count, **{name: float(value) for name, value in zip(names, middle, strict=True)}}


def _groups(maps: ArtefactMaps) -> list[tuple[Float, Float, Float]]:
    """Rows, columns (of centres) and circles of the pixels of each group of bright pixels that touch [px]."""
    from scipy.ndimage import find_objects, label  # slow to import

    bright, _ = label(maps.color.max(axis=2) > _BRIGHT, np.ones((3, 3)))
    groups = []
    for k, box in enumerate(find_objects(bright), start=1):
        y, x = np.nonzero(bright[box] == k)
        circle = np.abs(maps.coc[box][y, x])
        groups.append((y + box[0].start + 0.5, x + box[1].start + 0.5, circle))
    return groups


def _spots(lamp: Lamp, reference: Float, image: Float) -> tuple[Moments, Moments]:
    """Moments of the lamp in both pictures, above the reference's background."""
    whole = lamp.window + _RING
    rows = slice(int(lamp.y - whole), math.ceil(lamp.y + whole))
    columns = slice(int(lamp.x - whole), math.ceil(lamp.x + whole))
    first, second = reference[rows, columns], image[rows, columns]
    y, x = np.indices(first.shape[:2])
    distance = np.hypot(x + columns.start + 0.5 - lamp.x, y + rows.start + 0.5 - lamp.y)
    ring = (distance > lamp.window) & (distance <= whole)
    background = np.median(first[ring], axis=0)
    inside = (distance <= lamp.window)[..., None]
    one, other = (moments(np.where(inside, picture - background, 0.0)) for picture in (first, second))
    return one, other
