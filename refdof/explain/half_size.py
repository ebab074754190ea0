"""Half size: methods that blur at half the size, explained by what the last pass lays over each other.

Rows are the pixel of the sharp picture, layer 0, and the four texels around of each blurred picture, with the weights
that the method's last pass gives them. How the nearest of these texels came about is in further tables.

1. Read the four texels around a place                                   `around`
2. Values of which the median is a texel                                 `nine`
3. A texel of a stage that is linear in colour: its pixels               `pixels_of`
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation, Part
from refdof.explain.linear import SOURCE_COLUMNS, Begun, sources, weigh
from refdof.explain.pictures import Pictures

__all__ = ["Texels", "around", "explained", "nine", "pixels_of", "read"]

_COLUMNS = ("layer", "column", "row", "x", "y", *COLOR, "weight")
_WHAT = "layer 0: the sharp pixel; others: the four texels around of what was blurred at half the size"


class Texels(NamedTuple):
    """The four texels around a place: columns and rows (4,), weights (4,), and values (4, C)."""

    columns: Any
    rows: Any
    weights: Float
    values: Float

    @property
    def mean(self) -> Float:
        """What is read at the place."""
        return self.weights @ self.values


def around(picture: Float, place: Sequence[float]) -> Texels:
    """Around a place, column and row [texels from the corner] of a picture (h, w, C); beyond the edge it repeats."""
    sides = []
    for at, size in zip(place, (picture.shape[1], picture.shape[0]), strict=True):
        centred = min(max(at - 0.5, 0.0), size - 1.0)
        first = int(centred)
        sides.append((np.array([first, min(first + 1, size - 1)]), np.array([1.0 - centred + first, centred - first])))
    (columns, across), (rows, down) = sides
    columns, rows = np.tile(columns, 2), rows.repeat(2)
    return Texels(columns, rows, np.outer(down, across).ravel(), picture[rows, columns].astype(np.float64))


def read(picture: Float, places: Float) -> Float:
    """A picture at places (N, 2), as `around`: (N, C)."""
    return np.array([around(picture, place).mean for place in places])


def explained(
    begun: Begun,
    layers: Sequence[tuple[Texels, Float]],
    sharp: float,
    notes: tuple[str, ...],
    parts: Sequence[Part],
    texel_px: tuple[float, float],
) -> Explanation:
    """A pixel by the weight of the sharp one, and of the texels of layers, which are so wide and high [px].

    layers : texels, whose first three values are a colour, and their weights (4,)
    """
    x, y = begun.about["pixel"]
    rows = [(0, x, y, x + 0.5, y + 0.5, *begun.about["picture"][y, x], sharp)]
    for number, (texels, weights) in enumerate(layers, 1):
        for column, row, color, weight in zip(texels.columns, texels.rows, texels.values[:, :3], weights, strict=True):
            place = (column + 0.5) * texel_px[0], (row + 0.5) * texel_px[1]
            rows.append((number, column, row, *place, *color, weight))
    kept = [row for row in rows if row[-1] != 0.0 or row[0] == 0]
    table = np.array(kept, dtype=np.float64)
    return Explanation(**begun.about, what=_WHAT, columns=_COLUMNS, rows=table, notes=notes, parts=tuple(parts))


def nine(picture: Float, texel: tuple[int, int], last: str) -> Part:
    """The nine texels around one (column, row) of a picture (h, w, 4), of which the medians become that texel."""
    (column, row), (height, width) = texel, picture.shape[:2]
    rows = []
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            at = min(max(column + i, 0), width - 1), min(max(row + j, 0), height - 1)
            rows.append((*at, *picture[at[1], at[0]]))
    title = f"nine texels, of which the medians, each channel apart, are the texel {column},{row}"
    return Part(title, ("column", "row", *COLOR, last), np.array(rows, dtype=np.float64))


def pixels_of(method: str, given: Pictures, params: Any, stage: str, texel: tuple[int, int]) -> Part:
    """Pixels of the pinhole picture that add up to a texel (column, row) of a stage that is linear in colour."""
    column, row = texel

    def answer(_: Float, recorded: dict[str, Float]) -> list[Float]:
        return [recorded[stage][row, column, :3]]

    places, weights = weigh(method, given, params, answer, True)
    rows = np.column_stack([sources(given, places), weights])
    title = f"pixels of the pinhole picture that add up to the texel {column},{row} of the stage {stage}"
    return Part(title, (*SOURCE_COLUMNS, "weight"), rows)
