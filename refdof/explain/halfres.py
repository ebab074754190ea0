"""Halfres: the sharp pixel, and the texels of the far and the near picture over it; of what these are the greatest."""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation, Part
from refdof.explain.half_size import around, explained, pixels_of, read
from refdof.explain.linear import begin
from refdof.explain.pictures import Pictures
from refdof.methods.halfres.circles import circles_of, kept_shares
from refdof.methods.halfres.params import Params, points

__all__ = ["explain"]


def explain(given: Pictures, params: Params, pixel: tuple[int, int]) -> Explanation:
    """Every texel that is laid over the pixel; of the nearest ones every read and every pixel."""
    begun, (x, y) = begin("halfres", given, params, pixel), pixel
    stages, (width, height) = begun.stages, given.size
    rows, columns = stages["far_half"].shape
    place = (x + 0.5) * columns / width, (y + 0.5) * rows / height
    far, near = (around(stages[f"{name}_brightest"], place) for name in ("far", "near"))
    added = params.variant == "pmndrs"
    behind, before = (
        _kept(given, params, pixel) if added else (2.0 * min(texels.mean[3], 0.5) for texels in (far, near))
    )
    layers = [(far, far.weights * (1.0 if added else behind) * (1.0 - before)), (near, near.weights * before)]
    texel, parts = (int(place[0]), int(place[1])), []
    for name, share in (("far", behind), ("near", before)):
        if share > 0.0:
            parts.append(_greatest(stages, name, texel, params, (columns / width, rows / height)))
            parts.append(pixels_of("halfres", given, params, f"{name}_mean", texel))
    notes = (f"the far picture replaces {behind:.6g} of the pixel, the near one then {before:.6g}",)
    sharp = (1.0 - behind) * (1.0 - before)
    return explained(begun, layers, sharp, notes, parts, (width / columns, height / rows))


def _kept(given: Pictures, params: Any, pixel: tuple[int, int]) -> tuple[float, float]:
    """How much far and near picture replace, where the far one is added."""
    x, y = pixel
    behind, before = kept_shares(circles_of(given.depth, given.coc, params), params.largest_px)[:, y, x]
    return float(behind), float(before)


def _greatest(
    stages: dict[str, Float], name: str, texel: tuple[int, int], params: Params, scale: tuple[float, float]
) -> Part:
    """Reads of the mean of which the greatest, each channel apart, is the texel."""
    (column, row), mean = texel, stages[f"{name}_mean"]
    circle = float(mean[row, column, 3])
    table = np.concatenate([[[0.0, 0.0]], points()[1]]) * (params.largest_px * circle) * scale
    places = table + np.array([column + 0.5, row + 0.5])
    values = read(mean, places)[:, :3]
    rows = np.column_stack([np.arange(len(places)), places / scale, values])
    title = f"reads of the {name} mean, of which the greatest, each channel apart, are the texel {column},{row}"
    return Part(title, ("tap", "x", "y", *COLOR), rows)
