"""Cases of light: brightest, darkest, and what is no number."""

import numpy as np

from refdof.optics.lens import ThinLens
from refdof.raster.rays.surfaces import surfaces_of
from refdof.stability.cases.case import Case, Skip
from refdof.stability.checks import convex, dark, scaled_by
from refdof.stability.reach import reach_of
from refdof.stability.storage_checks import contamination
from refdof.stability.subjects import frame, mosaic, random_picture
from refdof.view import View

__all__ = ["CASES"]

_SIZE = (65, 49)
_LENS = ThinLens(0.0613, 2.0)
_LAMP = (32, 24)  # x, y
_COLOR = random_picture(5, (33, 25))
_DEPTH = np.random.default_rng(6).choice([1.03, 1.57, 2.0, 4.1, 16.3], (25, 33))


def _lit(light: float) -> View:
    """A pixel that bright among others."""
    color = _COLOR.copy()
    color[12, 16] = light
    return mosaic(color, _DEPTH, _LENS)


def _framed(scale: float) -> View:
    color = _COLOR.copy() * scale
    return frame(color, _DEPTH, _LENS, (0.0, 0.0, 0.0))


def _spoiled(value: float) -> View:
    """Past every check: one card of the mosaic has a colour that is no number. All circles are of 1.08 px."""
    color, depth = random_picture(7, _SIZE), np.full((_SIZE[1], _SIZE[0]), 1.3)
    view = mosaic(color, depth, ThinLens(0.125, 2.0))
    surfaces = surfaces_of(view.scene, view.camera)
    pixel = _LAMP[1] * _SIZE[0] + _LAMP[0]
    for face in (pixel, pixel + depth.size):
        surfaces.attribute[face, :9] = value
    view.product("surfaces", lambda: surfaces)
    return view


def _refused(value: float) -> View:
    color = _COLOR.copy()
    color[12, 16, 1] = value
    return frame(color, _DEPTH, _LENS)


CASES = (
    Case(
        "light-half",
        "light",
        "a pixel of 6e4, near the largest half float",
        lambda: _lit(6e4),
        (convex(0.1, 6e4),),
    ),
    Case(
        "light-1e30",
        "light",
        "colours up to 1e30",
        lambda: _framed(1e30),
        (scaled_by(1e30, lambda: _framed(1.0)), convex(0.0, 0.9e30)),
        skip=Skip.NO_TRIANGLES,
    ),
    Case(
        "light-scene-1e30",
        "light",
        "a scene's colour of 1e30, four of which multiplied leave float32",
        lambda: _lit(1e30),
        refused="color: largest value is 1e+30; allowed are values <= 1e+08",
    ),
    Case(
        "light-too-bright",
        "light",
        "a colour of 1e34, sums of which leave float32",
        lambda: _refused(1e34),
        refused="color: largest value is 1e+34; allowed are values <= 1e+33",
    ),
    Case(
        "light-denormal",
        "light",
        "colours of 1e-40, denormal float32",
        lambda: _framed(1e-40),
        (convex(0.0, 0.9e-40),),
        skip=Skip.NO_TRIANGLES,
    ),
    Case(
        "light-none",
        "light",
        "no light at all",
        lambda: mosaic(np.zeros((25, 33, 3)), _DEPTH, _LENS, (0.0, 0.0, 0.0)),
        (dark,),
    ),
    Case(
        "nan-pixel",
        "light",
        "one NaN",
        lambda: _refused(np.nan),
        refused="color: has 1 NaN values; none are allowed",
    ),
    Case(
        "inf-pixel",
        "light",
        "one infinite pixel",
        lambda: _refused(np.inf),
        refused="color: has 1 infinite values; only finite ones are allowed",
    ),
    Case(
        "nan-inside",
        "light",
        "one NaN behind the checks, as a port without checks has it",
        lambda: _spoiled(np.nan),
        (contamination(_LAMP, reach_of),),
        finite=False,
    ),
    Case(
        "inf-inside",
        "light",
        "one infinite pixel behind the checks",
        lambda: _spoiled(np.inf),
        (contamination(_LAMP, reach_of),),
        finite=False,
    ),
)
