"""Naive twin of rays through a height lens: SciPy's spline, a dense scan for the first sign change, and Brent's method.

One ray at a time. The plane of incidence gives Snell's law by angles. Departures: a scan of 4000 points may miss two
hits that are closer than 1 / 4000 of the way through the lens.
"""

import math

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

SCAN = 4000


def surfaces_of(lens):
    """[(spline, z of the vertex, sag in the middle)], front and back; a spline takes y, then x."""
    at = np.linspace(-lens.diameter / 2, lens.diameter / 2, len(lens.front))
    splines = [RectBivariateSpline(at, at, sag, kx=3, ky=3, s=0) for sag in (lens.front, lens.back)]
    return [(spline, z, spline(0.0, 0.0)[0, 0]) for spline, z in zip(splines, (0.0, lens.thickness), strict=True)]


def trace_one(lens, origin, direction, wavelength_um, *, reverse=False):
    """(first hit of each surface met, direction, passed, how many hits of each) of a ray from in front of the lens."""
    index, rim = lens.glass.index(wavelength_um), lens.diameter / 2
    stop = rim if lens.stop_diameter is None else lens.stop_diameter / 2
    faces = [(face, radius) for face, radius in zip(surfaces_of(lens), (stop, rim), strict=True)]
    point, way = np.array(origin, dtype=float), np.array(direction) / np.linalg.norm(direction)
    counts, points = [], []
    for number, ((spline, vertex, middle), radius) in enumerate(faces[::-1] if reverse else faces):

        def gap(t, spline=spline, vertex=vertex, middle=middle, point=point, way=way):
            x, y, z = point + t * way
            return (z - vertex - (spline(y, x)[0, 0] - middle)) * (-1.0 if reverse else 1.0)

        # Where the ray is inside the clear disc's cylinder, on a line that is long enough.
        a, b, c = way[:2] @ way[:2], 2 * point[:2] @ way[:2], point[:2] @ point[:2] - rim**2
        ends = np.roots([a, b, c]).real if a > 0 and b * b > 4 * a * c else np.array([0.0, 1e3])
        low, high = max(ends.min(), 0.0), min(ends.max(), 1e3)
        steps = np.linspace(low, high, SCAN)
        x, y, z = point[:, None] + way[:, None] * steps
        gaps = (z - vertex - (spline.ev(y, x) - middle)) * (-1.0 if reverse else 1.0)
        crossings = np.flatnonzero((gaps[:-1] < 0) & (gaps[1:] >= 0))
        counts.append(len(crossings))
        if gaps[0] >= 0 or not len(crossings):
            return points, way, False, counts
        k = crossings[0]
        t = brentq(gap, steps[k], steps[k + 1], xtol=1e-14, rtol=1e-15)
        hit = point + t * way
        points.append(hit)
        if math.hypot(hit[0], hit[1]) > radius:
            return points, way, False, counts
        normal = np.array([-spline(hit[1], hit[0], dy=1)[0, 0], -spline(hit[1], hit[0], dx=1)[0, 0], 1.0])
        normal *= (-1.0 if reverse else 1.0) / np.linalg.norm(normal)
        before, behind = (1.0, index) if number == 0 else (index, 1.0)
        tangent = np.cross(np.cross(normal, way), normal)
        sine = np.linalg.norm(tangent)
        if before * sine >= behind:
            return points, way, False, counts
        turned = math.asin(before * sine / behind)
        point, way = hit, math.cos(turned) * normal + (math.sin(turned) * tangent / sine if sine > 0 else 0.0)
    return points, way, True, counts
