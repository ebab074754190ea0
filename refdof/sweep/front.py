"""Front: the points that no other one beats in both time and quality, and answers to a budget or to a quality.

Time is that from the pinhole picture to the blurred one, quality is PSNR; see `Measured`. A point within 3 dB of the
reference's noise floor is as good as any: the fastest of them ends the front.
"""

import math
from collections.abc import Sequence

from refdof.sweep.measured import Measured

__all__ = ["fastest", "front", "nearest"]


def front(points: Sequence[Measured]) -> list[Measured]:
    """The points that are better than all faster ones, from fast to slow."""
    best, found = -math.inf, []
    for point in sorted(points, key=lambda point: (point.time_s, -point.quality, point.key)):
        if point.quality > best:
            best = point.quality
            found.append(point)
    return found


def fastest(points: Sequence[Measured], quality: float) -> Measured | None:
    """The fastest point with at least this PSNR [dB]; None if there is none."""
    good = [point for point in points if point.scores["psnr"] >= quality]
    return min(good, key=lambda point: (point.time_s, point.key), default=None)


def nearest(points: Sequence[Measured], budget: float) -> Measured | None:
    """The best point that takes at most so many seconds, the fastest of equals; None if there is none."""
    quick = front([point for point in points if point.time_s <= budget])
    return quick[-1] if quick else None
