"""NAME: every pixel becomes the mean of the pixels in its own circle of confusion.

1. Cut circles of confusion at the largest that is allowed                   `_blur`
2. Average the pixels whose centres are in the circle                        `_gather`

Stages: "coc" (H, W) px, "radius" (H, W) px.

Departures from the paper
-------------------------
- None yet. One line for every step that the paper leaves open or gets wrong.

References
----------
.. [1] Author (2026), Title.
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_instance, as_number
from refdof._jit import kernel, prange
from refdof.methods._contract import MEAN_RADIUS, Method
from refdof.methods._image_validation import as_images, within
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


@dataclass(frozen=True)
class Params:
    """What the paper leaves open.

    Parameters
    ----------
    largest_px : float
        Circles of confusion are cut at this radius [px], 0 .. 1024; it bounds the cost.
    """

    largest_px: float = 64.0

    def __post_init__(self) -> None:
        largest = as_number("largest_px", self.largest_px, minimum=0.0, maximum=1024.0)
        object.__setattr__(self, "largest_px", largest)


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel, for circles of the mean size: one for every pixel in it."""
    return math.pi * min(MEAN_RADIUS, params.largest_px) ** 2


METHOD = Method(
    citation="NAME",
    source="Author 2026",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry"),
    texture_reads=texture_reads,
    known_defects=("Energy is not kept: a pixel averages over its own circle, whatever its neighbours' are.",),
    paper={},
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    return _blur(view.pinhole().color, within(np.float32, view.coc_px()), params, recorder)


def blur(color: Float, depth: Float, coc: Float, params: Params = Params()) -> Float:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only checked.
    coc : (H, W)
        Signed circle of confusion, radius [px].
    params : Params

    Returns
    -------
    (H, W, 3) of the type of `color`.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.

    Notes
    -----
    Costs O(H W r^2) for circles of radius r.
    """
    as_instance("params", params, Params)
    color, depth, coc = as_images(color, depth, coc)
    return _blur(color, coc, params, StageRecorder())


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    radius = np.minimum(np.abs(coc).astype(np.float64), params.largest_px)
    recorder.record("coc", lambda: coc)
    recorder.record("radius", lambda: radius)
    return _gather(color, radius)


@kernel
def _gather(color, radius):
    """Average each pixel's circle: color (H, W, 3), radius (H, W) px -> (H, W, 3). Sums are float64."""
    height, width, _ = color.shape
    out = np.empty_like(color)
    for y in prange(height):
        for x in range(width):
            r = radius[y, x]
            reach = int(r)
            red, green, blue, count = 0.0, 0.0, 0.0, 0
            for j in range(max(0, y - reach), min(height, y + reach + 1)):
                for i in range(max(0, x - reach), min(width, x + reach + 1)):
                    if (i - x) ** 2 + (j - y) ** 2 <= r * r:
                        red += color[j, i, 0]
                        green += color[j, i, 1]
                        blue += color[j, i, 2]
                        count += 1
            out[y, x, 0] = red / count
            out[y, x, 1] = green / count
            out[y, x, 2] = blue / count
    return out
