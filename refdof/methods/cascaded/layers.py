"""Depth layers of `cascaded`: how far each is blurred, and the depths between them.

A layer n steps from the one in focus is blurred n times, by 1, 2, .. n steps of `sigma_step`. Gaussians add their
variances, so in all by sigma_n = sigma_step sqrt(n (n + 1) (2 n + 1) / 6) [px], the closed form of Eq. (15) with (14).
A disc of radius r has the standard deviation r / 2 along each axis, which is Eq. (10): d = 2 r = 4 sigma.

Depth and circle of confusion: with coc = P E (1 / focus - 1 / depth), a signed **radius** in pixels, both solutions of
Eqs. (6) and (7) are one expression, and the focal length, the f-number and the size of the sensor drop out.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float

__all__ = ["Layering", "cluster_layers", "deviation", "filter_layers", "inverse_coc", "without_foremost"]

_BINS = 4096  # of the histogram that k-means runs on
_ROUNDS = 100
_ROUNDING = 1e-6  # of a circle: one this little beyond an anchor makes no further layer


class Layering(NamedTuple):
    """K layers, front to back.

    bounds (K + 1,): anchors z_(-1) .. z_(K-1) [scene units]; deviation (K,): blur of each layer [px]; step (K,): blur
    between a layer and its neighbour towards focus [px]; focus: the layer in focus, -1 if there is none.
    """

    bounds: Float
    deviation: Float
    step: Float
    focus: int


def deviation(n: int, sigma_step: float = 1.0) -> float:
    """Standard deviation [px] after n blurs: Eqs. (14), (15)."""
    return sigma_step * math.sqrt(n * (n + 1) * (2 * n + 1) / 6.0)


def inverse_coc(coc: Float, scale: float, focus: float) -> Float:
    """Depth [scene units] at which the circle of confusion is `coc` [px], signed radius: Eqs. (5) - (7).

    `scale` is P E [px scene units]. Circles as large as that of infinity, or larger, are at inf: Eq. (8).
    """
    with np.errstate(divide="ignore", over="ignore"):
        nearness = 1.0 / focus - np.asarray(coc, dtype=np.float64) / scale
        return np.where(nearness > 0.0, 1.0 / np.where(nearness > 0.0, nearness, 1.0), np.inf)


def filter_layers(
    nearest: float, farthest: float, scale: float, focus: float, sigma_step: float, largest: float
) -> Layering:
    """Layers as the filter sizes place them, as many as circles of confusion from `nearest` to `farthest` need [px].

    A front layer is added until the core of the foremost one, up to the anchor that would follow, holds `nearest`; the
    same behind. `largest` [px] bounds the blur: circles beyond it are blurred as that.
    """
    front = _steps_to(-nearest, sigma_step, largest)
    back = _steps_to(farthest, sigma_step, largest)
    between = range(-front - 1, back + 1)  # the anchor z_k lies between step n and n + 1
    coc = np.array([_anchor(n, sigma_step) for n in between])
    bounds = inverse_coc(coc, scale, focus) if scale > 0.0 else np.array([0.0, np.inf])
    return _with_steps(bounds, np.array([deviation(abs(n), sigma_step) for n in range(-front, back + 1)]), front)


def cluster_layers(coc: Float, count: int, scale: float, focus: float, sigma_step: float) -> Layering:
    """Layers where the surfaces are: k-means over circles of confusion `coc` (N,) [px], `count` >= 1 centres.

    One centre stays at 0, which is what is in focus. Centres start spread evenly between the extremes and 0; those that
    are left without a surface are dropped, and those that end nearer to their neighbour than a blur can tell.
    """
    low, high = min(float(coc.min()), 0.0), max(float(coc.max()), 0.0)
    if count == 1 or not high > low:
        return filter_layers(0.0, 0.0, scale, focus, sigma_step, 0.0)
    bins = np.minimum(((coc - low) / (high - low) * _BINS).astype(np.int64), _BINS - 1)
    mass = np.bincount(bins, minlength=_BINS).astype(np.float64)
    place = low + (np.arange(_BINS) + 0.5) * (high - low) / _BINS
    least, most = int(low < 0.0), count - 1 - int(high > 0.0 and count > 2)
    front = min(max(round((count - 1) * -low / (high - low)), least), most)
    center = np.concatenate([np.linspace(low, 0.0, front + 1), np.linspace(0.0, high, count - front)[1:]])
    for _ in range(_ROUNDS):
        owner = np.searchsorted((center[1:] + center[:-1]) / 2.0, place)
        held = np.bincount(owner, mass, len(center))
        moved = np.bincount(owner, mass * place, len(center)) / np.where(held > 0.0, held, 1.0)
        moved[center == 0.0] = 0.0
        moved = moved[(held > 0.0) | (center == 0.0)]
        if np.array_equal(moved, center):
            break
        center = moved
    center = _apart(center, sigma_step)
    if len(center) == 1:
        return filter_layers(0.0, 0.0, scale, focus, sigma_step, 0.0)
    middle = (center[1:] + center[:-1]) / 2.0
    ends = np.concatenate([[2.0 * center[0] - middle[0]], middle, [2.0 * center[-1] - middle[-1]]])
    return _with_steps(inverse_coc(ends, scale, focus), np.abs(center) / 2.0, int(np.flatnonzero(center == 0.0)[0]))


def without_foremost(layering: Layering) -> Layering:
    """What z_0 = -inf, as printed, leaves: layer 0 has an empty core, and layer 1 holds what lies in front of z_1."""
    if len(layering.deviation) == 1:
        return layering
    return Layering(layering.bounds[1:], layering.deviation[1:], layering.step[1:], layering.focus - 1)


def _anchor(n: int, sigma_step: float) -> float:
    """Circle of confusion [px] half-way between the layers at steps n and n + 1 from focus: Eq. (9)."""
    inner, outer = deviation(abs(n), sigma_step), deviation(abs(n + 1), sigma_step)
    return math.copysign(inner + outer, n + 0.5)  # a radius is twice a deviation: (2 inner + 2 outer) / 2


def _steps_to(coc: float, sigma_step: float, largest: float) -> int:
    """The smallest n whose outer anchor is not below the circle `coc` [px], but for roundings."""
    n, reach = 0, min(coc, 2.0 * largest) * (1.0 - _ROUNDING)
    while _anchor(n, sigma_step) < reach:
        n += 1
    return n


def _apart(center: Float, sigma_step: float) -> Float:
    """Centres without those less than sigma_step / 2 from the next one towards 0 [px]: too little to blur by."""
    zero = int(np.flatnonzero(center == 0.0)[0])
    kept = [0.0]
    for side in (center[zero + 1 :], center[:zero][::-1]):
        last = 0.0
        for c in side:
            if math.sqrt(c * c - last * last) / 2.0 >= sigma_step / 2.0:
                kept.append(c)
                last = c
    return np.sort(kept)


def _with_steps(bounds: Float, deviations: Float, focus: int) -> Layering:
    """Layers with their steps: sigma_k^2 = step_k^2 + the variance of the neighbour towards focus, Eq. (15)."""
    finite = np.minimum(bounds[:-1], np.finfo(np.float64).max)  # a rounding away from infinity
    bounds = np.maximum.accumulate(np.concatenate([finite, bounds[-1:]]))
    inner = np.concatenate([deviations[1 : focus + 1], deviations[focus : focus + 1], deviations[focus:-1]])
    return Layering(bounds, deviations, np.sqrt(np.maximum(deviations**2 - inner**2, 0.0)), focus)
