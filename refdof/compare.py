"""Compare: the reference, every method and its scores, on one scene."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from refdof._check import InputError, as_choice, as_function, as_instance
from refdof.camera import Camera
from refdof.comparison import Comparison, Row
from refdof.lens import ThinLens
from refdof.methods import METHODS
from refdof.metrics import scores
from refdof.metrics.structural import WINDOW
from refdof.reference import reference_of_view
from refdof.rendering import make_params, render_view
from refdof.scene import Part, Scene
from refdof.view import View, view_of

__all__ = ["compare", "warm_up"]


def compare(
    scene: Scene,
    methods: Sequence[str],
    params: Mapping[str, Mapping[str, Any]] | None = None,
    camera: Camera | None = None,
    lens: ThinLens | None = None,
    samples: int = 256,
    tolerance: float | None = None,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
) -> Comparison:
    """Render the reference and every method, and score them.

    Parameters
    ----------
    scene, camera, lens
        Camera and lens default to the scene's suggested shot.
    methods : names in `refdof.METHODS`
    params : {method: {field: value}}
        Fields of the methods' `Params`; what is left out keeps its default.
    samples, tolerance, seed
        Of the reference.
    progress : callable, optional
        Called with (what, done, all).

    Raises
    ------
    InputError
        If a method or parameter is not allowed, or the picture is too small for SSIM's window.
    """
    view = view_of(scene, camera, lens)
    as_function("progress", progress)
    if isinstance(methods, str) or not isinstance(methods, Sequence):
        raise InputError(f"methods: got {type(methods).__name__}; allowed is a list of names")
    for name in methods:
        as_choice("methods", name, METHODS)
    given = {} if params is None else as_instance("params", params, Mapping)
    for name, values in given.items():
        as_instance(f"params of {as_choice('params', name, methods)}", values, Mapping)
    if min(view.camera.size) < WINDOW:
        width, height = view.camera.size
        raise InputError(f"size: got {width}x{height}; allowed for scores is at least {WINDOW}x{WINDOW}")
    chosen = {name: dict(given.get(name, {})) for name in methods}
    for name, values in chosen.items():
        make_params(name, values)
    tell = progress or (lambda _what, _done, _all: None)

    def step(done: int, count: int) -> None:
        tell("reference", done, count)

    warm_up("accumulation", {})  # the reference's kernels are the same
    truth = reference_of_view(view, samples=samples, tolerance=tolerance, seed=seed, progress=step)
    rows = []
    for k, (name, values) in enumerate(chosen.items()):
        tell(name, k, len(chosen))
        warm_up(name, values)
        result = render_view(name, view, **values)
        rows.append(
            Row(
                name,
                asdict(result.params),
                result.image,
                scores(truth.image, result.image),
                result.seconds["prepare"],
                result.seconds["blur"],
            )
        )
    tell("scores", len(chosen), len(chosen))
    return Comparison(
        scene.name,
        view.camera,
        view.lens,
        view.pinhole().color,
        truth.image,
        truth.standard_error,
        float(truth.samples.mean()),
        truth.seconds,
        truth.noise_floor_psnr,
        tuple(rows),
    )


def warm_up(method: str, params: Mapping[str, Any]) -> None:
    """Compile what `method` needs on a picture of 8 x 8 pixels, so that times speak of the algorithm alone."""
    camera = Camera(eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), size=(8, 8))
    lens = ThinLens(radius=0.1, focus_distance=1.0)
    triangle = Part(np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]]))
    render_view(method, View(Scene.from_parts("warm-up", [triangle], camera, lens), camera, lens), **params)
