"""State: what a page asks for, as JSON and checked.

A state is everything that a picture depends on besides the scene: camera, lens, focus points, method, overlay, frame.
"""

import math
from dataclasses import dataclass, fields
from typing import Any

from refdof._check import InputError, as_bool, as_choice, as_integer, as_number, as_pair
from refdof._toml import check_keys
from refdof.focus.focus_lens import KINDS
from refdof.focus.point import FocusPoint
from refdof.methods import METHODS
from refdof.optics.camera import Camera

__all__ = ["LENS_KINDS", "OVERLAYS", "LensSetting", "State", "parse_state", "point_as_json", "state_as_json"]

LENS_KINDS = ("thin", *KINDS, "file")
OVERLAYS = ("none", "coc", "focus", "depth", "layers", "error")

_MOST_PIXELS = 1920 * 1200
_MOST_POINTS = 256
_LARGEST_ID = 1 << 53  # whole numbers of JavaScript
_CAMERA = ("eye", "target", "up", "fov_y")
_LENS = ("kind", "radius", "focus", "focal_length", "file", "f_number")
_STATE = ("id", "camera", "size", "lens", "points", "method", "overlay", "frame", "moving")
_POINT = tuple(field.name for field in fields(FocusPoint))


@dataclass(frozen=True)
class LensSetting:
    """The lens of a state.

    Attributes
    ----------
    kind : one of `LENS_KINDS`
    radius : float
        Lens radius [scene units], >= 0; a real lens is scaled to it.
    focus : float
        Distance in focus of "thin" and "file" [scene units]; may be inf.
    focal_length : float
        [scene units]; the page's f-number is focal_length / (2 radius).
    file : str
        Of "file": a lens of data/lenses, or a file of the folder.
    f_number : float or None
        Stop of "file"; None: open as far as it goes.
    """

    kind: str
    radius: float
    focus: float
    focal_length: float
    file: str
    f_number: float | None


@dataclass(frozen=True)
class State:
    """What a picture depends on besides the scene.

    Attributes
    ----------
    id : int
        The page's number of this state.
    camera : Camera
        Its size is that of the fine picture.
    lens : LensSetting
    points : FocusPoints
    method : str
    overlay : one of `OVERLAYS`
    frame : float
    moving : bool
        Something is being dragged: no fine picture.
    """

    id: int
    camera: Camera
    lens: LensSetting
    points: tuple[FocusPoint, ...]
    method: str
    overlay: str
    frame: float
    moving: bool


def parse_state(raw: Any) -> State:
    """The state of a page's JSON.

    Raises
    ------
    InputError
        If something in it is missing, unknown or out of range.
    """
    check_keys("state", _table("state", raw), _STATE)
    camera, lens = _table("camera", raw["camera"]), _table("lens", raw["lens"])
    check_keys("camera", camera, _CAMERA)
    check_keys("lens", lens, _LENS)
    size = as_pair("size", raw["size"], minimum=1, maximum=8192)
    if size[0] * size[1] > _MOST_PIXELS:
        raise InputError(f"size: got {size[0]}x{size[1]}; allowed are at most {_MOST_PIXELS} pixels")
    given = raw["points"]
    if not isinstance(given, list) or len(given) > _MOST_POINTS:
        raise InputError(f"points: got {type(given).__name__}; allowed is a list of at most {_MOST_POINTS}")
    return State(
        as_integer("id", raw["id"], minimum=0, maximum=_LARGEST_ID),
        Camera(camera["eye"], camera["target"], camera["up"], camera["fov_y"], size),
        _lens(lens),
        tuple(_point(number, point) for number, point in enumerate(given, 1)),
        as_choice("method", raw["method"], METHODS),
        as_choice("overlay", raw["overlay"], OVERLAYS),
        as_number("frame", raw["frame"], minimum=-1e6, maximum=1e6),
        as_bool("moving", raw["moving"]),
    )


def state_as_json(state: State) -> dict[str, Any]:
    """The state as plain values; `parse_state` gives it back."""
    camera, lens = state.camera, state.lens
    return {
        "id": state.id,
        "camera": {name: _plain(getattr(camera, name)) for name in _CAMERA},
        "size": list(camera.size),
        "lens": {name: _plain(getattr(lens, name)) for name in _LENS},
        "points": [point_as_json(point) for point in state.points],
        "method": state.method,
        "overlay": state.overlay,
        "frame": state.frame,
        "moving": state.moving,
    }


def point_as_json(point: FocusPoint) -> dict[str, Any]:
    """A focus point as plain values."""
    return {name: _plain(getattr(point, name)) for name in _POINT}


def _lens(raw: dict[str, Any]) -> LensSetting:
    focus, stop = raw["focus"], raw["f_number"]
    if not isinstance(raw["file"], str):
        raise InputError(f"file: got {type(raw['file']).__name__}; allowed is text")
    return LensSetting(
        as_choice("kind", raw["kind"], LENS_KINDS),
        as_number("radius", raw["radius"], minimum=0.0),
        math.inf if focus is None else as_number("focus", focus, above=0.0),
        as_number("focal_length", raw["focal_length"], above=0.0),
        raw["file"],
        None if stop is None else as_number("f_number", stop, above=0.0),
    )


def _point(number: int, raw: Any) -> FocusPoint:
    try:
        check_keys("", _table("point", raw), ("triangle", "barycentrics"), _POINT[2:])
        return FocusPoint(**raw)
    except InputError as error:
        raise InputError(f"point {number}: {error}") from None


def _table(name: str, raw: Any) -> dict[str, Any]:
    if not isinstance(raw, dict) or not all(isinstance(key, str) for key in raw):
        raise InputError(f"{name}: got {type(raw).__name__}; allowed is an object")
    return raw


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(part) for part in value]
    return None if isinstance(value, float) and math.isinf(value) else value
