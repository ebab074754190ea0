"""Stages: the arrays of a method by name, for whoever ports it. Costs nothing when nobody listens.

A method declares its stages in its record, `Stage`; who calls it says which it wants, `Stages`; and it records them,
`StageRecorder`. A name that ends in "*" stands for one stage for every step asked for, such as "mean 10" for "mean *".
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_choice, as_integer, as_pair

__all__ = ["COMPARISONS", "MOST_PROBES", "Bounds", "Stage", "StageRecorder", "Staged", "Stages", "as_stages"]

MOST_PROBES = 16
_MOST_STEPS = 65536
_LARGEST_SIDE = 32768

COMPARISONS: dict[str, str] = {
    "exact": "nothing is rounded: the same bits, whole numbers or texels",
    "formula": "a few roundings of the type: 8 units in the last place",
    "filter": "a weighted sum: as many roundings as terms, in any order",
}


@dataclass(frozen=True)
class Stage:
    """What a method declares of a stage.

    Attributes
    ----------
    name : str
        As recorded; one that ends in "*" is recorded for every step of `Stages.steps`.
    axes : str
        Names and lengths of its axes: H and W are the picture's, P probes; others are the method's own.
    unit : str
    meaning : str
    comparison : one of `COMPARISONS`
        How a correct port's may differ.
    columns : names of the entries along the last axis, if they are not alike
    """

    name: str
    axes: str
    unit: str
    meaning: str
    comparison: str
    columns: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        as_choice("comparison", self.comparison, COMPARISONS)

    def names(self, name: str) -> bool:
        """Whether a recorded stage's name is this one's."""
        if not self.name.endswith("*"):
            return name == self.name
        return name.startswith(self.name[:-1]) and name[len(self.name) - 1 :].isdigit()


@dataclass(frozen=True)
class Stages:
    """Which stages to record.

    Parameters
    ----------
    steps : whole numbers, 0 .. 65536, or None
        Steps of a method's loop after which its state is recorded, such as taps. None: 1, 4, 16 and so on, and all.
    pixels : pairs (x, y), at most 16, or None
        Probes: pixels whose loop is recorded step by step. Row 0 is the top row. None: the middles of 4 x 4 parts.

    Raises
    ------
    InputError
        If a step or a pixel is no whole number, or there are too many.
    """

    steps: tuple[int, ...] | None = ()
    pixels: tuple[tuple[int, int], ...] | None = ()

    def __post_init__(self) -> None:
        if self.steps is not None:
            steps = {as_integer("steps", k, minimum=0, maximum=_MOST_STEPS) for k in _listed("steps", self.steps)}
            object.__setattr__(self, "steps", tuple(sorted(steps)))
        if self.pixels is not None:
            pixels = [as_pair("pixels", p, minimum=0, maximum=_LARGEST_SIDE) for p in _listed("pixels", self.pixels)]
            if len(pixels) > MOST_PROBES:
                raise InputError(f"pixels: got {len(pixels)}; allowed are at most {MOST_PROBES}")
            object.__setattr__(self, "pixels", tuple(pixels))


class Staged(NamedTuple):
    """A picture (H, W, 3) and the stages on the way to it, by name."""

    image: Float
    stages: dict[str, np.ndarray]


class Bounds(NamedTuple):
    """What correct programs may give where a choice is not determined.

    low, high (H, W, 3) float64, the same where all is determined; ambiguity (H, W) bool, where they differ.
    """

    low: Float
    high: Float
    ambiguity: np.ndarray


class StageRecorder:
    """Records arrays under names if `on`; otherwise `record` does not even make them."""

    def __init__(self, on: bool | Stages = False) -> None:
        self.on = bool(on)
        self._wanted = on if isinstance(on, Stages) else Stages()
        self.stages: dict[str, np.ndarray] = {}

    def record(self, name: str, make: Callable[[], Any]) -> None:
        """Keep a copy of `make()` as stage `name`."""
        if self.on:
            self.stages[name] = np.array(make())

    def record_all(self, make: Callable[[], Mapping[str, Any]]) -> None:
        """Keep copies of all stages that `make()` gives by name."""
        if self.on:
            self.stages |= {name: np.array(stage) for name, stage in make().items()}

    def answer(self, image: Float) -> Float | Staged:
        """`image`, with all stages recorded so far if any were wanted."""
        return Staged(image, self.stages) if self.on else image

    def steps(self, count: int) -> tuple[int, ...]:
        """The steps wanted of a loop of `count`."""
        if self._wanted.steps is None:
            return tuple(sorted({*(4**k for k in range(8) if 4**k < count), count}))
        beyond = [k for k in self._wanted.steps if k > count]
        if beyond:
            raise InputError(f"steps: got {beyond[0]}; allowed are 0 .. {count}, the steps of the loop")
        return self._wanted.steps

    def pixels(self, height: int, width: int) -> tuple[tuple[int, int], ...]:
        """The probes wanted in a picture."""
        if self._wanted.pixels is None:
            middles = [[(2 * k + 1) * side // 8 for k in range(4)] for side in (width, height)]
            return tuple(sorted({(x, y) for y in middles[1] for x in middles[0]}, key=lambda place: place[::-1]))
        for x, y in self._wanted.pixels:
            if x >= width or y >= height:
                raise InputError(f"pixels: got ({x}, {y}); allowed are pixels of {width} x {height}")
        return self._wanted.pixels


def as_stages(value: Any) -> bool | Stages:
    """Return the argument `stages` if it is True, False or a `Stages`."""
    if isinstance(value, Stages):
        return value
    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise InputError(f"stages: got a {type(value).__name__}; allowed are True, False and a refdof.Stages")


def _listed(name: str, value: Any) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple):
        raise InputError(f"{name}: got a {type(value).__name__}; allowed is a list")
    return tuple(value)
