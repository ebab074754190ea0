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
from refdof._jit.texel_registers import add_share, lay_share
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.methods.scatter.disc import LARGEST_DISC, covered_in_row, inner_count, outer_count, start_of_arc
from refdof.stages import Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


_BAND = 64  # rows
_KEPT = 64  # px, reach of the largest disc whose shares are kept for the next, which may be as large
_KEPT_ROW = 2 * (_KEPT + 2)  # of such a disc


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
    kernel=(1.0, 1.0),
    known_defects=("There is no order in depth: what lies behind spreads over what is in front of it.",),
    basis="reconstruction",
    tradeoff=("order", ("none", "far_to_near")),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, pinhole.depth, coc, params, recorder)


def blur(
    color: Float, depth: Float, coc: Float, params: Params = Params(), stages: bool | Stages = False
) -> Float | Staged:
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
    stages : bool or refdof.Stages
        Record stages, too. It has neither steps nor probes.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0.

    Notes
    -----
    Costs O(H W r^2) for circles of radius r. Energy is kept where all circles are alike, away from the border.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    depth = depth_in_range(color.dtype.type, depth)
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
    # A disc's rows would meet in the same lines of the cache if rows began a multiple of 4096 bytes apart.
    sums = np.zeros((height, width + (10 - width) % 128, 4), dtype=np.float64)
    for band in prange((height + _BAND - 1) // _BAND):
        colors, out, centre, ys, rs = borrow(color), borrow(sums), borrow(places), borrow(rows), borrow(radii)
        first, end = band * _BAND, min((band + 1) * _BAND, height)
        size, disc, last = max(width, _KEPT + 2), -1, -1.0
        arcs, disc_of_arc, areas = np.zeros(size), np.full(size, -1), np.zeros(size)
        shares, outers, disc_of_row = (
            np.zeros(max((_KEPT + 1) * _KEPT_ROW, 2 * size)),
            np.zeros(_KEPT + 1, np.int64),
            np.full(_KEPT + 1, -1),
        )
        for k in range(len(ys)):
            y, r = np.int64(ys[k]), rs[k]
            reach = int(np.floor(r + 0.5))
            if y + reach < first or y - reach >= end:
                continue
            if r != last:
                disc, last = k, r
            x = centre[k] - y * width
            even = 1.0 / (math.pi * r * r) if reach > 0 else 1.0
            tint = np.float64(colors[y, x, 0]), np.float64(colors[y, x, 1]), np.float64(colors[y, x, 2])
            low, row_of_low, widest = (0.0, 0.0), -1, max(x, width - 1 - x) + 1
            # Rows j above and below the centre are alike, and those of the next disc, if it is as large.
            for j in range(max(first - y, y - end + 1, 0), min(max(y - first, end - 1 - y), reach) + 1):
                n = j if reach <= _KEPT else 0
                middle = n * _KEPT_ROW + _KEPT_ROW // 2 if reach <= _KEPT else size
                if reach == 0:
                    shares[middle], outers[n], disc_of_row[n] = 1.0, 1, disc
                elif reach > _KEPT or disc_of_row[n] != disc:
                    if row_of_low != j:
                        low = start_of_arc(max(j - 0.5, 0.0), r)
                    inner, outer, high = inner_count(j, r), outer_count(j, r), start_of_arc(j + 0.5, r)
                    outer = outer if reach <= _KEPT else min(outer, widest)
                    covered_in_row(j, r, inner, outer, low, high, disc, arcs, disc_of_arc, areas)
                    _spread_row(even, min(inner, outer), outer, areas, shares, middle)
                    low, row_of_low = high, j + 1
                    outers[n], disc_of_row[n] = outer, disc
                _share_rows(out, (first, end), width, x, y, j, outers[n], shares, middle, tint, over)
    return sums[:, :width]


@inline
def _spread_row(even, inner, outer, areas, shares, middle):
    """Write a row's shares around `middle`: pixels up to inner - 1 are covered, those up to outer - 1 in part."""
    for i in range(middle - inner + 1, middle + inner):
        shares[i] = even
    for i in range(inner, outer):
        share = even * areas[i]
        shares[middle - i], shares[middle + i] = share, share


@inline
def _share_rows(out, band, width, x, y, j, outer, shares, middle, tint, over):
    """Add a disc's shares of the rows j above and below its centre (x, y), as far as they lie in the band."""
    begin, end = max(x - outer + 1, 0), min(x + outer, width)
    row_shares = shares[middle + begin - x : middle + end - x]
    for side in range(2 if j > 0 else 1):
        row = y + j if side == 0 else y - j
        if row >= band[0] and row < band[1]:
            line = out[row, begin:end]
            for i in range(len(row_shares)):
                _add(line, i, tint, row_shares[i], over)


@inline
def _add(line, i, tint, share, over):
    """Add a share of a colour to pixel i of a line, or blend it over what is there."""
    red, green, blue = tint
    if over:
        lay_share(line, i, (red, green, blue, 1.0), share)
    else:
        add_share(line, i, (red, green, blue, 1.0), share)
