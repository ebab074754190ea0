"""Multiview synthesis: every pixel sends rays from the lens through a scene that was drawn once, as layers of depth.

Steps and departures: `method`.
"""

from refdof.methods.multiview import method
from refdof.methods.multiview.method import (
    CONES,
    LEAST_SPACING,
    METHOD,
    OFFSCREEN,
    SEARCHES,
    SPACING,
    SPACING_HEIGHT,
    STARTS,
    Params,
    cone_width,
    render,
)

__all__ = [
    "CONES",
    "LEAST_SPACING",
    "METHOD",
    "OFFSCREEN",
    "SEARCHES",
    "SPACING",
    "SPACING_HEIGHT",
    "STARTS",
    "Params",
    "cone_width",
    "render",
]

__doc__ = method.__doc__
