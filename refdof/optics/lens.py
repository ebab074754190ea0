"""Thin lens: its radius, its focal plane, its aperture, and the circle of confusion.

References
----------
.. [1] Potmesil & Chakravarty (1981), A Lens and Aperture Camera Model for Synthetic Image Generation.
.. [2] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Eq. (3).
"""

import math
import sys
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_depth, as_instance, as_number, shape_of
from refdof.optics.aperture import Aperture
from refdof.optics.camera import Camera

__all__ = ["ThinLens", "photographic_share", "rounded"]


@dataclass(frozen=True)
class ThinLens:
    """A thin lens in the plane of the eye.

    Parameters
    ----------
    radius : float
        Lens **radius** E, not diameter [scene units], >= 0; 0 is a pinhole.
    focus_distance : float
        Planar distance of the plane in focus [scene units], > 0; ``inf`` is allowed.
    aperture : Aperture
        Shape of the aperture inside the lens disc.

    Raises
    ------
    InputError
        If radius is negative, infinite or NaN, or focus_distance is not above 0.
    """

    radius: float
    focus_distance: float
    aperture: Aperture = field(default_factory=Aperture.disc)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", as_number("radius", self.radius, minimum=0.0))
        focus = as_number("focus_distance", self.focus_distance, above=0.0, finite=False)
        object.__setattr__(self, "focus_distance", focus)
        as_instance("aperture", self.aperture, Aperture)

    @classmethod
    def from_f_number(
        cls, focal_length: float, f_number: float, focus_distance: float, aperture: Aperture | None = None
    ) -> "ThinLens":
        """Lens of a photographer: radius = focal_length / (2 f_number), all lengths in scene units.

        The field of view stays the camera's; the picture does not breathe with focus. So circles are smaller than by
        the photographic formula, which has the sensor farther away for nearer focus: see `photographic_share`.

        Raises
        ------
        InputError
            If focus_distance <= focal_length: such a lens has no real image.
        """
        focal_length = as_number("focal_length", focal_length, above=0.0)
        f_number = as_number("f_number", f_number, above=0.0)
        focus_distance = as_number("focus_distance", focus_distance, above=0.0, finite=False)
        if focus_distance <= focal_length:
            raise InputError(
                f"focus_distance: got {focus_distance:g}; allowed is a distance above the focal length {focal_length:g}"
            )
        radius = focal_length / (2.0 * f_number)
        if math.isinf(radius):
            raise InputError(f"f_number: got {f_number:g}; allowed is one that gives the lens a finite radius")
        return cls(radius, focus_distance, Aperture.disc() if aperture is None else aperture)

    def coc_px(self, depth: Any, camera: Camera) -> Float:
        """Signed circle of confusion: the **radius** of a point's image [px].

        ``coc = P E (1 / focus - 1 / depth)``: negative in front of the focal plane, positive behind it.

        Parameters
        ----------
        depth : array of any shape, or a number
            Planar distance along the optical axis [scene units], > 0; ``inf`` is background.
        camera : Camera
            Gives P, the pixels per unit tangent.

        Returns
        -------
        array of the same shape and float type; finite for depth = inf.

        Raises
        ------
        InputError
            If a depth is NaN or not above 0.
        """
        as_instance("camera", camera, Camera)
        array = as_depth(depth, shape_of("depth", depth))
        if self.radius == 0.0:
            return np.zeros_like(array)
        pixels, focus = camera.pixels_per_tangent, self.focus_distance
        scale = pixels * self.radius
        exact = array.astype(np.float64)
        if math.isinf(focus):
            with np.errstate(over="ignore"):
                coc = -pixels * (self.radius / exact) if math.isinf(scale) else -scale / exact
                return rounded(coc, array.dtype)
        # The difference 1/focus - 1/depth cancels near focus; (depth - focus) / depth does not, and
        # 1 - focus / depth is the same number for far depths, where the former would be inf / inf.
        far = exact >= 2.0 * focus
        near = np.where(far, focus, exact)
        with np.errstate(over="ignore"):
            ratio = np.where(far, 1.0 - focus / exact, (near - focus) / near)
            slope = pixels * (self.radius / focus) if math.isinf(scale) else scale / focus
            return rounded(min(slope, sys.float_info.max) * ratio, array.dtype)  # inf times a ratio of 0 is no number

    def as_thin(self, depth: Float, camera: Camera) -> tuple[Float, "ThinLens"]:
        """Depths, and a plain thin lens that gives them the circles of confusion that this lens gives to `depth`."""
        return depth, self

    def largest_circle_px(self, depth: Float, camera: Camera) -> float:
        """The largest circle of confusion of these depths [px]."""
        return float(np.abs(self.coc_px(depth, camera)).max())


def photographic_share(focal_length: float, focus_distance: float) -> float:
    """Circle of confusion of a `ThinLens` over that of the photographic formula: (s - f) / s, f focal length, s focus.

    The photographic circle of a point at depth d is f^2 / N |d - s| / (d (s - f)) across on the sensor, N the f-number.
    There the sensor is f s / (s - f) behind the lens. In a `Camera` whose field of view is that of focus at infinity it
    is f behind it, whatever is in focus, and the circle is f^2 / N |d - s| / (d s) across.

    Raises
    ------
    InputError
        If focus_distance <= focal_length.
    """
    focal_length = as_number("focal_length", focal_length, above=0.0)
    focus_distance = as_number("focus_distance", focus_distance, above=0.0, finite=False)
    if not focal_length < focus_distance:
        raise InputError(
            f"focal_length, focus_distance: got {focal_length:g} and {focus_distance:g}; allowed is a focus beyond the "
            "focal length"
        )
    return 1.0 - focal_length / focus_distance


def rounded(coc: Float, dtype: np.dtype) -> Float:
    """Round once to `dtype`; what is too large for it becomes its largest number, not infinity."""
    largest = np.finfo(dtype).max
    return np.clip(coc, -largest, largest).astype(dtype)
