"""Point names: the name of each point of a plot, so that none is taken for another's.

1. try each place around the point; a place is its own where no other point is as near    `_own`
2. take the one that covers least of points and names before it                          `_cost`
3. if none is free, go further away and draw a thin line to the point                    `_far`
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from refdof.report.text import one_line

__all__ = ["write_names"]

_INK = "#222222"
_BESIDE: Any = {"textcoords": "offset points"}
_LINE: Any = {"arrowstyle": "-", "color": "#888888", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 2.5}  # shrink: [pt]
_SIDES = (  # where a name may stand: offset from its point [pt], and which end of it is there
    (0.0, 5.0, "center", "bottom"),
    (0.0, -5.0, "center", "top"),
    (6.0, 0.0, "left", "center"),
    (-6.0, 0.0, "right", "center"),
    (4.0, 5.0, "left", "bottom"),
    (-4.0, 5.0, "right", "bottom"),
    (4.0, -5.0, "left", "top"),
    (-4.0, -5.0, "right", "top"),
)
_FAR = (16.0, 24.0, 34.0, 46.0, 60.0, 80.0)  # lengths of lines [pt]
_DIRECTIONS = 16

_Place = tuple[float, float, str, str]


def write_names(figure: Figure, axes: Any, points: Sequence[tuple[float, float, str]], marker: float) -> None:
    """Write each name beside its point, or with a line to it where other points are nearer or all is taken.

    Parameters
    ----------
    points : (x, y, name)
        In the units of the axes, whose limits are to be final.
    marker : float
        Diameter of a point [pt].
    """
    figure.draw_without_rendering()  # fixes the axes, on which distances depend
    centres = np.array([axes.transData.transform(point[:2]) for point in points]).reshape(-1, 2)
    half = 0.5 * marker * figure.dpi / 72.0
    taken = [Bbox.from_extents(x - half, y - half, x + half, y + half) for x, y in centres]
    for k, (x, y, name) in enumerate(points):
        text = axes.annotate(
            one_line(name), (x, y), xytext=(0.0, 0.0), fontsize=8, color=_INK, parse_math=False, **_BESIDE
        )
        text.set_in_layout(False)  # the axes stay where they are
        near = [place for place in _SIDES if _own(_box(text, place), centres, k)]
        best, cost = _cheapest(text, near, taken, axes.bbox)
        if cost > 0.0:
            far, cost_of_far = _cheapest(text, _far(), taken, axes.bbox)
            if cost_of_far < cost:
                best = far
                line = axes.annotate("", (x, y), xytext=far[:2], arrowprops=_LINE, **_BESIDE)
                line.set_in_layout(False)
        taken.append(_box(text, best))


def _cheapest(text: Any, places: Sequence[_Place], taken: Sequence[Bbox], whole: Bbox) -> tuple[_Place, float]:
    """The first of the places where a name covers least, and how much; infinitely much if there is no place."""
    costs = [_cost(_box(text, place), taken, whole) for place in places]
    return (places[costs.index(min(costs))], min(costs)) if costs else (_SIDES[0], math.inf)


def _own(box: Bbox, centres: Any, k: int) -> bool:
    """Whether point k is nearer to a name than all others."""
    nearest = np.clip(centres, box.min, box.max)
    distances = np.hypot(*(centres - nearest).T)
    return bool(np.all(np.delete(distances, k) > distances[k]))


def _cost(box: Bbox, taken: Sequence[Bbox], whole: Bbox) -> float:
    """The area of a name that covers others, or is outside the axes [px^2]."""
    shared = [Bbox.intersection(box, other) for other in (*taken, whole)]
    areas = [0.0 if area is None else area.width * area.height for area in shared]
    return float(sum(areas[:-1]) + max(box.width * box.height - areas[-1], 0.0))


def _far() -> list[_Place]:
    """Places all around, the nearest first; a name's end or middle is where its line meets it."""
    places: list[_Place] = []
    for length in _FAR:
        for k in range(_DIRECTIONS):
            angle = 2.0 * math.pi * (k + 0.5) / _DIRECTIONS
            x, y = length * math.cos(angle), length * math.sin(angle)
            places.append((x, y, "left" if x > 0.0 else "right", "bottom" if y > 0.0 else "top"))
    return places


def _box(text: Any, place: _Place) -> Bbox:
    """Put a name there; what it covers, without its line [px]."""
    x, y, horizontal, vertical = place
    text.set_position((x, y))
    text.set(horizontalalignment=horizontal, verticalalignment=vertical)
    box: Bbox = text.get_window_extent()
    return box
