"""Rays: what methods that average lens rays have in common: one row a ray, and one a layer in a further table."""

from collections.abc import Callable

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Part
from refdof.optics.pixel_samples import LensPointSets
from refdof.view import View

__all__ = ["RAY_COLUMNS", "layer_table", "one_point", "points_of"]

RAY_COLUMNS = ("ray", "lens_x", "lens_y", "layer", "x", "y", "depth", "coc", *COLOR, "weight")


def points_of(pattern: LensPointSets, pixel: tuple[int, int]) -> tuple[Float, Float]:
    """The lens points (N, 2) of a pixel and their weights (N,)."""
    x, y = pixel
    chosen = pattern.set[y % len(pattern.set), x % len(pattern.set)]
    return pattern.points[chosen], pattern.weights[chosen]


def one_point(point: Float) -> LensPointSets:
    """A pattern of a single lens point, for all pixels."""
    return LensPointSets(point.reshape(1, 1, 2), np.ones((1, 1)), np.zeros((1, 1), dtype=np.int32))


def depth_of(view: View, coc: Float) -> Float:
    """Depth [scene units] at signed circles of confusion [px]; NaN stays."""
    scale = view.camera.pixels_per_tangent * view.lens.radius
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / np.maximum(1.0 / view.lens.focus_distance - coc / scale, 0.0))


def layer_table(count: int, seen: Callable[[int], Float], shares: Callable[[range], Float]) -> Part:
    """What each layer adds to the pixel: layer k's colours alone, `seen(k)` (3,), and the shares of up to three."""
    rows = []
    for first in range(0, count, 3):
        some = range(first, min(first + 3, count))
        for k, share in zip(some, shares(some), strict=False):
            if share > 0.0:
                rows.append((k, share, *seen(k)))
    rest = 1.0 - sum(row[1] for row in rows)
    columns = ("layer", "share", *COLOR)
    title = f"layers, front to back: share of the pixel and light from it; the other {rest:.6g} is of no layer"
    return Part(title, columns, np.array(rows).reshape(-1, len(columns)))
