"""Focus point: a place on a surface that shall be sharp, or blurred by an offset, and how much it counts.

A point is a triangle and barycentric coordinates, so that it follows its surface wherever the vertices go, [1]. What is
said of it may change over time: a number, or keyframes.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 5.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_bool, as_choice, as_float, as_instance, as_integer, as_number, as_pair
from refdof.focus.fading import places, shares
from refdof.focus.keys import as_number_or_keys
from refdof.view import View

__all__ = ["FocusPoint", "Placed", "pick", "placed"]

_RANGES: dict[str, dict[str, Any]] = {  # of what may have keyframes
    "offset": {"minimum": -1e100, "maximum": 1e100},
    "aperture": {"minimum": 0.0, "maximum": 1.0},
    "weight": {"minimum": 0.0, "maximum": 1e6},
    "image_offset": {"minimum": -1e100, "maximum": 1e100},
}


@dataclass(frozen=True)
class FocusPoint:
    """A place on a surface, and what the lens shall do there.

    Parameters
    ----------
    triangle : int
        Index of the triangle in the scene's faces.
    barycentrics : 3 floats
        Of its corners, >= 0; they are divided by their sum.
    offset : float, or keyframes
        The distance in focus there lies so far behind the point [scene units]; 0: it is sharp.
    aperture : float, or keyframes
        Radius of the aperture there over the lens radius, 0 to 1.
    weight : float, or keyframes
        alpha, >= 0: how much the point counts beside others.
    falloff : float
        beta, 1 to 8: how fast it counts less with the distance in the picture; 2 to 4 works well, [1].
    image_offset : float, or keyframes
        The image plane there is displaced so far away from the lens [scene units, on the image's side]: curvature of
        field, and no longer sharp.
    keep : bool
        Counts as much when it is outside the picture or hidden.
    name : str

    Keyframes are pairs (frame, value), frames in growing order; between them a monotone cubic, beyond them constant.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    triangle: int
    barycentrics: tuple[float, float, float]
    offset: Any = 0.0
    aperture: Any = 1.0
    weight: Any = 1.0
    falloff: float = 3.0
    image_offset: Any = 0.0
    keep: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "triangle", as_integer("triangle", self.triangle, minimum=0))
        shares = as_float("barycentrics", self.barycentrics, (3,), dtype=np.float64, minimum=0.0, maximum=1e6)
        if not shares.sum() > 0.0:
            raise InputError("barycentrics: all are 0; at least one must be above 0")
        whole = 1.0 if abs(shares.sum() - 1.0) < 1e-12 else shares.sum()  # what was divided stays as it is
        object.__setattr__(self, "barycentrics", tuple((shares / whole).tolist()))
        for word, limits in _RANGES.items():
            object.__setattr__(self, word, as_number_or_keys(word, getattr(self, word), limits))
        object.__setattr__(self, "falloff", as_number("falloff", self.falloff, minimum=1.0, maximum=8.0))
        as_bool("keep", self.keep)
        if not isinstance(self.name, str):
            raise InputError(f"name: got {type(self.name).__name__}; allowed is text")

    def value(self, word: str, frame: float) -> float:
        """`offset`, `aperture`, `weight` or `image_offset` at a frame."""
        given = getattr(self, as_choice("word", word, _RANGES))
        frame = as_number("frame", frame)
        if not isinstance(given, tuple):
            return float(given)
        from scipy.interpolate import PchipInterpolator  # slow to import

        frames, values = np.transpose(given)
        frames = np.concatenate([[frames[0] - 1.0], frames, [frames[-1] + 1.0]])  # it starts and ends without a jerk
        values = np.concatenate([values[:1], values, values[-1:]])
        return float(PchipInterpolator(frames, values)(np.clip(frame, frames[0], frames[-1])))


class Placed(NamedTuple):
    """Points before a camera: N of them, those that count."""

    places: Float  # (N, 2) x and y in the image [px]
    depth: Float  # (N,) planar distance [scene units]
    focus: Float  # (N,) distance in focus there
    aperture: Float  # (N,)
    weight: Float  # (N,) alpha, less where the point fades out or others are nearer
    falloff: Float  # (N,)
    image_offset: Float  # (N,) [scene units]
    hold: Float  # (N,) above 0 to 1: how much of the point's constraint is left, less where less than half of it counts


def pick(view: View, pixel: tuple[int, int], name: str = "") -> FocusPoint:
    """The focus point under a pixel (column, row).

    Raises
    ------
    InputError
        If the pixel is outside the picture, or shows the background.
    """
    as_instance("view", view, View)
    pixel = as_pair("pixel", pixel, minimum=0, maximum=1 << 20)
    width, height = view.camera.size
    if not (0 <= pixel[0] < width and 0 <= pixel[1] < height):
        raise InputError(f"pixel: got {pixel[0]},{pixel[1]}; allowed is 0,0 to {width - 1},{height - 1}")
    triangle = int(view.layers(1).triangle[0, pixel[1], pixel[0]]) if view.layers(1).triangle.size else -1
    if triangle < 0:
        raise InputError(f"pixel: got {pixel[0]},{pixel[1]}, which shows the background; allowed is one on a surface")
    corners = view.camera.camera_from_world(view.scene.vertices[view.scene.faces[triangle]])
    scale = 1.0 / view.camera.pixels_per_tangent
    ray = np.array([(pixel[0] + 0.5 - 0.5 * width) * scale, (0.5 * height - pixel[1] - 0.5) * scale, -1.0])
    shares = np.linalg.solve(corners.T, ray)  # the ray's point is a sum of corners; its length drops out
    return FocusPoint(triangle, tuple((np.maximum(shares, 0.0) / np.maximum(shares, 0.0).sum()).tolist()), name=name)


def placed(points: list[FocusPoint], view: View, frame: float | None = None) -> Placed:
    """The points as a view's camera sees them at a frame. Default: the one that the scene stands at.

    A point outside the picture fades out over a tenth of its height, a hidden one as its surroundings are hidden: by
    the visible share of a disc of a fiftieth of the height. Where the scene moves, both change smoothly in time:
    `refdof.focus.fading`. Of two points, the nearer weighs more, in proportion.

    Raises
    ------
    InputError
        If a triangle does not exist, or no point counts.
    """
    faces, frame = view.scene.faces, view.scene.frame if frame is None else frame
    for point in points:
        if point.triangle >= len(faces):
            raise InputError(f"triangle: got {point.triangle}; the scene has {len(faces)}, counted from 0")
    triangles = np.array([point.triangle for point in points])
    barycentrics = np.array([point.barycentrics for point in points])
    x, y, depth = places(triangles, barycentrics, view.at_frame(frame)).T
    weight = np.array([point.value("weight", frame) for point in points])
    weight[~(depth > 0.0)] = 0.0
    fades = np.array([not point.keep for point in points]) & (weight > 0.0)
    share = np.ones(len(points))
    if fades.any():
        share[fades] = shares(triangles[fades], barycentrics[fades], view, frame)
    weight *= share
    counts = weight > 0.0
    if not counts.any():
        raise InputError("points: none of them is in the picture; allowed is one that is, or `keep`")
    focus = depth + np.array([point.value("offset", frame) for point in points])
    if not focus[counts].min() > 0.0:
        raise InputError(f"offset: puts the focus at {focus[counts].min():g}; allowed is a distance above 0")
    found = np.stack([x, y], axis=1), depth, focus, [point.value("aperture", frame) for point in points]
    others = [point.falloff for point in points], [point.value("image_offset", frame) for point in points]
    nearest = depth[counts].min()
    weight = weight * nearest / np.where(counts, depth, 1.0)
    hold = np.minimum(2.0 * share, 1.0)
    return Placed(*(np.asarray(values, dtype=np.float64)[counts] for values in (*found, weight, *others, hold)))
