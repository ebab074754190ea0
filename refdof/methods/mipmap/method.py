"""Mipmap interpolation: every pixel reads a mip level as coarse as its blur, made without leaks from sharp pixels.

1. Take the circle of confusion as degree of blur                           `blur`
2. Build mip levels of circles, and of colour without what is sharper
   `refdof.methods.mipmap.anisotropic.downsample`
3. Find the blur of nearer neighbours at the last level
   `refdof.methods.mipmap.anisotropic.foreground_blur`
4. Upsample it, and read the degree of blur as coarse as that
   `refdof.methods.mipmap.upsample.smooth_blur`
5. Blend two mip levels of colour at nine points of a circle                `refdof.methods.mipmap.upsample.upsample`

Stages: "coc" (H, W) px, "degree" (H, W) px, "neighbours" (H, W) px, "smoothed" (H, W) px, "level" (H, W),
"color 1", "color 2", ... (h, w, 3).

The lens size E of [1] is a **diameter**, and so is its C; its degree of blur is sigma = C / 2, the radius that refdof
calls circle of confusion. [1] takes sigma for the standard deviation of a Gaussian; what the steps really give at an
edge is between 0.28 C and 0.33 C. That is how the method is, and it is left so.

Departures from the paper
-------------------------
- Equations (2) to (4), the circle of confusion of an eye in dots of a display, are replaced by the thin lens's in px.
- Colours are filtered as linear light; [1] does not say what its textures hold.
- Depth is kept as the signed circle of confusion: it has the order of depth, is 0 in the focal plane and finite for the
  background. Coarser levels thus average inverse depth, as those of a z-buffer do.
- Equation (8) reads level l - 1, which does not exist for l = 0, and blurs where equation (6) says "no effect". Here
  the level read is max(m - 1, 0) and the circle has a radius of min(m, 1) texels: nothing happens at m = 0.
- Equations (7) and (8) print a geometric blend of levels. Section 6 reads a level that is not whole, which blends
  linearly, and finds the difference marginal: `blend`.
- The operator H of equation (9) stands for G in equation (8), says the text. Figure 6 and step 3 apply it where levels
  are made, equation (1), and so does this. Its p and q are read at the finer level, so that p itself always counts.
- The Gaussian's standard deviation, the places of its taps and the offset delta are not given: one finer texel, one
  finer texel around the coarse centre, and 0.5 px. Diagonal taps keep the weight G(sqrt 2) after they moved inwards.
- Only the last level of equation (10) is ever read. It looks at blurs of the level before it, so no other is made.
- The last level is that of the largest blur in the picture, not of a bound set beforehand.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation,
   IEEE Transactions on Visualization and Computer Graphics 15(3).
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, InputError, as_choice, as_instance, as_integer, as_number
from refdof.methods._contract import LARGEST_RADIUS, Method, level_shares
from refdof.methods._image_validation import as_images, within
from refdof.methods.mipmap.anisotropic import begin, depth_of_chain, downsample, foreground_blur, new_chain
from refdof.methods.mipmap.upsample import CIRCLE, K_SIGMA, smooth_blur, upsample
from refdof.raster.gpu.gpu_model import LLVMPIPE, store
from refdof.stages import Staged, StageRecorder, Stages, as_stages
from refdof.view import View

__all__ = ["METHOD", "Params", "blur", "render", "texture_reads"]


@dataclass(frozen=True)
class Params:
    """What the paper leaves open.

    Parameters
    ----------
    delta : float >= 0
        How much sharper than its centre a pixel may be to enter a blurred background [px]; inf lets all in: isotropic.
    foreground_points : 0, 5 or 9
        Points of the circle that smooths the foreground's boundary; 0 leaves it as it is.
    blend : "linear" or "geometric"
        Of two mip levels.
    depth_format : "f32" or "f16"
        Texture of depth and blur. 16 bits are rounded towards zero at every level, as render targets do.
    """

    delta: float = 0.5
    foreground_points: int = 5
    blend: str = "linear"
    depth_format: str = "f32"

    def __post_init__(self) -> None:
        object.__setattr__(self, "delta", as_number("delta", self.delta, minimum=0.0, finite=False))
        points = as_integer("foreground_points", self.foreground_points, minimum=0, maximum=9)
        object.__setattr__(self, "foreground_points", points)
        if points not in (0, 5, 9):
            raise InputError(f"foreground_points: got {self.foreground_points!r}; allowed are 0, 5, 9")
        as_choice("blend", self.blend, ("linear", "geometric"))
        as_choice("depth_format", self.depth_format, ("f32", "f16"))


def texture_reads(params: Params, width: int, height: int, largest: float = LARGEST_RADIUS) -> float:
    """Texture reads per pixel [1, table 1], for a largest circle of confusion of radius `largest` [px]."""
    shares = level_shares(width, height, _last_level(largest, width, height))
    taps = 9 + 9  # circles, and colour, of the finer level
    smoothing = params.foreground_points + 1 if params.foreground_points and shares else 0
    return taps * math.fsum(shares) + smoothing + len(CIRCLE)


METHOD = Method(
    citation="lee2009mipmap",
    source="Lee, Kim, Choi 2009",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "focus", "convexity", "symmetry"),
    texture_reads=texture_reads,
    kernel=(1.29, 1.0),
    known_defects=("Blurs too much: by about 0.3 of the circle's diameter, where a disc has 0.25.",),
    paper={
        "blend": "geometric",  # Eqs. (7), (8)
        "depth_format": "f16",  # Section 3.1: "a 16-bit floating-point texture"
    },
    tradeoff=("foreground_points", (0, 5, 9)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), within(np.float32, view.coc_px())
    return _blur(pinhole.color, coc, params, recorder)


def blur(
    color: Float, depth: Float, coc: Float, params: Params = Params(), stages: bool | Stages = False
) -> Float | Staged:
    """Blur a pinhole image.

    Parameters
    ----------
    color : (H, W, 3) float32 or float64
        Linear RGB, >= 0 if `blend` is "geometric"; its type is the type of all arithmetic.
    depth : (H, W)
        Planar depth [any unit], > 0; inf is background. Only checked: circles of confusion have its order.
    coc : (H, W)
        Signed circle of confusion, **radius** [px]: the paper's C is twice its size.
    params : Params
    stages : bool or refdof.Stages
        Record stages, too. It has neither steps nor probes.

    Returns
    -------
    (H, W, 3) of the type of `color`; with stages a `Staged`, a pair of that and of the stages by name.

    Raises
    ------
    InputError
        If shapes disagree, an array is empty, a value is NaN, a colour or circle is infinite, a depth is not above 0,
        or a colour is negative where the blend is geometric.

    Notes
    -----
    Costs the same for any blur above 1.5 px; below, one level is read and not two, and none where there is no blur. A
    blur wider than the picture is cut.
    """
    as_instance("params", params, Params)
    recorder = StageRecorder(as_stages(stages))
    color, _, coc = as_images(color, depth, coc)
    if params.blend == "geometric" and color.min() < 0:
        raise InputError(f"color: smallest value is {color.min():g}; allowed with blend 'geometric' are values >= 0")
    return recorder.answer(_blur(color, coc, params, recorder))


def _blur(color: Float, coc: Float, params: Params, recorder: StageRecorder) -> Float:
    height, width = coc.shape
    last = _last_level(max(float(coc.max()), -float(coc.min())), width, height)
    circles, colors = (new_chain((height, width, channels), last, color.dtype) for channels in (2, 4))
    begin(color, coc, colors.level(0), circles.level(0))  # four channels are one register
    _round(circles.level(0), params)
    for k in range(last):
        downsample(colors.level(k), circles.level(k), params.delta, colors.level(k + 1), circles.level(k + 1))
        _round(circles.level(k + 1), params)
    points = params.foreground_points if last else 0
    if points:
        nearer = foreground_blur(circles.level(last - 1), int(circles.heights[last]), int(circles.widths[last]))
    else:
        nearer = np.zeros((1, 1), dtype=color.dtype)
    _round(nearer, params)
    smoothed = smooth_blur(circles, nearer, points)
    recorder.record("coc", lambda: coc)
    recorder.record("degree", lambda: np.abs(coc))
    recorder.record("neighbours", lambda: smoothed.neighbours)
    recorder.record("smoothed", lambda: smoothed.smoothed)
    recorder.record("level", lambda: smoothed.levels)
    for k in range(1, last + 1):
        recorder.record(f"color {k}", lambda k=k: colors.level(k)[..., :3])  # type: ignore[misc]
    return upsample(colors, smoothed, params.blend == "geometric")


def _last_level(largest: float, width: int, height: int) -> int:
    """M: the level of the largest degree of blur [px], if the picture has it."""
    if K_SIGMA * largest <= 0.5:
        return 0
    return min(math.ceil(1.0 + math.log2(K_SIGMA * largest)), depth_of_chain(width, height))  # Eq. (6)


def _round(values: Float, params: Params) -> None:
    if params.depth_format == "f16":
        values[:] = store(values.astype(np.float32), "f16", LLVMPIPE)
