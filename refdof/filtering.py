"""Filtering: every method that needs no more than a frame made elsewhere, on that frame."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from refdof._check import InputError, as_function, as_image, as_instance
from refdof.compare import as_settings, check_window, distinct, rows_of
from refdof.comparison import Comparison
from refdof.frame.frame import Frame
from refdof.methods import METHODS
from refdof.warm import job_of, warm

__all__ = ["filter_frame", "methods_of_frame"]

_OF_LAYERS = ("cascaded", "lensblur")  # what they need are surfaces of every pixel, and a lens
_OF_TRIANGLES = "deferred"  # a parameter of such a method that needs more


def methods_of_frame(frame: Frame) -> list[str]:
    """The methods that need no more than this frame has: single-image filters; of a deep one also methods of layers."""
    as_instance("frame", frame, Frame)
    layered = frame.layers is not None and frame.lens is not None
    return [
        name
        for name, module in METHODS.items()
        if module.METHOD.kind == "single image" or (layered and name in _OF_LAYERS)
    ]


def filter_frame(
    frame: Frame,
    methods: Sequence[str] | None = None,
    params: Mapping[str, Mapping[str, Any]] | None = None,
    preset: str | Sequence[str] = "best",
    reference: Any = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Comparison:
    """Blur a frame with every method, and score the pictures where there is a reference.

    Parameters
    ----------
    frame : Frame
    methods : names, optional
        None: all that need no more than the frame has.
    params : {method: {field: value}}
    preset : one or more of `refdof.rendering.PRESETS`
        As of `refdof.compare.compare`.
    reference : (H, W, 3), optional
        Linear RGB; at least 11 x 11 pixels.
    progress : callable, optional
        Called with (what, done, all).

    Raises
    ------
    InputError
        If a method needs more than the frame has, or a method, preset, parameter or reference is not allowed.
    """
    allowed = methods_of_frame(frame)
    as_function("progress", progress)
    given = as_settings(allowed if methods is None else methods, params)
    for name, settings in given.items():
        if name not in allowed:
            raise InputError(
                f"methods: got {name!r}, which needs {_missing(name, frame)}; allowed on this frame are "
                f"{', '.join(allowed)}"
            )
        if settings.get(_OF_TRIANGLES):
            raise InputError(f"{name}.{_OF_TRIANGLES}: got True, which needs triangles; allowed on a frame is False")
    chosen = distinct(given, preset)
    view = frame.view()
    view.times_warm_runs = True
    truth = None
    if reference is not None:
        truth = as_image("reference", reference, frame.color.shape, dtype=np.float32)
        check_window(view)
    tell = progress or (lambda _what, _done, _all: None)
    warm([job_of(name, kind) for name, kind in chosen], progress, at_least=2)
    rows = rows_of(view, chosen, given, truth, tell)
    pinhole = view.pinhole().color
    unknown = math.nan
    return Comparison(
        frame.name,
        frame.camera,
        frame.lens,
        pinhole,
        truth,
        None,
        unknown,
        unknown,
        unknown,
        tuple(rows),
        depth=frame.depth,
        coc_px=view.coc_px(),
        surface_counts=None if frame.layers is None else view.surface_counts(),
    )


def _missing(name: str, frame: Frame) -> str:
    """What the frame has not, and a method needs."""
    if name not in _OF_LAYERS:
        return ", ".join(METHODS[name].METHOD.inputs)
    return "a deep file" if frame.layers is None else "a lens instead of circles of confusion"
