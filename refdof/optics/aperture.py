"""Apertures: their shape inside the unit lens disc, and area-uniform points on it.

The longest half-axis of every shape is the lens radius, so no point leaves the unit disc (save, for an image, the outer
corners of texels on its rim) and circles of confusion bound every blur. A picture's brightness is an average over the
aperture: it does not change with the shape. A Gaussian aperture lets less light through towards its rim; its points are
denser in the middle, and those of an image are as dense as its texels are clear, so that each has the same weight.
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, InputError, as_float, as_image, as_integer, as_number
from refdof._jit import kernel, prange
from refdof.optics.lens_maps import concentric_disc, fan_point, gaussian_stretch, image_point

__all__ = ["Aperture"]

_FIELDS = ("boundary", "weights", "scale", "deviation")
_LEAST_SCALE = 1e-6  # of an anamorphic squeeze: a slit, still wider than roundings
_MOST_SCALE = 4.0  # darts fall on apertures wider than the lens
_ARC_SEGMENTS = 64  # per curved blade: the inscribed chords lose 1.8e-4 of the area with three blades, less with more


@dataclass(frozen=True, eq=False)
class Aperture:
    """An aperture inside the unit disc. Make one with `disc`, `gaussian`, `polygon` or `image`.

    Attributes
    ----------
    boundary : (K, 2) float64
        Corners counter-clockwise, such that all K triangles (centre, corner k, corner k + 1) have the same area;
        empty for a full disc.
    weights : (h, w) float64
        Transmission over the square [-1, 1]^2, row 0 at the top; empty unless made from an image.
    scale : (x, y)
        Anamorphic squeeze, each in (0, 1] for apertures inside the lens disc; up to 4 is taken.
    deviation : float
        Standard deviation of a Gaussian aperture [lens radii]; inf: transmission is even.
    """

    boundary: Float
    weights: Float
    scale: tuple[float, float] = (1.0, 1.0)
    deviation: float = math.inf

    def __post_init__(self) -> None:
        boundary = as_float(
            "boundary", self.boundary, (None, 2), dtype=np.float64, minimum=-1.0 - 1e-9, maximum=1.0 + 1e-9
        )
        weights = as_float("weights", self.weights, (None, None), dtype=np.float64, minimum=0.0, maximum=1.0)
        if weights.size and not weights.any():
            raise InputError("weights: all are zero; at least one must be > 0")
        scale = as_float("scale", self.scale, (2,), dtype=np.float64, minimum=_LEAST_SCALE, maximum=_MOST_SCALE)
        deviation = as_number("deviation", self.deviation, above=0.0, finite=False)
        for name, value in zip(_FIELDS, (boundary, weights, tuple(scale.tolist()), deviation), strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def disc(cls, ratio: float = 1.0) -> "Aperture":
        """A full disc; `ratio` is width / height of the aperture (anamorphic lens)."""
        return cls(np.zeros((0, 2)), np.zeros((0, 0)), _squeeze(ratio))

    @classmethod
    def gaussian(cls, deviation: float = 0.5, ratio: float = 1.0) -> "Aperture":
        """A disc whose transmission is exp(-r^2 / (2 deviation^2)), cut at the lens radius (an apodised lens).

        Parameters
        ----------
        deviation : float
            [lens radii], 0.01 .. 100. 0.5 is the spread of an even disc: both have the variance 1/4 along each axis
            before the Gaussian is cut.
        ratio : float
            Width / height of the aperture.
        """
        deviation = as_number("deviation", deviation, minimum=0.01, maximum=100.0)
        return cls(np.zeros((0, 2)), np.zeros((0, 0)), _squeeze(ratio), deviation)

    @classmethod
    def polygon(cls, blades: int, rotation: float = 0.0, curvature: float = 0.0, ratio: float = 1.0) -> "Aperture":
        """A regular polygon whose corners lie on the lens circle.

        Parameters
        ----------
        blades : int
            Number of sides, 3 .. 64.
        rotation : float
            Counter-clockwise [degrees]; at 0 one corner points to the right.
        curvature : float
            0: straight blades; 1: the blades are arcs of the lens circle; between them, circular arcs
            through the corners whose height is in proportion.
        ratio : float
            Width / height of the aperture.
        """
        blades = as_integer("blades", blades, minimum=3, maximum=64)
        rotation = math.radians(as_number("rotation", rotation))
        curvature = as_number("curvature", curvature, minimum=0.0, maximum=1.0)
        corners = _blade(blades, curvature)
        turn = rotation + 2.0 * np.pi * np.arange(blades)[:, None] / blades
        x = np.cos(turn) * corners[:, 0] - np.sin(turn) * corners[:, 1]
        y = np.sin(turn) * corners[:, 0] + np.cos(turn) * corners[:, 1]
        boundary = np.stack([x.ravel(), y.ravel()], axis=1)
        return cls(boundary, np.zeros((0, 0)), _squeeze(ratio))

    @classmethod
    def image(cls, weights: Float, ratio: float = 1.0) -> "Aperture":
        """An image as transmission: (h, w), >= 0, over the square around the lens disc, row 0 at the top.

        The image is constant inside each texel. Texels whose centre lies outside the lens disc are opaque.
        """
        weights = as_image("weights", weights, (None, None), dtype=np.float64, minimum=0.0).copy()
        height, width = weights.shape
        x = (np.arange(width) + 0.5) / max(width, 1) * 2.0 - 1.0
        y = 1.0 - (np.arange(height) + 0.5) / max(height, 1) * 2.0
        weights[x[None, :] ** 2 + y[:, None] ** 2 > 1.0] = 0.0
        if not weights.sum() > 0.0:
            raise InputError("weights: all inside the lens disc are zero; at least one must be > 0")
        return cls(np.zeros((0, 2)), weights / weights.max(), _squeeze(ratio))

    @property
    def is_image(self) -> bool:
        """True if made from an image."""
        return self.weights.size > 0

    @property
    def reach(self) -> float:
        """Largest distance of a point of the aperture from the centre; above 1 only for texels on an image's rim."""
        if not self.is_image:
            return 1.0
        height, width = self.weights.shape
        row, column = np.nonzero(self.weights)
        x = np.maximum(abs(2.0 * column / width - 1.0), abs(2.0 * (column + 1) / width - 1.0)) * self.scale[0]
        y = np.maximum(abs(2.0 * row / height - 1.0), abs(2.0 * (row + 1) / height - 1.0)) * self.scale[1]
        return max(1.0, float(np.hypot(x, y).max()))

    def cumulated(self) -> tuple[Float, Float]:
        """Cumulated transmission of an image's rows (h + 1,) and of the texels in each (h, w + 1), from 0 to 1."""
        if not self.is_image:
            return np.zeros(0), np.zeros((0, 0))
        rows = np.concatenate([[0.0], np.cumsum(self.weights.sum(axis=1))])
        texels = np.concatenate([np.zeros((len(self.weights), 1)), np.cumsum(self.weights, axis=1)], axis=1)
        return rows / rows[-1], texels / np.maximum(texels[:, -1:], np.finfo(float).tiny)

    def from_square(self, square: Float) -> Float:
        """Map points of the unit square (N, 2) to the aperture (N, 2), keeping areas in proportion to the light."""
        square = as_float("square", square, (None, 2), dtype=np.float64, minimum=0.0)
        if square.size and square.max() > 1.0:
            raise InputError(f"square: largest value is {square.max():g}; allowed are values <= 1")
        return _aperture_points(square, self.boundary, *self.cumulated(), self.deviation) * np.asarray(self.scale)

    def transmission(self, points: Float) -> Float:
        """Transmission (N,) at lens points (N, 2): of an image 0 outside it; 1 everywhere for other apertures."""
        points = as_float("points", points, (None, 2), dtype=np.float64)
        if not self.is_image:
            return np.ones(len(points))
        height, width = self.weights.shape
        with np.errstate(over="ignore"):  # far outside
            x, y = (points / np.asarray(self.scale)).T
            column = np.clip((x + 1.0) / 2.0 * width, 0, width - 1).astype(np.int64)
            row = np.clip((1.0 - y) / 2.0 * height, 0, height - 1).astype(np.int64)
        return np.where(np.maximum(abs(x), abs(y)) <= 1.0, self.weights[row, column], 0.0)


@kernel
def _aperture_points(square, boundary, row_sums, texel_sums, deviation):
    """Points (N, 2) of the aperture before its squeeze."""
    points = np.empty_like(square)
    for k in prange(len(square)):
        u, v = square[k, 0], square[k, 1]
        if len(boundary) > 0:
            points[k, 0], points[k, 1] = fan_point(boundary, u, v)
        elif len(row_sums) > 0:
            points[k, 0], points[k, 1] = image_point(row_sums, texel_sums, u, v)
        else:
            x, y = concentric_disc(u, v)
            stretch = gaussian_stretch(x, y, deviation) if deviation < np.inf else 1.0
            points[k, 0], points[k, 1] = x * stretch, y * stretch
    return points


def _squeeze(ratio: float) -> tuple[float, float]:
    ratio = as_number("ratio", ratio, minimum=_LEAST_SCALE, maximum=1.0 / _LEAST_SCALE)
    return min(1.0, ratio), min(1.0, 1.0 / ratio)


def _blade(blades: int, curvature: float) -> Float:
    """Corners (S, 2) of the first blade, from angle 0 up to but without 2 pi / blades, at equal sector areas."""
    if curvature < 1e-12:  # an arc lower than this is straight to the last digits
        return np.array([[1.0, 0.0]])
    half = math.pi / blades
    sagitta = curvature * (1.0 - math.cos(half))  # height of the arc above the straight blade
    chord = math.sin(half)
    radius = (chord * chord + sagitta * sagitta) / (2.0 * sagitta)
    # Walk the arc in small steps, then cut it where the swept area is a multiple of the whole / S.
    opening = math.asin(min(1.0, chord / radius))
    swing = np.linspace(-opening, opening, 64 * _ARC_SEGMENTS + 1)
    top = math.cos(half) + sagitta  # of the arc, along the blade's middle
    # radius (1 - cos) as 2 radius sin^2 of the half: a flat arc's huge radius then cancels nothing.
    x, y = top - 2.0 * radius * np.sin(swing / 2.0) ** 2, radius * np.sin(swing)
    area = np.concatenate([[0.0], np.cumsum(x[:-1] * y[1:] - x[1:] * y[:-1])])
    cut = np.interp(np.linspace(0.0, area[-1], _ARC_SEGMENTS + 1)[:-1], area, swing)
    x, y = top - 2.0 * radius * np.sin(cut / 2.0) ** 2, radius * np.sin(cut)
    return np.stack([math.cos(half) * x - math.sin(half) * y, math.sin(half) * x + math.cos(half) * y], axis=1)
