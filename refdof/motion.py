"""Motion: how much a method's picture flickers while the camera moves by less than a pixel.

The camera and what it looks at move to the right by 1/16 px of the focal plane per frame: what is in focus moves by
that, and a surface at depth d by focus / (16 d) px.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_function, as_instance, as_integer
from refdof.compare import as_settings
from refdof.metrics.artefacts import ArtefactMaps, flicker
from refdof.rendering import make_params, render_view
from refdof.truth.reference import as_seed, reference_of_view
from refdof.view import View

__all__ = ["FRAMES", "STEP_PX", "blurred_in_all", "flickers", "moved_views"]

FRAMES = 16
STEP_PX = 1.0 / 16.0  # of the focal plane, per frame


def moved_views(view: View, frames: int = FRAMES) -> list[View]:
    """The view, and the same view moved to the right by `STEP_PX` more each time.

    Parameters
    ----------
    view : View
    frames : int
        3 .. 1000, the first one included.

    Raises
    ------
    InputError
        If the lens is focused at infinity, where nothing moves.
    """
    as_instance("view", view, View)
    frames = as_integer("frames", frames, minimum=3, maximum=1000)
    camera, focus = view.camera, view.lens.focus_distance
    if not np.isfinite(focus):
        raise InputError("view: got a lens focused at infinity; allowed is a finite focus distance")
    step = camera.rotation[0] * (STEP_PX * focus / camera.pixels_per_tangent)
    moved = []
    for k in range(frames):
        eye, target = (tuple((np.asarray(place) + k * step).tolist()) for place in (camera.eye, camera.target))
        moved.append(View(view.scene, replace(camera, eye=eye, target=target), view.lens))
    return moved


def blurred_in_all(views: Sequence[View]) -> np.typing.NDArray[np.bool_]:
    """Pixels that are sharp in no view: (H, W). See `ArtefactMaps.sharp`: blur in front of them counts, too."""
    return np.logical_and.reduce([~ArtefactMaps(view.pinhole().depth, view.coc_px()).sharp for view in views])


def flickers(
    view: View,
    methods: Sequence[str],
    params: Mapping[str, Mapping[str, Any]] | None = None,
    preset: str = "best",
    samples: int = 256,
    frames: int = FRAMES,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
) -> dict[str, float]:
    """Flicker of the reference, and of each method beyond it, where no frame is sharp.

    The reference is rendered twice per frame, from independent seeds, so that its noise does not count: see
    `refdof.metrics.artefacts.flicker`.

    Parameters
    ----------
    view : View
        Of the first frame. Small pictures do: 160 x 120 has some thousand pixels to average.
    methods : names in `refdof.METHODS`
    params : {method: {field: value}}
    preset : one of `refdof.rendering.PRESETS`
    samples, seed : of the references; they are 2 `frames` pictures with seeds from `seed` on
    frames : int
    progress : callable, optional
        Called with (what, done, all).

    Returns
    -------
    dict
        "reference": its flicker; by method: flicker minus that. NaN where every pixel is sharp in some frame.

    Raises
    ------
    InputError
        If a method, preset, parameter or number is not allowed, or the lens is focused at infinity.
    """
    as_function("progress", progress)
    tell = progress or (lambda _what, _done, _all: None)
    given = as_settings(methods, params)
    for name, settings in given.items():
        make_params(name, settings, preset)
    views, seed = moved_views(view, frames), as_seed(seed)
    region = blurred_in_all(views)

    def sequence(what: str, picture: Callable[[int, View], Float]) -> Float:
        made = []
        for k, one in enumerate(views):
            tell(what, k, len(views))
            made.append(picture(k, one))
        return np.stack(made)

    def noisy(other: int) -> Callable[[int, View], Float]:
        first = (seed + other * len(views)) % 2**32
        return lambda k, one: reference_of_view(one, samples=samples, seed=(first + k) % 2**32).image

    truth = flicker(sequence("reference", noisy(0)), region, sequence("reference", noisy(1)))
    found = {"reference": truth}
    for name, settings in given.items():

        def rendered(_: int, one: View, name: str = name, settings: dict[str, Any] = settings) -> Float:
            image = render_view(name, one, preset=preset, **settings).image
            one.forget_layers()
            return image

        found[name] = flicker(sequence(name, rendered), region) - truth
    return found
