"""Naive twin of pictures through a singlet: a plain sum over wavelengths and a square lattice of rays, in NumPy.

A row of pixels sees a grey card that covers all on the right of an edge, before black. From the middle of every pixel
on the film, rays go to a lattice of points in the plane behind the lens, and through two spheres and a rim by the
textbook's formulas. A ray counts with the fourth power of its cosine on the film.
"""

import math
from typing import NamedTuple

import numpy as np


class Singlet(NamedTuple):
    """Biconvex, with its stop at the first vertex; lengths in mm."""

    radius1: float
    radius2: float
    thickness: float
    rim1: float  # clear radii
    rim2: float


class Card(NamedTuple):
    """A card on the right of x = edge, `distance` before the lens's first vertex [mm]."""

    edge: float
    distance: float


def row(lens, index, film, places, card, lattice=600):
    """Light (len(places),) that comes from the card to film points (x, 0, film), at one refractive index; in no unit.

    Lattice points are as far apart whatever the index is.
    """
    last = lens.thickness
    half = 1.3 * lens.rim2
    steps = (np.arange(lattice) + 0.5) / lattice * 2.0 * half - half
    px, py = (a.ravel() for a in np.meshgrid(steps, steps))
    light = []
    for x in places:
        dx, dy, dz = px - x, py, np.full(px.shape, last - film)
        length = np.sqrt(dx**2 + dy**2 + dz**2)
        cosine4 = (dz / length) ** 4
        point = np.array([np.full(px.shape, x), np.zeros(px.shape), np.full(px.shape, film)])
        way = np.array([dx, dy, dz]) / length
        good = np.ones(px.shape, dtype=bool)
        for radius, vertex, rim, ratio in (
            (lens.radius2, last, lens.rim2, 1.0 / index),
            (lens.radius1, 0.0, lens.rim1, index),
        ):
            point, way, good = _surface(point, way, good, radius, vertex, rim, ratio)
        t = (-card.distance - point[2]) / way[2]
        light.append(float((cosine4 * (good & (point[0] + t * way[0] > card.edge))).sum()))
    return np.array(light)


def _surface(point, way, good, radius, vertex, rim, ratio):
    """Through a sphere: the root nearest to the vertex, and Snell's law along the surface."""
    centre = np.array([0.0, 0.0, vertex + radius])[:, None]
    offset = point - centre
    b, c = (offset * way).sum(axis=0), (offset**2).sum(axis=0) - radius**2
    square = b * b - c
    root = np.sqrt(np.maximum(square, 0.0))
    hits = [point + t * way for t in (-b - root, -b + root)]
    far = [np.abs(hit[2] - vertex) for hit in hits]
    hit = np.where(far[0] < far[1], hits[0], hits[1])
    good = good & (square > 0.0) & (hit[0] ** 2 + hit[1] ** 2 <= rim**2)
    normal = (hit - centre) / abs(radius)
    normal = normal * np.sign((normal * way).sum(axis=0))
    cosine = (normal * way).sum(axis=0)
    tangent = ratio * (way - cosine * normal)
    rest = 1.0 - (tangent**2).sum(axis=0)
    return hit, tangent + np.sqrt(np.maximum(rest, 0.0)) * normal, good & (rest > 0.0)


def colours(lens, index_at, film, places, card, wavelengths, weights, lattice=600):
    """Linear RGB (len(places), 3): a sum over wavelengths, by weights (N, 3), for a card of grey 1.

    The middle wavelength's light on the axis, all of it from the card, is 1.
    """
    everywhere = Card(-math.inf, card.distance)
    middle = row(lens, index_at(wavelengths[len(wavelengths) // 2]), film, [0.0], everywhere, lattice)[0]
    rows = [row(lens, index_at(wavelength), film, places, card, lattice) for wavelength in wavelengths]
    return np.tensordot(np.array(rows), weights, axes=(0, 0)) / middle
