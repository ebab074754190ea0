"""Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.

1. Clamp every pixel's circle of confusion to the largest blur               `walk.sizes_of`
2. Walk the spiral outwards from the pixel                                   `walk.spiral`
3. Shrink taps that lie behind the pixel to twice the pixel's own size       `walk._reach`
4. Blend in each tap by how far its disc covers the pixel, or else the mean   `walk._blend`

Stages: "coc", "size", "limit", "weight_sum", (H, W) each; "taps" (N, 3) px, y down, and radius. As asked for: after K
taps "mean K" (H, W, 3), of tap K "reach K" and "weight K" (H, W), and "probes" (P, N + 1, 13). More in
`trace.STAGES`.

Departures from the paper
-------------------------
- The published listing reads the centre colour at `vTexCoord` where `texCoord` is meant.
- The pseudo-code's ``nextcolor /= total`` is two lines: ``next`` and ``color /= total``.
- The text first clamps taps from behind to 1.0 times the centre's size; the listing and the closing note use 2.0.
- ``focusScale`` is P E / MAX_BLUR_SIZE for a thin lens, so that a size is the circle of confusion in pixels.
- The listing leaves texture filters to the host. Colour is bilinear, clamped to the edge. Depth is read at the nearest
  texel: a blend of near and far depth is a surface that nobody saw. `depth_filter="bilinear"` blends inverse depth and
  circle of confusion, which is what a linearly filtered z-buffer gives; "bilinear_depth" blends depth, as a linearly
  filtered texture of linear depth does.
- Offsets are computed once in float64; the listing adds up angles in float32 (less than 0.0007 px apart, but pixels
  apart for a small RAD_SCALE: `precision="float32"`).
- The spiral runs as the listing's texture coordinates do if row 0 is the top: x right, y down, clockwise on the screen.
  Where row 0 is the bottom, as in OpenGL, the same listing walks the mirrored spiral: another picture, as correct.
  `row_order="up"` is that one.
- With depth at the nearest texel and colour bilinear, a tap beside an edge has up to half a texel of the colour across.
- The half-resolution variant that the article mentions is not described well enough to be rebuilt.

References
----------
.. [1] Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.
"""

import numpy as np

from refdof._check import Float, as_instance
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.methods.singlepass.params import Params
from refdof.methods.singlepass.trace import STAGES, record_stages
from refdof.methods.singlepass.walk import spiral, spread, walk_of
from refdof.stages import Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "spiral", "texture_reads"]


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: colour and depth at every tap."""
    return 2.0 * len(spiral(params))


METHOD = Method(
    citation="gustafsson2018",
    source="Gustafsson 2018",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "convexity"),
    texture_reads=texture_reads,
    kernel=(1.01, 1.0),
    known_defects=(
        "Energy is not kept: the mean runs along the spiral, so that the order of taps matters.",
        "The mirrored scene does not give the mirrored picture: the spiral turns one way.",
        "Circles of confusion are cut, by default at 20 px.",
    ),
    stages=STAGES,
    paper={},  # the listing leaves texture filters to the host; all else are its own constants
    tradeoff=("rad_scale", (4.0, 2.0, 1.0, 0.5, 0.25)),
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
        Planar depth [any unit], > 0; inf is background.
    coc : (H, W)
        Signed circle of confusion, radius [px].
    params : Params
    stages : bool or refdof.Stages
        Record stages, too: those that every run has, or also steps and probes.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, or a depth is not
        above 0; if a step or probe is beyond the loop or the picture; or if `depth_filter` is "bilinear_depth" and the
        circles are not a thin lens's.

    Notes
    -----
    Costs 398 taps a pixel by default, whatever the blur. The mean is a running one: order matters, energy is not kept.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    return recorder.answer(_blur(*as_images(color, depth, coc), params, recorder))


def _blur(color: Float, depth: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    """`blur` after validation. Stages show the depth as it was given."""
    walk = walk_of(color, depth_in_range(color.dtype.type, depth), coc, params)
    record_stages(recorder, walk, coc, depth, params)
    return spread(walk)
