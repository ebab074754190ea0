"""Pinhole camera: where it stands, where it looks, and how large its picture is.

Camera space has x right, y up and looks down -z; `depth` is -z, the planar distance along the optical axis.
Pixel (x, y) is sampled at (x + 0.5, y + 0.5); row 0 is the top row.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from refdof._check import LARGEST_LENGTH, Float, InputError, as_float, as_number, as_pair, as_vector

__all__ = ["Camera"]

_MAX_SIDE_PX = 32768  # larger pictures are taken for a slip of the keyboard
_MIN_FOV = 1e-6  # degrees: a row of the largest picture is then a micrometre 60 km away


@dataclass(frozen=True)
class Camera:
    """A pinhole view of the world.

    Parameters
    ----------
    eye, target, up : (3,) floats
        World position of the eye, a point it looks at, and a direction that is upwards in the picture.
    fov_y : float
        Full vertical field of view [degrees].
    size : (width, height)
        [px]

    Raises
    ------
    InputError
        If the view is degenerate, the angle is outside 1e-6 .. 179 or the size is 0 or absurd.
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    fov_y: float = 40.0
    size: tuple[int, int] = (640, 480)

    def __post_init__(self) -> None:
        for name in ("eye", "target", "up"):
            object.__setattr__(self, name, as_vector(name, getattr(self, name)))
        object.__setattr__(self, "fov_y", as_number("fov_y", self.fov_y, minimum=_MIN_FOV, maximum=179.0))
        object.__setattr__(self, "size", as_pair("size", self.size, minimum=1, maximum=_MAX_SIDE_PX))
        forward = np.subtract(self.target, self.eye)
        reach = np.abs(forward).max()
        if not reach > 0:
            raise InputError(f"target: got {self.target}, the same point as eye; allowed is any other point")
        if not (np.cross(forward / reach, np.divide(self.up, max(np.abs(self.up).max(), 1e-300))) != 0).any():
            raise InputError(f"up: got {self.up}, parallel to the view; allowed is any other direction")

    @classmethod
    def look_at(
        cls,
        eye: tuple[float, float, float],
        target: tuple[float, float, float],
        up: tuple[float, float, float] = (0.0, 1.0, 0.0),
        fov_y: float = 40.0,
        size: tuple[int, int] = (640, 480),
    ) -> "Camera":
        """Camera at `eye` that looks at `target`; `fov_y` in degrees, `size` is (width, height) in pixels."""
        return cls(eye, target, up, fov_y, size)

    def with_size(self, size: tuple[int, int]) -> "Camera":
        """The same view at another picture size; the vertical field of view is kept."""
        return replace(self, size=size)

    @property
    def width(self) -> int:
        """Picture width [px]."""
        return self.size[0]

    @property
    def height(self) -> int:
        """Picture height [px]."""
        return self.size[1]

    @property
    def pixels_per_tangent(self) -> float:
        """P = H / (2 tan(fov_y / 2)): how many pixels a unit tangent spans [px]."""
        return self.height / (2.0 * math.tan(math.radians(self.fov_y) / 2.0))

    @property
    def rotation(self) -> Float:
        """(3, 3) float64: rows are the camera's right, up and backward axes in world space."""
        backward = np.subtract(self.eye, self.target)
        # Scale by a power of two before the norm, so that the unit of length changes no bit.
        backward = backward * 2.0 ** -np.frexp(np.abs(backward).max())[1]
        backward /= np.linalg.norm(backward)
        right = np.cross(self.up, backward)
        right = right * 2.0 ** -np.frexp(np.abs(right).max())[1]
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(backward, right), backward])

    def camera_from_world(self, points: Float) -> Float:
        """World points (N, 3) in camera space (N, 3); depth is -z."""
        bound = LARGEST_LENGTH
        points = as_float("points", points, (None, 3), dtype=np.float64, minimum=-bound, maximum=bound)
        return (points - np.asarray(self.eye)) @ self.rotation.T

    def project(self, points: Float) -> Float:
        """World points (N, 3) as (N, 3): x [px], y [px] and depth. Points with depth <= 0 have no picture (NaN)."""
        x, y, z = self.camera_from_world(points).T
        depth = np.where(z < 0, -z, np.nan)
        scale = self.pixels_per_tangent / depth
        return np.stack([self.width / 2 + x * scale, self.height / 2 - y * scale, -z], axis=1)
