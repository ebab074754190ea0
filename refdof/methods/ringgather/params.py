"""Params of the ring gather, and its points."""

from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_bool, as_choice, as_number

__all__ = ["COLORS", "RINGS", "TILE", "Params", "from_working", "points", "to_working"]

COLORS = ("linear", "tonemapped")
RINGS = 3  # that are used, of a table of four
TILE = 32  # px


@dataclass(frozen=True)
class Params:
    """What ports change.

    Parameters
    ----------
    largest_px : float
        Circles of confusion are cut at this radius [px], 0 .. 1024. Tiles reach 32 px: more leaks past them.
    foreground : float > 0
        How far behind the nearest surface around it a tap still counts as near [unit of depth]; engines have 0.667
        units, 2.5 m or 100 inches.
    gain : float
        Opacity of the near taps, 0 .. 8; the engine's is 1, another port's 2.
    fill : bool
        Taps reach as far as the blur does, instead of three quarters of it.
    working : {"linear", "tonemapped"}
        The colours that are summed: as given, or divided by one more than their greatest channel.
    """

    largest_px: float = 32.0
    foreground: float = 2.0 / 3.0
    gain: float = 1.0
    fill: bool = False
    working: str = "linear"

    def __post_init__(self) -> None:
        for name, most in (("largest_px", 1024.0), ("gain", 8.0)):
            object.__setattr__(self, name, as_number(name, getattr(self, name), minimum=0.0, maximum=most))
        object.__setattr__(self, "foreground", as_number("foreground", self.foreground, above=0.0))
        object.__setattr__(self, "fill", as_bool("fill", self.fill))
        as_choice("working", self.working, COLORS)


def to_working(color: Float, working: str) -> Float:
    """Colours (H, W, 3) as they are summed."""
    return color if working == "linear" else color / (color.dtype.type(1) + color.max(axis=2, keepdims=True))


def from_working(soft: Float, working: str) -> Float:
    """Sums of them (h, w, 4), alpha last, as colours again."""
    if working == "linear":
        return soft
    kind = soft.dtype.type
    whole = np.maximum(kind(1) - soft[..., :3].max(axis=2, keepdims=True), kind(1e-6))
    return np.concatenate([soft[..., :3] / whole, soft[..., 3:]], axis=2)


def points(fill: bool) -> Float:
    """The taps (48, 2), y down, ring by ring: 8 j at j quarters of the radius, odd rings from half a step on."""
    found = []
    for j in range(1, RINGS + 1):
        angles = (np.arange(8 * j) + 0.5 * (j % 2)) * (2.0 * np.pi / (8 * j))
        found.append(j / (RINGS if fill else 4.0) * np.column_stack([np.cos(angles), np.sin(angles)]))
    return np.concatenate(found)
