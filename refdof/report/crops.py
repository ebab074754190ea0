"""Crops: the two parts of the picture that a comparison should show closely, found without a choice by hand.

1. where the methods err most          mean squared display error over all methods
2. where the lens blurs most           squared display difference of reference and pinhole image, which is
                                       largest at the edges of things far out of focus

Each is the window with the largest sum; the second does not overlap the first.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.comparison import Comparison
from refdof.image.display import display

__all__ = ["Box", "choose_crops", "crops_of", "squared_error"]


@dataclass(frozen=True)
class Box:
    """A window of pixels: left column x, top row y."""

    x: int
    y: int
    width: int
    height: int

    def of(self, image: Any) -> Any:
        """The part of `image` inside the window."""
        return image[self.y : self.y + self.height, self.x : self.x + self.width]


def choose_crops(comparison: Comparison, width: int, height: int) -> tuple[Box, ...]:
    """Two windows of width x height pixels; one if there is no room for a second. Ties go to the top left."""
    reference = display(comparison.standard[1])
    error = np.zeros(reference.shape[:2])
    for row in comparison.rows:
        error += squared_error(display(row.image), reference)
    return crops_of(error, squared_error(display(comparison.pinhole), reference), width, height)


def squared_error(image: Float, reference: Float) -> Float:
    """Squared difference of two display images (H, W, 3), over all channels: (H, W) float64."""
    error: Float = ((image - reference.astype(np.float64)) ** 2).sum(axis=2)
    return error


def crops_of(error: Float, blur: Float, width: int, height: int) -> tuple[Box, ...]:
    """`choose_crops` of the methods' squared error and the pinhole image's, both (H, W)."""
    first = _best(_window_sums(error, width, height))
    if first is None:
        return ()
    sums = _window_sums(blur, width, height)
    # A window that starts closer than its own size in both directions would overlap the first.
    x, y = first
    sums[max(0, y - height + 1) : y + height, max(0, x - width + 1) : x + width] = -np.inf
    second = _best(sums)
    corners = [first] if second is None else [first, second]
    return tuple(Box(x, y, width, height) for x, y in corners)


def _window_sums(values: Float, width: int, height: int) -> Float:
    """Sum over the window whose top left pixel is (y, x), for every place where it fits."""
    table = np.pad(values, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    high, low = table[height:], table[:-height]
    sums: Float = high[:, width:] - high[:, :-width] - low[:, width:] + low[:, :-width]
    return sums


def _best(sums: Float) -> tuple[int, int] | None:
    """Corner (x, y) of the largest sum, or None if no window is left.

    Rounded, so that the order of additions cannot decide a tie.
    """
    if sums.size == 0 or np.isneginf(sums.max()):
        return None
    y, x = np.unravel_index(int(np.argmax(np.round(sums, 9))), sums.shape)
    return int(x), int(y)
