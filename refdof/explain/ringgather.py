"""Ringgather: the sharp pixel, and the texels over it; of the nearest one the nine of its median, and its pixels."""

from typing import Any

import numpy as np

from refdof.explain.explanation import Explanation
from refdof.explain.half_size import around, explained, nine, pixels_of
from refdof.explain.linear import begin
from refdof.explain.pictures import Pictures
from refdof.methods.ringgather.params import TILE, from_working

__all__ = ["explain"]


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every texel that is laid over the pixel; of the nearest one every pixel, where colours are summed as given."""
    begun, (x, y) = begin("ringgather", given, params, pixel), pixel
    stages, (width, height) = begun.stages, given.size
    soft, tile = from_working(stages["median"].astype(np.float64), params.working), (y // TILE, x // TILE)
    place = (x + 0.5) * soft.shape[1] / width, (y + 0.5) * soft.shape[0] / height
    texels = around(soft, place)
    alpha, own, most = texels.mean[3], float(stages["circle"][y, x]), float(stages["greatest"][tile])
    behind = float(np.float32(given.depth[y, x])) - float(stages["nearest"][tile])
    near = min(max(1.0 - behind, 0.0), 1.0)
    reach = most * (1.0 - near) + own * near
    share = min(max(own * (1.0 - alpha) + reach * alpha, 0.0), 1.0)
    texel = int(place[0]), int(place[1])
    parts = [nine(stages["rings"], texel, "alpha")]
    if params.working == "linear":
        parts.append(pixels_of("ringgather", given, params, "rings", texel))
    notes = (
        f"circle of the pixel {own:.6g}, greatest around {most:.6g} px of half the size; {behind:.6g} behind the "
        f"nearest around; alpha {alpha:.6g}",
        f"the blurred picture replaces {share:.6g} of the pixel",
    )
    texel_px = width / soft.shape[1], height / soft.shape[0]
    return explained(begun, [(texels, texels.weights * share)], 1.0 - share, notes, parts, texel_px)
