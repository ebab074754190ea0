"""Single pass: its taps, as its stage "probes" has them, with the weight that each has left when the loop ends.

The listing adds a tap by color += mix(color / tot, tap, m). What a tap leaves in the running sum grows by
1 + (1 - m) / tot with every later tap; the sum is divided by tot at the end.
"""

from typing import Any

import numpy as np

from refdof._check import Float
from refdof.explain.explanation import COLOR, Explanation
from refdof.explain.linear import begin
from refdof.explain.pictures import Pictures
from refdof.stages import Stages

__all__ = ["explain", "explain_mean"]

_COLUMNS = ("tap", "x", "y", "depth", *COLOR, "size", "reach", "m", "sum_red", "sum_green", "sum_blue", "tot", "weight")
_WHAT = "taps of the loop, from the stage `probes`; tap 0 is the pixel itself"


def explain(given: Pictures, params: Any, pixel: tuple[int, int]) -> Explanation:
    """Every tap of a pixel."""
    return explain_mean(given, params, pixel, None)


def explain_mean(given: Pictures, params: Any, pixel: tuple[int, int], count: int | None) -> Explanation:
    """Every tap of a pixel after `count` taps, the stage "mean"; None: after all, the picture."""
    wanted = Stages(() if count is None else (count,), (pixel,))
    begun = begin("singlepass", given, params, pixel, wanted, "image" if count is None else f"mean {count}")
    probes = begun.stages["probes"][0][: None if count is None else count + 1]
    rows = np.column_stack([np.arange(len(probes)), probes, _left_weights(probes[:, 8])])
    limit, x, y = float(begun.stages["limit"][pixel[1], pixel[0]]), *pixel
    size = float(begun.stages["size"][y, x])
    notes = (
        f"size of the pixel: {size:.6g} px; taps from behind are cut at {limit:.6g} px",
        "m is the listing's smoothstep(radius - 0.5, radius + 0.5, reach); sums and tot are its color and tot",
    )
    return Explanation(**begun.about, what=_WHAT, columns=_COLUMNS, rows=rows, notes=notes)


def _left_weights(cover: Float) -> Float:
    """Weights (N + 1,) in the end of taps that cover (N + 1,) of the pixel; the pixel itself is first."""
    weights, later = np.empty(len(cover)), 1.0 / len(cover)
    for k in range(len(cover) - 1, -1, -1):
        weights[k] = cover[k] * later
        later *= 1.0 + (1.0 - cover[k]) / max(k, 1)
    return weights
