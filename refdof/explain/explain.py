"""The doors: explain a pixel of a method's picture, or of one of its stages.

Every method has one entry in `EXPLAINERS`; it explains the picture. Stages: `refdof.explain.stages`.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

from refdof._check import InputError, as_choice, as_instance
from refdof.explain import (
    accumulation,
    cascaded,
    filament,
    halfres,
    lensblur,
    mipmap,
    multiview,
    poisson,
    pyramidal,
    ringgather,
    scatter,
    separable,
    singlepass,
)
from refdof.explain.explanation import Explanation
from refdof.explain.linear import explain_linear
from refdof.explain.pictures import Pictures, pictures_of
from refdof.explain.stages import explain_stage
from refdof.methods import METHODS
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.systems.system_lens import SystemLens
from refdof.view import View

__all__ = ["EXPLAINERS", "explain_pictures", "explain_view"]

EXPLAINERS: dict[str, Callable[[Any, Any, tuple[int, int]], Explanation]] = {
    "accumulation": accumulation.explain,
    "cascaded": cascaded.explain,
    "circular": partial(explain_linear, "circular"),
    "filament": filament.explain,
    "halfres": halfres.explain,
    "hexagon": partial(explain_linear, "hexagon"),
    "lensblur": lensblur.explain,
    "mipmap": mipmap.explain,
    "multiview": multiview.explain,
    "poisson": poisson.explain,
    "pyramidal": pyramidal.explain,
    "ringgather": ringgather.explain,
    "scatter": scatter.explain,
    "separable": separable.explain,
    "singlepass": singlepass.explain,
}
"""(`Pictures` or `View`, the method's Params, pixel) -> Explanation, by method."""


def explain_view(method: str, view: View, params: Any, pixel: tuple[int, int], stage: str = "image") -> Explanation:
    """Explain a pixel of what a method makes of a view.

    Parameters
    ----------
    method : a name in `refdof.METHODS`
    view : View
    params : the method's Params
    pixel : (column, row)
        Row 0 is the top row.
    stage : str
        "image", or a stage that the method records.

    Raises
    ------
    InputError
        If there is no such method, pixel or stage, or the method has no explanation.
    """
    as_instance("view", view, View)
    _check(method, params, pixel, view.camera.size)
    if isinstance(view.lens, SystemLens | ExpressiveLens) and method in ("accumulation", "lensblur"):
        raise InputError(
            f"lens: got one whose rays are its own; allowed for an explanation of {method} is a plain thin lens"
        )
    given = pictures_of(view) if METHODS[method].METHOD.kind == "single image" else view
    return _explained(method, given, params, pixel, stage)


def explain_pictures(
    method: str, given: Pictures, params: Any, pixel: tuple[int, int], stage: str = "image"
) -> Explanation:
    """`explain_view` of a single-image method that is given pictures."""
    as_instance("given", given, Pictures)
    _check(method, params, pixel, given.size)
    if METHODS[method].METHOD.kind != "single image":
        raise InputError(f"method: got {method!r}, which needs a scene; allowed are those that filter a single image")
    return _explained(method, given, params, pixel, stage)


def _explained(method: str, given: Pictures | View, params: Any, pixel: tuple[int, int], stage: str) -> Explanation:
    if stage == "image":
        return EXPLAINERS[method](given, params, pixel)
    return explain_stage(method, given, params, pixel, stage)


def _check(method: str, params: Any, pixel: tuple[int, int], size: tuple[int, int]) -> None:
    as_choice("method", method, METHODS)
    if method not in EXPLAINERS:
        raise InputError(f"method: got {method!r}, which has no explanation; allowed are {', '.join(EXPLAINERS)}")
    as_instance("params", params, METHODS[method].METHOD.params)
    x, y = pixel
    if not (0 <= x < size[0] and 0 <= y < size[1]):
        raise InputError(f"pixel: got {x},{y}; allowed are 0,0 .. {size[0] - 1},{size[1] - 1}")
