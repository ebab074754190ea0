"""Rows: what the files of every format are read into, and the lens system that they make."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from refdof._check import InputError, as_number
from refdof.optics.systems.glass import AIR, Glass, glass_of
from refdof.optics.systems.paraxial import cardinal_points
from refdof.optics.systems.system import LensSystem, Surface

__all__ = ["MOST_SURFACES", "Material", "Row", "check_count", "glass_from", "system_from"]

MOST_SURFACES = 100  # of a file, as of a `LensSystem`
_LEAST_ABBE = 2.0  # below, indices of the formula come down to 1 within 0.3 to 2.5 um; glasses have 15 to 100
_FARTHEST = 1e5  # [mm] behind the last surface
_FLAT = 1e12  # [mm] from which a radius is that of a flat surface: over a metre it bends by less than a nanometre

Material: TypeAlias = str | float | tuple[float, float]
"""The name of a glass, its index, or its index and Abbe number."""


@dataclass(frozen=True)
class Row:
    """One surface of a file; `place` says where in the file. Lengths are mm; radius 0 and ``inf`` are flat."""

    place: str
    radius: float
    thickness: float
    material: Material
    diameter: float
    is_stop: bool = False


def check_count(file: str, count: int) -> None:
    """Raise before anything is made of a file of more surfaces than any lens has."""
    if not 1 <= count <= MOST_SURFACES:
        raise InputError(f"{file}: got {count} surfaces; allowed are 1 to {MOST_SURFACES}")


def glass_from(material: Material) -> Glass:
    """The glass that a file names or describes."""
    if isinstance(material, str):
        return glass_of(material)
    n_d, v_d = material if isinstance(material, tuple) else (material, math.inf)
    n_d = as_number("glass: n_d", n_d, minimum=1.0, maximum=10.0)
    if n_d == 1.0:
        return AIR
    if math.isinf(v_d):
        return Glass(f"{n_d:g}", n_d)
    return Glass(f"[{n_d:g}, {v_d:g}]", n_d, as_number("glass: V_d", v_d, minimum=_LEAST_ABBE))


def system_from(file: str, name: str, source: str, rows: Sequence[Row]) -> LensSystem:
    """A lens system of a file's rows; errors name the file and the place in it.

    A last thickness of 0 is replaced by the paraxial back focal distance at the d line, if it is positive.

    Raises
    ------
    InputError
        If a number is out of range, or the rows make no lens: see `LensSystem`.
    """
    check_count(file, len(rows))
    surfaces = []
    for row in rows:
        try:
            surfaces.append(_surface(row))
        except InputError as error:
            raise InputError(f"{file}: {row.place}: {error}") from None
    if all(surface.glass == AIR for surface in surfaces):
        raise InputError(f"{file}: got no glass; allowed is a lens with one glass at least")
    try:
        return _focused(LensSystem(name, tuple(surfaces), source))
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def _surface(row: Row) -> Surface:
    diameter = as_number("diameter of the stop" if row.is_stop else "diameter", row.diameter, above=0.0)
    radius = row.radius if 0.0 < abs(row.radius) < _FLAT else math.inf
    if diameter > 2.0 * abs(radius):
        raise InputError(f"diameter: got {diameter:g}; allowed is at most that of the sphere, {2.0 * abs(radius):g}")
    return Surface(radius, row.thickness, glass_from(row.material), 0.5 * diameter, row.is_stop)


def _focused(system: LensSystem) -> LensSystem:
    last = system.surfaces[-1]
    if last.thickness > 0.0:
        return system
    try:
        distance = cardinal_points(system).back_focal_distance
    except InputError:  # it bends no rays
        return system
    if not (math.isfinite(distance) and distance > 0.0):
        return system
    if distance > _FARTHEST:
        raise InputError(
            f"thickness of the last surface: got 0 for a lens that is sharp {distance:g} mm behind it; "
            f"allowed is one that is so within {_FARTHEST:g} mm"
        )
    return replace(system, surfaces=(*system.surfaces[:-1], replace(last, thickness=distance)))
