"""Lens point sets: which lens points each pixel's rays pass, one set for all pixels or a set of its own for each.

======  ===============================================================================================
none    the same points at every pixel: too few of them show as ghost edges
noise   every pixel moves each point by a pair of numbers out of the four of its texel in a noise texture [1]
halton  every pixel takes `count` points in a row, from its own start, out of 2 `count` Halton points [1]
======  ===============================================================================================

The texture of noise and starts repeats every 64 pixels. With noise, the 16 ordered pairs of a texel's four numbers
serve 1/16 of the points each, and a point moves by up to half the mean distance to its nearest neighbour along x and
along y; [1] gives neither. A single point goes anywhere on the lens. A point that leaves the aperture is mirrored at
its rim, and one that comes to a darker texel of an image may stay where it was.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.5.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index, as_choice, as_instance, as_integer
from refdof.optics.aperture import Aperture
from refdof.optics.lens_samples import PATTERNS, lens_samples
from refdof.optics.lens_shape import mirrored

__all__ = ["JITTERS", "LensPointSets", "lens_point_sets", "mean_nearest_distance"]

JITTERS = ("none", "noise", "halton")
_TILE_PX = 64
_PAIRS = 16
_LARGEST_COUNT = 4096  # a set for every pixel of the tile then takes 384 MiB


class LensPointSets(NamedTuple):
    """K sets of N lens points. Pixel (x, y) uses set[y % side, x % side].

    points (K, N, 2) float64, on the unit lens disc, x right, y up; weights (K, N) float64, mean 1 in each set, and here
    all ones; set (side, side) int32.
    """

    points: Float
    weights: Float
    set: Index


def lens_point_sets(
    count: int, aperture: Aperture, jitter: str = "noise", pattern: str = "poisson", seed: int = 0
) -> LensPointSets:
    """Lens points for every pixel.

    Parameters
    ----------
    count : int
        Points per pixel, 1 .. 4096.
    aperture : Aperture
        Points are as dense as its light.
    jitter : one of `JITTERS`
    pattern : str
        One of `refdof.optics.lens_samples.PATTERNS`; with "halton" jitter always Halton.
    seed : int
        >= 0.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    count = as_integer("count", count, minimum=1, maximum=_LARGEST_COUNT)
    as_instance("aperture", aperture, Aperture)
    jitter = as_choice("jitter", jitter, JITTERS)
    as_choice("pattern", pattern, PATTERNS)
    seed = as_integer("seed", seed, minimum=0)
    if jitter == "none":
        points, weights = lens_samples(count, pattern, seed, aperture)
        return LensPointSets(points[None], weights[None], np.zeros((1, 1), dtype=np.int32))
    random = np.random.default_rng([seed, 1])
    if jitter == "halton":
        points, weights = lens_samples(2 * count, "halton", seed, aperture)
        window = (np.arange(2 * count)[:, None] + np.arange(count)) % (2 * count)
        chosen = random.integers(0, 2 * count, (_TILE_PX, _TILE_PX), dtype=np.int32)
        return LensPointSets(points[window], weights[window], chosen)
    points, _ = lens_samples(count, pattern, seed, aperture)
    noise = random.random((_TILE_PX * _TILE_PX, 4))
    pair = np.arange(count) * _PAIRS // count
    shift = np.stack([noise[:, pair % 4], noise[:, pair // 4]], axis=-1) * 2.0 - 1.0
    if count == 1:  # no neighbour: anywhere on the lens
        moved = aperture.from_square(noise[:, :2])
    else:
        moved = _moved(aperture, points, 0.5 * mean_nearest_distance(points) * shift, random).reshape(-1, 2)
    chosen = np.arange(_TILE_PX * _TILE_PX, dtype=np.int32).reshape(_TILE_PX, _TILE_PX)
    return LensPointSets(moved.reshape(-1, count, 2), np.ones((len(noise), count)), chosen)


def mean_nearest_distance(points: Float) -> float:
    """Mean distance from a point (N, 2) to its nearest neighbour; 2, the lens's diameter, for a single point."""
    if len(points) == 1:
        return 2.0
    from scipy.spatial import cKDTree  # slow to import

    return float(cKDTree(points).query(points, k=2)[0][:, 1].mean())


def _moved(aperture: Aperture, points: Float, shift: Float, random: np.random.Generator) -> Float:
    """Points (N, 2) moved by shift (K, N, 2), and still as dense as the light: (K, N, 2).

    On an image, a move to a darker texel is taken with the odds of the transmissions there and here, else the point
    stays (Metropolis); elsewhere a point that leaves the aperture is mirrored at its rim.
    """
    moved = points + shift
    flat = moved.reshape(-1, 2)
    if not aperture.is_image:
        return mirrored(aperture, flat).reshape(moved.shape)
    odds = aperture.transmission(flat).reshape(moved.shape[:2]) / aperture.transmission(points)
    return np.where((random.random(odds.shape) < odds)[..., None], moved, points)
