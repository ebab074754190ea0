"""Excess: what an image has beyond its reference, of the mean of the channels: leaks, steps, ringing.

What the reference's noise can explain does not count: each local excess must be above four standard errors of what it
is compared with. One of 30 000 normal values is.
"""

import math
from typing import TypeAlias

import numpy as np

from refdof._check import Float
from refdof.metrics.artefacts.maps import ArtefactMaps

__all__ = ["Range", "boundary_step", "circle_range", "leakage", "neighbour_range", "ringing"]

Range: TypeAlias = tuple[Float, Float]
"""Least and greatest value that a pixel may have: (H, W) each."""

_SURE = 4.0  # standard errors


def neighbour_range(maps: ArtefactMaps, reference: Float) -> Range:
    """What 3 x 3 pixels of the reference (H, W) and of the pinhole's picture have."""
    least, greatest = _range(reference, 3)
    if maps.color is not None:
        low, high = _range(maps.color.mean(axis=2), 3)
        least, greatest = np.minimum(least, low), np.maximum(greatest, high)
    return least, greatest


def leakage(maps: ArtefactMaps, allowed: Range, image: Float) -> tuple[float, float]:
    """Light in sharp pixels that has no source within a pixel: its signed mean, and the largest of either sign.

    A circle of half a pixel mixes no more than neighbours, so a sharp pixel has a value within the `neighbour_range`.
    What is above has leaked in from farther away; what is below is darkness that has, and counts as negative. From the
    largest, four standard errors are taken off; the mean needs none, since noise only widens the range.

    image : (H, W)
    """
    if not maps.sharp.any():
        return math.nan, math.nan
    least, greatest = allowed
    leak = (image - np.clip(image, least, greatest))[maps.sharp]
    return float(leak.mean()), max(0.0, float((np.abs(leak) - _SURE * maps.noise[maps.sharp]).max()))


def boundary_step(maps: ArtefactMaps, reference: Float, image: Float) -> float:
    """The largest step across a foreground edge beyond the reference's step there; at least 0.

    A surface in front of focus fades out over its circle, so the reference has no step at its pinhole silhouette.
    The noise of a step is that of two pixels.

    reference, image : (H, W)
    """
    found = []
    turned = zip((reference, reference.T), (image, image.T), (maps.noise, maps.noise.T), maps.foreground, strict=True)
    for first, second, noise, edge in turned:
        room = _SURE * np.hypot(noise[1:], noise[:-1])
        beyond = np.abs(np.diff(second, axis=0)) - np.abs(np.diff(first, axis=0)) - room
        found += [float(beyond[edge].max())] if edge.any() else []
    return max(0.0, *found) if found else math.nan


def circle_range(maps: ArtefactMaps, reference: Float) -> Range:
    """What the reference (H, W) has in a square of 3, 5, 9, 17, ... px that holds a continuous pixel's circle."""
    circle = np.where(maps.continuous, np.abs(maps.coc), 0.0)
    steps = np.ceil(np.log2(np.maximum(circle, 1.0))).astype(np.int64)  # half a side is 2^steps px
    least, greatest = reference.copy(), reference.copy()
    for step in np.unique(steps):
        here = steps == step
        low, high = _range(reference, 2 * 2 ** int(step) + 1)
        least[here], greatest[here] = low[here], high[here]
    return least, greatest


def ringing(maps: ArtefactMaps, allowed: Range, image: Float) -> float:
    """RMS over- and undershoot on continuous surfaces, beyond the `circle_range` and four standard errors.

    image : (H, W)
    """
    region = maps.continuous
    if not region.any():
        return math.nan
    least, greatest = allowed
    beyond = np.maximum(image - greatest, least - image) - _SURE * maps.noise
    return math.sqrt(float(np.mean(np.maximum(beyond[region], 0.0) ** 2)))


def _range(values: Float, side: int) -> Range:
    """Least and greatest value in a square of `side` px around each pixel."""
    from scipy.ndimage import maximum_filter, minimum_filter  # slow to import

    return minimum_filter(values, side, mode="nearest"), maximum_filter(values, side, mode="nearest")
