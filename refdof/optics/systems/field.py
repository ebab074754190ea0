"""Field: what a lens does off its axis, from rays through it: chief rays, light, distortion, spots and focal surfaces.

Everything lies in the plane x = 0: film points are (0, h, sensor). Rays in front of the lens run towards it.

1. rays through the centre of the stop                      `chief_slopes`, `chief_rays`
2. light at a film point, over its pupil                    `illumination`
3. image height beside that of an ideal lens                `distortion`
4. where the rays of one point meet the film                `spot`
5. where rays of the axis cross it                          `longitudinal_aberration`
6. where narrow bundles are sharp, by rays beside the chief `focal_surfaces`

References
----------
.. [1] Welford (1986), Aberrations of Optical Systems, sections 5 to 7.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.paraxial import entrance_pupil, exit_pupil, image_scale
from refdof.optics.systems.system import LensSystem
from refdof.optics.systems.trace import Traced, part_of, table_of, trace, traced

__all__ = [
    "FilmLight",
    "Rays",
    "bundle",
    "chief_rays",
    "chief_slopes",
    "distortion",
    "focal_surfaces",
    "illumination",
    "longitudinal_aberration",
    "spot",
]

_STEPS = 20  # of Newton's method for the chief ray; five are usual
_CLOSE = 1e-6  # [mm] from the stop's centre
_COARSE, _FINE = 96, 240  # rays across the pupil: to find its bounds, and to measure it
_NARROW = 1e-3  # of the entrance pupil's radius: a bundle about the chief ray, whose aberrations are below 1e-6 of it


class Rays(NamedTuple):
    """Rays in front of the lens: points [mm] and directions, (N, 3) each; NaN where there is none."""

    origins: Float
    directions: Float


class FilmLight(NamedTuple):
    """Light at film points: over that on the axis; and extent of the pupil along the field over that across it."""

    relative: Float  # (N,)
    cat_eye: Float  # (N,)


def chief_rays(system: LensSystem, heights: Float, wavelength_um: float = LINE_D) -> Rays:
    """The rays from the scene that pass the stop's centre and meet the film at `heights` (N,) [mm], rims or not."""
    origins = _on_film(heights, system.sensor)
    slopes = chief_slopes(system, heights, system.sensor, wavelength_um)
    known = np.isfinite(slopes)
    found = _without_rims(system, origins, _towards_scene(np.where(known, slopes, 0.0)), wavelength_um, reverse=True)
    through = (known & found.passed)[:, None]
    return Rays(np.where(through, found.origins, np.nan), np.where(through, -found.directions, np.nan))


def chief_slopes(system: LensSystem, heights: Float, sensor: float, wavelength_um: float = LINE_D) -> Float:
    """Slopes dy / -dz (N,) of rays from film points (0, heights, sensor) [mm] to the stop's centre, rims or not.

    NaN where there is none.
    """
    origins = _on_film(heights, sensor)
    table = part_of(table_of(system, wavelength_um, rims=False), slice(system.stop, None))
    open_table = table._replace(rim=np.full_like(table.rim, np.inf))

    def height_at_stop(slope: Float) -> Float:
        found = traced(open_table, True, np.ascontiguousarray(origins), _towards_scene(slope))  # a stop may be tiny
        return np.where(found.passed, found.origins[:, 1], np.nan)

    # Newton's method on the slope at the film, from the paraxial chief ray.
    slope = heights / (exit_pupil(system, wavelength_um).z - sensor)
    for _ in range(_STEPS):
        height = height_at_stop(slope)
        if (np.abs(height[np.isfinite(height)]) < _CLOSE).all():
            break
        derivative = (height_at_stop(slope + 1e-6) - height) / 1e-6
        slope = np.where(np.isfinite(height / derivative), slope - height / derivative, slope)
    return np.where(np.abs(height_at_stop(slope)) < _CLOSE, slope, np.nan)


def _on_film(heights: Float, sensor: float) -> Float:
    """Points (0, heights, sensor), (N, 3)."""
    return np.stack([np.zeros_like(heights), heights, np.full_like(heights, sensor)], axis=1)


def _towards_scene(slope: Float) -> Float:
    """Directions (N, 3) from the film with dy / -dz = slope."""
    return np.stack([np.zeros_like(slope), slope, np.full_like(slope, -1.0)], axis=1)


def _without_rims(
    system: LensSystem, origins: Float, ways: Float, wavelength_um: float, *, reverse: bool = False
) -> Traced:
    """Rays (N, 3) through the surfaces, blocked by no rim but the stop's."""
    table = table_of(system, wavelength_um, rims=False)
    return traced(table, reverse, np.ascontiguousarray(origins), np.ascontiguousarray(ways))


def illumination(system: LensSystem, heights: Float, wavelength_um: float = LINE_D) -> FilmLight:
    """Irradiance at film points (N,), of a scene that is equally bright everywhere, over that on the axis.

    A point gets the integral of cos^4 / distance^2 over the part of the exit pupil's plane whose rays pass.
    """
    lights, shapes = [], []
    for height in [0.0, *heights.tolist()]:
        film = np.array([0.0, height, system.sensor])
        light, shape = _light(system, film, wavelength_um)
        lights.append(light)
        shapes.append(shape)
    with np.errstate(invalid="ignore", divide="ignore"):
        return FilmLight(np.array(lights[1:]) / lights[0], np.array(shapes[1:]))


def _light(system: LensSystem, film: Float, wavelength_um: float) -> tuple[float, float]:
    """Light at a film point, in no unit, and the extent of its pupil along y over that along x."""
    last = float(system.vertices[-1])
    plane = exit_pupil(system, wavelength_um).z
    if not plane < 0.5 * (last + system.sensor):  # near the film or behind it
        plane = last
    # The last surface, as the film point sees it in the plane: a ray may meet its rim beside its vertex.
    scale, reach = (film[2] - plane) / (film[2] - last), 1.5 * system.surfaces[-1].semi_diameter
    low, high = film[:2] + scale * (-reach - film[:2]), film[:2] + scale * (reach - film[:2])
    half, chief = _pupil_about(system, film, plane, wavelength_um)
    if half < 0.1 * scale * reach and math.isfinite(chief):  # a stop that may be smaller than a cell
        low, high = np.array([-half, chief - half]), np.array([half, chief + half])
    for count in (_COARSE, _FINE):
        points, cell = _grid(low, high, count)
        ways = np.column_stack([points, np.full(len(points), plane)]) - film
        passed = trace(system, np.broadcast_to(film, ways.shape), ways, wavelength_um, reverse=True).passed
        if not passed.any():
            return 0.0, math.nan
        low, high = points[passed].min(axis=0) - cell, points[passed].max(axis=0) + cell
    square = (ways[passed] ** 2).sum(axis=1)
    width, height = high - low - cell
    return float((ways[0, 2] ** 2 / square**2).sum() * cell.prod()), float(height / width)


def _pupil_about(system: LensSystem, film: Float, plane: float, wavelength_um: float) -> tuple[float, float]:
    """One and a half times the pupil's paraxial radius in a plane, and where there the ray to the stop's centre is."""
    pupil, depth = exit_pupil(system, wavelength_um), film[2] - plane
    half = 1.5 * pupil.radius * abs(depth / (film[2] - pupil.z)) if pupil.z != film[2] else math.inf
    slope = float(chief_slopes(system, film[1:2], float(film[2]), wavelength_um)[0])
    return half, float(film[1] + depth * slope)


def _grid(low: Float, high: Float, count: int) -> tuple[Float, Float]:
    """Centres of count x count cells between two corners, (count^2, 2), and the size of a cell."""
    cell = (high - low) / count
    middles = np.arange(count) + 0.5
    x, y = np.meshgrid(low[0] + middles * cell[0], low[1] + middles * cell[1])
    return np.column_stack([x.ravel(), y.ravel()]), cell


def distortion(system: LensSystem, heights: Float, distance: float) -> Float:
    """Film height over that of an ideal lens of the same focal length, minus 1; (N,), 0 on the axis.

    The ideal image is that of the plane in focus, `distance` [mm] before the entrance pupil; it may be infinite.
    """
    rays = chief_rays(system, heights)
    slope: Float = rays.directions[:, 1] / rays.directions[:, 2]
    if not math.isinf(distance):
        slope = -_at_plane(rays, entrance_pupil(system).z - distance)[:, 1] / distance
    ideal = image_scale(system, distance) * slope
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(heights == 0.0, 0.0, heights / ideal - 1.0)


def bundle(system: LensSystem, chief: Rays, targets: Float, distance: float) -> Rays:
    """Rays from the object point of one chief ray through points (N, 2) of the plane z = 0."""
    origin, way = chief.origins[0], chief.directions[0]
    points = np.column_stack([targets, np.zeros(len(targets))])
    if math.isinf(distance):
        return Rays(points, np.broadcast_to(way, points.shape))
    plane = entrance_pupil(system).z - distance
    place = origin + (plane - origin[2]) / way[2] * way
    return Rays(np.broadcast_to(place, points.shape), points - place)


def spot(system: LensSystem, height: float, distance: float, wavelength_um: float, count: int = 40) -> Float:
    """Where the rays of one point meet the film, from the chief ray's point of the d line: (M, 2) [mm].

    The rays are a square lattice of at most count x count over the entrance pupil.
    """
    chief = chief_rays(system, np.array([height]))
    if not np.isfinite(chief.origins).all():
        return np.empty((0, 2))
    reach = system.surfaces[0].semi_diameter
    centre = _at_plane(chief, 0.0)[0]
    low, high = centre - 2.0 * reach, centre + 2.0 * reach
    for across in (_COARSE, count):
        points, cell = _grid(low, high, across)
        found = trace(system, *bundle(system, chief, points, distance), wavelength_um)
        if not found.passed.any():
            return np.empty((0, 2))
        low, high = points[found.passed].min(axis=0) - cell, points[found.passed].max(axis=0) + cell
    rays = Rays(found.origins[found.passed], found.directions[found.passed])
    return _at_plane(rays, system.sensor) - [0.0, height]


def _at_plane(rays: Rays, z: float) -> Float:
    """x and y of rays at a plane: (N, 2)."""
    step = (z - rays.origins[:, 2:]) / rays.directions[:, 2:]
    return (rays.origins + step * rays.directions)[:, :2]


def longitudinal_aberration(system: LensSystem, fractions: Float, distance: float, wavelength_um: float) -> Float:
    """Where rays from the axis cross it again, from the film: (N,) [mm], NaN where they are blocked.

    `fractions` (N,), above 0, are heights of the rays in the entrance pupil over its radius.
    """
    pupil = entrance_pupil(system)
    place = np.column_stack([np.zeros_like(fractions), fractions * pupil.radius, np.full_like(fractions, pupil.z)])
    if math.isinf(distance):
        rays = Rays(place - [0.0, 0.0, pupil.z], np.broadcast_to([0.0, 0.0, 1.0], place.shape))
    else:
        axis = np.array([0.0, 0.0, entrance_pupil(system).z - distance])
        rays = Rays(np.broadcast_to(axis, place.shape), place - axis)
    found = trace(system, *rays, wavelength_um)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = found.origins[:, 2] - found.origins[:, 1] * found.directions[:, 2] / found.directions[:, 1]
    return np.where(found.passed, crossing - system.sensor, np.nan)


def focal_surfaces(system: LensSystem, heights: Float, distance: float) -> tuple[Float, Float]:
    """Where narrow bundles about the chief rays are sharp, along the axis from the film: sagittal, tangential (N,).

    Sagittal: rays beside the chief ray in x. Tangential: rays above and below it in y. [mm]
    """
    offset = _NARROW * entrance_pupil(system).radius
    chief = chief_rays(system, heights)
    found = []
    for x, y in ((offset, 0.0), (0.0, -offset), (0.0, offset)):
        places = _at_plane(chief, 0.0) + np.array([x, y])
        points = np.column_stack([places, np.zeros(len(places))])
        if math.isinf(distance):
            ways = chief.directions
        else:
            plane = entrance_pupil(system).z - distance
            objects = np.column_stack([_at_plane(chief, plane), np.full(len(places), plane)])
            points, ways = objects, points - objects
        known = np.isfinite(points).all(axis=1)
        ends = np.full((2, len(places), 3), np.nan)
        through = _without_rims(system, points[known], ways[known], LINE_D)
        ends[0, known], ends[1, known] = through.origins, through.directions
        found.append(Rays(*ends))
    beside, below, above = found
    slopes = [rays.directions[:, 1] / rays.directions[:, 2] for rays in found]
    # At the last vertex: heights and slopes of the two tangential rays; they meet where their heights are equal.
    last = float(system.vertices[-1])
    heights_there = [_at_plane(rays, last)[:, 1] for rays in (below, above)]
    tangential = last - (heights_there[1] - heights_there[0]) / (slopes[2] - slopes[1])
    sagittal = last - _at_plane(beside, last)[:, 0] * beside.directions[:, 2] / beside.directions[:, 0]
    return sagittal - system.sensor, tangential - system.sensor
