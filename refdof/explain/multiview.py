"""Multiview: the rays of a pixel, or its cones: what each sees by itself, and what all see of each layer.

1. Prepare layers and lens points as the method does      `refdof.methods.multiview.method.prepare`
2. Send one ray at a time: its colour                      `_colors`
3. Tell what leaves the image, which does not count        `_stays`
4. Colour one layer at a time: its part in the pixel       `_layers`
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import Explanation, Part
from refdof.explain.rays import RAY_COLUMNS, depth_of, layer_table, one_point, points_of
from refdof.methods.multiview.cones import chain_of
from refdof.methods.multiview.method import Prepared, prepare, send_rays
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["explain"]

_LEFT = -2


def explain(view: View, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every ray."""
    recorder, (x, y) = StageRecorder(True), pixel
    scene = prepare(view, params, recorder)
    image = send_rays(view, scene)
    points, weights = points_of(scene.pattern, pixel)
    stages = {name: recorder.stages[name][y, x].astype(np.float64) for name in ("hit_layer", "hit_texel", "hit_coc")}
    stay = _stays(view, params, scene, points, pixel, stages["hit_layer"])
    counted = weights * stay
    if not counted.any():
        return _pinhole(view, image, pixel)
    layer = np.where(stages["hit_layer"] >= 0, stages["hit_layer"], np.nan)
    coc = np.where(stages["hit_layer"] >= 0, stages["hit_coc"], np.nan)
    there = np.array([x + 0.5, y + 0.5]) + coc[:, None] * points * [-1.0, 1.0]
    colors = _colors(view, scene, points, pixel)
    rows = np.column_stack(
        [np.arange(len(points)), points, layer, there, depth_of(view, coc), coc, colors, counted / counted.sum()]
    )
    kind = "rays" if scene.chain is None else f"cones, {scene.widening:.4g} |coc| wide; places are their middle's"
    notes = [f"{len(scene.layers.coc)} layers; layer: the first that a ray's middle meets; none: the background"]
    if (stages["hit_layer"] == _LEFT).any():
        notes.append("rays that leave the image weigh less, or nothing")
    parts: tuple[Part, ...] = ()
    if params.view_dependent:
        notes.append("surfaces are shaded along each ray: no table of layers")
    else:
        parts = (_layers(view, params, scene, pixel),)
    return Explanation(
        "multiview",
        "image",
        pixel,
        view.camera.size,
        image[y, x].astype(np.float64),
        f"{kind}: each colour is the method's picture through that lens point alone",
        RAY_COLUMNS,
        rows,
        notes=tuple(notes),
        parts=parts,
        picture=view.pinhole().color,
    )


def _colored(params: Any, scene: Prepared, surface: Float, background: Any) -> Prepared:
    """The same layers in other colours."""
    chain = scene.chain and chain_of(surface, scene.layers, scene.widening, params.wall_px)
    return scene._replace(surface=surface, chain=chain, background=background)


def _colors(view: View, scene: Prepared, points: Float, pixel: tuple[int, int]) -> Float:
    """What each ray sees: (N, 3)."""
    x, y = pixel
    return np.array([send_rays(view, scene._replace(pattern=one_point(point)))[y, x] for point in points])


def _stays(view: View, params: Any, scene: Prepared, points: Float, pixel: tuple[int, int], layer: Float) -> Float:
    """Which part of each ray counts: (N,), 1 but for rays that leave the image, where they are dropped.

    A cone may lose a part of itself. It is told by a second run with the pinhole's ray beside it, which never leaves:
    the method gives (t a + b) / (t + 1) for the part t of a cone that shows a beside one that shows b.
    """
    stay = np.where(layer == _LEFT, 0.0, 1.0)
    if not scene.search.discard or scene.chain is None:
        return stay
    count, height, width = scene.layers.coc.shape
    rows, columns = np.indices((height, width), dtype=np.float32)
    ramp = np.stack([columns / width, rows / height, np.ones_like(rows)], axis=-1)
    surface = np.stack([ramp * np.float32(k + 1) / np.float32(count) for k in range(count)])
    ramps = _colored(params, scene, surface, (-1.0, -1.0, -1.0))
    middle = np.zeros(2)
    (b,) = _colors(view, ramps, middle[None], pixel).astype(np.float64)
    x, y = pixel
    for n in np.flatnonzero(stay):
        a = _colors(view, ramps, points[n : n + 1], pixel)[0].astype(np.float64)
        pair = one_point(middle)._replace(points=np.stack([points[n], middle])[None], weights=np.ones((1, 2)))
        both = send_rays(view, ramps._replace(pattern=pair))[y, x].astype(np.float64)
        channel = int(np.abs(a - b).argmax())
        if abs(a[channel] - b[channel]) > 1e-6:
            stay[n] = min(max((b - both)[channel] / (both - a)[channel], 0.0), 1.0)
    return stay


def _layers(view: View, params: Any, scene: Prepared, pixel: tuple[int, int]) -> Part:
    """What each layer adds."""
    x, y = pixel

    def sent(surface: Float) -> Float:
        return send_rays(view, _colored(params, scene, surface, (0.0, 0.0, 0.0)))[y, x]

    def seen(k: int) -> Float:
        surface = np.zeros_like(scene.surface)
        surface[k] = scene.surface[k]
        return sent(surface)

    def shares(some: range) -> Float:
        surface = np.zeros_like(scene.surface)
        for channel, k in enumerate(some):
            surface[k, ..., channel] = 1.0
        return sent(surface)

    return layer_table(len(scene.surface), seen, shares)


def _pinhole(view: View, image: Float, pixel: tuple[int, int]) -> Explanation:
    """A pixel whose rays all leave the image shows what the pinhole sees."""
    x, y = pixel
    value = image[y, x].astype(np.float64)
    row = [np.nan, 0.0, 0.0, np.nan, x + 0.5, y + 0.5, view.pinhole().depth[y, x], view.coc_px()[y, x], *value, 1.0]
    what = "the pinhole's ray: all others leave the image"
    size, seen = view.camera.size, view.pinhole().color
    return Explanation("multiview", "image", pixel, size, value, what, RAY_COLUMNS, np.array([row]), picture=seen)
