"""Halfres: near and far blur at half the size, each a mean and then a maximum over a disc of points; as in three.js.

1. Blur of each pixel in front and behind, 0 .. 1; the near one is spread                  `circles.circles_of`
2. Mean of the picture over 64 points of a disc as large as that, near and far             `gather.means`
3. Greatest values of these over 16 points                                                 `gather.brightest`
4. Lay the far, then the near picture over the sharp one, wholly from half blur on         `gather.composite`

Stages: "coc" px, "near", "far", (H, W) each; of half the size "near_spread", "far_half", (h, w); "near_mean",
"far_mean", "near_brightest", "far_brightest", (h, w, 4), their blur last.

Departures from the paper
-------------------------
- There is no paper: shaders of engines are the source, and Doom (2016) is what they follow.
- Blur is the circle of confusion over its largest, `largest_px`: a thin lens. What [1] and [2] do, a smooth step of the
  distance from the plane in focus, is `circles="smoothstep"`. [2] measures that distance radially; refdof's is planar.
- [1] and [2] store colours as half floats; here they keep their type. The 8 bits of [2]'s blur are kept.
- Texture coordinates run down. Where they run up, the points are mirrored.
- Where blur is 0, all points read one place, so that one read is made.

References
----------
.. [1] three.js r187 (2025), examples/jsm/tsl/display/DepthOfFieldNode.js.
.. [2] pmndrs postprocessing 6.39 (2025), DepthOfFieldEffect, BokehMaterial.
"""

import numpy as np

from refdof._check import Float, as_instance
from refdof.image.channels import joined
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, within
from refdof.methods.halfres.circles import circles_of, kept_shares
from refdof.methods.halfres.gather import brightest, composite, means
from refdof.methods.halfres.params import Params, points
from refdof.stages import Stage, Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]

_NONE = np.zeros((2, 1, 1))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: near and far, 81 points at half the size; 26 of near blur; 5 of the composite."""
    return 2.0 * 81.0 / 4.0 + (26.0 if params.variant == "three" else 4.0) + 5.0


METHOD = Method(
    citation="threejs2025",
    source="three.js 2025, after Doom 2016",
    kind="single image",
    basis="engine",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "convexity"),
    texture_reads=texture_reads,
    kernel=(1.71, 4.54),
    known_defects=(
        "The maximum makes small lights several times brighter and wider than the disc.",
        "From half of the greatest blur on, nothing of the sharp picture is left: a hard border of focus.",
        "No depth is looked at: what is in focus leaks into the blur behind it, and near blur drags background in.",
        "Near things keep a sharp edge over a blurred background.",
        "The blur is off its middle by 0.03 radii.",
        "Circles of confusion are cut, by default at 16 px.",
    ),
    stages=(
        Stage("coc", "(H, W)", "px", "signed circle of confusion, radius", "formula"),
        Stage("near", "(H, W)", "", "blur in front, 0 .. 1", "formula"),
        Stage("far", "(H, W)", "", "blur behind, 0 .. 1", "formula"),
        Stage("near_spread", "(h, w)", "", "near blur of neighbours, too, at half the size", "filter"),
        Stage("far_half", "(h, w)", "", "far blur at half the size", "filter"),
        Stage("near_mean", "(h, w, 4)", "linear RGB, blur", "mean over the near disc", "filter"),
        Stage("far_mean", "(h, w, 4)", "linear RGB, blur", "mean over the far disc", "filter"),
        Stage("near_brightest", "(h, w, 4)", "linear RGB, blur", "greatest values over the near disc", "filter"),
        Stage("far_brightest", "(h, w, 4)", "linear RGB, blur", "greatest values over the far disc", "filter"),
    ),
    paper={},
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
        Planar depth [the unit of `Params.focus_plane`], > 0; inf is background. Only read where `circles` is
        "smoothstep".
    coc : (H, W)
        Signed circle of confusion, radius [px].
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
    Costs 160 reads for every four pixels, whatever the blur.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation."""
    kind, circles = color.dtype, circles_of(depth, coc, params)
    mean_of, most_of = (np.ascontiguousarray(table.T, dtype=kind) for table in points())
    reach, (rows, columns) = params.largest_px, circles.far_half.shape
    small = reach * columns / coc.shape[1], reach * rows / coc.shape[0]
    picture = joined(color, circles.far)
    near_circle, far_source = circles.spread_near, picture
    pmndrs = params.variant == "pmndrs"
    if pmndrs:
        near_circle = np.where(circles.spread_near > 0, np.maximum(circles.spread_near, circles.far_half), kind.type(0))
        far_source = picture * np.minimum(circles.far * kind.type(reach), kind.type(1))[..., None]
    near = means(picture, near_circle, mean_of, reach)
    far = means(far_source, circles.far_half, mean_of, reach)
    near_most, far_most = brightest(near, most_of, *small), brightest(far, most_of, *small)
    recorder.record("coc", lambda: coc)
    recorder.record("near", lambda: circles.near)
    recorder.record("far", lambda: circles.far)
    recorder.record("near_spread", lambda: circles.spread_near)
    recorder.record("far_half", lambda: circles.far_half)
    recorder.record("near_mean", lambda: near)
    recorder.record("far_mean", lambda: far)
    recorder.record("near_brightest", lambda: near_most)
    recorder.record("far_brightest", lambda: far_most)
    return composite(color, far_most, near_most, kept_shares(circles, reach) if pmndrs else _NONE.astype(kind), pmndrs)
