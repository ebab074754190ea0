"""Focal plane: the plane through what shall be sharp, and the tilted image plane that a thin lens needs for it.

A plane A depth + B x + C y = 1 in camera space has the inverse distance A + B tx + C ty along the chief ray of slopes
tx and ty: over the picture it is linear. The thin lens takes it to the image plane (1/F - A) u + B x' + C y' = 1, [1]:
the two meet in the plane of the lens (Scheimpflug's rule), and what is parallel to the image plane through the lens's
centre meets the focal plane at the distance F before the lens (the hinge rule).

Departures from the paper
-------------------------
- Least squares are of the inverse distance, in which the plane is linear, weighed by the points' weights.
- The paper limits the normal where the plane aligns with the view vector. What a lens cannot do is a plane through its
  own centre; a ground below it is parallel to the axis, and possible. So the limit is on B and C: the plane stays so
  far from the centre that across the axis its inverse distance changes by 10 nearest distances' in a unit tangent.
- Chief rays stay where they are: the picture is not drawn out by the tilted image plane, as with a view camera whose
  picture is set right.

References
----------
.. [1] Merklinger (1996), Focusing the View Camera, chapters 3 and 5.
.. [2] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 5.1.
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, InputError, as_instance, as_number
from refdof.focus.point import Placed
from refdof.optics.camera import Camera

__all__ = ["FocalPlane", "focal_plane"]

_STEEPEST = 10.0  # of the nearest point's inverse distance, per unit tangent


@dataclass(frozen=True)
class FocalPlane:
    """The plane A depth + B x + C y = 1; coefficients are (A, B, C) [1 / scene unit]."""

    coefficients: tuple[float, float, float]

    def inverse_focus(self, camera: Camera) -> Float:
        """(H, W): one over the distance in focus at the pixels' centres; below 0 beyond the plane's horizon."""
        as_instance("camera", camera, Camera)
        a, b, c = self.coefficients
        x = (np.arange(camera.width) + 0.5 - 0.5 * camera.width) / camera.pixels_per_tangent
        y = (0.5 * camera.height - np.arange(camera.height) - 0.5) / camera.pixels_per_tangent
        return a + b * x + c * y[:, None]

    @property
    def angle(self) -> float:
        """Between the plane's normal and the axis [degrees]."""
        a, b, c = self.coefficients
        return math.degrees(math.atan2(math.hypot(b, c), a))

    def image_plane(self, focal_length: float) -> tuple[float, float, float]:
        """Distance of the image plane along the axis [scene units], and its tilts about x and y [degrees].

        A plane that is tilted about x by t above 0 has u growing with y as tan(t) y.

        Raises
        ------
        InputError
            If the focal length is not below the plane's distance along the axis.
        """
        focal_length = as_number("focal_length", focal_length, above=0.0)
        a, b, c = self.coefficients
        strength = 1.0 / focal_length - a
        if not strength > 0.0:
            raise InputError(f"focal_length: got {focal_length:g}; allowed is less than the plane's distance {1 / a:g}")
        return 1.0 / strength, math.degrees(math.atan(-c / strength)), math.degrees(math.atan(-b / strength))


def focal_plane(found: Placed, camera: Camera) -> FocalPlane:
    """The plane through three points' distances in focus, or nearest to more; through fewer, the least tilted."""
    scale = 1.0 / camera.pixels_per_tangent
    slopes = (found.places - [0.5 * camera.width, 0.5 * camera.height]) * [scale, -scale]
    root = np.sqrt(found.weight / found.weight.max())
    inverse = 1.0 / found.focus
    middle = (root**2 @ slopes) / (root**2).sum()
    mean = float(root**2 @ inverse / (root**2).sum())
    tilt, *_ = np.linalg.lstsq(root[:, None] * (slopes - middle), root * (inverse - mean), rcond=1e-9)
    size, most = math.hypot(*tilt), _STEEPEST * float(inverse.max())
    tilt = tilt * min(1.0, most / size) if size > 0.0 else tilt
    a = mean - float(tilt @ middle)
    return FocalPlane((a, float(tilt[0]), float(tilt[1])))
