"""Lamplight: the light of small lamps baked into vertex colours, and its streaks on wet ground."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof.scene.kit.mesh import Mesh, scatter
from refdof.scene.kit.shapes import sphere

__all__ = ["Lamps", "bulbs", "lamp_light", "streaks"]


class Lamps(NamedTuple):
    """L small round lamps."""

    place: Float  # (L, 3)
    radius: Float  # (L,)
    radiance: Float  # (L, 3) linear RGB


def lamp_light(mesh: Mesh, lamps: Lamps, power: float, floor: tuple[float, float, float]) -> Mesh:
    """Multiply colours by the lamps' light at each vertex, plus a faint constant `floor`.

    `power` scales the light; within about half a unit of a lamp it grows no further.
    """
    light = np.broadcast_to(np.asarray(floor), mesh.vertices.shape).copy()
    strength = lamps.radiance * (lamps.radius**2)[:, None]
    for p, s in zip(lamps.place, strength, strict=True):
        to = p - mesh.vertices
        square = (to * to).sum(axis=1) + 0.25
        cosine = np.maximum((to * mesh.normal).sum(axis=1) / np.sqrt(square), 0.0)
        light += power * (0.15 + cosine)[:, None] / square[:, None] * s
    return mesh.tinted(light)


def streaks(points: Float, eye: Float, lamps: Lamps, gain: float) -> Float:
    """Long reflections (N, 3) of the lamps on wet ground, as seen from `eye`."""
    total = np.zeros_like(points)
    to = points - eye
    distance = np.hypot(to[:, 0], to[:, 2])
    bearing = np.arctan2(to[:, 0], -to[:, 2])
    for p, r, s in zip(lamps.place, lamps.radius, lamps.radiance, strict=True):
        lamp = p - eye
        far = np.hypot(lamp[0], lamp[2])
        mirror = far * eye[1] / (eye[1] + p[1])  # where a still puddle would show the lamp
        wide = 2.5 * r / far + 0.006
        across = np.exp(-(((bearing - np.arctan2(lamp[0], -lamp[2])) / wide) ** 2))
        along = np.exp(-((np.log(distance / mirror) / 0.42) ** 2))
        total += gain * r / wide / far * (across * along)[:, None] * s
    return total


def bulbs(lamps: Lamps, rows: int = 6, columns: int = 10) -> Mesh:
    """Spheres that shine: their colour is the radiance."""
    count = len(lamps.radius)
    turn = np.broadcast_to(np.eye(3), (count, 3, 3))
    return scatter(sphere(1.0, rows, columns), lamps.place, turn, lamps.radius, lamps.radiance)
