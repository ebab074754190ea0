"""Height lens: a single lens of two height-field surfaces, as in [1], of any shape.

Rays refract at the splines through its samples, `refdof.optics.systems.height_field`. What knows spheres only takes its
paraxial system, `HeightLens.paraxial`: two spheres with the curvatures of the surfaces in the middle, found by least
squares over half the clear radius. Focus, pupils and f-number are the paraxial system's.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 3.1.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_float, as_instance, as_integer, as_number
from refdof.optics.systems.glass import AIR, Glass
from refdof.optics.systems.height_field import limits_of, spline_of
from refdof.optics.systems.system import LensSystem, Surface, ThickLens

__all__ = ["HeightLens"]

_FEWEST, _MOST = 8, 1025  # samples a side
_SMALLEST, _LARGEST = 1e-3, 1e4  # [mm]
_STEEPEST = 5.0  # slope, 79 degrees
_FITTED = 0.5  # of the clear radius: where the paraxial curvature is found
_FIT_POINTS = 128  # a side, about


@dataclass(frozen=True, eq=False)
class HeightLens:
    """A lens of two height fields; its stop is a disc on the first.

    Sample (j, i) of N x N lies at x = (2 i / (N - 1) - 1) diameter / 2, and y likewise by j: the grid covers the square
    around the clear disc, edges included. x is right and y is up as the camera sees them.

    Parameters
    ----------
    front, back : (N, N) float64
        Sag of each surface [mm]: its z, towards the sensor, from its point on the axis. A constant added to all of a
        map changes nothing. N is 8 to 1025.
    thickness : float
        Along the axis [mm].
    diameter : float
        Clear **diameter** of both surfaces [mm].
    glass : Glass
    stop_diameter : float, optional
        **Diameter** of the stop on the front [mm]; the clear diameter if left out.
    name : str

    Raises
    ------
    InputError
        If a number is out of range, maps differ in shape, a slope within the clear disc is above 5, the surfaces cut
        each other there, or a paraxial sphere is smaller than the clear disc.
    """

    front: Float
    back: Float
    thickness: float
    diameter: float
    glass: Glass
    stop_diameter: float | None = None
    name: str = "height lens"

    def __post_init__(self) -> None:
        as_instance("glass", self.glass, Glass)
        as_instance("name", self.name, str)
        for word in ("thickness", "diameter"):
            number = as_number(word, getattr(self, word), minimum=_SMALLEST, maximum=_LARGEST)
            object.__setattr__(self, word, number)
        if self.stop_diameter is not None:
            stop = as_number("stop_diameter", self.stop_diameter, minimum=_SMALLEST, maximum=self.diameter)
            object.__setattr__(self, "stop_diameter", stop)
        shape: tuple[int | None, int | None] = (None, None)
        for word in ("front", "back"):
            sag = as_float(word, getattr(self, word), shape, dtype=np.float64, minimum=-_LARGEST, maximum=_LARGEST)
            if sag.shape[0] != sag.shape[1] or not _FEWEST <= len(sag) <= _MOST:
                raise InputError(f"{word}: got shape {sag.shape}; allowed is N x N with N in {_FEWEST} .. {_MOST}")
            shape = sag.shape
            sag = sag.copy()
            sag.flags.writeable = False
            object.__setattr__(self, word, sag)
        self._check_surfaces()
        curvature = abs(_curvature(self.splines[0], self.diameter / 2.0))
        if not curvature * self.clear_radii[0] <= 1.0:
            raise InputError(
                f"front: has a radius of curvature of {1.0 / curvature:.6g} mm in the middle; "
                f"allowed is at least the stop's radius, {self.clear_radii[0]:g} mm"
            )

    @classmethod
    def from_functions(
        cls,
        front: Callable[[Float, Float], Any],
        back: Callable[[Float, Float], Any],
        thickness: float,
        diameter: float,
        glass: Glass,
        samples: int = 65,
    ) -> "HeightLens":
        """A lens of functions that give the sag [mm] at x and y, (N, N) each [mm], N = `samples`.

        Raises
        ------
        InputError
            As for `HeightLens`; functions are called in the whole square, beyond the clear disc, too.
        """
        count = as_integer("samples", samples, minimum=_FEWEST, maximum=_MOST)
        half = as_number("diameter", diameter, minimum=_SMALLEST, maximum=_LARGEST) / 2.0
        x, y = np.meshgrid(*2 * [np.linspace(-half, half, count)])
        maps = []
        for word, function in (("front", front), ("back", back)):
            if not callable(function):
                raise InputError(f"{word}: got {type(function).__name__}; allowed is a function of x and y")
            try:
                sag = function(x, y) + 0.0 * x
            except (TypeError, ValueError) as error:
                raise InputError(f"{word}: gives no array for x and y of {count} x {count} each") from error
            maps.append(as_float(word, sag, (count, count), dtype=np.float64))
        return cls(maps[0], maps[1], thickness, diameter, glass)

    @classmethod
    def of(cls, lens: ThickLens, samples: int = 65) -> "HeightLens":
        """A spherical lens, sampled.

        Raises
        ------
        InputError
            If a sphere does not reach the corners of the square around the clear disc.
        """
        as_instance("lens", lens, ThickLens)
        smallest, corner = min(abs(lens.radius1), abs(lens.radius2)), lens.diameter / 2.0**0.5
        if not smallest >= 1.01 * corner:  # where it ends, it is upright
            raise InputError(f"lens: has a radius of {smallest:g} mm; allowed is at least {1.01 * corner:.6g} mm")

        def sphere(radius: float) -> Callable[[Float, Float], Float]:
            return lambda x, y: (x * x + y * y) / radius / (1.0 + np.sqrt(1.0 - (x * x + y * y) / radius**2))

        return cls.from_functions(
            sphere(lens.radius1), sphere(lens.radius2), lens.thickness, lens.diameter, lens.glass, samples
        )

    def with_stop(self, semi_diameter: float) -> "HeightLens":
        """The same lens with another **radius** of the stop [mm], at most the clear radius."""
        wanted = as_number("semi_diameter", semi_diameter, minimum=_SMALLEST / 2.0, maximum=self.diameter / 2.0)
        return replace(self, stop_diameter=2.0 * wanted)

    @cached_property
    def splines(self) -> Float:
        """(2, N + 2, N + 2) float64: of front and back, `height_field.spline_of`, 0 on the axis."""
        splines = [spline_of(sag) for sag in (self.front, self.back)]
        return np.stack([spline - _refined(spline)[len(spline) - 3, len(spline) - 3] for spline in splines])

    @cached_property
    def limits(self) -> Float:
        """(2, 5) float64: of front and back, `height_field.limits_of`."""
        return np.stack([limits_of(spline, self.diameter / 2.0) for spline in self.splines])

    @property
    def clear_radii(self) -> tuple[float, float]:
        """Radii [mm] of the stop, on the front, and of the back."""
        rim = self.diameter / 2.0
        return rim if self.stop_diameter is None else self.stop_diameter / 2.0, rim

    @cached_property
    def paraxial(self) -> LensSystem:
        """Two spheres with the curvatures of the surfaces in the middle; the stop is the first.

        The clear radius of the second is halved until the spheres do not cut each other.
        """
        curvatures = [_curvature(spline, self.diameter / 2.0) for spline in self.splines]
        radii = [1.0 / curvature if curvature else math.inf for curvature in curvatures]
        stop, rim = self.clear_radii
        front = Surface(radii[0], self.thickness, self.glass, stop, is_stop=True)
        while True:
            back = Surface(radii[1], 0.0, AIR, min(rim, abs(radii[1])))
            near = min(back.semi_diameter, stop)
            if self.thickness + back.sag(near) >= front.sag(near):
                return LensSystem(self.name, (front, back))
            rim /= 2.0

    def _check_surfaces(self) -> None:
        """Refuse steep surfaces, and surfaces that cut each other, at the samples and halfway between them."""
        half = self.diameter / 2.0
        front, back = (_refined(spline) for spline in self.splines)
        at = np.linspace(-half, half, len(front))
        inside = np.hypot(at, at[:, None]) <= half
        for word, sag in (("front", front), ("back", back)):
            slope = np.hypot(*np.gradient(sag, at[1] - at[0]))[inside].max()
            if not slope <= _STEEPEST:
                raise InputError(f"{word}: has a slope of {slope:.3g}; allowed is at most {_STEEPEST:g}")
        gap = np.where(inside, self.thickness + back - front, np.inf)
        if gap.min() < -1e-9 * half:
            j, i = np.unravel_index(int(gap.argmin()), gap.shape)
            raise InputError(
                f"thickness: got {self.thickness:g}; allowed is at least {self.thickness - gap.min():.6g}, "
                f"so that the surfaces do not cut each other at x = {at[i]:.4g}, y = {at[j]:.4g}"
            )


def _refined(spline: Float) -> Float:
    """Sag at the samples and halfway between them, (2 N - 1, 2 N - 1), of a spline (N + 2, N + 2)."""
    for _ in range(2):
        fine = np.empty((2 * len(spline) - 5, spline.shape[1]))
        fine[::2] = (spline[:-2] + 4.0 * spline[1:-1] + spline[2:]) / 6.0
        fine[1::2] = (spline[:-3] + 23.0 * (spline[1:-2] + spline[2:-1]) + spline[3:]) / 48.0
        spline = fine.T
    return spline


def _curvature(spline: Float, half: float) -> float:
    """Mean curvature on the axis [1/mm]: the r^2 of a polynomial that fits the middle, with tilt and astigmatism."""
    sag = _refined(spline)
    step = max(len(sag) // _FIT_POINTS, 1)
    part = slice((len(sag) // 2) % step, None, step)  # the point on the axis is one
    unit = np.linspace(-1.0, 1.0, len(sag))[part] / _FITTED
    x, y = np.meshgrid(unit, unit)
    square = x * x + y * y
    near = square <= 1.0
    terms = (square, square**2, square**3, 1.0 + 0.0 * x, x, y, x * x - y * y, x * y)
    found = np.linalg.lstsq(np.stack([term[near] for term in terms], axis=1), sag[part, part][near])[0]
    return 2.0 * float(found[0]) / (_FITTED * half) ** 2
