"""Trace: rays through a lens system, by the sphere and Snell's law at every surface.

For one ray and one surface after the other, `trace_ray`:

1. go to the ray's point that is nearest to the surface's vertex
2. from there to the sphere, in a form without division by the curvature: flat surfaces are no special case
3. stop at a rim, on the sphere's far half, or where sphere and ray do not meet
4. refract by Snell's law in vector form, or stop if all light is reflected

With c the curvature, p the nearest point from the vertex and d the unit direction, the distance t to the sphere solves
c t^2 - 2 d_z t + (c p^2 - 2 p_z) = 0, [1]. Its smaller root's square root is the cosine of the angle of incidence.

References
----------
.. [1] Welford (1986), Aberrations of Optical Systems, section 4.
.. [2] Kolb, Mitchell & Hanrahan (1995), A Realistic Camera Model for Computer Graphics, SIGGRAPH.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from refdof._check import Float, InputError, as_bool, as_float, as_instance
from refdof._jit import inline, kernel, prange
from refdof.optics.systems.system import LensSystem

__all__ = ["SurfaceTable", "Traced", "table_of", "trace", "trace_path", "trace_ray", "traced"]

_FARTHEST = 1e12  # [mm]: squares of it times curvatures stay in float32
_ROUNDING = 1e-3  # [mm]: surfaces that touch at their rims may seem to lie the other way round by this


class SurfaceTable(NamedTuple):
    """A lens system at one wavelength, for kernels: N surfaces, from the scene to the sensor."""

    vertex: Float  # (N,) z [mm]
    curvature: Float  # (N,) [1/mm]; 0 is flat
    rim: Float  # (N,) square of the clear radius [mm^2]; inf lets every ray pass
    ratio: Float  # (2, N): index in front of the surface over index behind it; and the inverse


class Traced(NamedTuple):
    """Rays behind the lens. A ray that did not pass stays where it was stopped."""

    origins: Float  # (N, 3) points on the last surface [mm]
    directions: Float  # (N, 3) unit vectors
    passed: npt.NDArray[np.bool_]  # (N,)


def table_of(
    system: LensSystem, wavelength_um: float, *, dtype: npt.DTypeLike = np.float64, rims: bool = True
) -> SurfaceTable:
    """Table of a system's surfaces at a wavelength [um]; without `rims` only the stop's is kept."""
    as_instance("system", system, LensSystem)
    index = system.indices(wavelength_um)
    ratio = index[:-1] / index[1:]
    surfaces = system.surfaces
    rim = [s.semi_diameter**2 if as_bool("rims", rims) or s.is_stop else np.inf for s in surfaces]
    columns = (system.vertices, [s.curvature for s in surfaces], rim, [ratio, 1.0 / ratio])
    return SurfaceTable(*(np.ascontiguousarray(column, dtype=dtype) for column in columns))


def trace(
    system: LensSystem, origins: Float, directions: Float, wavelength_um: float, *, reverse: bool = False
) -> Traced:
    """Rays through a lens.

    Parameters
    ----------
    system : LensSystem
    origins : (N, 3) float32 or float64
        Any points of the rays [mm], at most 1e12 from the lens. All is calculated in their type.
    directions : (N, 3)
        Of any length above 0. Rays that run away from the lens do not pass.
    wavelength_um : float
        Vacuum wavelength [um], 0.3 to 2.5.
    reverse : bool
        Rays come from the sensor and run towards the scene: their directions have z < 0.

    Raises
    ------
    InputError
        If shapes disagree, a number is not finite, or a direction is 0.
    """
    origins, directions = _rays(origins, directions)
    table = table_of(system, wavelength_um, dtype=origins.dtype)
    return traced(table, as_bool("reverse", reverse), origins, directions)


def trace_path(
    system: LensSystem, origins: Float, directions: Float, wavelength_um: float, *, reverse: bool = False
) -> Float:
    """Where rays meet each surface: (N, S + 1, 3), the origins first; NaN behind where a ray is stopped.

    Arguments and errors are those of `trace`.
    """
    origins, directions = _rays(origins, directions)
    table, reverse = table_of(system, wavelength_um, dtype=origins.dtype), as_bool("reverse", reverse)
    points = [origins]
    for count in range(1, len(system.surfaces) + 1):
        part = slice(-count, None) if reverse else slice(count)
        found = traced(SurfaceTable(*(np.ascontiguousarray(x[..., part]) for x in table)), reverse, origins, directions)
        points.append(np.where(found.passed[:, None], found.origins, origins.dtype.type(np.nan)))
    return np.stack(points, axis=1)


def _rays(origins: Any, directions: Any) -> tuple[Float, Float]:
    """Validated rays of one float type, with unit directions."""
    origins = as_float("origins", origins, (None, 3), minimum=-_FARTHEST, maximum=_FARTHEST)
    directions = as_float("directions", directions, (len(origins), 3), dtype=np.float64)
    largest = np.abs(directions).max(axis=1, initial=0.0, keepdims=True)
    if (largest == 0.0).any():
        raise InputError(f"directions: got {int((largest == 0.0).sum())} of length 0; allowed are others")
    directions = directions / largest
    directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
    return origins, directions.astype(origins.dtype)


def traced(table: SurfaceTable, reverse: bool, origins: Float, directions: Float) -> Traced:
    """`trace` behind its validation: rays of the table's type, with unit directions."""
    out = Traced(np.empty_like(origins), np.empty_like(directions), np.empty(len(origins), dtype=np.bool_))
    _trace(table, reverse, origins, directions, out.origins, out.directions, out.passed)
    return out


@kernel
def _trace(table, reverse, origins, directions, ends, ways, passed):
    """Fill ends, ways (N, 3) and passed (N,)."""
    for r in prange(len(origins)):
        x, y, z = origins[r, 0], origins[r, 1], origins[r, 2]
        dx, dy, dz = directions[r, 0], directions[r, 1], directions[r, 2]
        x, y, z, dx, dy, dz, through = trace_ray(table, reverse, x, y, z, dx, dy, dz)
        ends[r, 0], ends[r, 1], ends[r, 2] = x, y, z
        ways[r, 0], ways[r, 1], ways[r, 2] = dx, dy, dz
        passed[r] = through


@inline
def trace_ray(table, reverse, x, y, z, dx, dy, dz):
    """Point (x, y, z), direction and whether the ray passed; the direction is a unit vector, before and after."""
    scalar = table.vertex.dtype.type
    zero, one, two, behind = scalar(0.0), scalar(1.0), scalar(2.0), scalar(-_ROUNDING)
    forward, side = (-one, 1) if reverse else (one, 0)
    count = len(table.vertex)
    for step in range(count):
        k = count - 1 - step if reverse else step
        vertex, curvature = table.vertex[k], table.curvature[k]

        # Go to the ray's point nearest to the vertex, and from there to the sphere.
        z -= vertex
        along = -(x * dx + y * dy + z * dz)
        px, py, pz = x + along * dx, y + along * dy, z + along * dz
        excess = curvature * (px * px + py * py + pz * pz) - two * pz
        square = dz * dz - curvature * excess
        if not (square > zero and forward * dz > zero):
            return x, y, z + vertex, dx, dy, dz, False
        cosine = np.sqrt(square)
        onward = excess / (dz + forward * cosine)
        x, y, z = px + onward * dx, py + onward * dy, pz + onward * dz

        # Stop at the rim, on the sphere's far half, and where the surface lies behind the one before.
        facing = one - curvature * z
        if x * x + y * y > table.rim[k] or facing <= zero or (step > 0 and along + onward < behind):
            return x, y, z + vertex, dx, dy, dz, False

        # Refract: the normal is (-c x, -c y, 1 - c z).
        ratio = table.ratio[side, k]
        if ratio != one:
            refracted = one - ratio * ratio * (one - square)
            if refracted <= zero:
                return x, y, z + vertex, dx, dy, dz, False
            turn = forward * (np.sqrt(refracted) - ratio * cosine)
            dx = ratio * dx - turn * curvature * x
            dy = ratio * dy - turn * curvature * y
            dz = ratio * dz + turn * facing
        z += vertex
    return x, y, z, dx, dy, dz, True
