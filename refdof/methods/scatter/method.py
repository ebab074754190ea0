"""Scatter: every pixel spreads its colour evenly over its circle of confusion.

1. Find every pixel's circle of confusion                                     `refdof.optics.lens`
2. Share each pixel among those that its disc covers, by covered area         `_scatter`, `refdof.methods.scatter.disc`
3. Divide what a pixel got by the sum of its shares                           `_scatter`

Stages: "coc" (H, W) px, "shares" (H, W), what each pixel's shares add up to.

Departures from the paper
-------------------------
This is a **reconstruction**: the text of [1] was not at hand, only what [2] and others say of it.

- The spread is even over the disc; the paper also takes the diffraction pattern of Lommel.
- The paper has no order in depth, and neither has the default. Later descriptions [2] blend discs from far to near,
  each with its share as opacity, and normalise what comes out: `order`.
- Every band of rows is written by one thread, which meets all pixels that reach it: the same sums on any thread count.
- Sums are taken in float64.

References
----------
.. [1] Potmesil & Chakravarty (1981), A Lens and Aperture Camera Model for Synthetic Image Generation, SIGGRAPH.
.. [2] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), section 2.2.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index, as_choice, as_instance
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.methods.scatter.disc import LARGEST_DISC, covered_in_row, inner_count, outer_count, start_of_arc
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


_BAND = 64  # rows


@dataclass(frozen=True)
class Params:
    """What the paper leaves open.

    Parameters
    ----------
    order : "none" or "far_to_near"
        Add up all discs that cover a pixel, or blend each over those behind it.
    """

    order: str = "none"

    def __post_init__(self) -> None:
        as_choice("order", self.order, ("none", "far_to_near"))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: each is read once. What costs are the writes, pi r^2 of them."""
    return 1.0


METHOD = Method(
    citation="potmesil1981",
    source="after Potmesil, Chakravarty 1981",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry"),
    texture_reads=texture_reads,
    known_defects=("There is no order in depth: what lies behind spreads over what is in front of it.",),
    reconstruction=True,
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, depth_in_range(pinhole.depth), coc, params, recorder)


def blur(color: Float, depth: Float, coc: Float, params: Params = Params()) -> Float:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Its order counts where `order` is "far_to_near".
    coc : (H, W)
        Signed circle of confusion, **radius** [px]; the paper's is a diameter. Cut at 65536 px.
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
    Costs O(H W r^2) for circles of radius r. Energy is kept where all circles are alike, away from the border.
    """
    return _blur(*as_images(color, depth, coc), as_instance("params", params, Params), StageRecorder())


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    radius = np.minimum(np.abs(coc).astype(np.float64), LARGEST_DISC)
    if params.order == "none":
        order = np.arange(depth.size)
    else:
        order = np.argsort(-depth, axis=None, kind="stable")
    rows = (order // depth.shape[1]).astype(np.int32)
    sums = _scatter(color, Discs(order, rows, radius.ravel()[order]), params.order != "none")
    recorder.record("coc", lambda: coc)
    recorder.record("shares", lambda: sums[..., 3])
    return (sums[..., :3] / sums[..., 3:]).astype(color.dtype)


class Discs(NamedTuple):
    """All pixels in the order in which they are shared: place in the flattened picture, row, radius [px]; (H W,)."""

    place: Index
    row: Index
    radius: Float


@kernel
def _scatter(color, discs, over):
    """Sums (H, W, 4) of shared colours and of shares."""
    height, width = color.shape[0], color.shape[1]
    places, rows, radii = discs.place, discs.row, discs.radius
    sums = np.zeros((height, width, 4), dtype=np.float64)
    for band in prange((height + _BAND - 1) // _BAND):
        colors, out, centre, ys, rs = borrow(color), borrow(sums), borrow(places), borrow(rows), borrow(radii)
        first, end = band * _BAND, min((band + 1) * _BAND, height)
        arcs, disc_of_arc, shares = np.zeros(width), np.full(width, -1), np.zeros(width)
        for k in range(len(ys)):
            y, r = np.int64(ys[k]), rs[k]
            reach = int(np.floor(r + 0.5))
            if y + reach < first or y - reach >= end:
                continue
            x = centre[k] - y * width
            red, green, blue = np.float64(colors[y, x, 0]), np.float64(colors[y, x, 1]), np.float64(colors[y, x, 2])
            even = 1.0 / (math.pi * r * r) if reach > 0 else 1.0
            widest = max(x, width - 1 - x) + 1
            # Rows j above and below the centre are alike.
            nearest = max(first - y, y - end + 1, 0)
            low = start_of_arc(max(nearest - 0.5, 0.0), r) if reach > 0 else (0.0, 0.0)
            for j in range(nearest, min(max(y - first, end - 1 - y), reach) + 1):
                inner, outer = inner_count(j, r), min(outer_count(j, r), widest)
                if reach > 0:
                    high = start_of_arc(j + 0.5, r)
                    covered_in_row(j, r, inner, outer, low, high, k, arcs, disc_of_arc, shares)
                    low = high
                else:
                    inner, outer = 1, 1
                for side in range(2 if j > 0 else 1):
                    row = y + j if side == 0 else y - j
                    if row < first or row >= end:
                        continue
                    for column in range(max(x - inner + 1, 0), min(x + inner, width)):
                        _add(out[row, column], red, green, blue, even, over)
                    for i in range(inner, outer):
                        if x + i < width:
                            _add(out[row, x + i], red, green, blue, even * shares[i], over)
                        if i > 0 and x - i >= 0:
                            _add(out[row, x - i], red, green, blue, even * shares[i], over)
    return sums


@inline
def _add(pixel, red, green, blue, share, over):
    """Add a share of a colour, or blend it over what is there."""
    kept = 1.0 - share if over else 1.0
    pixel[0] = pixel[0] * kept + red * share
    pixel[1] = pixel[1] * kept + green * share
    pixel[2] = pixel[2] * kept + blue * share
    pixel[3] = pixel[3] * kept + share
