"""Cases of storage: depth and circles as a GPU stores them."""

import numpy as np

from refdof._check import Float
from refdof.frame.depth_kinds import planar_depth
from refdof.optics.lens import ThinLens
from refdof.stability.cases.case import Case, Skip
from refdof.stability.checks import Check
from refdof.stability.storage_checks import in_half, stored_circles, stored_picture
from refdof.stability.subjects import PIXELS, camera_of, frame, mosaic, random_picture
from refdof.view import View

__all__ = ["CASES"]

_SIZE = (33, 25)
_LENS = ThinLens(0.1613, 2.0)  # circles of -8 to 2.5 px
_COLOR = random_picture(13, _SIZE)
_NEAR, _FAR = 0.01, 100.0  # planes
_DEPTH = np.geomspace(0.5, 50.0, 33 * 25)[np.random.default_rng(14).permutation(33 * 25)].reshape(25, 33)
_SCALE = PIXELS * _LENS.radius  # px per unit of inverse depth
_SPAN = 1.0 / _NEAR - 1.0 / _FAR


def _exact() -> View:
    return frame(_COLOR, _DEPTH, _LENS)


def _stored(kind: str, store: str) -> View:
    """The picture with its depth as a depth buffer holds it."""
    n, f, z = _NEAR, _FAR, _DEPTH
    if kind == "device":
        value, planes = f * (z - n) / (z * (f - n)), {"near": n, "far": f}
    elif kind == "reversed":
        value, planes = n * (f - z) / (z * (f - n)), {"near": n, "far": f}
    else:
        value, planes = n / z, {"near": n}
    return frame(_COLOR, planar_depth(_rounded(value, store), kind, camera_of(_SIZE), **planes), _LENS)


def _rounded(value: Float, store: str) -> Float:
    if store == "float32":
        return value.astype(np.float32).astype(np.float64)
    steps = 2.0 ** int(store) - 1.0
    return np.round(value * steps) / steps


def _case(kind: str, store: str, room: float, says: str, reason: str) -> Case:
    checks: tuple[Check, ...] = (stored_circles(_exact, _SCALE * room, reason), stored_picture(_exact))
    return Case(
        f"depth-{kind}-{store}",
        "stored",
        says,
        lambda: _stored(kind, store),
        checks,
        skip=Skip.NO_TRIANGLES,
    )


def _of_scene(far: float) -> View:
    depth = np.where(np.arange(33) < 16, _DEPTH, far)
    return mosaic(_COLOR, depth, _LENS)


CASES = (
    _case("device", "16", _SPAN / 65535.0 / 2.0, "a 16-bit depth buffer", "half a step of 1 / 65535, of 1 / n - 1 / f"),
    _case("device", "24", _SPAN / (2.0**24 - 1.0) / 2.0, "a 24-bit depth buffer", "half a step, of 1 / n - 1 / f"),
    _case(
        "device",
        "float32",
        _SPAN * 2.0**-25,
        "a float32 depth buffer",
        "half a step of float32 below 1, of 1 / n - 1 / f",
    ),
    _case(
        "reversed-infinite",
        "float32",
        2.0**-24 / 0.5,
        "a reversed float32 depth buffer without a far plane",
        "half a step of float32, of 1 / depth itself",
    ),
    _case(
        "reversed", "16", _SPAN / 65535.0 / 2.0, "a reversed 16-bit depth buffer", "half a step of 1 / 65535, as if not"
    ),
    Case("half-circle", "stored", "circles or parallax in half floats", lambda: _of_scene(50.0), (in_half("circle"),)),
    Case("half-depth", "stored", "depth in half floats", lambda: _of_scene(50.0), (in_half("depth"),)),
    Case(
        "half-depth-far",
        "stored",
        "depth in half floats, with surfaces beyond their largest number, 65504",
        lambda: _of_scene(1e6),
        (in_half("depth"),),
    ),
)
