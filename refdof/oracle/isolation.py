"""Isolation: what a right port makes of a port's own earlier parts, so that an own error and an inherited one differ.

A case has parts: stages, in the order in which they are made, and the image last. Each one is compared twice:

- cumulative, as it comes, with the golden one;
- isolated, with what a right port makes of this port's earlier parts, where any of those is off.

Cumulative off and isolated right: the error is inherited. Both off: it is the part's own, or of what the port does not
show between the part and the one before. Where isolation cannot be computed, the cause of a later part is unknown.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from refdof._check import Float, InputError
from refdof.methods.poisson import Params as PoissonParams
from refdof.methods.poisson import code_of, shrink
from refdof.methods.poisson.ties import bounds_of_coded
from refdof.methods.singlepass import Params
from refdof.methods.singlepass.ties import Start, bounds_from
from refdof.oracle.case import in_file_order
from refdof.oracle.verdict import PASS, Finding
from refdof.rendering import make_params

__all__ = ["CAUSES", "INHERITED", "OWN", "UNKNOWN", "causes_of", "follow"]

OWN, INHERITED, UNKNOWN = "own", "inherited", "unknown"
CAUSES = (OWN, INHERITED, UNKNOWN)

Pair = tuple[Float, Float]
Images = tuple[Float, Float, Float]


def follow(about: Mapping[str, Any], part: str, images: Images, given: Mapping[str, Float]) -> Pair | None:
    """Bounds of a part, made of a port's earlier parts.

    Parameters
    ----------
    about : what case.json holds: its method, params and rows are used
    part : "image" or a stage, by its name in the pack
    images : color (H, W, 3), depth (H, W), coc (H, W) [px]
        The case's inputs, rows as in its files.
    given : {part: (H, W) or (H, W, 3)}
        Earlier parts as the port has them.

    Returns
    -------
    (low, high), float64, rows as in files; None if the method's parts cannot be followed, or not from such values.
    """
    made = _METHODS.get(about["method"])
    if made is None or not all(np.isfinite(values).all() for values in given.values()):
        return None
    try:
        params = in_file_order(make_params(about["method"], dict(about["params"])), about["rows"])
        color, depth, coc = (image.astype(np.float64) for image in images)
        return made(part, (color, depth, coc), params, dict(given))
    except InputError:  # circles that a filter cannot take, or parameters of a later version
        return None


def causes_of(parts: Mapping[str, Finding], isolated: Mapping[str, Finding | None]) -> dict[str, str]:
    """Why each part that is off is so.

    parts: cumulative findings, in the order of making; isolated: those of parts with an earlier one that is off, None
    where it cannot be told.
    """
    causes = {}
    for part, finding in parts.items():
        if finding.status == PASS:
            continue
        own = isolated.get(part, finding)
        causes[part] = UNKNOWN if own is None else INHERITED if own.status == PASS else OWN
    return causes


def _singlepass(part: str, images: Images, params: Params, given: dict[str, Float]) -> Pair | None:
    """Sizes come of circles, limits of sizes, and means of sizes, limits and the mean before."""
    color, depth, coc = images
    circles = given.get("coc", coc).astype(np.float64)
    sizes = np.minimum(np.abs(circles), params.max_blur_size)
    if part == "size":
        return sizes, sizes
    sizes = given.get("size", sizes).astype(np.float64)
    if part == "limit":
        return params.behind_factor * sizes, params.behind_factor * sizes
    steps = {_step(name): name for name in given if _step(name) is not None}
    if part != "image" and _step(part) is None:
        return None
    last = params.max_taps if part == "image" else _step(part)
    start = Start(limit=given["limit"].astype(np.float64) if "limit" in given else None)
    before = [step for step in steps if step is not None and (last is None or step <= last)]
    if before:
        start = start._replace(mean=given[steps[max(before)]].astype(np.float64), taps=max(before))
    # Sizes beyond the largest are the port's own: the loop takes them as they are.
    largest = max(params.max_blur_size, float(np.abs(sizes).max()))
    loop = replace(params, max_taps=last, max_blur_size=largest, loop_bound=params.bound)
    signed = np.copysign(sizes, circles) if "size" in given else circles
    low, high, _ = bounds_from(color, depth, signed, loop, start)
    return low, high


def _step(name: str) -> int | None:
    """K of "mean_K"."""
    word, _, number = name.partition("_")
    return int(number) if word == "mean" and number.isdecimal() else None


def _poisson(part: str, images: Images, params: PoissonParams, given: dict[str, Float]) -> Pair | None:
    """The code comes of circles or of depth, the small picture of the code, and means of both."""
    color, depth, coc = images
    code = code_of(depth, given.get("coc", coc).astype(np.float64), params)
    if part == "code":
        return code, code
    coded = np.concatenate([color, given.get("code", code).astype(np.float64)[..., None]], axis=-1)
    if part == "small":
        small = shrink(coded, params.small_size)
        return small, small
    if part != "image" and _step(part) is None:
        return None
    small = given["small"].astype(np.float64) if "small" in given else shrink(coded, params.small_size)
    loop = params if part == "image" else replace(params, max_taps=_step(part))
    low, high, _ = bounds_of_coded(coded, small, loop)
    return low, high


_METHODS: dict[str, Callable[[str, Images, Any, dict[str, Float]], Pair | None]] = {
    "singlepass": _singlepass,
    "poisson": _poisson,
}
