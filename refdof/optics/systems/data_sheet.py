"""Data sheet: the numbers of a lens that is focused at a distance, on the axis and over the field."""

import math
from dataclasses import dataclass, replace

import numpy as np

from refdof.optics.systems.field import distortion, illumination
from refdof.optics.systems.paraxial import (
    cardinal_points,
    entrance_pupil,
    exit_pupil,
    f_number,
    image_scale,
    sensor_for,
    transmission,
)
from refdof.optics.systems.system import LensSystem

__all__ = ["FILM", "HEIGHTS", "DataSheet", "FieldRow", "data_sheet", "focused"]

FILM = (36.0, 24.0)  # [mm]
HEIGHTS = (0.0, 10.0, 18.0, 21.6)  # [mm] from the film's centre; the last is its corner


@dataclass(frozen=True)
class FieldRow:
    """One film height; NaN is what no ray reaches."""

    height: float  # [mm]
    light: float  # irradiance over that on the axis
    cat_eye: float  # extent of the pupil along the field over that across it, seen from the film
    distortion: float  # image height over the ideal one, minus 1


@dataclass(frozen=True)
class DataSheet:
    """Lengths in mm; places are z from the first vertex; fields of view are full angles [degrees]."""

    name: str
    source: str
    focus_distance: float  # [m] before the entrance pupil
    focal_length: float
    f_number: float
    t_stop: float  # f-number / sqrt(transmission) of uncoated glass on the axis; absorption is not counted
    front_principal: float
    back_principal: float
    entrance_pupil_z: float
    entrance_pupil_radius: float
    exit_pupil_z: float
    exit_pupil_radius: float
    last_vertex: float
    sensor: float
    field_width: float
    field_height: float
    field_diagonal: float
    field: tuple[FieldRow, ...]


def focused(system: LensSystem, distance: float) -> LensSystem:
    """The lens with its sensor where a point of the axis, `distance` [mm] before the entrance pupil, is sharp.

    Raises
    ------
    InputError
        If the distance is too near, or there is no image behind the lens.
    """
    last = replace(system.surfaces[-1], thickness=sensor_for(system, distance) - float(system.vertices[-1]))
    return replace(system, surfaces=(*system.surfaces[:-1], last))


def data_sheet(system: LensSystem, distance: float) -> DataSheet:
    """Numbers of a lens that is `focused` at `distance` [mm]; rays are of the d line.

    Fields of view are those of the ideal image, seen from the entrance pupil.
    """
    points, entrance, exit = cardinal_points(system), entrance_pupil(system), exit_pupil(system)
    scale, heights = image_scale(system, distance), np.array(HEIGHTS)
    light = illumination(system, heights)
    columns = (HEIGHTS, light.relative.tolist(), light.cat_eye.tolist(), distortion(system, heights, distance).tolist())
    width, height, diagonal = (2.0 * math.degrees(math.atan(0.5 * side / scale)) for side in (*FILM, math.hypot(*FILM)))
    return DataSheet(
        name=system.name,
        source=system.source,
        focus_distance=distance / 1000.0,
        focal_length=points.focal_length,
        f_number=f_number(system),
        t_stop=f_number(system) / math.sqrt(transmission(system)),
        front_principal=points.front_principal,
        back_principal=points.back_principal,
        entrance_pupil_z=entrance.z,
        entrance_pupil_radius=entrance.radius,
        exit_pupil_z=exit.z,
        exit_pupil_radius=exit.radius,
        last_vertex=points.last_vertex,
        sensor=system.sensor,
        field_width=width,
        field_height=height,
        field_diagonal=diagonal,
        field=tuple(FieldRow(*row) for row in zip(*columns, strict=True)),
    )
