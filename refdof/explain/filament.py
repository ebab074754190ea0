"""Filament: the sharp pixel, and the texels over it; of the nearest one the nine of its median, and what it gathers."""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation, Part
from refdof.explain.half_size import Texels, around, explained, nine
from refdof.explain.impulses import weights_of
from refdof.explain.linear import begin
from refdof.explain.pictures import Pictures
from refdof.methods.filament.combine import BLURRED_ALONE, NOT_BLURRED, OVER, sorts_of
from refdof.methods.filament.gather import gather
from refdof.methods.filament.half import TILE, half_of, noise
from refdof.raster.filters.tiles import Tiles

__all__ = ["explain"]

_SORTS = {
    NOT_BLURRED: "nothing around is blurred: the sharp pixel alone",
    OVER: "the blurred picture, over the sharp one by its alpha",
    BLURRED_ALONE: "all around is blurred alike: the blurred picture alone",
}


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every texel that is laid over the pixel; of the nearest one every texel of the levels that it gathers."""
    begun, (x, y) = begin("filament", given, params, pixel), pixel
    stages, tile = begun.stages, (y // (2 * TILE), x // (2 * TILE))
    tiles = Tiles(stages["least"], stages["greatest"])
    least, greatest, sort = float(tiles.least[tile]), float(tiles.greatest[tile]), int(sorts_of(tiles)[tile])
    place, texel_px = ((x + 0.5) / 2.0, (y + 0.5) / 2.0), (2.0, 2.0)
    notes: tuple[str, ...] = (f"circles of the tile and those around: {least:.6g} .. {greatest:.6g} px", _SORTS[sort])
    if sort == NOT_BLURRED:
        return explained(begun, [], 1.0, notes, [], texel_px)
    texels = around(stages["median"], place)
    sharp = 0.0 if sort == BLURRED_ALONE else 1.0 - float(texels.mean[3])
    texel = int(place[0]), int(place[1])
    parts = [nine(stages["gathered"], texel, "alpha"), _gathered(given, params, texel)]
    notes = (*notes, "colours of the nine are times alpha")
    alpha = texels.values[:, 3:]
    plain = Texels(*texels[:3], texels.values[:, :3] / np.where(alpha == 0.0, 1.0, alpha))
    return explained(begun, [(plain, texels.weights * alpha[:, 0])], sharp, notes, parts, texel_px)


def _gathered(given: Pictures, params: Any, texel: tuple[int, int]) -> Part:
    """Texels of the halved picture's levels that add up to a texel (column, row), before the median."""
    (column, row), half = texel, half_of(given.color, given.coc, params.largest_px)
    height, width = half.finest.shape[:2]
    moved = noise(height, width, given.color.dtype)
    least, greatest = (np.zeros_like(side) for side in half.tiles)  # other tiles do nothing
    tile = row // TILE, column // TILE
    least[tile], greatest[tile] = half.tiles.least[tile], half.tiles.greatest[tile]

    def respond(color: Float) -> Float:
        texels = half.texels.copy()
        texels[:, :3] = color
        return gather(texels, half.places, least, greatest, moved, params.rings)[row, column, :3][None]

    found, weights = weights_of(respond, half.texels.shape[:1], given.color.dtype.type)
    level = np.searchsorted(half.starts, found[:, 0], side="right") - 1
    within = found[:, 0] - half.starts[level]
    rows = np.column_stack(
        [level, within % half.widths[level], within // half.widths[level], half.texels[found[:, 0]], weights]
    ).astype(np.float64)
    title = f"texels of the halved picture's levels that add up to the texel {column},{row}, times alpha"
    return Part(title, ("level", "column", "row", *COLOR, "coc", "weight"), rows)
