"""Search: the first picture on which a check fails, by hypothesis, from the same seed every time."""

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, Verbosity, find, settings
from hypothesis import strategies as st
from hypothesis.errors import FlakyFailure, NoSuchExample
from hypothesis.internal.conjecture.providers import AVAILABLE_PROVIDERS, HypothesisProvider

from refdof.testing.compared import Room
from refdof.testing.picture import DEPTHS, WALLS, Case, Picture, axis_of, circles_up_to
from refdof.testing.properties import Property

__all__ = ["Flaky", "search"]

_BACKEND = "refdof"
_LIGHTS = (1.0, 0.5, 0.25, 3.0, 12000.0)  # also beyond white; five times as much is still a half float
_MOST_MARKS, _MARK_SIDE = 4, 3
_COLOR_GRAIN, _DEPTH_GRAIN = 1, 2  # every pixel for itself, from one of so many seeds
_MOST_SEEDS = 999
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
    AVAILABLE_PROVIDERS.setdefault(_BACKEND, f"{__name__}._Plain")
    wanted = settings(
        backend=_BACKEND,
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


class _Plain(HypothesisProvider):
    """Hypothesis without the numbers that it picks from modules of the caller's: the same pictures for everybody."""

    def _maybe_draw_constant(self, *_: Any, **__: Any) -> None:
        return None


@st.composite
def _cases(draw: st.DrawFn, prop: Property, room: Room, circle: float, channels: int) -> Case:
    """Cases of a property: simple first, few marks on a picture of one colour and depth."""
    circle = draw(st.sampled_from(circles_up_to(circle)))
    numbers = tuple(draw(st.integers(0, most)) for most in prop.numbers)
    margin = room.margin(circle)
    margins = (prop.along, prop.across) if numbers and axis_of(numbers[0]) == 0 else (prop.across, prop.along)
    least = [int(count * margin) for count in margins]
    height, width = (side + draw(st.integers(1, _MOST_PIXELS)) for side in least)

    values = _LIGHTS if prop.lamp else (0.0, *_LIGHTS)
    depths = WALLS if prop.wall else DEPTHS

    def drawn_color() -> tuple[float, ...]:
        """One number stands for all channels: every draw takes its time."""
        code = draw(st.integers(0, len(values) ** channels - 1))
        return tuple(values[code // len(values) ** c % len(values)] for c in range(channels))

    def drawn_depth() -> float:
        return depths[draw(st.integers(0, len(depths) - 1))]

    color, depth = np.zeros((height, width, channels), np.float32), np.empty((height, width), np.float32)
    if not prop.lamp:
        color[:] = drawn_color()
    depth[:] = drawn_depth() if prop.base is None else prop.base
    grain, seed = draw(st.integers(0, _COLOR_GRAIN | _DEPTH_GRAIN)), draw(st.integers(0, _MOST_SEEDS))
    random = np.random.default_rng(seed)
    if grain & _COLOR_GRAIN and not (prop.lamp or prop.plain):
        color[:] = random.choice(values, color.shape)
    if grain & _DEPTH_GRAIN and not (prop.wall or prop.base is not None):
        depth[:] = random.choice(depths, depth.shape)
    for _ in range(draw(st.integers(1 if prop.lamp else 0, _MOST_MARKS))):
        # Lights lie in the middle.
        top, left = (side // 2 if prop.lamp else 0 for side in least)
        y, x = draw(st.integers(top, height - 1 - top)), draw(st.integers(left, width - 1 - left))
        rows, columns = divmod(draw(st.integers(0, _MARK_SIDE**2 - 1)), _MARK_SIDE)
        place = slice(y, min(y + 1 + rows, height - top)), slice(x, min(x + 1 + columns, width - left))
        if not prop.plain:
            color[place] = drawn_color()
        if not prop.wall:
            depth[place] = drawn_depth()
    return Case(Picture(color, depth, circle), numbers)
