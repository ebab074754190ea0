"""Lens map: what a renderer needs of a real lens, a ray in camera space for every point of the image and of a square.

For a place in the image [px], a point of the unit square and a wavelength, `lens_map_ray`:

1. find the sensor's point, which the lens has turned upside down, and pick a point of the exit pupil's box, turned
   about the axis to where the sensor point is; weigh it by the box's area and the angle's cosine^4       `_aim`
2. trace backwards through the lens                                                                       `trace_ray`
3. put the ray into camera space                                                                          `_arrive`

The entrance pupil is at the eye: its centre is what perspective is drawn from, and its plane is depth 0. The lens is
focused by moving the sensor: a point of the axis at the focus distance is sharp, but for aberrations.

Brightness follows from E = (A / Z^2) L cos^4: a sensor point's light is the integral over the pupil's area A at the
distance Z, [1]. Weights are divided by that of the centre, so that an even scene has its own brightness there.

References
----------
.. [1] Kolb, Mitchell & Hanrahan (1995), A Realistic Camera Model for Computer Graphics, SIGGRAPH, section 4.
.. [2] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 4.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_float, as_instance, as_integer, as_number
from refdof._jit import borrow, inline, kernel, prange
from refdof.optics.camera import Camera
from refdof.optics.systems.glass import LINE_D
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.paraxial import entrance_pupil, image_scale, sensor_for
from refdof.optics.systems.pupil import PupilBounds, bounds_at, joined_boxes, light_through, pupil_bounds
from refdof.optics.systems.spectrum import RGB_WAVELENGTHS
from refdof.optics.systems.system import LensSystem
from refdof.optics.systems.trace import BLOCK, SurfaceTable, refract_all, table_of, trace_ray

__all__ = [
    "LensMap",
    "borrow_lens_map",
    "lens_map_block",
    "lens_map_of",
    "lens_map_ray",
    "lens_map_rays",
    "new_scratch",
]


class LensMap(NamedTuple):
    """A focused lens before a camera's picture, for kernels; W wavelengths, N surfaces.

    Flat, since parallel loops take no record inside a record.
    """

    vertex: Float  # (N,), as in `SurfaceTable`
    curvature: Float  # (N,)
    rim: Float  # (N,)
    ratios: Float  # (W, 2, N)
    plane: float  # as in `PupilBounds`, of all wavelengths
    sensor: float
    reach: float
    boxes: Float  # (K + 1, 3)
    width: int  # [px]
    height: int  # [px]
    pitch: float  # [mm / px]
    eye: float  # z of the entrance pupil [mm]
    scale: float  # scene units of a millimetre
    inverse_centre: float  # one over the centre's area times cosine^4 [1 / mm^2]
    splines: Float | None = None  # (N, M, M), as in `SurfaceTable`
    limits: Float | None = None  # (N, 5)


@inline
def borrow_lens_map(o):
    """`LensMap` whose arrays are borrowed, for a tile kernel's inner loops."""
    return LensMap(
        borrow(o.vertex), borrow(o.curvature), borrow(o.rim), borrow(o.ratios), o.plane, o.sensor, o.reach,
        borrow(o.boxes), o.width, o.height, o.pitch, o.eye, o.scale, o.inverse_centre,
        _borrow_fields(o.splines), _borrow_fields(o.limits),
    )  # fmt: skip


@inline
def _borrow_fields(array):
    return None if array is None else borrow(array)


@inline
def _table_at(lens_map, wavelength):
    """The lens at one wavelength."""
    return SurfaceTable(
        lens_map.vertex,
        lens_map.curvature,
        lens_map.rim,
        lens_map.ratios[wavelength],
        lens_map.splines,
        lens_map.limits,
    )


def lens_map_of(
    system: LensSystem | HeightLens,
    camera: Camera,
    focus_distance: float,
    *,
    wavelengths_um: Sequence[float] = RGB_WAVELENGTHS,
    sensor_height: float | None = None,
    millimetres: float = 1000.0,
    rims: bool = True,
) -> LensMap:
    """Focus a lens and put it before a camera's eye.

    Parameters
    ----------
    system : LensSystem or HeightLens
    camera : Camera
        Only its picture size and, without `sensor_height`, its field of view count: camera space is where rays are.
    focus_distance : float
        Planar distance of what is sharp from the eye [scene units]; ``inf`` is allowed.
    wavelengths_um : 1 to 32 floats
        [um]
    sensor_height : float or None
        [mm]; the field of view then follows from the lens, and breathes with the focus. None: the sensor is as large as
        makes the camera's field of view at the focus distance.
    millimetres : float
        Of one scene unit.
    rims : bool
        False: only the stop bounds the light, without mechanical vignetting; of a height lens, its rim too.

    Raises
    ------
    InputError
        If the lens cannot be focused there, or no light comes to the sensor's centre.
    """
    as_instance("camera", camera, Camera)
    lens, system = system, system.paraxial if isinstance(system, HeightLens) else system
    as_instance("system", system, LensSystem)
    millimetres = as_number("millimetres", millimetres, minimum=1e-6, maximum=1e6)
    focus = as_number("focus_distance", focus_distance, above=0.0, finite=False) * millimetres
    if not isinstance(wavelengths_um, list | tuple) or not 1 <= len(wavelengths_um) <= 32:
        raise InputError("wavelengths_um: allowed is a list of 1 to 32 numbers")
    wavelengths = [as_number("wavelengths_um", w, minimum=0.3, maximum=2.5) for w in wavelengths_um]
    sensor = sensor_for(system, focus)
    if sensor_height is None:
        pitch = image_scale(system, focus) / camera.pixels_per_tangent
    else:
        pitch = as_number("sensor_height", sensor_height, minimum=1e-3, maximum=1e4) / camera.height
    tables = [table_of(lens, wavelength, rims=rims) for wavelength in wavelengths]
    reach = 0.5 * math.hypot(camera.width, camera.height) * pitch * (1.0 + 1e-9)  # a rounding
    each = [pupil_bounds(lens, reach, sensor=sensor, wavelength_um=w, rims=rims) for w in wavelengths]
    boxes = each[0].boxes
    for other in each[1:]:
        boxes = joined_boxes(boxes, other.boxes)
    middle = tables[len(tables) // 2]
    return LensMap(
        middle.vertex,
        middle.curvature,
        middle.rim,
        np.stack([table.ratio for table in tables]),
        *each[0]._replace(boxes=boxes),
        camera.width,
        camera.height,
        pitch,
        entrance_pupil(system, LINE_D).z,
        1.0 / millimetres,
        1.0 / light_through(middle, each[len(tables) // 2]),
        *middle[4:],
    )


def lens_map_rays(lens_map: LensMap, places: Float, squares: Float, wavelength: int = 0) -> tuple[Float, Float]:
    """Rays (N, 4), as `lens_map_ray` has them, and weights (N,), for image places and square points, (N, 2) each.

    Parameters
    ----------
    lens_map : LensMap
    places : (N, 2)
        x and y in the image [px], y down.
    squares : (N, 2)
        Points of the unit square.
    wavelength : int
        Index of the wavelength.

    Raises
    ------
    InputError
        If shapes disagree, a number is out of range, or there is no such wavelength.
    """
    as_instance("lens_map", lens_map, LensMap)
    places = as_float("places", places, (None, 2), dtype=np.float64, minimum=-1e6, maximum=1e6)
    squares = as_float("squares", squares, (len(places), 2), dtype=np.float64, minimum=0.0, maximum=1.0)
    which = as_integer("wavelength", wavelength, minimum=0, maximum=len(lens_map.ratios) - 1)
    rays, weights = np.empty((len(places), 4)), np.empty(len(places))
    _map_rays(lens_map, places, squares, which, rays, weights)
    return rays, weights


@kernel
def _map_rays(lens_map, places, squares, wavelength, rays, weights):
    """Fill rays (N, 4) and weights (N,), a block at a time."""
    for block in prange((len(places) + BLOCK - 1) // BLOCK):
        begin, end = block * BLOCK, min((block + 1) * BLOCK, len(places))
        numbers, scratch = np.empty((6, end - begin)), np.empty(7 * BLOCK)
        for k in range(begin, end):
            numbers[0, k - begin], numbers[1, k - begin] = places[k, 0], places[k, 1]
            numbers[2, k - begin], numbers[3, k - begin] = squares[k, 0], squares[k, 1]
        columns, rows, x, y, dx, dy = numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]
        lens_map_block(lens_map, wavelength, scratch, columns, rows, x, y, dx, dy, weights[begin:end])
        for k in range(begin, end):
            for axis in range(4):
                rays[k, axis] = numbers[2 + axis, k - begin]


@inline
def new_scratch():
    """Memory for `lens_map_block`."""
    return np.zeros(7 * BLOCK)


@inline
def lens_map_block(lens_map, wavelength, scratch, columns, rows, x, y, dx, dy, weights):
    """`lens_map_ray` for arrays (N,) of any length, with the same bits and vectorised.

    x and y hold the square's points, and then the rays'. dx and dy may be the memory of columns and rows; scratch is of
    `new_scratch`.
    """
    table = _table_at(lens_map, wavelength)
    for first in range(0, len(x), BLOCK):
        here = min(BLOCK, len(x) - first)
        scratch[:] = 0.0
        for i in range(here):
            k = first + i
            px, py, wx, wy, wz, weights[k] = _aim(lens_map, columns[k], rows[k], x[k], y[k])
            scratch[i], scratch[BLOCK + i], scratch[2 * BLOCK + i] = px, py, lens_map.sensor
            scratch[3 * BLOCK + i], scratch[4 * BLOCK + i], scratch[5 * BLOCK + i] = wx, wy, wz
            scratch[6 * BLOCK + i] = 1.0
        refract_all(table.splines, table, True, scratch)
        for i in range(here):
            k = first + i
            px, py, pz = scratch[i], scratch[BLOCK + i], scratch[2 * BLOCK + i]
            wx, wy, wz = scratch[3 * BLOCK + i], scratch[4 * BLOCK + i], scratch[5 * BLOCK + i]
            weight = weights[k] * scratch[6 * BLOCK + i]
            x[k], y[k], dx[k], dy[k], weights[k] = _arrive(lens_map, px, py, pz, wx, wy, wz, weight)


@inline
def lens_map_ray(lens_map, column, row, u, v, wavelength):
    """Ray (x, y, slope_x, slope_y) and weight of a place in the image and a point (u, v) of the unit square.

    The ray passes (x, y, 0) in camera space, in scene units, and runs along (slope_x, slope_y, -1). A ray that does not
    pass has weight 0, and is the axis.
    """
    table = _table_at(lens_map, wavelength)
    x, y, dx, dy, dz, weight = _aim(lens_map, column, row, u, v)
    x, y, z, dx, dy, dz, passed = trace_ray(table, True, x, y, lens_map.sensor, dx, dy, dz)
    return _arrive(lens_map, x, y, z, dx, dy, dz, weight if passed else 0.0)


@inline
def _aim(lens_map, column, row, u, v):
    """Sensor point (x, y), unit direction to the exit pupil, and the weight, 0 where the pupil is empty."""
    sensor_x = (0.5 * lens_map.width - column) * lens_map.pitch
    sensor_y = (row - 0.5 * lens_map.height) * lens_map.pitch
    radius = np.sqrt(sensor_x * sensor_x + sensor_y * sensor_y)
    turn_x, turn_y = (sensor_x / radius, sensor_y / radius) if radius > 0.0 else (1.0, 0.0)

    # Pick a point of the box, as if the sensor point were (radius, 0), and turn it.
    bounds = PupilBounds(lens_map.plane, lens_map.sensor, lens_map.reach, lens_map.boxes)
    x0, x1, y1 = bounds_at(bounds, radius)
    along, across = x0 + (x1 - x0) * u, y1 * (2.0 * v - 1.0)
    dx = turn_x * along - turn_y * across - sensor_x
    dy = turn_y * along + turn_x * across - sensor_y
    dz = bounds.plane - bounds.sensor
    square = dz * dz / (dx * dx + dy * dy + dz * dz)
    scale = np.sqrt(square) / -dz
    weight = 2.0 * y1 * (x1 - x0) * square * square * lens_map.inverse_centre
    return sensor_x, sensor_y, dx * scale, dy * scale, dz * scale, weight


@inline
def _arrive(lens_map, x, y, z, dx, dy, dz, weight):
    """The traced ray at the plane of the eye, in scene units: (x, y, slope_x, slope_y), weight."""
    if not (weight > 0.0 and dz < 0.0):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    slope_x, slope_y, depth = -dx / dz, -dy / dz, z - lens_map.eye
    return (x + depth * slope_x) * lens_map.scale, (y + depth * slope_y) * lens_map.scale, slope_x, slope_y, weight
