"""Hexagon: means along three directions, two of them in one pass, make a hexagon of three rhombi; as in Bevy.

1. Turn circles of confusion into a number of steps                              `_steps`
2. Mean of the picture downwards, and of it up to the right; keep the first,
   and the mean of both                                                          `_first_pass`
3. Mean of the first up to the right, and of the other up to the left; the
   picture is the mean of these                                                  `_second_pass`

Stages: "coc" px, "steps", (H, W) each; "down" and "both", (H, W, 3) each.

Departures from the paper
-------------------------
- The engine is the source, and the post that it follows. The engine computes circles by a thin lens whose largest
  diameter is 64 px; refdof takes the picture's circles, and cuts them at the same size.
- A number of steps is half the diameter rounded, halves to even, as shading languages round where they say how.
- The engine means the two results of the first pass. So one rhombus weighs as much as the two others together.
  The post adds them, and divides by three in the end: `rhombi="equal"`.
- The post starts half a step from the pixel, so that the rhombi do not overlap. With equal rhombi, refdof does so, too;
  then as many steps are read as the radius has pixels, and a pixel without a step keeps its colour.

References
----------
.. [1] Bevy (2024), crates/bevy_post_process/src/dof/dof.wesl, Bokeh.
.. [2] Barre-Brisebois (2017), Hexagonal Bokeh Blur Revisited, colinbarrebrisebois.com.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, as_choice, as_instance, as_number
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods._contract import MEAN_RADIUS, Method
from refdof.methods._image_validation import as_images, within
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

_RIGHT, _UP = math.cos(math.radians(30.0)), -0.5  # up to the right, y down; up to the left is (-_RIGHT, _UP)


@dataclass(frozen=True)
class Params:
    """What ports change.

    Parameters
    ----------
    largest_px : float
        Circles of confusion are cut at this radius [px], 0 .. 1024; it bounds the cost. The engine's is 32.
    rhombi : {"engine", "equal"}
        "engine" weighs one rhombus twice, as Bevy does; "equal" is the post's form.
    """

    largest_px: float = 32.0
    rhombi: str = "engine"

    def __post_init__(self) -> None:
        largest = as_number("largest_px", self.largest_px, minimum=0.0, maximum=1024.0)
        object.__setattr__(self, "largest_px", largest)
        as_choice("rhombi", self.rhombi, ("engine", "equal"))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel, for circles of the mean size: two means in each pass."""
    steps = round(min(MEAN_RADIUS, params.largest_px))
    return 4.0 * (steps + (1 if params.rhombi == "engine" else 0))


METHOD = Method(
    citation="bevy2024",
    source="Bevy 2024, after Barre-Brisebois 2017",
    kind="single image",
    basis="engine",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity"),
    texture_reads=texture_reads,
    known_defects=(
        "One rhombus is twice as bright as the two others, and the blur is off its middle by a tenth of the radius.",
        "Where rhombi meet, a ridge in the shape of a Y is brighter.",
        "No depth is looked at: blurred things read what is sharp beside them, and their blur ends at sharp ones.",
        "Energy is not kept where circles vary: a pixel means over its own hexagon.",
        "Circles of confusion are cut, by default at 32 px.",
    ),
    stages=(
        Stage("coc", "(H, W)", "px", "signed circle of confusion, radius", "formula"),
        Stage("steps", "(H, W)", "", "steps along each direction", "exact"),
        Stage("down", "(H, W, 3)", "linear RGB", "mean downwards", "filter"),
        Stage(
            "both", "(H, W, 3)", "linear RGB", "of it and of the mean up to the right: the mean, or the sum", "filter"
        ),
    ),
    paper={},
    tradeoff=("largest_px", (4.0, 8.0, 16.0, 32.0)),
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
        Planar depth [any unit], > 0; inf is background. Only checked.
    coc : (H, W)
        Signed circle of confusion, radius [px]; the engine's is a diameter.
    params : Params
    stages : bool or refdof.Stages
        Record stages, too.

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
    Costs 4 (r + 1) reads a pixel for circles of radius r.
    """
    as_instance("params", params, Params)
    color, depth, coc = as_images(color, depth, coc)
    recorder = StageRecorder(as_stages(stages))
    image = _blur(color, coc, params, recorder)
    return Staged(image, recorder.stages) if recorder.on else image


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    steps, equal = _steps(coc, params.largest_px), params.rhombi == "equal"
    longest = int(steps.max())
    down, right, left = (
        _reads(x, y, longest, equal, color.dtype) for x, y in ((0.0, 1.0), (_RIGHT, _UP), (-_RIGHT, _UP))
    )
    picture = _padded(np.moveaxis(color, 2, 0), longest)
    first, second = _means(picture, picture, steps, down, right, equal)
    both = (first + second) * color.dtype.type(1.0 if equal else 0.5)
    recorder.record("coc", lambda: coc)
    recorder.record("steps", lambda: steps)
    recorder.record("down", lambda: np.moveaxis(first, 0, 2))
    recorder.record("both", lambda: np.moveaxis(both, 0, 2))
    first, second = _means(_padded(first, longest), _padded(both, longest), steps, right, left, equal)
    image = (first + second) * color.dtype.type(1.0 / 3.0 if equal else 0.5)
    return np.ascontiguousarray(np.moveaxis(image, 0, 2))


def _steps(coc: Float, largest_px: float) -> Index:
    """Half the diameter of each circle, cut, as a whole number of steps: (H, W) int32."""
    return np.rint(np.minimum(np.abs(coc), coc.dtype.type(largest_px))).astype(np.int32)


class _Reads(NamedTuple):
    """Reads along a direction: the first texel's column and row from the pixel, and the weights of those beside it.

    A direction is the same for all pixels, so these are, too.
    """

    columns: Index
    rows: Index
    across: Float
    down: Float


def _reads(x: float, y: float, longest: int, equal: bool, dtype: Any) -> _Reads:
    """The reads of the longest mean; with equal rhombi the first is half a step away."""
    along = np.arange(longest + 1) + (0.5 if equal else 0.0)
    columns, rows = np.floor(along * x), np.floor(along * y)
    weights = (along * x - columns).astype(dtype), (along * y - rows).astype(dtype)
    return _Reads(columns.astype(np.int64), rows.astype(np.int64), *weights)


def _padded(planes: Float, border: int) -> Float:
    """Planes (3, H, W) with their edges repeated, and one texel more, which bilinear reads touch."""
    return np.pad(planes, ((0, 0), (border + 1, border + 1), (border + 1, border + 1)), "edge")


def _means(first: Float, second: Float, steps: Index, one: _Reads, two: _Reads, equal: bool) -> tuple[Float, Float]:
    """Means of two padded pictures, each along its direction: (3, H, W) each."""
    return _mean(first, steps, one, equal), _mean(second, steps, two, equal)


@kernel
def _mean(padded, steps, reads, equal):
    """Mean along a direction of each pixel's own number of reads: (3, H, W)."""
    height, width = steps.shape
    border = (padded.shape[1] - height) // 2
    out = np.empty((3, height, width), dtype=padded.dtype)
    for job in prange(3 * height):
        plane, y = job // height, job % height
        _mean_row(borrow(padded)[plane], (border, y), borrow(steps)[y], reads, equal, borrow(out)[plane, y])
    return out


@inline
def _mean_row(texels, place, steps, reads, equal, out):
    """`_mean` of one row of one plane: reads outside, pixels inside, where loops vectorise."""
    scalar, (border, y) = texels.dtype.type, place
    more, most = np.int32(0 if equal else 1), np.int32(0)
    for x in range(len(out)):
        out[x] = scalar(0)
        most = max(most, steps[x])
    for k in range(most + more):
        row, column = border + y + reads.rows[k], border + reads.columns[k]
        upper, lower = texels[row, column:], texels[row + 1, column:]
        across, down, step = reads.across[k], reads.down[k], np.int32(k)
        for x in range(len(out)):
            a = upper[x] + (upper[x + 1] - upper[x]) * across
            b = lower[x] + (lower[x + 1] - lower[x]) * across
            value = a + (b - a) * down
            out[x] += value if step < steps[x] + more else scalar(0)
    for x in range(len(out)):
        count = steps[x] + more
        out[x] = out[x] / scalar(count) if count > 0 else texels[border + y, border + x]
