"""Reads: what pixels read of a picture's texels at the places of all taps."""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.samples import Samples

__all__ = ["Spots", "pixels_of", "read", "spots_of"]


class Spots(NamedTuple):
    """Texels x, y right and down of the pixel, and shares of the next ones, (N,) each; no shares: the nearest texel."""

    x: Index
    y: Index
    right: Float | None
    down: Float | None


def pixels_of(samples: Samples, model: Model) -> tuple[Index, Index]:
    """The pixels for which a port ran the loop, x and y (P,), to give what stands at the samples."""
    x, y = samples.x - model.image_shift[0], samples.y - model.image_shift[1]
    x, y = x % samples.width, y % samples.height
    x = samples.width - 1 - x if "x" in model.flip else x
    y = samples.height - 1 - y if "y" in model.flip else y
    return (x - x % 2, y - y % 2) if model.half else (x, y)


def spots_of(places: Float, kind: str) -> Spots:
    """Texels and shares for places (N, 2) [px from the pixel's centre] and a filter."""
    x, y = places[:, 0], places[:, 1]
    if kind == "nearest":
        return Spots(np.floor(x + 0.5).astype(np.int64), np.floor(y + 0.5).astype(np.int64), None, None)
    left, top = np.floor(x), np.floor(y)
    right = np.zeros_like(x) if kind == "bilinear_y" else x - left
    down = np.zeros_like(y) if kind == "bilinear_x" else y - top
    return Spots(left.astype(np.int64), top.astype(np.int64), right, down)


def read(samples: Samples, texels: Float, x: Index, y: Index, spots: Spots, border: str) -> Float:
    """Read texels (T,) or (T, C) at all spots of all pixels: (P, N) or (P, N, C)."""
    if border == "black":
        texels = np.concatenate([texels, np.zeros_like(texels[:1])])
    steps = (0,) if spots.right is None else (0, 1)
    columns = [_within(x[:, None] + (spots.x + step), samples.width, border) for step in steps]
    rows = [_within(y[:, None] + (spots.y + step), samples.height, border) for step in steps]

    def texel(row: Index, column: Index) -> Float:
        place = row * samples.width + column
        if border == "black":
            place = np.where((row < 0) | (column < 0), len(texels) - 1, place)
        return texels.take(place, axis=0)

    if spots.right is None or spots.down is None:
        return texel(rows[0], columns[0])
    right, down = (_as(texels, share) for share in (spots.right, spots.down))
    first, second = (texel(row, columns[0]) * (1.0 - right) + texel(row, columns[1]) * right for row in rows)
    return first * (1.0 - down) + second * down


def _as(texels: Float, share: Float) -> Float:
    """Shares (N,) of the texels' type, for one or several channels."""
    share = share.astype(texels.dtype)
    return share if texels.ndim == 1 else share[:, None]


def _within(index: Index, count: int, border: str) -> Index:
    """Indices of texels that stand for those beyond the border; -1 for black."""
    if border == "repeat":
        return index % count
    if border == "mirror":
        folded = index % (2 * count)
        return np.minimum(folded, 2 * count - 1 - folded)
    if border == "black":
        return np.where((index >= 0) & (index < count), index, -1)
    return np.minimum(np.maximum(index, 0), count - 1)
