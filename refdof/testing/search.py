"""Search: the first picture on which a check fails, by hypothesis, from the same seed every time."""

from collections.abc import Callable

import numpy as np
from hypothesis import HealthCheck, Phase, Verbosity, find, settings
from hypothesis import strategies as st
from hypothesis.errors import FlakyFailure, NoSuchExample

from refdof.testing.compared import Room
from refdof.testing.picture import DEPTHS, Case, Picture, axis_of, circles_up_to
from refdof.testing.properties import Property

__all__ = ["Flaky", "search"]

_LIGHTS = (1.0, 0.5, 0.25, 3.0, 1000.0)  # also beyond white
_MOST_MARKS = 4
_MOST_PIXELS = 7  # of a side, beyond what a property needs


class Flaky(Exception):
    """The check fails on a picture once, and later not."""


def search(
    prop: Property, fails: Callable[[Case], bool], room: Room, circle: float, channels: int, examples: int
) -> Case | None:
    """A small case for which `fails` is true, or None.

    Raises
    ------
    Flaky
        If `fails` says now this and now that.
    """
    wanted = settings(
        max_examples=examples,
        derandomize=True,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
        verbosity=Verbosity.quiet,
    )
    try:
        return find(_cases(prop, room, circle, channels), fails, settings=wanted)
    except NoSuchExample:
        return None
    except FlakyFailure as error:
        raise Flaky from error


@st.composite
def _cases(draw: st.DrawFn, prop: Property, room: Room, circle: float, channels: int) -> Case:
    """Cases of a property: simple first, few marks on a picture of one colour and depth."""
    circle = draw(st.sampled_from(circles_up_to(circle)))
    numbers = tuple(draw(st.integers(0, most)) for most in prop.numbers)
    margin = room.margin(circle)
    margins = (prop.along, prop.across) if numbers and axis_of(numbers[0]) == 0 else (prop.across, prop.along)
    least = [int(count * margin) for count in margins]
    height, width = (side + draw(st.integers(1, _MOST_PIXELS)) for side in least)

    light = st.sampled_from(_LIGHTS)
    colors = st.tuples(*[light if prop.lamp else st.sampled_from((0.0, *_LIGHTS))] * channels)
    depths = st.sampled_from(DEPTHS)
    base = (0.0,) * channels if prop.lamp else draw(colors)
    depth = draw(st.sampled_from(DEPTHS[1:])) if prop.wall else DEPTHS[0] if prop.sharp else draw(depths)
    color, distance = np.empty((height, width, channels), np.float32), np.full((height, width), depth, np.float32)
    color[:] = base

    def side(length: int, least: int) -> slice:
        """Of a mark; of a lamp's, one in the middle."""
        start = draw(st.integers(least // 2, length - 1 - least // 2)) if prop.lamp else draw(st.integers(0, length - 1))
        return slice(start, start + draw(st.integers(1, 2 if prop.lamp else 3)))

    for _ in range(draw(st.integers(1 if prop.lamp else 0, _MOST_MARKS))):
        place = side(height, least[0]), side(width, least[1])
        if not prop.plain:
            color[place] = draw(colors)
        if not prop.wall:
            distance[place] = draw(depths)
    return Case(Picture(color, distance, circle), numbers)
