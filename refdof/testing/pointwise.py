"""Pointwise: properties that one result has by itself, and those of a light on a wall.

Each function takes a filter, a case and the room that is left to the filter. It returns what to compare, or None where
the case has nothing to tell.
"""

import math

import numpy as np

from refdof._check import Float
from refdof.testing.compared import Compared, Mask, Room, distance_to
from refdof.testing.filter import BrokenCall, Filter
from refdof.testing.picture import FOCUS, Case, Picture

__all__ = ["aperture", "behind", "call", "constant", "convexity", "energy", "focus", "pinhole", "radius"]

_HARD_EDGE = math.sqrt(0.5)  # px: a disc of whole pixels that is just below 1 px is one pixel


def call(run: Filter, case: Case, room: Room) -> Compared:
    """A finite picture, twice the same."""
    first, second = run(case.picture), run(case.picture)
    if first.tobytes() != second.tobytes():
        raise BrokenCall("returned two results for one picture; allowed is always the same one")
    return Compared(first, second, 0.0)


def constant(run: Filter, case: Case, room: Room) -> Compared | None:
    """One colour at any depth."""
    picture = case.picture
    if (picture.color != picture.color[0, 0]).any():
        return None
    return Compared(picture.color, run(picture), room.tolerance * picture.brightest)


def pinhole(run: Filter, case: Case, room: Room) -> Compared:
    """A lens of radius 0."""
    picture = case.picture.with_(circle=0.0)
    return Compared(picture.color, run(picture), room.tolerance * picture.brightest, said="with a lens of radius 0")


def focus(run: Filter, case: Case, room: Room) -> Compared | None:
    """Pixels in focus, far from all that is not."""
    return _kept(run, case.picture, room, case.picture.blurred)


def behind(run: Filter, case: Case, room: Room) -> Compared | None:
    """Pixels in focus, far from all in front of them."""
    return _kept(run, case.picture, room, case.picture.depth < FOCUS)


def _kept(run: Filter, picture: Picture, room: Room, disturbing: Mask) -> Compared | None:
    counts = ~picture.blurred & (distance_to(disturbing) > room.margin(picture.largest))
    if not counts.any():
        return None
    return Compared(picture.color, run(picture), room.tolerance * picture.brightest, counts)


def convexity(run: Filter, case: Case, room: Room) -> Compared:
    """No channel leaves its range."""
    picture = case.picture
    low, high = picture.color.min(axis=(0, 1)), picture.color.max(axis=(0, 1))
    result = run(picture)
    return Compared(np.clip(result, low, high), result, room.tolerance * picture.brightest)


def energy(run: Filter, case: Case, room: Room) -> Compared | None:
    """The total of a light on a wall."""
    if not _is_lamp(case.picture, room):
        return None
    total = case.picture.color.sum(axis=(0, 1), dtype=np.float64)
    got = run(case.picture).sum(axis=(0, 1))
    return Compared(total, got, room.tolerance * float(total.max()), said="sums over all pixels")


def radius(run: Filter, case: Case, room: Room) -> Compared | None:
    """RMS radius of a light on the wall, the light's own taken off."""
    picture = case.picture
    if not _is_lamp(picture, room):
        return None
    # A disc of radius c has the second moment c^2 / 2.
    ideal, spread = picture.largest / math.sqrt(2.0), _second_moment(run(picture)) - _second_moment(picture.color)
    if math.isnan(spread):
        return Compared(np.array(1.0), np.array(0.0), 0.5, said="spots; no light is left")
    found = math.sqrt(max(spread, 0.0))
    return Compared(np.array(ideal), np.array(found), _HARD_EDGE, said="RMS radius of the spot in px")


def aperture(run: Filter, case: Case, room: Room) -> Compared | None:
    """The second moment with two apertures."""
    picture = case.picture
    if not _is_lamp(picture, room):
        return None
    narrow, wide = (_second_moment(run(picture.with_(circle=s * picture.circle))) for s in (0.5, 1.0))
    if math.isnan(narrow) or math.isnan(wide):
        return None
    allowed = room.tolerance * (1.0 + narrow)
    said = "second moments of the spot in px^2, with half of the aperture (at least so much is expected) and all of it"
    return Compared(np.array(max(narrow, wide)), np.array(wide), allowed, said=said)


def _is_lamp(picture: Picture, room: Room) -> bool:
    """Whether the picture is lights on a black wall out of focus, two margins away from the border.

    What sees a light is a margin away from it; what it weighs the light by, another.
    """
    if (picture.depth != picture.depth[0, 0]).any() or not picture.color.any():
        return False
    height, width = picture.depth.shape
    rows, columns = np.nonzero(picture.color.any(axis=2))
    nearest = 1 + min(rows.min(), height - 1 - rows.max(), columns.min(), width - 1 - columns.max())
    return bool(nearest > 2.0 * room.margin(picture.largest))


def _second_moment(image: Float) -> float:
    """Of all channels, around the light's own middle [px^2]; NaN without light."""
    light = image.sum(axis=2, dtype=np.float64)
    total = light.sum()
    if not total > 0.0:
        return math.nan
    y, x = np.indices(light.shape)
    middle_y, middle_x = (light * y).sum() / total, (light * x).sum() / total
    return float((light * ((y - middle_y) ** 2 + (x - middle_x) ** 2)).sum() / total)
