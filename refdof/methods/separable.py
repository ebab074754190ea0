"""Separable: a horizontal and a vertical pass, each over the pixel's own circle of confusion.

1. Weigh neighbours in the row by overlap, brightness and leakage, and average   `_across`
2. The same down the column, on what the first pass left                         `_down`

Stages: "coc" (H, W) px, "across" (H, W, 3): the first pass.

Departures from the paper
-------------------------
This is a **reconstruction**: the text of [1] was not at hand, only its abstract, and what [2] says of it: two passes,
each of 2 r + 1 reads of a pixel's own radius r, the second one of colour and of the original depth. The rest is chosen:

- Overlap: a neighbour at distance d with radius r counts clamp(r - d, 0, 1); the pixel itself counts in full.
- Brightness: a disc of radius r has pi r^2 px^2; smaller than one pixel, it is no brighter.
- Leakage: what lies behind the pixel counts clamp(leakage r, 0, 1) of the pixel's own radius r: nothing for sharp ones.
- Pixels outside the picture do not count.

As [2] saw, the filter is not separable: what it does along x before y leaves traces.

References
----------
.. [1] Zhou, Chen & Pullen (2007), Accurate Depth of Field Simulation in Real Time, Computer Graphics Forum 26(1).
.. [2] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), table 1 and section 7.
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_instance, as_number
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods._contract import MEAN_RADIUS, Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.stages import Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


_LARGEST = 65536.0  # px: pi r^2 stays far from the ends of float32


@dataclass(frozen=True)
class Params:
    """What the sources leave open.

    Parameters
    ----------
    leakage : float >= 0
        How much of what lies behind enters a pixel, per pixel of its radius, at most 1.
    """

    leakage: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "leakage", as_number("leakage", self.leakage, minimum=0.0, maximum=1e6))


def texture_reads(params: Params, width: int, height: int, mean: float = MEAN_RADIUS) -> float:
    """Texture reads per pixel, for a mean radius of `mean` [px], each rounded up: one across, two down at every tap."""
    return (1 + 2) * (2.0 * mean + 1.0)


METHOD = Method(
    citation="zhou2007",
    source="after Zhou, Chen, Pullen 2007",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry"),
    texture_reads=texture_reads,
    kernel=(1.08, 1.0),
    known_defects=("The filter is not separable: what it does along x before y leaves traces.",),
    basis="reconstruction",
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
        Linear RGB; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only its order counts.
    coc : (H, W)
        Signed circle of confusion, radius [px]; cut at 65536 px.
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
    Costs two passes of as many taps as the largest circle of each row is wide.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    depth = depth_in_range(color.dtype.type, depth)
    scalar = color.dtype.type
    radius = np.minimum(np.abs(coc), scalar(_LARGEST))
    light = scalar(1) / np.maximum(scalar(1), scalar(math.pi) * radius * radius)
    leak = np.minimum(scalar(params.leakage) * radius, scalar(1))
    planes = np.ascontiguousarray(np.moveaxis(color, -1, 0))
    across = _across(planes, depth, radius, light, leak)
    recorder.record("coc", lambda: coc)
    recorder.record("across", lambda: np.moveaxis(across, 0, -1))
    return np.ascontiguousarray(np.moveaxis(_down(across, depth, radius, light, leak), 0, -1))


@kernel
def _across(planes, depth, radius, light, leak):
    """Weighted means along rows: planes (3, H, W) -> (3, H, W); taps outside, pixels of a row inside."""
    height, width = depth.shape
    out = np.empty_like(planes)
    for y in prange(height):
        color, d, r, i, k = borrow(planes)[:, y], depth[y], radius[y], light[y], leak[y]
        sums, total = np.zeros((3, width), dtype=planes.dtype), np.zeros(width, dtype=planes.dtype)
        weight = np.empty(width, dtype=planes.dtype)
        reach = min(int(np.ceil(r.max())), width - 1)
        for step in range(-reach, reach + 1):
            first, end = max(0, -step), min(width, width - step)
            here, there = slice(first, end), slice(first + step, end + step)
            w = weight[here]
            _weigh(abs(step), d[there], r[there], i[there], d[here], r[here], k[here], w)
            for c in range(3):
                _add(color[c][there], w, sums[c][here])
            _count(w, total[here])
        for c in range(3):
            for x in range(width):
                out[c, y, x] = sums[c, x] / total[x]
    return out


@kernel
def _down(planes, depth, radius, light, leak):
    """Weighted means along columns: as `_across`, with whole rows as taps."""
    height, width = depth.shape
    out = np.empty_like(planes)
    for y in prange(height):
        color, depths, radii, lights = borrow(planes), borrow(depth), borrow(radius), borrow(light)
        d, r, k = depth[y], radius[y], leak[y]
        sums, total = np.zeros((3, width), dtype=planes.dtype), np.zeros(width, dtype=planes.dtype)
        weight = np.empty(width, dtype=planes.dtype)
        reach = int(np.ceil(r.max()))
        for row in range(max(0, y - reach), min(height, y + reach + 1)):
            _weigh(abs(row - y), depths[row], radii[row], lights[row], d, r, k, weight)
            for c in range(3):
                _add(color[c, row], weight, sums[c])
            _count(weight, total)
        for c in range(3):
            for x in range(width):
                out[c, y, x] = sums[c, x] / total[x]
    return out


@inline
def _weigh(distance, depth, radius, light, pixel_depth, pixel_radius, pixel_leak, out):
    """Overlap, brightness and leakage of one tap for a row of pixels."""
    zero, one, step = out.dtype.type(0), out.dtype.type(1), out.dtype.type(distance)
    for x in range(len(out)):
        overlap = min(max(radius[x] - step, zero), one) if step > zero else one
        reached = one if pixel_radius[x] > step - one else zero  # ceil(own radius) >= step
        out[x] = overlap * reached * light[x] * (one if depth[x] <= pixel_depth[x] else pixel_leak[x])


@inline
def _add(color, weight, sums):
    for x in range(len(sums)):
        sums[x] += weight[x] * color[x]


@inline
def _count(weight, total):
    for x in range(len(total)):
        total[x] += weight[x]
