"""Trace: rays through a lens system, by the sphere and Snell's law at every surface.

For one ray and one surface after the other, `_refract`:

1. go to the ray's point that is nearest to the surface's vertex
2. from there to the sphere, in a form without division by the curvature: flat surfaces are no special case
3. stop at a rim, on the sphere's far half, or where sphere and ray do not meet
4. refract by Snell's law in vector form, or stop if all light is reflected

With c the curvature, p the nearest point from the vertex and d the unit direction, the distance t to the sphere solves
c t^2 - 2 d_z t + (c p^2 - 2 p_z) = 0, [1]. The root of a quarter of its discriminant is the cosine of the angle of
incidence. Rays are lines: the first surface may lie behind a ray's origin.

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
from refdof.optics.systems.height_field import through_fields
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.system import LensSystem

__all__ = [
    "BLOCK",
    "SurfaceTable",
    "Traced",
    "part_of",
    "refract_all",
    "table_of",
    "trace",
    "trace_path",
    "trace_ray",
    "traced",
]

_FARTHEST = 1e12  # [mm]: squares of it times curvatures stay in float32
BLOCK = 64  # rays whose numbers stay in the nearest cache


class SurfaceTable(NamedTuple):
    """A lens system at one wavelength, for kernels: N surfaces, from the scene to the sensor."""

    vertex: Float  # (N,) z [mm]
    curvature: Float  # (N,) [1/mm]; 0 is flat
    rim: Float  # (N,) square of the clear radius [mm^2]; inf lets every ray pass
    ratio: Float  # (2, N): index in front of the surface over index behind it; and the inverse
    splines: Float | None = None  # (N, M, M) of height fields, which then stand for the spheres
    limits: Float | None = None  # (N, 5) of `height_field.limits_of`


class Traced(NamedTuple):
    """Rays behind the lens. A ray that did not pass stays where it was stopped."""

    origins: Float  # (N, 3) points on the last surface [mm]
    directions: Float  # (N, 3) unit vectors
    passed: npt.NDArray[np.bool_]  # (N,)


def table_of(
    system: LensSystem | HeightLens, wavelength_um: float, *, dtype: npt.DTypeLike = np.float64, rims: bool = True
) -> SurfaceTable:
    """Table of a system's surfaces at a wavelength [um]; without `rims` only the stop's and height fields' are kept."""
    lens, system = system, system.paraxial if isinstance(system, HeightLens) else system
    as_instance("system", system, LensSystem)
    index = system.indices(wavelength_um)
    ratio = index[:-1] / index[1:]
    surfaces = system.surfaces
    radii = [s.semi_diameter if as_bool("rims", rims) or s.is_stop else np.inf for s in surfaces]
    fields: tuple[Float, ...] = ()
    if isinstance(lens, HeightLens):
        radii, fields = list(lens.clear_radii), (lens.splines, lens.limits)
    rim = np.square(radii)
    columns = (system.vertices, [s.curvature for s in surfaces], rim, [ratio, 1.0 / ratio], *fields)
    return SurfaceTable(*(np.ascontiguousarray(column, dtype=dtype) for column in columns))


def part_of(table: SurfaceTable, part: slice) -> SurfaceTable:
    """Table of some of the surfaces."""
    columns = (*(column[..., part] for column in table[:4]), *(x[part] for x in table[4:] if x is not None))
    return SurfaceTable(*(np.ascontiguousarray(column) for column in columns))


def trace(
    system: LensSystem | HeightLens, origins: Float, directions: Float, wavelength_um: float, *, reverse: bool = False
) -> Traced:
    """Rays through a lens.

    Parameters
    ----------
    system : LensSystem or HeightLens
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
    system: LensSystem | HeightLens, origins: Float, directions: Float, wavelength_um: float, *, reverse: bool = False
) -> Float:
    """Where rays meet each surface: (N, S + 1, 3), the origins first; NaN behind where a ray is stopped.

    Arguments and errors are those of `trace`.
    """
    origins, directions = _rays(origins, directions)
    table, reverse = table_of(system, wavelength_um, dtype=origins.dtype), as_bool("reverse", reverse)
    points = [origins]
    for count in range(1, len(table.vertex) + 1):
        part = slice(-count, None) if reverse else slice(count)
        found = traced(part_of(table, part), reverse, origins, directions)
        points.append(np.where(found.passed[:, None], found.origins, origins.dtype.type(np.nan)))
    return np.stack(points, axis=1)


def _rays(origins: Any, directions: Any) -> tuple[Float, Float]:
    """Validated rays of one float type."""
    origins = as_float("origins", origins, (None, 3), minimum=-_FARTHEST, maximum=_FARTHEST)
    directions = as_float("directions", directions, (len(origins), 3), dtype=origins.dtype)
    nowhere = (directions[:, 0] == 0.0) & (directions[:, 1] == 0.0) & (directions[:, 2] == 0.0)
    if nowhere.any():
        raise InputError(f"directions: got {int(nowhere.sum())} of length 0; allowed are others")
    return origins, directions


def traced(table: SurfaceTable, reverse: bool, origins: Float, directions: Float) -> Traced:
    """`trace` behind its validation: rays of the table's type."""
    out = Traced(np.empty_like(origins), np.empty_like(directions), np.empty(len(origins), dtype=np.bool_))
    _trace(table, reverse, origins, directions, out.origins, out.directions, out.passed)
    return out


@kernel
def _trace(table, reverse, origins, directions, ends, ways, passed):
    """Fill ends, ways (N, 3) and passed (N,), a block of rays at a time."""
    count, scalar = len(origins), table.vertex.dtype.type
    for block in prange((count + BLOCK - 1) // BLOCK):
        rays = np.zeros(7 * BLOCK, dtype=table.vertex.dtype)
        first = block * BLOCK
        here = min(BLOCK, count - first)
        for i in range(here):
            dx, dy, dz = directions[first + i, 0], directions[first + i, 1], directions[first + i, 2]
            largest = max(max(abs(dx), abs(dy)), abs(dz))  # squares of others are too large, or 0
            dx, dy, dz = dx / largest, dy / largest, dz / largest
            scale = scalar(1.0) / np.sqrt(dx * dx + dy * dy + dz * dz)
            for axis in range(3):
                rays[axis * BLOCK + i] = origins[first + i, axis]
            rays[3 * BLOCK + i], rays[4 * BLOCK + i], rays[5 * BLOCK + i] = dx * scale, dy * scale, dz * scale
            rays[6 * BLOCK + i] = scalar(1.0)
        refract_all(table.splines, table, reverse, rays)
        for i in range(here):
            for axis in range(3):
                ends[first + i, axis] = rays[axis * BLOCK + i]
                ways[first + i, axis] = rays[(3 + axis) * BLOCK + i]
            passed[first + i] = rays[6 * BLOCK + i] > scalar(0.0)


@inline
def trace_ray(table, reverse, x, y, z, dx, dy, dz):
    """Point (x, y, z), direction and whether the ray passed; the direction is a unit vector, before and after."""
    return _trace_ray(table.splines, table, reverse, x, y, z, dx, dy, dz)


@inline
def _trace_ray(splines, table, reverse, x, y, z, dx, dy, dz):
    if splines is None:
        return _through_spheres(table, reverse, x, y, z, dx, dy, dz)
    else:
        return through_fields(table, reverse, x, y, z, dx, dy, dz)


@inline
def refract_all(splines, table, reverse, rays):
    """Take a block of rays, as `_refract_block` has it, through all surfaces in place; splines: the table's."""
    if splines is None:
        for step in range(len(table.vertex)):
            _refract_block(_surface_at(table, reverse, step), rays)
    else:
        for i in range(BLOCK):
            if rays[6 * BLOCK + i] > 0.0:
                x, y, z = rays[i], rays[BLOCK + i], rays[2 * BLOCK + i]
                dx, dy, dz = rays[3 * BLOCK + i], rays[4 * BLOCK + i], rays[5 * BLOCK + i]
                x, y, z, dx, dy, dz, passed = through_fields(table, reverse, x, y, z, dx, dy, dz)
                rays[i], rays[BLOCK + i], rays[2 * BLOCK + i] = x, y, z
                rays[3 * BLOCK + i], rays[4 * BLOCK + i], rays[5 * BLOCK + i] = dx, dy, dz
                rays[6 * BLOCK + i] = 1.0 if passed else 0.0


@inline
def _through_spheres(table, reverse, x, y, z, dx, dy, dz):
    scalar = table.vertex.dtype.type
    going = scalar(1.0)
    for step in range(len(table.vertex)):
        x, y, z, dx, dy, dz, going = _refract(_surface_at(table, reverse, step), x, y, z, dx, dy, dz, going)
        if going == scalar(0.0):
            break
    return x, y, z, dx, dy, dz, going > scalar(0.0)


class _Face(NamedTuple):
    """One surface, as a ray meets it: numbers of one type."""

    vertex: float
    curvature: float
    rim: float
    ratio: float  # index before over index behind
    forward: float  # 1; -1 for a ray from the sensor


@inline
def _surface_at(table, reverse, step):
    """The surface that a ray meets after `step` others."""
    k, side = (len(table.vertex) - 1 - step, 1) if reverse else (step, 0)
    forward = table.vertex.dtype.type(-1.0 if reverse else 1.0)
    return _Face(table.vertex[k], table.curvature[k], table.rim[k], table.ratio[side, k], forward)


@inline
def _refract_block(face, rays):
    """Take a block of rays (7 BLOCK,) through a surface in place: all x, all y, all z, the directions', and 1 or 0.

    1 is a ray that goes on, 0 one that was stopped. Distances in memory are constants: compilers vectorise this.
    """
    for i in range(BLOCK):
        x, y, z, dx, dy, dz, going = _refract(
            face,
            rays[i],
            rays[BLOCK + i],
            rays[2 * BLOCK + i],
            rays[3 * BLOCK + i],
            rays[4 * BLOCK + i],
            rays[5 * BLOCK + i],
            rays[6 * BLOCK + i],
        )
        rays[i], rays[BLOCK + i], rays[2 * BLOCK + i] = x, y, z
        rays[3 * BLOCK + i], rays[4 * BLOCK + i], rays[5 * BLOCK + i] = dx, dy, dz
        rays[6 * BLOCK + i] = going


@inline
def _refract(face, x, y, z, dx, dy, dz, going):
    """A ray at one surface, without a branch. going: 1, or 0 if it was stopped; then it stays as it is."""
    one = face.forward * face.forward
    zero = one - one
    away = z - face.vertex

    # Go to the ray's point nearest to the vertex, and from there to the sphere.
    along = -(x * dx + y * dy + away * dz)
    px, py, pz = x + along * dx, y + along * dy, away + along * dz
    excess = face.curvature * (px * px + py * py + pz * pz) - (pz + pz)
    square = dz * dz - face.curvature * excess
    met = (going > zero) & (square > zero) & (face.forward * dz > zero)
    cosine = np.sqrt(square if met else one)
    onward = excess / (dz + face.forward * cosine if met else one)
    hx, hy, hz = px + onward * dx, py + onward * dy, pz + onward * dz

    # Stop at the rim and on the sphere's far half.
    facing = one - face.curvature * hz
    inside = met & (hx * hx + hy * hy <= face.rim) & (facing > zero)

    # Refract: the normal is (-c x, -c y, 1 - c z). Where all light is reflected, stop.
    bends = face.ratio != one
    refracted = one - face.ratio * face.ratio * (one - square) if bends else one
    through = inside & (refracted > zero)
    turn = face.forward * (np.sqrt(refracted if through else one) - face.ratio * cosine) if bends else zero
    bend = turn * face.curvature
    dx = face.ratio * dx - bend * hx if through else dx
    dy = face.ratio * dy - bend * hy if through else dy
    dz = face.ratio * dz + turn * facing if through else dz
    x, y, z = hx if met else x, hy if met else y, hz + face.vertex if met else z
    return x, y, z, dx, dy, dz, one if through else zero
