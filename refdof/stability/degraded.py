"""Degraded: what a method cannot do better as it was published, by how much it may fail, and why."""

from collections.abc import Mapping
from typing import NamedTuple

__all__ = ["DEGRADED", "Documented", "reasons", "wider_bound"]


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

_STEPS = Documented(
    {"picture": 0.67},  # 3/4 of a contrast of 0.8 over the brightest, 0.9
    "Circles round to whole steps, and circles that are stored coarsely to another one: of s + 1 steps to each side of "
    "a rhombus to s + 2, which moves 1 - ((s + 1) / (s + 2))^2 of a pixel's weights, three quarters at most.",
)
_UNIT_OF_DEPTH = Documented(
    {"same bits": 33.0 * 25.0, "same picture": 5e4},  # all pixels; 1 over the room, 168 2^-23: black for the brightest
    "Near and far are told by differences of depth beside constants of the engine in one unit: in another unit it is "
    "another picture, which may hold any colour from black to the brightest.",
)
_GREATEST_AROUND = Documented(
    {"sharpness": 3e3},  # 0.8 times 0.13 px times 0.48 units of depth, over the room of a pixel in focus, 1.8e-5
    "A pixel in focus that lies behind the nearest surface around takes as much of the blurred picture as the greatest "
    "circle around has pixels of half the size, up to 0.13 here, times the depth between the two, up to 0.48.",
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
    ("depth-device-16", "hexagon"): _STEPS,
    ("depth-reversed-16", "hexagon"): _STEPS,
    ("focus-ulps", "ringgather"): _GREATEST_AROUND,
    ("scale-2^-20", "ringgather"): _UNIT_OF_DEPTH,
    ("scale-2^1", "ringgather"): _UNIT_OF_DEPTH,
    ("scale-2^20", "ringgather"): _UNIT_OF_DEPTH,
    ("unit-micro", "ringgather"): _UNIT_OF_DEPTH,
    ("unit-mega", "ringgather"): _UNIT_OF_DEPTH,
    ("unit-tied", "ringgather"): _UNIT_OF_DEPTH,
}


def wider_bound(case: str, method: str, figure: str) -> float | None:
    """What is documented of a figure instead of its bound; None: nothing is."""
    documented = DEGRADED.get((case, method))
    return None if documented is None else documented.bounds.get(figure)


def reasons() -> dict[str, dict[tuple[str, str], Mapping[str, float]]]:
    """The bounds of each (case, method) by the sentence that explains them."""
    found: dict[str, dict[tuple[str, str], Mapping[str, float]]] = {}
    for place, documented in DEGRADED.items():
        found.setdefault(documented.why, {})[place] = documented.bounds
    return found
