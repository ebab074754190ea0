"""Paraxial optics: focal length, principal planes and pupils of a lens system, by ray-transfer matrices.

A matrix takes (height, slope) of a ray near the axis through a part of the lens:

- a surface      slope -> (n / n') slope - (n' - n) / (n' R) height
- a gap          height -> height + thickness slope

The pupils are the stop's images through the surfaces in front of it and behind it.

References
----------
.. [1] Gerrard & Burch (1975), Introduction to Matrix Methods in Optics.
.. [2] Smith (2008), Modern Optical Engineering, 4th edition, chapters 2 and 9.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from refdof._check import InputError, as_instance, as_number
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.system import LensSystem

__all__ = [
    "CardinalPoints",
    "Pupil",
    "cardinal_points",
    "entrance_pupil",
    "exit_pupil",
    "f_number",
    "focal_length",
    "image_scale",
    "nearest_focus",
    "sensor_for",
    "stopped_down",
    "transmission",
]

_ENGRAVED = 0.95  # an engraved f-number over the true one, at least
_LONGEST_FOCUS = 1e9  # [mm]: of longer ones, places near the lens have lost their digits


@dataclass(frozen=True)
class CardinalPoints:
    """Where a thin lens would stand in a system's place; all z are from the first vertex [mm]."""

    focal_length: float  # [mm]; below 0 for a lens that diverges
    front_focus: float  # z where rays come from that leave parallel to the axis
    back_focus: float  # z where rays meet that come from infinity
    front_principal: float
    back_principal: float
    last_vertex: float

    @property
    def front_focal_distance(self) -> float:
        """From the first vertex to the front focus [mm], above 0 if that lies in front of the lens."""
        return -self.front_focus

    @property
    def back_focal_distance(self) -> float:
        """From the last vertex to the back focus [mm]."""
        return self.back_focus - self.last_vertex


@dataclass(frozen=True)
class Pupil:
    """An image of the stop."""

    z: float  # place [mm]; inf: the lens is telecentric
    radius: float  # [mm]


def focal_length(system: LensSystem, wavelength_um: float = LINE_D) -> float:
    """Focal length [mm]; ``inf`` if the system does not bend rays as a whole."""
    power = -_matrix(system, wavelength_um, 0, None)[1][0]
    return 1.0 / power if power else math.inf


def cardinal_points(system: LensSystem, wavelength_um: float = LINE_D) -> CardinalPoints:
    """Focal length, foci and principal planes.

    Raises
    ------
    InputError
        If the system has no focal length, or one above 1e9 mm.
    """
    ((a, _), (c, d)), last = _matrix(system, wavelength_um, 0, None), float(system.vertices[-1])
    if not abs(c) * _LONGEST_FOCUS >= 1.0:
        raise InputError(
            f"system: got {system.name!r}, which has no focal length up to {_LONGEST_FOCUS:g} mm; "
            "allowed is a lens that bends rays"
        )
    length = -1.0 / c
    # A ray parallel to the axis at height 1 leaves at height A with slope -1/f; one from behind likewise, with D.
    front, back = -length * d, last + length * a
    return CardinalPoints(length, front, back, front + length, back - length, last)


def entrance_pupil(system: LensSystem, wavelength_um: float = LINE_D) -> Pupil:
    """The stop as the scene sees it, which bounds the light of a point on the axis."""
    (a, b), _ = _matrix(system, wavelength_um, 0, _stop(system))
    # The ray (height, slope) = (-b, a) meets the stop's centre; heights in the pupil come to the stop times a.
    return _pupil(b / a, _stop_radius(system) / abs(a)) if a else Pupil(math.inf, math.inf)


def exit_pupil(system: LensSystem, wavelength_um: float = LINE_D) -> Pupil:
    """The stop as the sensor sees it."""
    (a, b), (c, d) = _matrix(system, wavelength_um, _stop(system), None)
    # Rays of the stop's centre leave at height b with slope d.
    if d == 0.0:
        return Pupil(math.inf, math.inf)
    return _pupil(float(system.vertices[-1]) - b / d, _stop_radius(system) * abs(a - b * c / d))


def _pupil(z: float, radius: float) -> Pupil:
    """A pupil, at infinity where its place is beyond all numbers."""
    return Pupil(z, radius) if math.isfinite(z) and math.isfinite(radius) else Pupil(math.inf, math.inf)


def f_number(system: LensSystem, wavelength_um: float = LINE_D) -> float:
    """Focal length over the **diameter** of the entrance pupil; ``inf`` without a focal length.

    The glass's transmission is not counted: `transmission`.
    """
    length = abs(focal_length(system, wavelength_um))
    return length / (2.0 * entrance_pupil(system, wavelength_um).radius) if math.isfinite(length) else math.inf


def transmission(system: LensSystem, wavelength_um: float = LINE_D) -> float:
    """Share of the light of a ray on the axis that uncoated surfaces let through; glass absorbs nothing.

    Fresnel's reflectance at normal incidence, ((n - n') / (n + n'))^2, is lost at every surface, also where two glasses
    are cemented.
    """
    index = as_instance("system", system, LensSystem).indices(wavelength_um).tolist()
    return math.prod(1.0 - ((n - behind) / (n + behind)) ** 2 for n, behind in pairwise(index))


def stopped_down(system: LensSystem, f_stop: float, wavelength_um: float = LINE_D) -> LensSystem:
    """The lens with its stop closed to an f-number. Engraved ones are rounded: up to 5 % below its own is wide open.

    Raises
    ------
    InputError
        If the stop had to be wider than it is, or the entrance pupil is at infinity.
    """
    _near_pupil(system, wavelength_um)
    wanted, widest = as_number("f_stop", f_stop, above=0.0, maximum=1e4), f_number(system, wavelength_um)
    if wanted < _ENGRAVED * widest:
        raise InputError(f"f_stop: got {wanted:g}; allowed is at least the lens's own, {widest:.4g}")
    return system.with_stop(_stop_radius(system) * min(widest / wanted, 1.0))


def sensor_for(system: LensSystem, focus_distance: float, wavelength_um: float = LINE_D) -> float:
    """z of the sensor [mm] on which a point of the axis is sharp, `focus_distance` [mm] before the entrance pupil.

    Raises
    ------
    InputError
        If the distance is inside the lens, or the image is not behind it.
    """
    points = cardinal_points(system, wavelength_um)
    focus = _before_front_focus(system, points, focus_distance, wavelength_um)
    # Newton's equation, f^2 / x behind the focus; a power of two keeps the square in range and changes no digit.
    unit = math.ldexp(1.0, math.frexp(points.focal_length)[1])
    sensor = points.back_focus + (points.focal_length / unit) ** 2 / (focus / unit) * unit
    if sensor <= points.last_vertex:
        raise InputError(
            f"system: got {system.name!r}, whose image lies inside it; allowed is a lens with a real image"
        )
    return sensor


def image_scale(system: LensSystem, focus_distance: float, wavelength_um: float = LINE_D) -> float:
    """Image height [mm] of a unit tangent, seen from the entrance pupil, at the distance in focus [mm].

    This is the focal length at infinity, and grows as the lens is focused nearer: focus breathing.

    Raises
    ------
    InputError
        As `sensor_for` does.
    """
    points = cardinal_points(system, wavelength_um)
    focus = _before_front_focus(system, points, focus_distance, wavelength_um)
    if math.isinf(focus):
        return abs(points.focal_length)
    return abs(points.focal_length) * (float(focus_distance) / focus)  # magnification is f / x, [2]


def _before_front_focus(
    system: LensSystem, points: CardinalPoints, focus_distance: float, wavelength_um: float
) -> float:
    """How far the plane in focus lies before the front focus [mm]."""
    pupil = _near_pupil(system, wavelength_um)
    distance = as_number("focus_distance", focus_distance, above=0.0, finite=False)
    nearest = _nearest(pupil, points)
    if not distance > nearest:
        raise InputError(f"focus_distance: got {distance:g} mm; allowed is more than {nearest:.6g} mm")
    return distance - (pupil.z - points.front_focus)


def nearest_focus(system: LensSystem, wavelength_um: float = LINE_D) -> float:
    """Distance before the entrance pupil beyond which a plane can be in focus [mm]."""
    points = cardinal_points(system, wavelength_um)
    return _nearest(_near_pupil(system, wavelength_um), points)


def _nearest(pupil: Pupil, points: CardinalPoints) -> float:
    return pupil.z - min(points.front_focus, 0.0)


def _near_pupil(system: LensSystem, wavelength_um: float) -> Pupil:
    """The entrance pupil, if it is not at infinity."""
    pupil = entrance_pupil(system, wavelength_um)
    if math.isinf(pupil.z):
        raise InputError(
            f"system: got {system.name!r}, whose entrance pupil is at infinity; allowed is one that is not"
        )
    return pupil


def _stop(system: LensSystem) -> int:
    return as_instance("system", system, LensSystem).stop


def _stop_radius(system: LensSystem) -> float:
    return system.surfaces[system.stop].semi_diameter


def _matrix(system: LensSystem, wavelength_um: float, first: int, end: int | None) -> list[list[float]]:
    """2 x 2: from before surface `first` to before surface `end`; None: to behind the last one."""
    as_instance("system", system, LensSystem)
    index = system.indices(wavelength_um)
    matrix = np.eye(2)
    count = len(system.surfaces)
    for k in range(first, count if end is None else end):
        surface = system.surfaces[k]
        bend = (index[k] - index[k + 1]) * surface.curvature / index[k + 1]
        with np.errstate(over="ignore", invalid="ignore"):
            matrix = np.array([[1.0, 0.0], [bend, index[k] / index[k + 1]]]) @ matrix
            if k + 1 < count:
                matrix = np.array([[1.0, surface.thickness], [0.0, 1.0]]) @ matrix
    if not np.isfinite(matrix).all():
        raise InputError(
            f"system: got {system.name!r}, whose rays leave the range of numbers; allowed are larger radii of curvature"
        )
    return matrix.tolist()
