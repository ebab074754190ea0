"""Lens system: a prescription, which is a row of spherical surfaces on one axis with a stop.

Steps of validation:

1. every surface by itself                                        `Surface`
2. one stop, air at both ends, no two surfaces cut each other     `LensSystem`

References
----------
.. [1] Kolb, Mitchell & Hanrahan (1995), A Realistic Camera Model for Computer Graphics, SIGGRAPH.
.. [2] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 3.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from refdof._check import Float, InputError, as_bool, as_instance, as_instances, as_number
from refdof.optics.systems.glass import AIR, LINE_D, Glass

__all__ = ["LensSystem", "Surface", "ThickLens"]

_MOST_SURFACES = 100  # twice the most of any lens that is sold
_LONGEST = 1e5  # [mm]


@dataclass(frozen=True)
class Surface:
    """One spherical or flat surface of a lens, or its stop.

    Parameters
    ----------
    radius : float
        Radius of curvature [mm]: above 0 if the centre of curvature lies towards the sensor; ``inf`` is flat, 0 is not.
    thickness : float
        Distance along the axis to the next surface's vertex [mm], >= 0. Of the last surface: to the sensor.
    glass : Glass
        What is behind the surface, towards the sensor.
    semi_diameter : float
        Clear **radius**, not diameter [mm], > 0 and at most \\|radius\\|.
    is_stop : bool
        Whether the surface's rim is the aperture stop.

    Raises
    ------
    InputError
        If a number is out of range.
    """

    radius: float
    thickness: float
    glass: Glass
    semi_diameter: float
    is_stop: bool = False

    def __post_init__(self) -> None:
        radius = as_number("radius", self.radius, finite=False)
        if radius == 0.0:
            raise InputError("radius: got 0; allowed is a number other than 0, and inf for a flat surface")
        object.__setattr__(self, "radius", math.inf if math.isinf(radius) else radius)
        thickness = as_number("thickness", self.thickness, minimum=0.0, maximum=_LONGEST)
        object.__setattr__(self, "thickness", thickness)
        as_instance("glass", self.glass, Glass)
        semi_diameter = as_number("semi_diameter", self.semi_diameter, above=0.0, maximum=_LONGEST)
        if semi_diameter > abs(radius):
            raise InputError(
                f"semi_diameter: got {semi_diameter:g}; allowed is at most the surface's radius {abs(radius):g}"
            )
        object.__setattr__(self, "semi_diameter", semi_diameter)
        object.__setattr__(self, "is_stop", as_bool("is_stop", self.is_stop))

    @property
    def curvature(self) -> float:
        """1 / radius [1/mm]; 0 is flat."""
        return 1.0 / self.radius

    def sag(self, height: float) -> float:
        """z of the surface at a height above the axis, from its vertex [mm]; `height` at most \\|radius\\|."""
        height = as_number("height", height, minimum=0.0, maximum=min(abs(self.radius), _LONGEST))
        curvature = self.curvature
        root = math.sqrt(max(1.0 - (curvature * height) ** 2, 0.0))
        return curvature * height * height / (1.0 + root)


@dataclass(frozen=True)
class LensSystem:
    """Any number of surfaces, from the scene to the sensor, with one stop and air at both ends.

    Parameters
    ----------
    name : str
    surfaces : tuple of Surface
        1 to 100. Exactly one is the stop.
    source : str
        Patent or catalogue.

    Raises
    ------
    InputError
        If there is no stop or more than one, glass at the sensor's end, or two neighbours cut each other.
    """

    name: str
    surfaces: tuple[Surface, ...]
    source: str = ""

    def __post_init__(self) -> None:
        for word in ("name", "source"):
            if not isinstance(getattr(self, word), str):
                raise InputError(f"{word}: got {type(getattr(self, word)).__name__}; allowed is text")
        if isinstance(self.surfaces, list | tuple) and not 1 <= len(self.surfaces) <= _MOST_SURFACES:
            raise InputError(f"surfaces: got {len(self.surfaces)} surfaces; allowed are 1 to {_MOST_SURFACES}")
        object.__setattr__(self, "surfaces", as_instances("surfaces", self.surfaces, Surface))
        stops = sum(surface.is_stop for surface in self.surfaces)
        if stops != 1:
            raise InputError(f"surfaces: got {stops} stops; allowed is exactly one")
        if self.surfaces[-1].glass.index(LINE_D) != 1.0:
            raise InputError(f"surfaces: got {self.surfaces[-1].glass.name} behind the last one; allowed is air")
        for k, (front, back) in enumerate(pairwise(self.surfaces)):
            # The gap is monotonic in the height: who is apart at the axis and at the rim is apart everywhere.
            rim = min(front.semi_diameter, back.semi_diameter)
            gap = front.thickness + back.sag(rim) - front.sag(rim)
            if gap < -1e-9 * rim:
                raise InputError(
                    f"surfaces: surface {k + 1} cuts surface {k + 2} (by {-gap:.3g} mm at height {rim:g} mm); "
                    "allowed are surfaces that are apart, counted from 1"
                )

    @property
    def stop(self) -> int:
        """Index of the stop in `surfaces`."""
        return next(k for k, surface in enumerate(self.surfaces) if surface.is_stop)

    @property
    def vertices(self) -> Float:
        """(N,) float64: z of every surface's vertex [mm]; the first is 0."""
        return np.cumsum([0.0, *(surface.thickness for surface in self.surfaces[:-1])])

    @property
    def sensor(self) -> float:
        """z of the sensor as the prescription places it [mm]."""
        return float(self.vertices[-1]) + self.surfaces[-1].thickness

    def indices(self, wavelength_um: float) -> Float:
        """(N + 1,) float64: refractive index in front of the first surface, and behind every surface."""
        return np.array([1.0, *(surface.glass.index(wavelength_um) for surface in self.surfaces)])

    def with_stop(self, semi_diameter: float) -> "LensSystem":
        """The same lens with another **radius** of the stop [mm]."""
        surfaces = list(self.surfaces)
        surfaces[self.stop] = replace(surfaces[self.stop], semi_diameter=semi_diameter)
        return replace(self, surfaces=tuple(surfaces))

    def reversed(self) -> "LensSystem":
        """The lens turned round: the last surface is the first. The sensor is where the scene's side ends, at 0 mm."""
        glasses = [AIR, *(surface.glass for surface in self.surfaces[:-1])]
        gaps = [0.0, *(surface.thickness for surface in self.surfaces[:-1])]
        turned = [
            replace(surface, radius=-surface.radius, thickness=gap, glass=glass)
            for surface, gap, glass in zip(self.surfaces, gaps, glasses, strict=True)
        ]
        return replace(self, surfaces=tuple(turned[::-1]))


@dataclass(frozen=True)
class ThickLens:
    """A single lens of two spherical surfaces, as in [2]; its stop is the rim of the first.

    Parameters
    ----------
    radius1, radius2 : float
        Radii of curvature, front and back [mm], signed as in `Surface`: a biconvex lens has radius2 < 0.
    thickness : float
        Along the axis [mm].
    diameter : float
        Clear **diameter** of both surfaces [mm].
    glass : Glass

    Raises
    ------
    InputError
        If a number is out of range, or the surfaces cut each other inside the diameter.
    """

    radius1: float
    radius2: float
    thickness: float
    diameter: float
    glass: Glass

    def __post_init__(self) -> None:
        as_instance("glass", self.glass, Glass)
        for word in ("thickness", "diameter"):
            object.__setattr__(self, word, as_number(word, getattr(self, word), above=0.0, maximum=_LONGEST))
        rim = self.diameter / 2.0
        for word in ("radius1", "radius2"):
            radius = as_number(word, getattr(self, word), finite=False)
            if not abs(radius) >= rim:
                raise InputError(f"{word}: got {radius:g}; allowed is a size of at least half the diameter, {rim:g}")
            object.__setattr__(self, word, math.inf if math.isinf(radius) else radius)
        front, back = (
            Surface(radius, 0.0, self.glass, rim).sag(rim) for radius in (float(self.radius1), float(self.radius2))
        )
        if not self.thickness >= front - back:
            raise InputError(
                f"thickness: got {self.thickness:g}; allowed is at least {front - back:.6g}, "
                "so that the surfaces do not cut each other"
            )

    def system(self, name: str = "thick lens") -> LensSystem:
        """The lens as a `LensSystem` of two surfaces; the sensor is where distant points are sharp, or at the lens."""
        index, rim = self.glass.index(LINE_D), self.diameter / 2.0
        bent = (index - 1.0) * self.thickness / index
        power = (index - 1.0) * (1.0 / self.radius1 - 1.0 / self.radius2 + bent / self.radius1 / self.radius2)
        back_focal_distance = (1.0 - bent / self.radius1) / power if power > 0.0 else 0.0
        back_focal_distance = back_focal_distance if back_focal_distance <= _LONGEST else 0.0
        front = Surface(self.radius1, self.thickness, self.glass, rim, is_stop=True)
        return LensSystem(name, (front, Surface(self.radius2, max(back_focal_distance, 0.0), AIR, rim)))
