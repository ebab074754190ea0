"""Stages: what made the value of a stage at one pixel.

1. Circles of confusion: the formula with its numbers                            `_circle`
2. Means of the single pass: their taps                                          `singlepass.explain_mean`
3. A stage that is linear in colour: the weight of every pixel, or surface       `explain_linear`, `cascaded.explain`
4. Else: the value, and what the method declares of the stage                    `_value`
"""

import re
from typing import Any

import numpy as np

from refdof._check import Float, InputError
from refdof.explain import cascaded, singlepass
from refdof.explain.explanation import Explanation, Part
from refdof.explain.linear import explain_linear
from refdof.explain.pictures import Pictures, pictures_of, run
from refdof.methods import METHODS
from refdof.stages import Stages
from refdof.view import View

__all__ = ["explain_stage"]

_COLORS = (3, 4)  # channels of a stage that is a picture


def explain_stage(method: str, given: Pictures | View, params: Any, pixel: tuple[int, int], stage: str) -> Explanation:
    """Explain a stage; "_" in its name stands for a blank, too.

    Raises
    ------
    InputError
        If the method records no such stage, or the stage has no value at a pixel.
    """
    if stage == "coc":
        return _circle(method, given, pixel)
    step = re.fullmatch(r".*[ _](\d{1,5})", stage)
    wanted = Stages((int(step[1]),) if step else (), ())
    try:
        _, recorded = run(method, given, params, wanted)
    except InputError as error:
        raise InputError(str(error).replace("steps:", "stage: the step is beyond the loop;", 1)) from None
    names = {name.replace(" ", "_"): name for name in recorded if _at(recorded[name], given, pixel) is not None}
    name = names.get(stage.replace(" ", "_"))
    if name is None:
        allowed = ["image", "coc", *names, *(s.name for s in METHODS[method].METHOD.stages if s.name.endswith("*"))]
        raise InputError(f"stage: got {stage!r}; allowed for {method} are {', '.join(dict.fromkeys(allowed))}")
    if method == "singlepass" and step and name.startswith("mean"):
        return singlepass.explain_mean(_pictures(given), params, pixel, int(step[1]))
    if method == "singlepass" and step:
        return _tap(_value(method, given, params, pixel, name, recorded), given, params, int(step[1]))
    if recorded[name].shape[2:] in [(count,) for count in _COLORS] and recorded[name].shape[:2] == _shape(given):
        if isinstance(given, Pictures):
            return explain_linear(method, given, params, pixel, name, wanted)
        if method == "cascaded":
            return cascaded.explain(given, params, pixel, name)
    return _value(method, given, params, pixel, name, recorded)


def _pictures(given: Pictures | View) -> Pictures:
    return given if isinstance(given, Pictures) else pictures_of(given)


def _shape(given: Pictures | View) -> tuple[int, int]:
    width, height = given.size if isinstance(given, Pictures) else given.camera.size
    return height, width


def _at(values: Any, given: Pictures | View, pixel: tuple[int, int]) -> Float | None:
    """The values of a stage at a pixel (N,); None: it has none."""
    x, y = pixel
    shape = _shape(given)
    if values.ndim >= 2 and values.shape[:2] == shape:
        return np.atleast_1d(values[y, x]).astype(np.float64).ravel()
    if values.ndim >= 3 and values.shape[-2:] == shape:
        return np.asarray(values[..., y, x], dtype=np.float64).ravel()
    if values.ndim == 4 and values.shape[1:3] == shape:
        return np.asarray(values[:, y, x], dtype=np.float64).ravel()
    return None


def _value(
    method: str, given: Pictures | View, params: Any, pixel: tuple[int, int], name: str, stages: dict[str, Any]
) -> Explanation:
    """A value that is no sum, with what the method declares."""
    declared = next((stage for stage in METHODS[method].METHOD.stages if stage.names(name)), None)
    meaning = f"{declared.meaning} [{declared.unit or '1'}]" if declared else "see the method's list of stages"
    values = _at(stages[name], given, pixel)
    width_height = _shape(given)[::-1]
    assert values is not None
    notes = _formula(method, name, stages, params, pixel)
    return Explanation(method, name, pixel, width_height, values, meaning, notes=notes, picture=_pictures(given).color)


def _formula(method: str, name: str, stages: dict[str, Any], params: Any, pixel: tuple[int, int]) -> tuple[str, ...]:
    """How the single pass makes its maps."""
    if method != "singlepass" or name not in ("size", "limit"):
        return ()
    x, y = pixel
    size = float(stages["size"][y, x])
    if name == "size":
        return (
            f"size = min(|coc|, max_blur_size) = min({abs(float(stages['coc'][y, x])):.9g}, {params.max_blur_size:g})",
        )
    return (f"limit = behind_factor size = {params.behind_factor:g} * {size:.9g}",)


def _tap(value: Explanation, given: Pictures | View, params: Any, number: int) -> Explanation:
    """Reach and weight of one tap: its row of the table."""
    table = singlepass.explain_mean(_pictures(given), params, value.pixel, number)
    part = Part(f"tap {number}", table.columns[:-1], table.rows[-1:, :-1])
    notes = ("m = smoothstep(radius - 0.5, radius + 0.5, reach); reach is the size, cut where the tap lies behind",)
    return Explanation(
        value.method, value.stage, value.pixel, value.size, value.value, value.what, notes=notes, parts=(part,),
        picture=value.picture,
    )  # fmt: skip


def _circle(method: str, given: Pictures | View, pixel: tuple[int, int]) -> Explanation:
    """The thin lens's formula with its numbers."""
    pictures, (x, y) = _pictures(given), pixel
    depth, coc = float(pictures.depth[y, x]), float(pictures.coc[y, x])
    notes: tuple[str, ...] = ("the circles were given; the lens is not known",)
    if pictures.coc_scale is not None and pictures.focus is not None:
        scale, focus = pictures.coc_scale, pictures.focus
        made = scale * (1.0 / focus - 1.0 / depth)
        notes = (
            "coc = P E (1 / focus - 1 / depth), P in pixels per unit of tangent, E the lens radius",
            f"= {scale:.9g} * (1 / {focus:.9g} - 1 / {depth:.9g}) = {made:.9g} px",
            f"{'in front of' if coc < 0 else 'behind' if coc > 0 else 'in'} the focal plane",
        )
    what = "signed circle of confusion, a radius [px]"
    return Explanation(method, "coc", pixel, pictures.size, np.array([coc]), what, notes=notes, picture=pictures.color)
