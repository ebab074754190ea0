"""Cascaded: the weight of every peeled surface, and by which way it comes: in front of, in or behind the focus.

1. Peel surfaces as the method does                       `refdof.methods.cascaded.buffers_of`
2. Recover the weight of each, by impulses, in the picture and in the stages "front" and "back"   `explain`
3. Tell the layers at the pixel                                                                   `_layers`
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation, Part
from refdof.explain.impulses import weights_of
from refdof.methods.cascaded import blur_buffers, buffers_of, layering_of
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["explain"]

_WAYS = ("in_front", "in_focus", "in_back")
_COLUMNS = ("surface", "x", "y", "depth", "coc", *COLOR)
_WHAT = "peeled surfaces, 0 is the nearest; each weight is what the method gives for a single one of colour 1"


class _Chosen(StageRecorder):
    """Records only some stages: impulses run the method many times."""

    def __init__(self, names: tuple[str, ...]) -> None:
        super().__init__(bool(names))
        self._names = names

    def record(self, name: str, make: Any) -> None:
        if name in self._names:
            super().record(name, make)


def explain(view: View, params: Any, pixel: tuple[int, int], stage: str = "image") -> Explanation:
    """Every surface, in the picture or in a stage (H, W, 4)."""
    (color, depth), (x, y) = buffers_of(view, params), pixel
    recorder = StageRecorder(True)
    image = blur_buffers(color, depth, view.camera, view.lens, params, recorder)
    stages = recorder.stages
    value = (image if stage == "image" else stages[stage])[y, x, :3].astype(np.float64)
    split = params.cascade and stage == "image"
    names = ("front", "back", "composite") if split else (() if stage == "image" else (stage,))

    def respond(tinted: Float) -> Float:
        some = _Chosen(names)
        picture = blur_buffers(tinted, depth, view.camera, view.lens, params, some)
        first = picture if stage == "image" else some.stages[stage]
        return np.array([first[y, x, :3], *(some.stages[name][y, x, :3] for name in names)])

    places, weights = weights_of(respond, depth.shape, color.dtype.type)
    at = tuple(places.T)
    circles = view.lens.coc_px(depth[at], view.camera)
    rows = np.column_stack([places[:, 0], places[:, 2] + 0.5, places[:, 1] + 0.5, depth[at], circles, color[at]])
    layers, visible, alpha = _layers(view, params, stages, depth, pixel)
    columns: tuple[str, ...] = (*_COLUMNS, "weight")
    notes = [f"the layers' opacity adds up to {alpha:.6g}" + (", by which they are divided" * params.normalize)]
    if split:
        divided = alpha if params.normalize and alpha > 0.0 else 1.0
        front, back = weights[:, 1] / divided, weights[:, 2] * visible / divided
        rows = np.column_stack([rows, front, weights[:, 3] / divided - front - back, back])
        columns = (*_COLUMNS, *_WAYS, "weight")
        notes.append("in_front, in_focus, in_back: parts of the weight, by the layers in front of, in and behind focus")
    return Explanation(
        "cascaded",
        stage,
        pixel,
        view.camera.size,
        value,
        _WHAT,
        columns,
        np.column_stack([rows, weights[:, 0]]),
        notes=tuple(notes),
        parts=(layers,),
        picture=view.pinhole().color,
    )


def _layers(
    view: View, params: Any, stages: dict[str, Float], depth: Float, pixel: tuple[int, int]
) -> tuple[Part, float, float]:
    """The layers here before they are blurred, what is visible of the back buffer, and the composite's alpha."""
    x, y = pixel
    layering = layering_of(depth, view.camera, view.lens, params)
    matted, count = stages["layers"][:, y, x].astype(np.float64), len(layering.deviation)
    blurs = np.where(layering.deviation > 0.0, layering.deviation, 0.0)
    bounds = layering.bounds.astype(np.float64)
    rows = np.column_stack([np.arange(count), bounds[:-1], bounds[1:], blurs, matted[:, 3], matted[:, :3]])
    columns = ("layer", "from_depth", "to_depth", "deviation", "opacity", *COLOR)
    title = f"layers, front to back; layer {layering.focus} is in focus: depths, blur [px], and what is matted here"
    visible = 1.0
    if params.cascade:
        visible = 1.0 - float(stages["front"][y, x, 3])
        if layering.focus >= 0:
            visible *= 1.0 - matted[layering.focus, 3]
    return Part(title, columns, rows), visible, float(stages["composite"][y, x, 3])
