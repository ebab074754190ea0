"""Poisson-disc points on an aperture: darts that keep their distance, moved until their moments are the aperture's.

1. Throw darts on a wider aperture, those on the aperture count                 `_darts`
2. Shift and shear the points to the aperture's mean and covariance            `_with_moments`
3. Push apart what came too near, pull in what came outside; go on with 2      `_repaired`

A dart keeps `RELATIVE_DISTANCE` times the distance of the densest packing of as many points at its density, sqrt(2 /
(sqrt(3) n)) with n points per area, from all others; of two darts the smaller distance counts. Where the aperture has
no room for so many, the distance shrinks until it has. Mean and covariance are the aperture's to rounding, a single
point lies in the middle, and two points have the trace of the covariance; where the aperture has no room for that, as
images of few texels have none for few points, they are as near as the steps came.

References
----------
.. [1] Lagae & Dutré (2008), A Comparison of Methods for Generating Poisson Disk Distributions.
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, Index
from refdof.optics.aperture import Aperture
from refdof.optics.lens_shape import Moments, density, is_inside, middle, mirrored, moments, widened

__all__ = ["RELATIVE_DISTANCE", "poisson_disc"]

RELATIVE_DISTANCE = 0.7  # [1]: of the largest that `count` points can keep
_RIM = 2.0  # distances by which darts may miss the aperture: on the aperture alone they would crowd at its rim
_WIDEST_RIM = 0.5  # lens radii
_LEAST_DARTS, _MOST_DARTS = 64, 1 << 16  # per volley; otherwise as many as points are wanted
_IDLE_VOLLEYS = 30  # that may add nothing: then the aperture is full
_TRIES = 4  # to fill it at one distance, before that shrinks
_SHRINK = 0.98
_THROWS = 4  # on an image, whose parts points cannot change: the set nearest to its moments is taken
_ROUNDS = 100  # of moving
_SLACK = 1.01  # of the distance, to which points are pushed apart, so that moving ends
_CLOSE = 1e-14  # lens radii (squared): moments as good as equal


def poisson_disc(aperture: Aperture, count: int, rng: np.random.Generator) -> Float:
    """Points (count, 2) on `aperture`, in units of the lens radius."""
    if count == 1:
        return middle(aperture)[None]
    goal = moments(aperture)
    throws = [_darts(aperture, count, rng) for _ in range(_THROWS if aperture.is_image else 1)]
    points, share = min(throws, key=lambda throw: _miss(goal, throw[0]))
    best, least = points, _miss(goal, points)
    for _ in range(_ROUNDS):
        if least < _CLOSE:
            break
        moved = _with_moments(goal, points)
        if not _is_kept(aperture, moved, share):
            moved = _repaired(aperture, moved, points, share)
        points, off = moved, _miss(goal, moved)
        if off < least and _is_kept(aperture, points, share):
            best, least = points, off
    if count == 2 and least >= _CLOSE:  # their line left a squeezed aperture on every try
        along = _along_the_longest_axis(goal)
        best = along if _is_kept(aperture, along, share) else best
    return best


def _along_the_longest_axis(goal: Moments) -> Float:
    """Two points with the mean and the covariance's trace of `goal`."""
    axis = np.linalg.eigh(goal.covariance)[1][:, 1] * math.sqrt(np.trace(goal.covariance))
    return np.stack([goal.mean + axis, goal.mean - axis])


def _darts(aperture: Aperture, count: int, rng: np.random.Generator) -> tuple[Float, float]:
    """Points (count, 2), and the share of the largest distance that they keep: it shrinks, so that this always ends."""
    from scipy.spatial import cKDTree  # slow to import

    share = RELATIVE_DISTANCE
    usual = _reach(aperture, aperture.from_square(rng.random((_LEAST_DARTS, 2))), share, count).mean()
    wide, light = widened(aperture, min(_RIM * float(usual), _WIDEST_RIM))
    volley = min(max(math.ceil(count * light), _LEAST_DARTS), _MOST_DARTS)
    points, idle, tries = np.empty((0, 2)), 0, 1
    while True:
        inside = points[is_inside(aperture, points)]
        if len(inside) >= count:
            return inside[:count], share
        landed = wide.from_square(rng.random((volley, 2)))
        reach = _reach(wide, landed, share, count * light)
        if len(points):  # most darts fall too near to a point of an earlier volley
            old = _reach(wide, points, share, count * light)
            tree = cKDTree(points)
            distance, nearest = tree.query(landed)
            free = distance >= np.minimum(reach, old[nearest])
            landed, reach = landed[free], reach[free]
            if aperture.is_image or math.isfinite(aperture.deviation):  # the nearest point may keep less than others
                dart, point = _within(tree, landed, reach)
                distance = np.hypot(*(landed[dart] - points[point]).T)
                free = np.bincount(dart, distance < np.minimum(reach[dart], old[point]), len(landed)) == 0
                landed, reach = landed[free], reach[free]
        kept = np.ones(len(landed), dtype=bool)
        for earlier, later in _near_pairs(landed, reach):  # of one volley, the earlier dart wins
            kept[later] &= not kept[earlier]
        points = np.concatenate([points, landed[kept]])
        idle = 0 if kept.any() else idle + 1
        if idle == _IDLE_VOLLEYS:  # full, and too few on the lens: start again
            points, idle, tries = points[:0], 0, tries + 1
            share *= _SHRINK if tries > _TRIES else 1.0


def _reach(aperture: Aperture, points: Float, share: float, count: float) -> Float:
    """Distance (N,) that each of `count` points keeps."""
    with np.errstate(divide="ignore"):  # the light of a Gaussian may be none in float64: inf
        return share * np.sqrt(2.0 / (math.sqrt(3.0) * count * density(aperture, points)))


def _within(tree: Any, points: Float, reach: Float) -> tuple[Index, Index]:
    """All (i, j) such that point j of the tree lies within reach (N,) of points[i]."""
    if len(points) == 0:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    lists = tree.query_ball_point(points, np.minimum(reach, 4.0), return_sorted=True)
    lengths = [len(found) for found in lists]
    return np.repeat(np.arange(len(points)), lengths), np.concatenate(lists).astype(np.int64)


def _near_pairs(points: Float, reach: Float) -> Index:
    """Pairs (M, 2) of points, i < j, nearer than the smaller of their reaches, in the order of j."""
    from scipy.spatial import cKDTree  # slow to import

    later, earlier = _within(cKDTree(points), points, reach)
    pair = np.stack([earlier, later], axis=1)[earlier < later]
    distance = np.hypot(*(points[pair[:, 0]] - points[pair[:, 1]]).T)
    return pair[distance < reach[pair].min(axis=1)]


def _is_kept(aperture: Aperture, points: Float, share: float) -> bool:
    """Whether all points lie in the aperture and keep their distance."""
    return bool(
        is_inside(aperture, points).all()
        and len(_near_pairs(points, _reach(aperture, points, share, len(points)))) == 0
    )


def _miss(goal: Moments, points: Float) -> float:
    """Largest difference of mean and covariance from the aperture's; of two points only the trace counts."""
    offset = points - points.mean(axis=0)
    off = offset.T @ offset / len(points) - goal.covariance
    if len(points) == 2:
        off = np.trace(off)
    return float(max(np.abs(points.mean(axis=0) - goal.mean).max(), np.abs(off).max()))


def _with_moments(goal: Moments, points: Float) -> Float:
    """Points moved by the least affine map that gives them the mean and the covariance of `goal`."""
    offset = points - points.mean(axis=0)
    spread = offset.T @ offset / len(points)
    if len(points) == 2 or np.linalg.det(spread) <= 1e-12 * np.trace(spread) ** 2:  # on a line
        return goal.mean + offset * math.sqrt(np.trace(goal.covariance) / max(np.trace(spread), 1e-300))
    root = _root(spread)
    inverse = np.linalg.inv(root)
    return goal.mean + offset @ (inverse @ _root(root @ goal.covariance @ root) @ inverse)


def _root(matrix: Float) -> Float:
    """Square root of a symmetric positive matrix (2, 2)."""
    size = math.sqrt(max(np.linalg.det(matrix), 0.0))
    return (matrix + size * np.eye(2)) / math.sqrt(np.trace(matrix) + 2.0 * size)


def _repaired(aperture: Aperture, moved: Float, before: Float, share: float) -> Float:
    """Push pairs apart that came too near, then mirror what left the aperture; in an image it stays where it was."""
    if aperture.is_image:
        moved = np.where(is_inside(aperture, moved)[:, None], moved, before)
    reach = _reach(aperture, moved, share, len(moved)) * _SLACK
    pair = _near_pairs(moved, reach)
    first, second = pair.T
    apart = moved[first] - moved[second]
    distance = np.maximum(np.hypot(*apart.T), 1e-300)
    push = apart * (0.5 * (reach[pair].min(axis=1) - distance) / distance)[:, None]
    moved = moved.copy()
    np.add.at(moved, first, push)
    np.subtract.at(moved, second, push)
    if aperture.is_image:
        return np.where(is_inside(aperture, moved)[:, None], moved, before)
    return mirrored(aperture, moved)
