"""Focus lens: the lens that makes focus points sharp, in one of three ways.

- "distance": a thin lens, focused at the mean of the points' inverse distances        `_distance`
- "plane": tilt-shift, a tilted image plane behind a thin lens                          `focal_plane`
- "surface": a focal surface and an aperture of each pixel's own                        `moving_least_squares`

To each comes what simple lenses do wrong, if it is asked for:

- curvature of field: an offset surface of the image plane, through the points' own        `moving_least_squares`
- spherical aberration and bokeh: power and weight of rays over the aperture             `aperture_spline`

Departures from the paper
-------------------------
- The surface interpolates inverse distances: a plane through three points is one, as a lens sees it.
- Weights 1 / d^beta are those of a pixel's distance from each point, in picture heights.
- Offsets of the image plane go on from where the kind of lens puts it: from the tilted plane, or from the bent one that
  a focal surface needs. In the paper they are alone, or with tilt-shift (its figure 6).
- A point that fades out takes its constraint along: a plane through two points turns into the one through the other as
  one fades, and does not jump when it is gone. See `_blend`.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, sections 5.1 to 5.3.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_choice, as_instance, as_instances, as_number
from refdof.focus.aperture_spline import LEAST_POWER, aperture_spline, as_controls
from refdof.focus.focal_plane import FocalPlane, focal_plane
from refdof.focus.keys import Keys
from refdof.focus.moving_least_squares import moving_least_squares
from refdof.focus.point import FocusPoint, Placed, placed
from refdof.optics.camera import Camera
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.lens import ThinLens
from refdof.view import View

__all__ = ["KINDS", "Focus", "focus_lens"]

KINDS = ("distance", "plane", "surface")
_MOST_POINTS = 256
_FOCAL_LENGTH = 0.1  # of the nearest distance in focus, where none is given


@dataclass(frozen=True)
class Focus:
    """Focus points, and what the lens does to follow them.

    Parameters
    ----------
    points : tuple of FocusPoint
        1 to 256.
    kind : one of `KINDS`
        "surface" follows every point, and with one point is even; "plane" is what a view camera can do; "distance" is
        what any camera can.
    focal_length : float, optional
        [scene units]; below the distances in focus. It sets the tilt of the image plane, and with the lens radius the
        f-number; without an offset of the image plane or a power, the picture does not depend on it. Default: a tenth
        of the nearest distance in focus.
    power, ray_weights : sequence of pairs, optional
        Controls (share of the lens radius 0 .. 1, value): refractive power over that of the nominal lens, at least
        0.001, and weights of rays, >= 0 and not all 0; see `refdof.focus.aperture_spline`. Default: 1 everywhere.

    Raises
    ------
    InputError
        If a number is out of range or there is no point.
    """

    points: tuple[FocusPoint, ...]
    kind: str = "surface"
    focal_length: float | None = None
    power: Keys = ()
    ray_weights: Keys = ()

    def __post_init__(self) -> None:
        if isinstance(self.points, list | tuple) and not 1 <= len(self.points) <= _MOST_POINTS:
            raise InputError(f"points: got {len(self.points)}; allowed are 1 to {_MOST_POINTS}")
        object.__setattr__(self, "points", as_instances("points", self.points, FocusPoint))
        as_choice("kind", self.kind, KINDS)
        if self.focal_length is not None:
            object.__setattr__(self, "focal_length", as_number("focal_length", self.focal_length, above=0.0))
        for name, least in (("power", LEAST_POWER), ("ray_weights", 0.0)):
            object.__setattr__(self, name, as_controls(name, getattr(self, name), least))


def focus_lens(focus: Focus, view: View, frame: float | None = None) -> ThinLens:
    """The lens of the view's lens radius and aperture that follows focus points at a frame.

    The scene is taken to that frame; without one, it stays where it is. A lens for `view.at_frame(frame)` is the same
    from `view`, which keeps what it finds out for the frames that follow.

    Raises
    ------
    InputError
        If no point is in the picture, a triangle does not exist, a distance in focus is not in front of the lens, or
        an offset puts the image plane there.
    """
    as_instance("focus", focus, Focus)
    as_instance("view", view, View)
    frame = as_number("frame", view.scene.frame if frame is None else frame, minimum=-1e9, maximum=1e9)
    found = placed(list(focus.points), view, frame)
    length = _FOCAL_LENGTH * float(found.focus.min()) if focus.focal_length is None else focus.focal_length
    if not length < found.focus.min():
        raise InputError(
            f"focal_length: got {length:g}; allowed is less than the nearest distance in focus {found.focus.min():g}"
        )
    camera, lens = view.camera, view.lens
    given: dict[str, Any] = {
        "aperture": lens.aperture,
        "power": aperture_spline(focus.power, LEAST_POWER),
        "ray_weights": aperture_spline(focus.ray_weights, 0.0),
    }
    bend: Any = 0.0
    if found.image_offset.any():
        (bend,) = _blend(found, lambda part: _surfaces(part, camera, part.image_offset))
        given["image_offset"] = bend
    mean = 1.0 / float(_blend(found, _inverse))
    aperture = float(_blend(found, _aperture))
    if focus.kind == "distance":
        return ExpressiveLens(lens.radius, mean, length, aperture_scale=[[aperture]], **given)
    if focus.kind == "plane":
        a, b, c = _blend(found, lambda part: np.array(focal_plane(part, camera).coefficients)).tolist()
        plane = FocalPlane((a, b, c))
        inverse = plane.inverse_focus(camera)
        if not inverse.max() < 1.0 / length:
            raise InputError(
                f"focal_length: got {length:g}; allowed is less than the plane's nearest distance {1 / inverse.max():g}"
            )
        axis = 1.0 / plane.coefficients[0]
        offset = 1.0 / (1.0 / length - inverse) - 1.0 / (1.0 / length - 1.0 / axis)
        given |= {"image_offset": offset + bend, "aperture_scale": [[aperture]]}
        return ExpressiveLens(lens.radius, axis, length, **given)
    inverse, scale = _blend(found, lambda part: _surfaces(part, camera, 1.0 / part.focus, part.aperture))
    with np.errstate(divide="ignore"):
        surface = 1.0 / np.maximum(inverse, 0.0)
    return ExpressiveLens(
        lens.radius, mean, length, focal_surface=surface, aperture_scale=np.clip(scale, 0.0, 1.0), **given
    )


def _blend(found: Placed, make: Callable[[Placed], Any]) -> Any:
    """What points make of a focus: the mean, over thresholds up to the largest hold, of what those above each make.

    A point of hold h beside others of 1 has h of what all make, and the rest is of the others alone; so nothing jumps
    when it goes. It is the Choquet integral over the holds.
    """
    levels = np.unique(found.hold)
    steps = np.diff(levels, prepend=0.0) / levels[-1]
    above = [found.hold >= level for level in levels]
    return sum(
        step * make(Placed(*(values[those] for values in found))) for step, those in zip(steps, above, strict=True)
    )


def _inverse(found: Placed) -> float:
    """One inverse distance for all: the mean by weight."""
    return float((found.weight / found.focus).sum() / found.weight.sum())


def _aperture(found: Placed) -> float:
    """One aperture for all: the mean by weight."""
    return float((found.weight * found.aperture).sum() / found.weight.sum())


def _surfaces(found: Placed, camera: Camera, *of_points: Float) -> Float:
    """(C, H, W): surfaces over the picture through C values of each point, (N,) each."""
    rows, columns = np.mgrid[: camera.height, : camera.width]
    pixels = np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1)
    values = np.stack(of_points, axis=1)
    heights = np.empty((len(pixels), len(of_points)))
    scale = 1.0 / camera.height
    for row in range(0, len(pixels), camera.width):  # a row at a time: points times pixels of it are in memory
        part = slice(row, row + camera.width)
        heights[part] = moving_least_squares(
            found.places * scale, values, found.weight, found.falloff, pixels[part] * scale
        )
    return np.moveaxis(heights.reshape(camera.height, camera.width, -1), 2, 0)
