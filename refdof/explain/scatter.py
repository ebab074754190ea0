"""Scatter: the splats that reach the pixel, with the share that each leaves there."""

from dataclasses import replace
from typing import Any

import numpy as np

from refdof.explain.explanation import Explanation
from refdof.explain.linear import explain_linear
from refdof.explain.pictures import Pictures, run

__all__ = ["explain"]


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every splat."""
    found, (x, y) = explain_linear("scatter", given, params, pixel), pixel
    total = float(run("scatter", given, params, True)[1]["shares"][y, x])
    left = found.column("weight") * total
    notes = [f"shares at the pixel add up to {total:.6g}, by which what it got is divided"]
    if params.order == "none":
        notes.append("share: the part of the splat's light that falls on the pixel, covered area over pi coc^2")
    else:
        notes.append("share: the part of the splat's light that nearer splats leave visible")
    return replace(
        found,
        what="splats: pixels of the pinhole picture whose discs reach the pixel, as the method gives them for a single "
        "pixel of colour 1",
        columns=(*found.columns[:-1], "share", "weight"),
        rows=np.insert(found.rows, -1, left, axis=1),
        notes=tuple(notes),
    )
