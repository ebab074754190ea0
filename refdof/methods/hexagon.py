"""Hexagon: means along three directions, two of them in one pass, make a hexagon of three rhombi; as in Bevy.

1. Turn circles of confusion into a number of steps                              `_planes`
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

_RUN = 128  # pixels that take as many reads as the largest circle among them
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
    kernel=(0.95, 1.0),
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
    color, _, coc = as_images(color, depth, coc)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(color, coc, params, recorder))


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    equal, largest = params.rhombi == "equal", coc.dtype.type(params.largest_px)
    longest = int(np.rint(min(max(-coc.min(), coc.max()), largest)))
    down, right, left = (
        _reads(x, y, longest, equal, color.dtype) for x, y in ((0.0, 1.0), (_RIGHT, _UP), (-_RIGHT, _UP))
    )
    picture, steps = _planes(color.reshape(len(color), -1), coc, largest, longest + 1)
    first, both = _first_pass(picture, steps, down, right, equal)
    image = _second_pass(first, both, steps, right, left, equal).reshape(color.shape)
    inside = np.s_[:, :, longest + 1 : longest + 1 + color.shape[1]]
    recorder.record("coc", lambda: coc)
    recorder.record("steps", lambda: steps)
    recorder.record("down", lambda: np.moveaxis(first[inside], 0, 2))
    recorder.record("both", lambda: np.moveaxis(both[inside], 0, 2))
    return image


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


@kernel
def _planes(color, coc, largest, border):
    """Planes (3, H, W + 2 border) of color (H, 3 W), whose rows' ends are repeated; and steps (H, W) int32.

    Steps are half the diameter of each circle, cut, as a whole number.
    """
    height, width = coc.shape
    out, steps = np.empty((3, height, width + 2 * border), dtype=color.dtype), np.empty((height, width), np.int32)
    for y in prange(height):
        source, circles, planes, row = borrow(color)[y], borrow(coc)[y], borrow(out)[:, y], borrow(steps)[y]
        red, green, blue = planes[0][border:], planes[1][border:], planes[2][border:]
        for x in range(width):
            red[x], green[x], blue[x] = source[3 * x], source[3 * x + 1], source[3 * x + 2]
            row[x] = np.int32(np.rint(min(abs(circles[x]), largest)))
        for c in range(3):
            _repeat_ends(planes[c], border)
    return out, steps


@inline
def _repeat_ends(row, border):
    """Fill a row's first and last `border` texels."""
    last = len(row) - border - 1
    for x in range(border):
        row[x], row[last + 1 + x] = row[border], row[last]


@kernel
def _first_pass(picture, steps, one, two, equal):
    """Means of a picture along a direction, and of them and those along another: planes as the picture's."""
    _, height, length = picture.shape
    border, share = (length - steps.shape[1]) // 2, picture.dtype.type(1.0 if equal else 0.5)
    first, both = np.empty_like(picture), np.empty_like(picture)
    for job in prange(3 * height):
        c, y = job // height, job % height
        means = borrow(np.empty((2, steps.shape[1]), dtype=picture.dtype))
        _means(borrow(picture)[c], borrow(picture)[c], y, borrow(steps)[y], (one, two), equal, means)
        row, other = borrow(first)[c, y, border:], borrow(both)[c, y, border:]
        for x in range(steps.shape[1]):
            row[x] = means[0, x]
            other[x] = (means[0, x] + means[1, x]) * share
        _repeat_ends(borrow(first)[c, y], border)
        _repeat_ends(borrow(both)[c, y], border)
    return first, both


@kernel
def _second_pass(first, both, steps, one, two, equal):
    """Means of two pictures, each along its direction, and the mean of these: (H, 3 W)."""
    height, width = steps.shape
    share = first.dtype.type(1.0 / 3.0 if equal else 0.5)
    out = np.empty((height, 3 * width), dtype=first.dtype)
    for y in prange(height):
        means, row = borrow(np.empty((6, width), dtype=first.dtype)), borrow(out)[y]
        for c in range(3):
            planes = borrow(first)[c], borrow(both)[c]
            _means(planes[0], planes[1], y, borrow(steps)[y], (one, two), equal, means[2 * c : 2 * c + 2])
        for x in range(width):
            row[3 * x] = (means[0, x] + means[1, x]) * share
            row[3 * x + 1] = (means[2, x] + means[3, x]) * share
            row[3 * x + 2] = (means[4, x] + means[5, x]) * share
    return out


@inline
def _means(first, second, y, steps, directions, equal, out):
    """Means of row y of two planes, each along its direction: out (2, W). Runs of pixels take as many reads."""
    for k in range(2):
        for begin in range(0, len(steps), _RUN):
            end = min(begin + _RUN, len(steps))
            plane, reads = (first, directions[0]) if k == 0 else (second, directions[1])
            border = (plane.shape[1] - len(steps)) // 2
            _mean(plane, y, border + begin, steps[begin:end], reads, equal, out[k, begin:end])


@inline
def _mean(plane, y, start, steps, reads, equal, out):
    """Mean along a direction of each pixel's own number of reads: reads outside, pixels inside, where loops vectorise.

    start is the first pixel's column. Rows and columns that a read lies on are not blended with those beside them.
    """
    scalar, last, own = plane.dtype.type, len(plane) - 1, plane[y, start:]
    first, most = 0 if equal else 1, np.int32(0)
    for x in range(len(out)):
        out[x] = scalar(0) if equal and steps[x] > 0 else own[x]
        most = max(most, steps[x])
    for k in range(first, most + first):
        row, column, before = y + reads.rows[k], start + reads.columns[k], np.int32(k - first)
        upper, lower = plane[min(max(row, 0), last), column:], plane[min(max(row + 1, 0), last), column:]
        across, down = reads.across[k], reads.down[k]
        if down == scalar(0) and across == scalar(0):
            for x in range(len(out)):
                out[x] += upper[x] if steps[x] > before else scalar(0)
        elif down == scalar(0):
            for x in range(len(out)):
                value = upper[x] + (upper[x + 1] - upper[x]) * across
                out[x] += value if steps[x] > before else scalar(0)
        else:
            for x in range(len(out)):
                a = upper[x] + (upper[x + 1] - upper[x]) * across
                b = lower[x] + (lower[x + 1] - lower[x]) * across
                value = a + (b - a) * down
                out[x] += value if steps[x] > before else scalar(0)
    for x in range(len(out)):
        out[x] /= max(scalar(steps[x]) + scalar(first), scalar(1))
