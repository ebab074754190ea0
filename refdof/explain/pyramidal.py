"""Pyramidal: the weight of every pixel in each sub-image, and how much of each sub-image is seen.

Sub-images are laid over each other from the farthest to the nearest, and what they show is divided by their opacity.
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import Explanation, Part
from refdof.explain.linear import SOURCE_COLUMNS, begin, sources, weigh
from refdof.explain.pictures import Pictures

__all__ = ["explain"]

_WHAT = (
    "pixels of the pinhole picture in each sub-image: in it, their weight after filling, matte and |sub-image| levels "
    "of the pyramid, as the method gives it for a single pixel of colour 1"
)


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every pixel of every sub-image."""
    begun, (x, y) = begin("pyramidal", given, params, pixel), pixel
    names = [name for name in begun.stages if name.startswith("sub-image ")]  # from far to near
    numbers = np.array([int(name.split()[1]) for name in names])
    opacity = np.array([begun.stages[name][y, x, 3] for name in names], dtype=np.float64)
    seen = np.cumprod(np.append(1.0, 1.0 - opacity[::-1]))[:-1][::-1]
    total = float((seen * opacity).sum())
    layers = Part(
        "sub-images, from far to near: pyramid levels, opacity, what nearer ones leave visible, share of the pixel",
        ("sub_image", "levels", "opacity", "visible", "share"),
        np.column_stack([numbers, np.abs(numbers), opacity, seen, seen * opacity / max(total, 1e-300)]),
    )
    columns = ("sub_image", *SOURCE_COLUMNS, "in_it", "weight")
    if total == 0.0:
        rows = np.column_stack([np.nan, sources(given, np.array([[y, x]])), np.nan, 1.0])
        notes = ("no sub-image has any opacity here: the pixel keeps its colour",)
        return Explanation(**begun.about, what=_WHAT, columns=columns, rows=rows, notes=notes, parts=(layers,))

    def answer(image: Float, stages: dict[str, Float]) -> list[Float]:
        return [image[y, x], *(stages[name][y, x, :3] for name in names)]

    places, weights = weigh("pyramidal", given, params, answer, True)
    about, tables = sources(given, places), []
    for k, number in enumerate(numbers):
        inside = weights[:, k + 1]
        table = np.column_stack([np.full(len(places), number), about, inside, inside * seen[k] / total])
        tables.append(table[inside > 0.0])
    notes = (f"the sub-images' opacity adds up to {total:.6g}, by which what they show is divided",)
    rows = np.concatenate(tables)
    return Explanation(**begun.about, what=_WHAT, columns=columns, rows=rows, notes=notes, parts=(layers,))
