"""Linear: single-image filters that are linear in colour, explained by the weight of every pixel of the picture.

1. Run the method for its picture and its stages            `begin`
2. Recover the weight of every pixel, by impulses           `weigh`
3. Put depth, circle and colour beside each                 `sources`
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.explain.explanation import COLOR, Explanation
from refdof.explain.impulses import weights_of
from refdof.explain.pictures import Pictures, run
from refdof.stages import Stages

__all__ = ["SOURCE_COLUMNS", "Begun", "begin", "explain_linear", "sources", "weigh"]

SOURCE_COLUMNS = ("x", "y", "depth", "coc", *COLOR)
_WHAT = "pixels of the pinhole picture; each weight is what the method gives for a single pixel of colour 1"

Answer = Callable[[Float, dict[str, Float]], Any]


class Begun(NamedTuple):
    """A run of a method, and what an explanation of pixel (x, y) has of it: `Explanation`'s first fields."""

    image: Float
    stages: dict[str, Float]
    about: dict[str, Any]


def begin(
    method: str,
    given: Pictures,
    params: Any,
    pixel: tuple[int, int],
    stages: bool | Stages = True,
    stage: str = "image",
) -> Begun:
    """Run the method, with its stages."""
    image, recorded = run(method, given, params, stages)
    x, y = pixel
    value = (image if stage == "image" else recorded[stage])[y, x][:3].astype(np.float64)
    about = {
        "method": method,
        "stage": stage,
        "pixel": pixel,
        "size": given.size,
        "value": value,
        "epsilon": float(np.finfo(image.dtype).eps),
        "picture": given.color,
    }
    return Begun(image, recorded, about)


def weigh(
    method: str, given: Pictures, params: Any, answer: Answer, stages: bool | Stages = False
) -> tuple[Index, Float]:
    """Places (N, 2), row and column, and weights (N, P) of all pixels with a part in the first answer.

    `answer`: a picture and stages -> (P, 3).
    """

    def respond(color: Float) -> Float:
        return np.asarray(answer(*run(method, given.with_color(color), params, stages)))

    return weights_of(respond, given.coc.shape, given.color.dtype.type)


def sources(given: Pictures, places: Index) -> Float:
    """`SOURCE_COLUMNS` of pixels (N, 2)."""
    rows, columns = places.T
    return np.column_stack(
        [columns + 0.5, rows + 0.5, given.depth[rows, columns], given.coc[rows, columns], given.color[rows, columns]]
    ).astype(np.float64)


def explain_linear(
    method: str,
    given: Pictures,
    params: Any,
    pixel: tuple[int, int],
    stage: str = "image",
    stages: bool | Stages = True,
    **more: Any,
) -> Explanation:
    """Explain a picture or a stage of it by the weights of the pinhole's pixels alone."""
    begun, (x, y) = begin(method, given, params, pixel, stages, stage), pixel

    def answer(image: Float, recorded: dict[str, Float]) -> list[Float]:
        return [(image if stage == "image" else recorded[stage])[y, x, :3]]

    places, weights = weigh(method, given, params, answer, stages if stage != "image" else False)
    rows = np.column_stack([sources(given, places), weights])
    return Explanation(**begun.about, what=_WHAT, columns=(*SOURCE_COLUMNS, "weight"), rows=rows, **more)
