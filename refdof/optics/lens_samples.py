"""Lens samples: point sets on the aperture, made only from (count, pattern, seed).

========  ===========================================================================================
sobol     first points of a scrambled Sobol' net of the next power of two [1]
halton    Halton points in bases 2 and 3, digits permuted at random [2]
vogel     golden-angle spiral, rotated at random [3]
poisson   darts that keep a distance, with the mean and covariance of the aperture, `refdof.optics.poisson_disc`
jittered  one random point in each of `count` cells of equal area
random    independent points
========  ===========================================================================================

Poisson-disc points are made on the aperture itself. Every other pattern is a set of points of the unit square,
which the aperture maps to its shape, keeping areas in proportion to the light.

References
----------
.. [1] Matoušek (1998), On the L2-Discrepancy for Anchored Boxes (linear scrambling, as SciPy has it).
.. [2] Owen (2017), A Randomized Halton Algorithm in R.
.. [3] Vogel (1979), A Better Way to Construct the Sunflower Head, Mathematical Biosciences 44.
"""

import math
from collections.abc import Callable

import numpy as np

from refdof._check import Float, as_choice, as_instance, as_integer
from refdof.optics.aperture import Aperture
from refdof.optics.poisson_disc import poisson_disc

__all__ = ["PATTERNS", "lens_samples", "square_points"]

_MAX_COUNT = 1 << 20


def lens_samples(
    count: int, pattern: str = "sobol", seed: int = 0, aperture: Aperture | None = None
) -> tuple[Float, Float]:
    """Points on the aperture of a lens, as dense as its light.

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
        On the unit lens disc, x right, y up; of an image aperture, corners of texels on its rim may lie outside.
    weights : (count,) float64
        All ones: points are as dense as the light.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    count = as_integer("count", count, minimum=1, maximum=_MAX_COUNT)
    as_choice("pattern", pattern, PATTERNS)
    rng = np.random.default_rng(as_integer("seed", seed, minimum=0))
    aperture = Aperture.disc() if aperture is None else as_instance("aperture", aperture, Aperture)
    if pattern == "poisson":
        points = poisson_disc(aperture, count, rng)
    else:
        points = aperture.from_square(_SQUARES[pattern](count, rng))
    return points, np.ones(count)


def square_points(points: Float) -> Float:
    """Points (..., 2) of the unit square that the area-preserving map takes to points of the unit disc."""
    turn = np.arctan2(points[..., 1], points[..., 0]) / (2.0 * np.pi) % 1.0
    flat = _square_from_polar(np.hypot(points[..., 0], points[..., 1]).ravel(), turn.ravel())
    return flat.reshape(points.shape)


def _sobol(count: int, rng: np.random.Generator) -> Float:
    """A net of 2^m points has no gaps; its first `count` are the best that other counts can have."""
    from scipy.stats import qmc  # slow to import

    return qmc.Sobol(2, seed=rng).random_base2(max(count - 1, 0).bit_length())[:count]


def _halton(count: int, rng: np.random.Generator) -> Float:
    from scipy.stats import qmc  # slow to import

    return qmc.Halton(2, seed=rng).random(count)


def _vogel(count: int, rng: np.random.Generator) -> Float:
    """Point k lies at radius sqrt((k + 1/2) / count) and k golden angles, [3]."""
    k = np.arange(count)
    golden = (3.0 - math.sqrt(5.0)) / 2.0  # golden angle [turns]
    return _square_from_polar(np.sqrt((k + 0.5) / count), (k * golden + rng.random()) % 1.0)


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
    "jittered": _jittered,
    "random": _random,
}
PATTERNS = ("sobol", "halton", "vogel", "poisson", "jittered", "random")


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
