"""The shape of an aperture: its moments, how dense light is in it, and the way back into it.

Points are on the unit lens disc, x right, y up, as the aperture's squeeze leaves them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from refdof._check import Float
from refdof.optics.aperture import Aperture

__all__ = ["Moments", "density", "is_inside", "middle", "mirrored", "moments", "widened"]

_MOST_LIGHT = 9.0
_INSET = 2.0**-10  # of a texel: how far inside a clear one the middle lies if it is on an opaque one


class Moments(NamedTuple):
    """Of the light in an aperture: its mean (2,) and covariance (2, 2)."""

    mean: Float
    covariance: Float


def moments(aperture: Aperture) -> Moments:
    """Exact moments of the light."""
    mean, square = np.zeros(2), np.zeros((2, 2))  # square: mean of x x, x y, y y
    if aperture.is_image:
        height, width = aperture.weights.shape
        share = aperture.weights / aperture.weights.sum()
        x = (2.0 * np.arange(width) + 1.0) / width - 1.0
        y = 1.0 - (2.0 * np.arange(height) + 1.0) / height
        mean = np.array([share.sum(axis=0) @ x, share.sum(axis=1) @ y])
        across = (share.sum(axis=0) * (x - mean[0])) @ (x - mean[0]) + 1.0 / (3.0 * width**2)  # a texel's own 1/12
        along = (share.sum(axis=1) * (y - mean[1])) @ (y - mean[1]) + 1.0 / (3.0 * height**2)
        mixed = (y - mean[1]) @ share @ (x - mean[0])
        square = np.array([[across, mixed], [mixed, along]])
    elif len(aperture.boundary):
        # A triangle with the centre has the mean (a + b) / 3 and the mean square (a a + b b + (a + b)(a + b)) / 12.
        a, b = aperture.boundary, np.roll(aperture.boundary, -1, axis=0)
        area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        share = area / area.sum()
        mean = share @ (a + b) / 3.0
        square = sum((share[:, None] * p).T @ p for p in (a, b, a + b)) / 12.0 - np.outer(mean, mean)
    else:
        square = np.eye(2) * 0.25
        if math.isfinite(aperture.deviation):
            # Mean r^2 = 2 s^2 - q / (1 - q) with q = exp(-1 / (2 s^2)); half of it along each axis.
            double = 2.0 * aperture.deviation**2
            square = np.eye(2) * 0.5 * (double - 1.0 / math.expm1(min(1.0 / double, 700.0)))
    scale = np.asarray(aperture.scale)
    return Moments(mean * scale, square * np.outer(scale, scale))


def density(aperture: Aperture, points: Float) -> Float:
    """Share of the light per area (N,) at points (N, 2); of apertures that are no images it goes on beyond the rim."""
    area = float(np.prod(aperture.scale))
    if aperture.is_image:
        texel = 4.0 * area / aperture.weights.size
        return aperture.transmission(points) / (aperture.weights.sum() * texel)
    if len(aperture.boundary):
        a, b = aperture.boundary, np.roll(aperture.boundary, -1, axis=0)
        return np.full(len(points), 2.0 / (area * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()))
    if not math.isfinite(aperture.deviation):
        return np.full(len(points), 1.0 / (math.pi * area))
    double = 2.0 * aperture.deviation**2
    squared = ((points / np.asarray(aperture.scale)) ** 2).sum(axis=1)
    return np.exp(-squared / double) / (math.pi * area * double * -math.expm1(-1.0 / double))


def widened(aperture: Aperture, margin: float) -> tuple[Aperture, float]:
    """The aperture grown by about `margin` on all sides, at most to 9 times its light, and its light over the
    aperture's.

    The density is the same inside; beyond, it goes on, in an image as in the nearest clear texel.
    """
    scale = np.asarray(aperture.scale)
    if aperture.is_image:
        height, width = aperture.weights.shape
        rows = math.ceil(min(0.5 * height * margin / scale[1], height))
        columns = math.ceil(min(0.5 * width * margin / scale[0], width))
        padded = np.pad(aperture.weights, ((rows, rows), (columns, columns)))
        texel = 2.0 * scale[::-1] / (height, width)
        from scipy import ndimage  # slow to import

        distance, nearest = ndimage.distance_transform_edt(padded == 0.0, sampling=texel, return_indices=True)
        near = padded[tuple(nearest)]
        grown = np.where(distance <= margin, near, 0.0)
        while grown.sum() > _MOST_LIGHT * padded.sum():
            margin /= 2.0
            grown = np.where(distance <= margin, near, 0.0)
        sides = scale * (1.0 + 2.0 * columns / width, 1.0 + 2.0 * rows / height)
        return Aperture(aperture.boundary, grown, (sides[0], sides[1])), float(grown.sum() / padded.sum())
    inner = 1.0
    if len(aperture.boundary):
        halfway = (aperture.boundary + np.roll(aperture.boundary, -1, axis=0)) / 2.0
        inner = float(np.hypot(*halfway.T).min())
    factor = min(1.0 + margin / (inner * scale.min()), math.sqrt(_MOST_LIGHT))
    light = factor * factor
    if math.isfinite(aperture.deviation):
        double = 2.0 * aperture.deviation**2
        light = math.expm1(-factor * factor / double) / math.expm1(-1.0 / double)
    grown = scale * factor
    return Aperture(aperture.boundary, aperture.weights, (grown[0], grown[1]), aperture.deviation / factor), light


def is_inside(aperture: Aperture, points: Float) -> NDArray[np.bool_]:
    """Whether points (N, 2) lie in the aperture, an image's on a clear texel: (N,) bool."""
    if aperture.is_image:
        return aperture.transmission(points) > 0.0
    plain = points / np.asarray(aperture.scale)
    return np.hypot(plain[:, 0], plain[:, 1]) <= _rim(aperture.boundary, plain)


def mirrored(aperture: Aperture, points: Float) -> Float:
    """Points (N, 2) with those outside an aperture that is no image mirrored at its rim, on the line to its centre."""
    scale = np.asarray(aperture.scale)
    plain = points / scale
    reach = np.hypot(plain[:, 0], plain[:, 1])
    rim = _rim(aperture.boundary, plain)
    factor = np.where(reach > rim, np.maximum(2.0 * rim - reach, 0.0) / np.where(reach > 0.0, reach, 1.0), 1.0)
    return plain * factor[:, None] * scale


def middle(aperture: Aperture) -> Float:
    """The point (2,) of the aperture that is nearest to the mean of its light."""
    mean = moments(aperture).mean
    if is_inside(aperture, mean[None])[0]:
        return mean
    height, width = aperture.weights.shape
    scale = np.asarray(aperture.scale)
    row, column = np.nonzero(aperture.weights)
    texel = np.stack([column / width * 2.0 - 1.0, 1.0 - (row + 1) / height * 2.0], axis=1) * scale  # lower left corners
    size = 2.0 * scale / (width, height)
    place = np.clip(mean, texel + _INSET * size, texel + (1.0 - _INSET) * size)
    return place[((place - mean) ** 2).sum(axis=1).argmin()]


def _rim(boundary: Float, points: Float) -> Float:
    """Distance (N,) from the centre to the rim in the directions of points (N, 2); no boundary: the unit circle."""
    if len(boundary) == 0:
        return np.ones(len(points))
    corner_angle = np.unwrap(np.arctan2(boundary[:, 1], boundary[:, 0]))
    turn = (np.arctan2(points[:, 1], points[:, 0]) - corner_angle[0]) % (2.0 * np.pi)
    k = np.searchsorted(corner_angle - corner_angle[0], turn, side="right") - 1
    a, b = boundary[k], boundary[(k + 1) % len(boundary)]
    x, y = np.cos(turn + corner_angle[0]), np.sin(turn + corner_angle[0])
    across = x * (b[:, 1] - a[:, 1]) - y * (b[:, 0] - a[:, 0])
    return (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / across
