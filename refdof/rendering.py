"""Render a view with any method, by name, and book its time.

A method's parameters start from a preset: "best", the defaults of its `Params`, which measurement chose; or "paper",
where the fields in its record's `paper` follow the paper's text to the letter.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, as_choice, as_instance
from refdof.methods import METHODS
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.scene.scene import Scene
from refdof.stages import StageRecorder, Stages, as_stages
from refdof.view import View, view_of

__all__ = ["PRESETS", "Result", "make_params", "render", "render_view"]

PRESETS = ("best", "paper")


@dataclass(frozen=True, eq=False)
class Result:
    """A method's picture.

    Attributes
    ----------
    image : (H, W, 3) float32, linear RGB
    seconds : {"prepare", "blur"}
        Raster products the method used (whoever asked first), and the method itself.
    stages : arrays by name, empty unless asked for
    params : the method's Params
    layers_s : float
        Seconds of "prepare" for what goes beyond the scene and its pinhole picture: layers, triangles for a rasteriser.
    """

    image: Float
    seconds: dict[str, float]
    stages: dict[str, np.ndarray]
    params: Any
    layers_s: float = 0.0


def render(
    method: str,
    scene: Scene,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    stages: bool | Stages = False,
    preset: str = "best",
    **params: Any,
) -> Result:
    """Render a scene with a method.

    Parameters
    ----------
    method : str
        A name in `refdof.METHODS`.
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    stages : bool or refdof.Stages
        Record the method's stages: those that every run has, or also steps and probes.
    preset : one of `PRESETS`
        What fields have that are not given: "best", what measurement chose, or "paper", what the paper's text says.
    **params
        Fields of the method's `Params`.

    Raises
    ------
    InputError
        If the method, the preset, a parameter's name or its value is not allowed.
    """
    return render_view(method, view_of(scene, camera, lens), stages, preset, **params)


def render_view(method: str, view: View, stages: bool | Stages = False, preset: str = "best", **params: Any) -> Result:
    """`render` of a view whose products are shared."""
    chosen = make_params(method, params, preset)
    as_instance("view", view, View)
    recorder = StageRecorder(as_stages(stages))
    with view.booking() as book:
        start = time.perf_counter()
        image = METHODS[method].render(view, chosen, recorder)
        whole = time.perf_counter() - start
    return Result(image, {"prepare": book.prepare, "blur": whole - book.spent}, recorder.stages, chosen, book.layers)


def make_params(method: str, values: Mapping[str, Any], preset: str = "best") -> Any:
    """The method's `Params` with these values over those of a preset.

    Raises
    ------
    InputError
        If the method, the preset or a parameter does not exist (with the nearest name), or a value is not allowed.
    """
    as_choice("method", method, METHODS)
    as_choice("preset", preset, PRESETS)
    as_instance("values", values, dict)
    record = METHODS[method].METHOD
    for name in values:
        as_choice(f"parameter of {method}", name, record.defaults())
    return record.params(**{**(record.paper if preset == "paper" else {}), **values})
