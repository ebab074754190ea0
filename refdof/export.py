"""Export: what a port needs to begin, and what its stages are compared with, as files that every language reads.

1. Draw the scene: pinhole colour and depth, circles of confusion, layers   `_inputs`
2. Run methods with their stages                                            `_run`
3. Write all of it in one step                                              `refdof.image.arrays.save_arrays`
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from refdof._check import as_choice, as_instance, as_integer
from refdof.image.arrays import Described, check_arrays_folder, save_arrays
from refdof.methods import METHODS
from refdof.rendering import Result, make_params, render_view
from refdof.report.rows import PHOTOGRAPHIC, lens_as_json, plain
from refdof.stages import Stage, Stages
from refdof.view import View

__all__ = ["CONVENTIONS", "export_view", "save_stages", "with_declared_stages"]

CONVENTIONS: dict[str, str] = {
    "axis_y": "down: row 0 is the top row",
    "pixel_centre": "pixel (x, y) is sampled at (x + 0.5, y + 0.5)",
    "color_space": "linear Rec.709, radiance; above 1 is allowed",
    "depth_kind": "planar distance along the optical axis, in scene units",
    "depth_empty_value": "inf",
    "focus_surface": "plane",
    "focus_origin": "lens_plane",
    "lens_size": "radius",
    "coc_unit": "px_radius",
    "coc_sign": "negative_near",
    "coc": "P * E * (1 / focus - 1 / depth), P in pixels per unit of tangent, E the lens radius",
    "coc_photographic": PHOTOGRAPHIC,
    "byte_order": "little",
    "memory_order": "C: the last axis runs fastest",
}


def with_declared_stages() -> list[str]:
    """The methods whose records declare their stages."""
    return [name for name, module in METHODS.items() if module.METHOD.stages]


def export_view(
    view: View,
    folder: str | os.PathLike[str],
    methods: Sequence[str],
    params: Mapping[str, Mapping[str, Any]] | None = None,
    layers: int = 4,
    stages: Stages = Stages(None, None),
) -> None:
    """Write a view's raster products, and every method's picture and stages.

    Parameters
    ----------
    view : View
    folder : path
        New, empty, or an earlier export.
    methods : names
    params : {method: {parameter: value}}
    layers : int
        How many surfaces per pixel, 1 .. 64.
    stages : Stages

    Raises
    ------
    InputError
        If a name or value is not allowed, or the folder cannot be written.
    """
    as_instance("view", view, View)
    layers = as_integer("layers", layers, minimum=1, maximum=64)
    chosen = {name: dict((params or {}).get(as_choice("methods", name, METHODS), {})) for name in methods}
    for name, values in chosen.items():
        make_params(name, values)
    check_arrays_folder(folder)
    arrays, about = _inputs(view, layers), _about(view)
    for name, values in chosen.items():
        result = render_view(name, view, stages, **values)
        arrays |= {f"{name}/{key}": array for key, array in _run(name, result).items()}
        about["methods"][name] = {"params": plain(_params_of(result))}
    save_arrays(folder, arrays, about)


def save_stages(method: str, view: View, result: Result, folder: str | os.PathLike[str]) -> None:
    """Write the picture and the stages of one run.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    about = _about(view)
    about["methods"][method] = {"params": plain(_params_of(result))}
    save_arrays(folder, _run(method, result), about, "stages")


def _inputs(view: View, count: int) -> dict[str, Described]:
    """What methods are given, in float32 as they have it; but the depth, of which circles are made, in float64."""
    pinhole, layers = view.pinhole(), view.layers(count)
    with np.errstate(over="ignore"):
        layer_depth = layers.depth.astype(np.float32)
    coc, layer_coc = (
        values.astype(np.float32) for values in (view.coc_px(), view.lens.coc_px(layers.depth, view.camera))
    )
    return {
        "color": Described(pinhole.color, "H W 3", "linear RGB", "what a pinhole sees"),
        "depth": Described(pinhole.depth, "H W", "scene units", "planar depth of it; inf is background"),
        "coc": Described(coc, "H W", "px", "signed circle of confusion of it, a radius"),
        "layer_color": Described(layers.color, "L H W 3", "linear RGB", "surfaces, front to back; 0: none"),
        "layer_depth": Described(layer_depth, "L H W", "scene units", "their planar depth; inf where there is none"),
        "layer_coc": Described(layer_coc, "L H W", "px", "their signed circle of confusion, a radius"),
        "layer_triangle": Described(layers.triangle, "L H W", "", "their triangle; -1 where there is none"),
    }


def _run(method: str, result: Result) -> dict[str, Described]:
    """The picture and the stages of a run, by the names of files."""
    arrays = {"image": Described(result.image, "H W 3", "linear RGB", "the method's picture", (), "filter")}
    for name, values in result.stages.items():
        arrays[name.replace(" ", "_")] = _described(values, _declared(method, name))
    return arrays


def _declared(method: str, name: str) -> Stage | None:
    return next((stage for stage in METHODS[method].METHOD.stages if stage.names(name)), None)


def _described(values: np.ndarray, stage: Stage | None) -> Described:
    if stage is None:
        return Described(values, " ".join(map(str, values.shape)))
    return Described(values, stage.axes, stage.unit, stage.meaning, stage.columns, stage.comparison)


def _about(view: View) -> dict[str, Any]:
    """The shot, and what holds of all arrays."""
    camera = view.camera
    return {
        "scene": view.scene.name,
        "camera": {**plain(asdict(camera)), "pixels_per_tangent": plain(camera.pixels_per_tangent)},
        "lens": lens_as_json(view.lens),
        "background": plain(view.scene.background),
        "conventions": CONVENTIONS,
        "methods": {},
    }


def _params_of(result: Result) -> dict[str, Any]:
    return {field.name: getattr(result.params, field.name) for field in fields(result.params)}
