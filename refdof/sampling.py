"""Lens samples: point sets on the opening, made only from (count, pattern, seed).

========  ===========================================================================================
sobol     first points of a scrambled Sobol' net of the next power of two [1]
halton    Halton points in bases 2 and 3, digits permuted at random [2]
vogel     golden-angle spiral, rotated at random [3]
poisson   darts that keep a distance of 0.7 times the largest possible one [4]
jittered  one random point in each of `count` cells of equal area
random    independent points
========  ===========================================================================================

Every pattern is a set of points of the unit square; the aperture maps it to the opening, keeping areas.

References
----------
.. [1] Matoušek (1998), On the L2-Discrepancy for Anchored Boxes (linear scrambling, as SciPy has it).
.. [2] Owen (2017), A Randomized Halton Algorithm in R.
.. [3] Vogel (1979), A Better Way to Construct the Sunflower Head, Mathematical Biosciences 44.
.. [4] Lagae & Dutré (2008), A Comparison of Methods for Generating Poisson Disk Distributions.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree
from scipy.stats import qmc

from refdof._check import Float, InputError, as_choice, as_instance, as_integer
from refdof.aperture import Aperture

__all__ = ["PATTERNS", "lens_samples"]

_MAX_COUNT = 1 << 20
_RELATIVE_RADIUS = 0.7  # [4]: of the largest distance that `count` points on the disc can keep
_RIM = 2.0  # distances by which darts may miss the lens
_LEAST_DARTS = 64  # per volley; otherwise as many as points are wanted
_IDLE_VOLLEYS = 100  # that may add nothing before the distance shrinks
_SHRINK = 0.999


def lens_samples(
    count: int, pattern: str = "sobol", seed: int = 0, aperture: Aperture | None = None
) -> tuple[Float, Float]:
    """Area-uniform points on the opening of a lens.

    Parameters
    ----------
    count : int
        1 .. 2^20; exactly so many points come back.
    pattern : str
        One of `PATTERNS`.
    seed : int
        >= 0; the same seed gives the same points.
    aperture : Aperture
        A full disc if left out.

    Returns
    -------
    points : (count, 2) float64
        On the unit lens disc, x right, y up.
    weights : (count,) float64
        Mean 1; all ones unless the aperture is an image.

    Raises
    ------
    InputError
        If an argument is out of range, or if no point meets a texel of an image that lets light through.
    """
    count = as_integer("count", count, minimum=1, maximum=_MAX_COUNT)
    make = _SQUARES[as_choice("pattern", pattern, PATTERNS)]
    rng = np.random.default_rng(as_integer("seed", seed, minimum=0))
    aperture = Aperture.disc() if aperture is None else as_instance("aperture", aperture, Aperture)
    points = aperture.from_square(make(count, rng))
    weights = aperture.transmission(points)
    if not weights.sum() > 0.0:
        raise InputError(f"count: got {count}, and no sample meets the opening; allowed are more samples")
    return points, weights / weights.mean()


def _sobol(count: int, rng: np.random.Generator) -> Float:
    """A net of 2^m points has no gaps; its first `count` are the best that other counts can have."""
    return qmc.Sobol(2, seed=rng).random_base2(max(count - 1, 0).bit_length())[:count]


def _halton(count: int, rng: np.random.Generator) -> Float:
    return qmc.Halton(2, seed=rng).random(count)


def _vogel(count: int, rng: np.random.Generator) -> Float:
    """Point k lies at radius sqrt((k + 1/2) / count) and k golden angles, [3]."""
    k = np.arange(count)
    golden = (3.0 - math.sqrt(5.0)) / 2.0  # golden angle [turns]
    return _square_from_polar(np.sqrt((k + 0.5) / count), (k * golden + rng.random()) % 1.0)


def _poisson(count: int, rng: np.random.Generator) -> Float:
    """Dart throwing; where it gets stuck the distance shrinks, so that it always ends.

    Darts fall on a wider disc, and those on the lens are counted: darts on the lens alone would crowd at its rim, where
    they have fewer neighbours.
    """
    disc = Aperture.disc()
    radius = _RELATIVE_RADIUS * math.sqrt(2.0 * math.pi / (math.sqrt(3.0) * count))  # [4], Eq. (5)
    wider = 1.0 + _RIM * radius
    points = np.empty((0, 2))
    idle = 0
    while True:
        inside = points[np.hypot(points[:, 0], points[:, 1]) <= 1.0]
        if len(inside) >= count:
            break
        landed = wider * disc.from_square(rng.random((max(count, _LEAST_DARTS), 2)))
        if len(points):  # most darts fall too near to a point of an earlier volley
            landed = landed[cKDTree(points).query(landed)[0] >= radius]
        kept: list[int] = []
        for i, point in enumerate(landed):  # of one volley, the earlier dart wins
            offset = landed[kept] - point
            if not kept or (offset * offset).sum(axis=1).min() >= radius * radius:
                kept.append(i)
        points = np.concatenate([points, landed[kept]])
        idle = 0 if kept else idle + 1
        if idle == _IDLE_VOLLEYS:  # full, and too few on the lens: start again
            points, idle, radius = points[:0], 0, radius * _SHRINK
    x, y = inside[:count].T
    return _square_from_polar(np.hypot(x, y), np.arctan2(y, x) / (2.0 * np.pi) % 1.0)


def _jittered(count: int, rng: np.random.Generator) -> Float:
    """Rows of equal cells; a row's height is in proportion to its number of cells, so all areas agree."""
    rows = round(math.sqrt(count))
    columns = np.full(rows, count // rows)
    columns[: count % rows] += 1  # the first rows take what is left over
    row = np.repeat(np.arange(rows), columns)
    first = np.concatenate([[0], np.cumsum(columns)])
    column = np.arange(count) - first[row]
    jitter = rng.random((count, 2))
    x = (column + jitter[:, 0]) / columns[row]
    y = (first[row] + columns[row] * jitter[:, 1]) / count
    return np.stack([x, y], axis=1)


def _random(count: int, rng: np.random.Generator) -> Float:
    return rng.random((count, 2))


_SQUARES: dict[str, Callable[[int, np.random.Generator], Float]] = {
    "sobol": _sobol,
    "halton": _halton,
    "vogel": _vogel,
    "poisson": _poisson,
    "jittered": _jittered,
    "random": _random,
}
PATTERNS = tuple(_SQUARES)


def _square_from_polar(radius: Float, turn: Float) -> Float:
    """Points of the unit square that the concentric map takes to (radius, turn); turn 0 is +x, 1/4 is +y.

    A circle comes from a square of the same half-width, and angles are linear along each of its sides.
    """
    quarter = np.floor(turn * 4.0 + 0.5)  # 0: right side, 1: top, 2: left, 3: bottom
    along = radius * (turn * 4.0 - quarter) * 2.0  # counter-clockwise from the side's middle
    right, top, left = (quarter % 4 == k for k in range(3))
    a = np.select([right, top, left], [radius, -along, -radius], along)
    b = np.select([right, top, left], [along, radius, -along], -radius)
    return np.clip(np.stack([a + 1.0, b + 1.0], axis=1) / 2.0, 0.0, 1.0)
