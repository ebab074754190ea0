"""Lens blur: the rays of a pixel, what each sees by itself, and what all see of each layer.

1. Peel layers and choose lens points as the method does   `refdof.methods.lensblur.method.prepare`
2. Trace one ray at a time: its colour, or a miss          `_ray`
3. Trace it through layers whose colours are their places  `_ray`
4. Colour one layer at a time: its part in the pixel       `_layers`
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import Explanation, Part
from refdof.explain.rays import RAY_COLUMNS, layer_table, one_point, points_of
from refdof.methods.lensblur.method import Prepared, prepare, trace
from refdof.view import View

__all__ = ["explain"]

_WHAT = (
    "rays: each colour is the method's picture through that lens point alone; layer -1: a miss; none: the background"
)


def explain(view: View, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every ray."""
    x, y = pixel
    seen = view.pinhole()
    about = (pixel, view.camera.size)
    if view.lens.radius == 0.0:
        value = seen.color[y, x].astype(np.float64)
        row = [0, 0.0, 0.0, 0, x + 0.5, y + 0.5, seen.depth[y, x], 0.0, *value, 1.0]
        what = "the pinhole's ray: the lens is a point"
        return Explanation("lensblur", "image", *about, value, what, RAY_COLUMNS, np.array([row]), picture=seen.color)
    scene = prepare(view, params)
    image = trace(view, scene).image
    points, weights = points_of(scene.pattern, pixel)
    rays = [_ray(view, scene, point, pixel) for point in points]
    hits, missed = np.array([ray[:-1] for ray in rays]), np.array([ray[-1] for ray in rays], dtype=bool)
    counted = weights.astype(np.float64)
    if params.misses == "renormalise" and not missed[weights > 0.0].all():
        counted = np.where(missed, 0.0, counted)
    rows = np.column_stack([np.arange(len(points)), points, hits, counted / counted.sum()])
    notes = (
        f"{len(scene.values)} layers; {int(missed.sum())} of {len(points)} rays are missed, which "
        + {"renormalise": "do not count", "black": "are black", "pinhole": "see what the pinhole sees"}[params.misses],
    )
    of_layers = not params.deferred and params.misses != "pinhole" and not missed.all()
    parts = (_layers(view, scene, pixel),) if of_layers else ()
    value = image[y, x].astype(np.float64)
    return Explanation(
        "lensblur", "image", *about, value, _WHAT, RAY_COLUMNS, rows, notes=notes, parts=parts, picture=seen.color
    )


def _ray(view: View, scene: Prepared, point: Float, pixel: tuple[int, int]) -> tuple[float, ...]:
    """Layer, x, y, depth, circle and colour of what one ray meets, and whether it is missed."""
    x, y = pixel
    alone = scene._replace(pattern=one_point(point))
    traced = trace(view, alone)
    color, missed = traced.image[y, x].tolist(), bool(traced.missed[y, x] > 0.5)
    if missed:
        return (-1.0, *[np.nan] * 4, *color, True)
    count, height, width = scene.values.shape[:3]
    rows, columns = np.indices((height, width), dtype=np.float32) + np.float32(0.5)
    places = np.stack([columns, rows, np.ones_like(rows)], axis=-1)
    there = trace(view, _colored(alone, np.broadcast_to(places, (count, height, width, 3)))).image[y, x]
    if there[2] < 0.5:
        return (*[np.nan] * 5, *color, False)
    nearness = np.where(np.isfinite(scene.layers.depth), 1.0 / scene.layers.depth, 0.0)
    number = np.broadcast_to(np.arange(count)[:, None, None], nearness.shape)
    met = trace(view, _colored(alone, np.stack([number, nearness, nearness], axis=-1))).image[y, x].astype(np.float64)
    with np.errstate(divide="ignore"):
        depth = np.divide(1.0, met[1])
    return (met[0], there[0], there[1], depth, float(view.lens.coc_px(depth, view.camera)), *color, False)


def _colored(scene: Prepared, values: Float) -> Prepared:
    """The same layers in other colours, before black."""
    light = scene.surfaces.light.copy()
    light[5] = 0.0
    values = np.ascontiguousarray(values, dtype=np.float32)
    return scene._replace(values=values, surfaces=scene.surfaces._replace(light=light))


def _layers(view: View, scene: Prepared, pixel: tuple[int, int]) -> Part:
    """What each layer adds."""
    x, y = pixel

    def seen(k: int) -> Float:
        values = np.zeros_like(scene.values)
        values[k] = scene.values[k]
        return trace(view, _colored(scene, values)).image[y, x]

    def shares(some: range) -> Float:
        values = np.zeros_like(scene.values)
        for channel, k in enumerate(some):
            values[k, ..., channel] = 1.0
        return trace(view, _colored(scene, values)).image[y, x]

    return layer_table(len(scene.values), seen, shares)
