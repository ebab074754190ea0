"""Crops: the two parts of the picture that a comparison should show closely, found without a choice by hand.

1. where the methods err most          mean squared display error over all methods
2. where the lens blurs most           squared display difference of reference and pinhole image, which is
                                       largest at the edges of things far out of focus

Each is the window with the largest sum; the second does not overlap the first.
"""

import re
from collections.abc import Sequence

import numpy as np

from refdof._check import Float, InputError
from refdof.comparison import Box, Comparison
from refdof.image.display import display

__all__ = ["boxes_of", "choose_crops", "crops_of", "placed", "shown_crops", "squared_error"]

_LARGEST = 0.25  # of a side of the picture, of crops that are chosen for a page


def boxes_of(texts: Sequence[str], size: tuple[int, int]) -> tuple[Box, ...]:
    """'X,Y,W,H' each as a window of a picture of `size`, width and height [px]."""
    boxes = []
    for text in texts:
        numbers = re.fullmatch(r"\s*(\d{1,6}),(\d{1,6}),(\d{1,6}),(\d{1,6})\s*", text, re.ASCII)
        box = Box(*map(int, numbers.groups())) if numbers else Box(0, 0, 0, 0)
        if min(box.width, box.height) < 1 or box.x + box.width > size[0] or box.y + box.height > size[1]:
            allowed = f"X,Y,W,H in whole pixels, a window of the picture of {size[0]}x{size[1]}"
            raise InputError(f"crop: got {text!r}; allowed is {allowed}")
        boxes.append(box)
    return tuple(boxes)


def placed(crops: Sequence[Box], width: int, gap: int) -> tuple[list[tuple[int, int, int, int]], int]:
    """Where crops stand, (left, top, width, height) each, two in a row of `width` [px]; and the height of all.

    Each is enlarged by a whole factor to half of the row, or made smaller if it is wider. The first of a row is at its
    left end, the second at its right.
    """
    room = (width - gap) // 2
    places, top = [], 0
    for first in range(0, len(crops), 2):
        sizes = []
        for crop in crops[first : first + 2]:
            zoom = max(1, room // crop.width)
            wide = min(zoom * crop.width, room)
            sizes.append((wide, zoom * crop.height if wide >= crop.width else max(1, crop.height * wide // crop.width)))
        top += gap if first else 0
        places += [(0 if k == 0 else width - wide, top, wide, high) for k, (wide, high) in enumerate(sizes)]
        top += max(high for _, high in sizes)
    return places, top


def shown_crops(comparison: Comparison) -> tuple[Box, ...]:
    """The crops of a page: those of the comparison, or two that are chosen, a quarter of the picture wide and high."""
    if comparison.crops:
        return comparison.crops
    height, width = comparison.standard[1].shape[:2]
    return choose_crops(comparison, max(1, int(width * _LARGEST)), max(1, int(height * _LARGEST)))


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
