"""Pyramidal: the picture is cut by depth into sub-images, each filled, blurred by a pyramid and laid over the next.

1. Choose sub-images whose blur doubles with their distance from focus        `_sides`
2. Remove what lies in front of a sub-image, and fill the holes               `refdof.methods.pyramidal.pyramid.filled`
3. Matte by depth: opacity ramps up, stays, ramps down                        `_matte`
4. Blur by as many pyramid levels as the sub-image is away from focus         `refdof.methods.pyramidal.pyramid.blurred`
5. Blend from far to near, and divide by opacity                              `_blur`

Stages: "coc" (H, W) px, "sub-image i" (H, W, 4) for i from the farthest to the nearest (negative: in front of focus):
premultiplied colour and opacity after the blur.

Departures from the paper
-------------------------
This is a **reconstruction**: the text of [1] was not at hand. What is known: the chain of steps; the matte, which [3]
takes over from it; and the reads of each step, which table 1 of [2] counts and which tell the filters (2 x 2 for
filling, 4 x 4 for blurring, bilinear on the way back). The rest is chosen:

- Sub-image i has the nominal radius 1.7 2^(|i| - 1) px, and i = 0 none. Borders lie half-way between. There are as many
  as the picture's circles of confusion need, and at least one; [2] had eight.
- Ramps are linear in the signed circle of confusion, thus in inverse depth, and not in depth.
- The ramps of sub-images -1 and 1 end in the focal plane, where the general rule would take them on to the other side:
  a blurred copy with opacity 1/2 would lie over all that is in focus, wherever anything stands in front of it.
- Filling goes up to a single texel. Levels start at the top left and round up: the picture of a mirrored scene is the
  mirrored picture only where sides are powers of two.
- The sum of all mattes at a pixel is 2 away from focus, as [2] complains of: colours are repeated in two sub-images.
  "Over" takes the nearer one first; the result is divided by opacity, without which blurred borders would be dark.

References
----------
.. [1] Kraus & Strengert (2007), Depth-of-Field Rendering by Pyramidal Image Processing, Computer Graphics Forum 26(3).
.. [2] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3), table 1.
.. [3] Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, Journal of WSCG 20.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_instance, as_integer
from refdof._jit import kernel, prange
from refdof.image.channels import joined
from refdof.methods._contract import LARGEST_RADIUS, Method
from refdof.methods._image_validation import as_images, within
from refdof.methods.pyramidal.pyramid import blurred, empty_levels, filled, level_count
from refdof.stages import Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


_FILL_DOWN, _FILL_UP, _BLUR_DOWN, _BLUR_UP = 4, 5, 16, 4  # reads per texel: [2], table 1
_CULL, _MATTE, _LAY = 1, 1, 1  # reads per pixel and sub-image: [2], table 1


@dataclass(frozen=True)
class Params:
    """What the sources leave open.

    Parameters
    ----------
    largest_side : int
        Sub-images on each side of the focal plane, at most; farther ones have the blur of the last. 1 .. 16.
    """

    largest_side: int = 8

    def __post_init__(self) -> None:
        object.__setattr__(self, "largest_side", as_integer("largest_side", self.largest_side, minimum=1, maximum=16))


def texture_reads(params: Params, width: int, height: int, largest: float = LARGEST_RADIUS) -> float:
    """Texture reads per pixel, for circles of up to `largest` [px] on both sides of the focal plane."""
    side = _side(largest, params)
    fills = _shares(width, height, level_count(width, height))
    return math.fsum(_units(fills, _shares(width, height, abs(i))) for i in range(-side, side + 1))


METHOD = Method(
    citation="kraus2007",
    source="after Kraus, Strengert 2007",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity"),
    texture_reads=texture_reads,
    kernel=(1.38, 1.0),
    known_defects=(
        "Away from focus every colour is repeated in two sub-images.",
        "The mirrored scene gives the mirrored picture only where sides are powers of two.",
    ),
    basis="reconstruction",
    tradeoff=("largest_side", (1, 2, 4, 8, 16)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    return _blur(view.pinhole().color, within(np.float32, view.coc_px()), params, recorder)


def blur(
    color: Float, depth: Float, coc: Float, params: Params = Params(), stages: bool | Stages = False
) -> Float | Staged:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only checked: circles of confusion have its order.
    coc : (H, W)
        Signed circle of confusion, radius [px].
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
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    color, _, coc = as_images(color, depth, coc)
    return recorder.answer(_blur(color, coc, params, recorder))


def _units(fill: Sequence[float], soften: Sequence[float]) -> float:
    """Reads per pixel of one sub-image; `fill` and `soften` are texels per pixel of each pyramid, level 0 first."""
    down, up = math.fsum(fill[1:]), math.fsum(fill[:-1])
    down_blur, up_blur = math.fsum(soften[1:]), math.fsum(soften[:-1])
    reads = (_FILL_DOWN * down, _FILL_UP * up, _BLUR_DOWN * down_blur, _BLUR_UP * up_blur)
    return math.fsum((*reads, _CULL, _MATTE, _LAY))


def _shares(width: int, height: int, levels: int) -> list[float]:
    """Texels per pixel of levels 0 .. `levels`, sides rounded up."""
    return [-(-width // 2**k) * -(-height // 2**k) / (width * height) for k in range(levels + 1)]


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    recorder.record("coc", lambda: coc)
    front, back = _side(-float(coc.min()), params), _side(float(coc.max()), params)
    scalar = color.dtype.type
    known_all, levels = joined(color, coc), empty_levels(color)
    out = np.zeros((*coc.shape, 4), dtype=color.dtype)
    for i in range(back, -front - 1, -1):
        corners = _corners(i, front, back)
        layer = filled(known_all, coc >= corners[0], levels)
        _matte(layer, *(scalar(corner) for corner in corners))
        layer = blurred(layer, abs(i), levels)
        recorder.record(f"sub-image {i}", lambda layer=layer: layer)  # type: ignore[misc]
        _lay_over(layer, out)
    return _without_opacity(out, color)


def _side(largest: float, params: Params) -> int:
    """Sub-images needed on a side whose largest circle is `largest` [px]."""
    i = 0
    while i < params.largest_side and largest > _border(i):
        i += 1
    return i


def _radius(i: int) -> float:
    """Nominal radius of sub-image i >= 0 [px]."""
    return 1.7 * 2.0 ** (i - 1) if i > 0 else 0.0


def _border(i: int) -> float:
    """Signed circle of confusion between sub-images i and i + 1 [px]."""
    return 0.5 * (_radius(i) + _radius(i + 1)) if i >= 0 else -_border(-i - 1)


def _corners(i: int, front: int, back: int) -> tuple[float, float, float, float]:
    """Circles where the matte of sub-image i starts, is full, starts to end, has ended [px]; infinite at the ends."""
    start, full = (_border(i - 2), _border(i - 1)) if i > -front else (-math.inf, -math.inf)
    end, last = (_border(i), _border(i + 1)) if i < back else (math.inf, math.inf)
    if i == 1:  # what is in focus is in no sub-image but its own
        start = 0.0
    if i == -1:
        last = 0.0
    return start, full, end, last


@kernel
def _matte(layer, start, full, end, last):
    """Turn circles of confusion into opacity, 0, a ramp, 1, a ramp, 0, and multiply the colour by it, in place."""
    zero, one = layer.dtype.type(0), layer.dtype.type(1)
    rises, falls = np.isfinite(start), np.isfinite(last)
    up, down = (full - start if rises else one), (last - end if falls else one)
    for y in prange(len(layer)):
        row = layer[y]
        for x in range(len(row)):
            circle, opacity = row[x, 3], one
            if rises:
                opacity = min(opacity, min(max((circle - start) / up, zero), one))
            if falls:
                opacity = min(opacity, min(max((last - circle) / down, zero), one))
            for c in range(3):
                row[x, c] *= opacity
            row[x, 3] = opacity


@kernel
def _lay_over(layer, out):
    """Lay (H, W, 4) over `out`, both with the colour multiplied by the opacity, in place."""
    one = out.dtype.type(1)
    for y in prange(len(out)):
        front, row = layer[y], out[y]
        for x in range(len(row)):
            rest = one - front[x, 3]
            for c in range(4):
                row[x, c] = front[x, c] + rest * row[x, c]


@kernel
def _without_opacity(laid, color):
    """Colour over opacity; `color` where there is none."""
    out = np.empty_like(color)
    for y in prange(len(laid)):
        row, kept, shown = laid[y], color[y], out[y]
        for x in range(len(row)):
            for c in range(3):
                shown[x, c] = row[x, c] / row[x, 3] if row[x, 3] > 0 else kept[x, c]
    return out
