"""Twins: a method in float32, as everybody gets it, and the same kernels in float64 on the same inputs.

Image filters and `cascaded` work in the type of their colours. The rays of `multiview` and `lensblur` go through layers
in the type of their places; what they hit is averaged in float64 and rounded once in both. `accumulation` has no
float32: its rays are float64 but for Embree's traversal, so that it has no twin.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof.methods import METHODS
from refdof.methods._image_validation import depth_in_range, depth_in_unit, within
from refdof.methods.cascaded import method as cascaded
from refdof.methods.lensblur import method as lensblur
from refdof.methods.multiview import method as multiview
from refdof.methods.multiview.gather import record_rays
from refdof.optics.pixel_samples import LensPointSets
from refdof.rendering import make_params
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["Ran", "narrow", "narrow_of_half", "through_points", "wide"]

_NONE: Mapping[str, Any] = MappingProxyType({})
_OWN_UNIT = ("ringgather",)  # depth has a unit there, that of `foreground`


class Ran(NamedTuple):
    """A picture (H, W, 3) and its stages by name, in the order of the method's steps."""

    image: Float
    stages: dict[str, np.ndarray]


def narrow(method: str, view: View, params: Mapping[str, Any] = _NONE, stages: bool = False) -> Ran:
    """The method as everybody gets it."""
    recorder = StageRecorder(stages)
    image = METHODS[method].render(view, make_params(method, dict(params)), recorder)
    return Ran(image, recorder.stages)


def wide(method: str, view: View, params: Mapping[str, Any] = _NONE, stages: bool = False) -> Ran | None:
    """The method's kernels in float64 on what `narrow` is given; None: it has no other type."""
    chosen = make_params(method, dict(params))
    if METHODS[method].METHOD.kind == "single image":
        return _filtered(method, view, chosen, np.float64, stages=stages)
    run = _OF_LAYERS.get(method)
    return None if run is None else run(view, chosen, np.float64, _same, stages)


def narrow_of_half(method: str, view: View, params: Mapping[str, Any] = _NONE, what: str = "circle") -> Ran | None:
    """The method on circles of confusion ("circle") or depths ("depth") that half floats hold; None: it stores none.

    Halves round to nearest, and to infinity beyond 65504. Of `lensblur` it is the parallax, of `multiview` the layers'
    circles that are stored.
    """
    chosen = make_params(method, dict(params))
    if METHODS[method].METHOD.kind == "single image":
        return _filtered(method, view, chosen, np.float32, half=what)
    if method not in _OF_LAYERS or what != ("depth" if method == "cascaded" else "circle"):
        return None
    return _OF_LAYERS[method](view, chosen, np.float32, _half, False)


def through_points(method: str, view: View, points: Float) -> Float:
    """The picture of `lensblur` or `multiview` through given points of the unit lens disc: (1, N, 2)."""
    pattern = LensPointSets(points, np.ones(points.shape[:2]), np.zeros((1, 1), np.int32))
    params = make_params(method, {})
    if method == "lensblur":
        return lensblur.trace(view, lensblur.prepare(view, params)._replace(pattern=pattern)).image
    return multiview.send_rays(view, multiview.prepare(view, params, StageRecorder())._replace(pattern=pattern))


def _half(values: Float) -> Float:
    with np.errstate(over="ignore"):
        return values.astype(np.float16).astype(values.dtype)


def _same(values: Float) -> Float:
    return values


def _filtered(method: str, view: View, params: Any, dtype: type, half: str = "", stages: bool = False) -> Ran:
    pinhole = view.pinhole()
    depth, coc = pinhole.depth, view.coc_px()
    if half == "depth":
        depth = np.maximum(_half(depth), np.finfo(np.float16).smallest_subnormal)
        coc = view.lens.coc_px(depth, view.camera)
    coc = within(np.float32, coc)
    if half == "circle":
        coc = _half(coc)
    depth = (depth_in_unit if method in _OWN_UNIT else depth_in_range)(np.float32, depth)
    given: list[Float] = [part.astype(dtype) for part in (pinhole.color, depth, coc)]
    blurred = METHODS[method].blur(*given, params, stages=stages)
    return Ran(*blurred) if stages else Ran(blurred, {})


def _cascaded(view: View, params: Any, dtype: type, store: Callable[[Float], Float], stages: bool) -> Ran:
    color, depth = cascaded.buffers_of(view, params)
    recorder = StageRecorder(stages)
    image = cascaded.blur_buffers(color.astype(dtype), store(depth), view.camera, view.lens, params, recorder)
    return Ran(image, recorder.stages)


def _lensblur(view: View, params: Any, dtype: type, store: Callable[[Float], Float], stages: bool) -> Ran:
    if view.lens.radius == 0.0:
        return Ran(view.pinhole().color, {})
    scene = lensblur.prepare(view, params, dtype)
    stack = scene.stack
    stack = stack._replace(packs=store(stack.packs), lowest=store(stack.lowest), highest=store(stack.highest))
    traced = lensblur.trace(view, scene._replace(stack=stack))
    recorder = StageRecorder(stages)
    recorder.record_all(lambda: {"lowest": stack.lowest, "highest": stack.highest})
    recorder.record_all(lambda: {name: getattr(traced, name) for name in ("near", "far", "steps", "missed")})
    return Ran(traced.image, recorder.stages)


def _multiview(view: View, params: Any, dtype: type, store: Callable[[Float], Float], stages: bool) -> Ran:
    recorder = StageRecorder(stages)
    scene = multiview.prepare(view, params, StageRecorder())
    fields = scene.fields
    stored: dict[str, Float] = {
        name: store(getattr(fields, name)).astype(dtype) for name in ("near", "far", "coc", "lowest")
    }
    fields = fields._replace(near=stored["near"], far=stored["far"], coc=stored["coc"], lowest=stored["lowest"])
    scene = scene._replace(fields=fields)
    recorder.record("layer_coc", lambda: stored["coc"])
    record_rays(recorder, scene.fields, scene.pattern, scene.search)
    return Ran(multiview.send_rays(view, scene), recorder.stages)


_OF_LAYERS: dict[str, Callable[..., Ran]] = {
    "cascaded": _cascaded,
    "lensblur": _lensblur,
    "multiview": _multiview,
}
