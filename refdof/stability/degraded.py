"""Degraded: what a method cannot do better as it was published, by how much it may fail, and why."""

from collections.abc import Mapping
from typing import NamedTuple

__all__ = ["DEGRADED", "Documented", "reasons"]


class Documented(NamedTuple):
    """Wider bounds by a figure's name, and a sentence."""

    bounds: Mapping[str, float]
    why: str


_BY_DEPTH = Documented(
    {"sharpness": 1e5, "pinhole": 2.0**23, "picture": 0.1, "half": 1.0},
    "Its blur grows with depth up to the nearest and farthest surface, not with the circle of confusion: it does not "
    "end where circles end, and hangs on depths that a depth buffer holds coarsely or a half float not at all.",
)
_YES_OR_NO = Documented(
    {"float32": 2.0**14, "sharpness": 1e5},
    "A tap counts in full where its code is not below the pixel's, a yes or no that a rounding decides where codes are "
    "alike; and its blur grows with depth, not with the circle of confusion.",
)
_NEIGHBOURS = Documented(
    {"float32": 2.0**20, "picture": 0.25, "symmetry": 2.0**20},
    "The blur of nearer neighbours is taken where they are nearer, a yes or no that a rounding decides where circles "
    "are alike.",
)
_SHARP_OR_NOT = Documented(
    {"same picture": 1e3, "picture": 0.02},
    "What lies in front of a sub-image is removed, a yes or no that a rounding decides at its bound, and at the focal "
    "plane.",
)
_FEW_BUFFERS = Documented(
    {"constant": 2.0**17},
    "Surfaces behind the last of four buffers are missing; the background of pixels with fewer shines through there.",
)
_RAYS = Documented(
    {"picture": 0.1, "half": 0.05, "float32": 2.0**20},
    "A ray meets a surface or passes beside it, and reads a neighbour's colour if that is the same surface: where "
    "parallaxes are stored coarsely, or are just as far apart as one surface's may be, some rays change sides.",
)
_LEAKAGE = Documented(
    {"picture": 0.02},
    "What lies behind a pixel counts by the pixel's own radius, up to 1 px: small circles that err change that share.",
)
_EXTENDED = Documented({"edge": 0.175}, "Silhouettes are extended by up to a pixel where a surface lies behind them.")
_NEAR_PLANE = Documented(
    {"far as infinite": 10.0},
    "It draws triangles with a near plane at a millionth of the scene's largest coordinate, so that what is nearer is "
    "missing beside a wall as far as 1e12; the parameter near moves it.",
)
_COPLANAR = Documented(
    {"constant": 2.0**23},
    "Of two triangles in one place Embree takes the one it meets first, the same in every run; exact layers take the "
    "first of the scene.",
)

DEGRADED: dict[tuple[str, str], Documented] = {
    ("focus-ulps", "poisson"): _YES_OR_NO,
    ("focus-hair", "poisson"): _YES_OR_NO,
    ("circle-denormal", "poisson"): _BY_DEPTH,
    ("radius-small", "poisson"): _BY_DEPTH,
    ("depth-device-16", "poisson"): _BY_DEPTH,
    ("depth-reversed-16", "poisson"): _BY_DEPTH,
    ("half-depth-far", "poisson"): _BY_DEPTH,
    ("size-long", "mipmap"): _NEIGHBOURS,
    ("unit-micro", "pyramidal"): _SHARP_OR_NOT,
    ("unit-tied", "pyramidal"): _SHARP_OR_NOT,
    ("depth-device-16", "pyramidal"): _SHARP_OR_NOT,
    ("depth-reversed-16", "pyramidal"): _SHARP_OR_NOT,
    ("layers-thousands", "cascaded"): _FEW_BUFFERS,
    ("unit-tied", "lensblur"): _RAYS,
    ("depth-device-16", "lensblur"): _RAYS,
    ("depth-reversed-16", "lensblur"): _RAYS,
    ("half-circle", "lensblur"): _RAYS,
    ("half-circle", "multiview"): _RAYS,
    ("depth-device-16", "separable"): _LEAKAGE,
    ("depth-reversed-16", "separable"): _LEAKAGE,
    ("samples-most", "lensblur"): _EXTENDED,
    ("depth-infinite", "multiview"): _NEAR_PLANE,
    ("duplicates-apart", "accumulation"): _COPLANAR,
}


def reasons() -> dict[str, dict[tuple[str, str], Mapping[str, float]]]:
    """The bounds of each (case, method) by the sentence that explains them."""
    found: dict[str, dict[tuple[str, str], Mapping[str, float]]] = {}
    for place, documented in DEGRADED.items():
        found.setdefault(documented.why, {})[place] = documented.bounds
    return found
