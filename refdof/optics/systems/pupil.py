"""Exit pupil: through which part of the last surface's plane a point of the sensor sees the scene.

Rays drawn through the whole last surface are mostly lost at a stop that is closed. Here a box of the plane z = last
vertex is found for every distance of the sensor point from the axis, [1]:

1. on a grid over the last surface, and one around the ray to the stop's centre, bound the rays that pass   `_bound`
2. repeat with a grid on that box, twice, so that a cell of the grid and thus the box's margin is small
3. a point between two distances has a box between their boxes                                         `bounds_at`

Without rims, surfaces go on beyond where they end in glass, and far from the pupil rays may find a way through the stop
that no lens has. Step 1 then takes a grid over one and a half times the pupil, around the ray to the stop's centre.

Departures from [1]
-------------------
- Boxes are refined until their margin is small, so fewer rays are lost.
- Boxes belong to distances and are interpolated, where [1] has one box for an interval of distances.

References
----------
.. [1] Pharr, Jakob & Humphreys (2016), Physically Based Rendering, 3rd edition, section 6.4.5.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_instance, as_integer, as_number
from refdof._jit import inline, kernel, prange
from refdof.optics.systems.field import chief_slopes
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.paraxial import exit_pupil
from refdof.optics.systems.system import LensSystem
from refdof.optics.systems.trace import SurfaceTable, table_of, trace_ray, traced

__all__ = ["PupilBounds", "bounds_at", "joined_boxes", "light_through", "pupil_bounds"]

_ROUNDS = 4  # of narrowing a height lens's boxes; more change little
_SQUARES = 512  # a side: as many as are wrong lie at the rim, and make up 1e-4 of a disc
_DARK = "system: no light comes to the sensor's centre; allowed is a lens that it sees through"
_GRIDS = (64, 64, 256)  # points a side; each is laid on what the one before found


class PupilBounds(NamedTuple):
    """Boxes of the plane z = `plane` for sensor points (r, 0), r = 0 .. reach; one that no ray passes has no area."""

    plane: float  # [mm]
    sensor: float  # z of the sensor [mm]
    reach: float  # largest distance from the axis [mm]
    boxes: Float  # (K + 1, 3): x from, x to, and |y| to [mm], at r = k reach / K


def pupil_bounds(
    system: LensSystem | HeightLens,
    reach: float,
    *,
    sensor: float | None = None,
    wavelength_um: float = LINE_D,
    intervals: int = 128,
    rims: bool = True,
) -> PupilBounds:
    """Bounds of the exit pupil for sensor points up to `reach` from the axis.

    Parameters
    ----------
    system : LensSystem or HeightLens
        Of a height lens, which may be of any shape, boxes hold for sensor points in every direction from the axis.
    reach : float
        Half the sensor's diagonal [mm].
    sensor : float or None
        z of the sensor [mm], behind the last surface; None: as the prescription places it.
    wavelength_um : float
        [um]
    intervals : int
        K, 1 to 1024.
    rims : bool
        False: only the stop bounds the light, without mechanical vignetting: surfaces have no end; of a height lens,
        its rim too.

    Raises
    ------
    InputError
        If the sensor is not behind the lens.
    """
    lens, system = system, system.paraxial if isinstance(system, HeightLens) else system
    as_instance("system", system, LensSystem)
    reach = as_number("reach", reach, above=0.0, maximum=1e4)
    last, surface = float(system.vertices[-1]), system.surfaces[-1]
    sensor = as_number("sensor", system.sensor if sensor is None else sensor, above=last, maximum=1e6)
    intervals = as_integer("intervals", intervals, minimum=1, maximum=1024)
    if isinstance(lens, HeightLens):
        radii = np.linspace(0.0, reach, intervals + 1)
        return PupilBounds(last, sensor, reach, _height_boxes(lens, sensor - last, radii, wavelength_um))
    table = table_of(system, wavelength_um, rims=rims)

    stop, radii = exit_pupil(system, wavelength_um), np.linspace(0.0, reach, intervals + 1)
    scale = (sensor - last) / (sensor - stop.z) if stop.z != sensor else math.inf
    half = np.full(len(radii), 1.5 * stop.radius * abs(scale))
    centre = radii + (sensor - last) * chief_slopes(system, radii, sensor, wavelength_um)
    if not rims and 0.0 < half[0] < math.inf:
        boxes = np.stack([centre - half, centre + half, half], axis=1)
        for count in _GRIDS:
            boxes = _bounded(table, last, sensor, radii, boxes, count)
        return PupilBounds(last, sensor, reach, boxes)

    # A ray to the rim meets the plane farther out if the surface bulges.
    wide = surface.semi_diameter if rims else min(abs(surface.radius), 4.0 * surface.semi_diameter)
    wide += abs(surface.sag(wide)) * (reach + wide) / (sensor - last)
    boxes = _bounded(table, last, sensor, radii, np.tile([-wide, wide, wide], (len(radii), 1)), _GRIDS[0])
    if stop.z < sensor:  # it may be smaller than a cell, and far from its paraxial image
        centre = np.where(np.isfinite(centre), centre, radii * (1.0 - scale))
        image = np.stack([centre - half, centre + half, half], axis=1)
        boxes = joined_boxes(boxes, _bounded(table, last, sensor, radii, image, _GRIDS[0]))
    for count in _GRIDS[1:]:
        boxes = _bounded(table, last, sensor, radii, boxes, count)
    return PupilBounds(last, sensor, reach, boxes)


def _height_boxes(lens: HeightLens, depth: float, radii: Float, wavelength_um: float) -> Float:
    """Boxes (K, 3) around all that passes a height lens, at any azimuth, for a sensor at a depth behind its vertex.

    They are found by intervals, not by rays: each holds for all distances between its neighbours'.
    """
    (front_low, front_high), (low, high) = lens.limits[:, :2]
    if not depth > high:
        raise InputError(f"sensor: is {depth:g} mm behind the lens; allowed is more than its back's sag, {high:.6g}")
    near, far = radii[:-1], radii[1:]
    stop, rim = lens.clear_radii
    x0, x1, y1 = np.full_like(near, -rim), np.full_like(near, rim), np.full_like(near, rim)

    # Where a ray may meet the back so that it comes to the stop on the front: from the box known so far, a smaller one.
    index, normal = lens.glass.index(wavelength_um), np.sin(np.arctan(lens.limits[1, 2]))
    axial = max(lens.thickness + low - front_high, 0.0), lens.thickness + high - front_low
    for _ in range(_ROUNDS):
        slopes = np.stack([x0 - far, x1 - near]) / (depth - np.array([low, high])[:, None, None])
        slope0, slope1, across = slopes[:, 0].min(axis=0), slopes[:, 1].max(axis=0), y1 / (depth - high)
        steep = np.arctan(np.hypot(np.maximum(-slope0, slope1), across)) + np.arctan(lens.limits[1, 2])
        cosine = np.cos(np.minimum(steep, 0.5 * np.pi))  # of incidence, at least
        bent = normal * (np.sqrt(np.maximum(index * index - 1.0 + cosine * cosine, 0.0)) - cosine)
        sine0, sine1 = -_reach(-slope0, across, 1.0), _reach(slope1, across, 1.0)
        inside0, inside1 = (sine0 - bent) / index, (sine1 + bent) / index
        inside_y = (_reach(across, 0.0 * across, 1.0) + bent) / index
        tangent0, tangent1 = -_reach(-inside0, inside_y, -1.0), _reach(inside1, inside_y, -1.0)
        tangent_y = _reach(inside_y, np.maximum(-inside0, inside1), -1.0)
        x0 = np.maximum(x0, -stop - np.maximum(axial[0] * tangent1, axial[1] * tangent1))
        x1 = np.minimum(x1, stop - np.minimum(axial[0] * tangent0, axial[1] * tangent0))
        y1 = np.minimum(y1, stop + axial[1] * tangent_y)

    # A point of the back at height z is seen from the distance depth - z, enlarged in the plane of the vertex.
    scales = depth / (depth - np.array([low, high])[:, None, None])
    sides = np.stack([near, far]) * (1.0 - scales)
    x0, x1, y1 = (sides + scales * x0).min(axis=(0, 1)), (sides + scales * x1).max(axis=(0, 1)), scales.max() * y1
    boxes = np.where(x0 < x1, [x0, x1, y1], 0.0).T
    return joined_boxes(np.concatenate([boxes[:1], boxes]), np.concatenate([boxes, boxes[-1:]]))


def _reach(value: Float, other: Float, sign: float) -> Float:
    """Most of value / sqrt(1 + sign (value^2 + o^2)), o at most `other`: a sine of tangents, or a tangent of sines."""
    against = np.where((value > 0.0) == (sign > 0.0), 0.0, other)
    square = 1.0 + sign * (value * value + against * against)
    return np.where(square > 0.0, value / np.sqrt(np.maximum(square, 1e-300)), np.inf)


def _bounded(table: SurfaceTable, plane: float, sensor: float, radii: Float, boxes: Float, count: int) -> Float:
    """What passes boxes (K, 3), by grids of `count` points a side on them."""
    found = np.zeros_like(boxes)
    _bound(table, plane, sensor, radii, boxes, count, found)
    return found


@kernel
def _bound(table, plane, sensor, radii, boxes, count, found):
    """Fill found (K, 3), which is 0, with the bounds of the points that pass, a cell farther."""
    for k in prange(len(radii)):
        x0, x1, y1 = boxes[k, 0], boxes[k, 1], boxes[k, 2]
        step_x, step_y = (x1 - x0) / count, 2.0 * y1 / count
        low, high, top = count, -1, -1
        for row in range(count // 2 if x1 > x0 else 0):
            y = (row + 0.5) * step_y

            # Search every row from both ends, no farther than what is known.
            column = 0
            while column < count and not _passes(table, radii[k], sensor, plane, x0 + (column + 0.5) * step_x, y):
                column += 1
            if column == count:
                continue
            low, top = min(low, column), row
            column = count - 1
            while column > high and not _passes(table, radii[k], sensor, plane, x0 + (column + 0.5) * step_x, y):
                column -= 1
            high = max(high, column)
        if top >= 0:
            found[k, 0] = x0 + (low - 0.5) * step_x
            found[k, 1] = x0 + (high + 1.5) * step_x
            found[k, 2] = (top + 1.5) * step_y


@inline
def _passes(table, radius, sensor, plane, x, y):
    """Whether the ray of the sensor point (radius, 0) through a point of the plane reaches the scene."""
    dx, dy, dz = x - radius, y, plane - sensor
    scale = 1.0 / np.sqrt(dx * dx + dy * dy + dz * dz)
    return trace_ray(table, True, radius, 0.0, sensor, dx * scale, dy * scale, dz * scale)[6]


def joined_boxes(one: Float, two: Float) -> Float:
    """Boxes (K, 3) around two boxes each; an empty one adds nothing."""
    joined = np.stack([np.minimum(one[:, 0], two[:, 0]), *np.maximum(one[:, 1:], two[:, 1:]).T], axis=1)
    joined = np.where((one[:, 1] <= one[:, 0])[:, None], two, joined)
    return np.where((two[:, 1] <= two[:, 0])[:, None], one, joined)


def light_through(table: SurfaceTable, bounds: PupilBounds) -> float:
    """Integral of cosine^4 over what the sensor's centre sees [mm^2]: pi r^2 cosine^2 of a disc's rim."""
    depth, low, high = bounds.sensor - bounds.plane, 0.0, bounds.boxes[0, 1]
    if table.splines is not None:
        return _light_by_squares(table, depth, bounds)
    for _ in range(3):
        radii = np.linspace(low, high, 257)
        directions = np.stack([radii, 0.0 * radii, 0.0 * radii - depth], axis=1)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        passed = traced(table, True, np.tile([0.0, 0.0, bounds.sensor], (257, 1)), directions).passed
        if not passed.any():
            raise InputError(_DARK)
        last = int(np.flatnonzero(passed)[-1])
        low, high = radii[last], radii[min(last + 1, 256)]
    return math.pi * low * low * depth * depth / (depth * depth + low * low)


def _light_by_squares(table: SurfaceTable, depth: float, bounds: PupilBounds) -> float:
    """`light_through` of a lens that is not round, by small squares of the box."""
    x0, x1, y1 = bounds.boxes[0]
    at = (np.arange(_SQUARES) + 0.5) / _SQUARES
    x, y = np.meshgrid(x0 + (x1 - x0) * at, y1 * (2.0 * at - 1.0))
    directions = np.stack([x.ravel(), y.ravel(), np.full(x.size, -depth)], axis=1)
    passed = traced(table, True, np.tile([0.0, 0.0, bounds.sensor], (x.size, 1)), directions).passed
    if not passed.any():
        raise InputError(_DARK)
    square = depth**2 / (directions[passed] ** 2).sum(axis=1)  # of the cosine
    return float((square**2).sum()) * 2.0 * y1 * (x1 - x0) / x.size


@inline
def bounds_at(bounds, radius):
    """Box (x0, x1, y1) for a sensor point (radius, 0): x in x0 .. x1 and y in -y1 .. y1; empty beyond the reach."""
    intervals = len(bounds.boxes) - 1
    place = radius / bounds.reach * intervals
    if not 0.0 <= place <= intervals:
        return 0.0, 0.0, 0.0
    k = min(int(place), intervals - 1)
    near, far, t = bounds.boxes[k], bounds.boxes[k + 1], place - k
    if near[1] <= near[0]:
        return far[0], far[1], far[2]
    if far[1] <= far[0]:
        return near[0], near[1], near[2]
    return near[0] + t * (far[0] - near[0]), near[1] + t * (far[1] - near[1]), near[2] + t * (far[2] - near[2])
