"""Compared: what a property expects beside what came, and which pixels count."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from refdof._check import Float

__all__ = ["Compared", "Mask", "Room", "distance_to", "inside"]

Mask = npt.NDArray[np.bool_]


class Room(NamedTuple):
    """How much a filter may differ, and how far it may reach.

    tolerance : of the brightest value
    reach : how far blurs spread, in radii of the largest circle
    """

    tolerance: float
    reach: float

    def margin(self, largest: float) -> float:
        """The distance [px] up to which a circle of this radius [px] may show; rims, and bilinear reads, add 1 px."""
        return 0.0 if largest == 0.0 else self.reach * largest + 1.0


class Compared(NamedTuple):
    """Two arrays that shall be equal but for `allowed`.

    expected, got : (H, W, C), pixels; or a number of the whole picture, for each channel (C,) or for all ()
    allowed : largest difference
    counts : (H, W) bool; None: all
    said : what was done, in words; may be empty
    """

    expected: Float
    got: Float
    allowed: float
    counts: Mask | None = None
    said: str = ""

    def worst(self) -> tuple[int, ...] | None:
        """Index of the largest difference beyond what is allowed; None if there is none."""
        # The difference of two equal infinities is no number.
        same = (self.expected == self.got) | (np.isnan(self.expected) & np.isnan(self.got))
        with np.errstate(invalid="ignore", over="ignore"):
            error = np.where(same, 0.0, np.abs(self.got - self.expected))
        error[np.isnan(error)] = np.inf
        if self.counts is not None:
            error[~self.counts] = 0.0
        if not error.max() > self.allowed:
            return None
        return tuple(int(k) for k in np.unravel_index(error.argmax(), error.shape))


def distance_to(marked: Mask) -> Float:
    """(H, W) distance of each pixel to the nearest one of `marked` [px], centre to centre; inf where there is none."""
    if not marked.any():
        return np.full(marked.shape, np.inf)
    return np.asarray(ndimage.distance_transform_edt(~marked))


def inside(length: int, first: int, end: int, margin: float) -> Mask:
    """(length,) bool: places that lie in first .. end - 1, more than `margin` from every place of 0 .. length - 1 that
    does not.
    """
    place = np.arange(length)
    left = (place - first + 1 > margin) if first > 0 else place >= first
    right = (end - place > margin) if end < length else place < end
    return np.asarray(left & right)
