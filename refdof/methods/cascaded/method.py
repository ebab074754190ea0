"""Cascaded: peeled surfaces matted into depth layers, which are blurred and composed step by step towards focus.

1. Peel the scene into buffers of colour and depth                           `refdof.view`
2. Find the depth range, and from it layers and their anchors                `layering_of`, `filter_layers`
3. Decompose the buffers into layers by their depth                          `refdof.methods.cascaded.matting`,
   `source_of`
4. From the back to the focus: blend the next layer over the buffer, blur    `cascade`
5. From the front to the focus: blend the buffer over the next layer, blur   `cascade`
6. Front over (layer in focus over back), divided by alpha                   `blend_over`, `normalized`

Layers are made where they are blended, so memory does not grow with their number.

Stages: "bounds" (K + 1,) scene units, "deviation" (K,) px, "coordinate" (M, H, W), "layers" (K, H, W, 4), "back" and
"front" (H, W, 4) before they are composed (if cascaded), "composite" (H, W, 4) before it is divided; premultiplied.

Departures from the paper
-------------------------
`docs/cascaded_errata.png`, made by `benchmarks/cascaded_errata.py`, shows what the first four do.

- Eq. (4) is printed with its falling ramp upside down: it jumps from 1 to 0 at z_k and climbs to 1 at z_(k+1). Figure
  4(a) and the text want (z_(k+1) - z) / (z_(k+1) - z_k). `ramp="as_printed"` shows what the misprint does.
- z_(-2) = z_(-1) = z_0 = -inf leaves layer 0 an empty core and 0 / 0 on its ramp, though Eq. (9) gives z_0 a finite
  value: it is finite here, and what lies in front of it belongs to layer 0. The ramps of layers 1 and K - 2 into the
  first and the last core would still be infinitely long, with weights inf / inf. There are none (`boundary="hard"`), or
  they end at the anchor that one more layer would have ("extrapolate"), which shows what is blurred most a second time,
  blurred less. "as_printed" is hard without layer 0; weights that are not a number count as 0.
- What blurs see outside the picture is not said: here the nearest pixel (`border="clamp"`). With nothing there
  ("transparent") a near card that crosses the border thins out towards it. `benchmarks/cascaded_borders.py` measures
  these choices: on the scene `fence`, 320x240, "hard" gains 3.0 dB, and "clamp" gains on every built-in scene but one.
- Units: d is a diameter on the sensor and d_pix = 4 sigma counts pixels; circles of confusion here are radii in pixels,
  so a layer of standard deviation sigma stands for the radius 2 sigma.
- The size of the sensor, which d and d_pix differ by, is not given. Here the field of view is the camera's, and neither
  sensor nor focal length is needed. With 24 mm, f = 100 mm, N = 1.4 and 1024 rows the paper's shots have up to 105
  (focus 3) and 16.6 (focus 18.5) pixels of diameter behind focus.
- K: the foremost layer's core, extended to the anchor that one more layer would have, holds the nearest surface, and
  the same behind. The paper wants z_0 in front of it, which is one more layer on either side. No blur is wider than the
  picture's longer side.
- A background is a surface at infinity in the first buffer that has nothing else. Where all M buffers are taken, what
  lies behind them is missing, and the division by alpha fills in: sharp-edged patches where two wires of `fence` cross,
  whose four faces take all four buffers. `buffers="all"` has none.
- Taps are sampled up to 3 standard deviations and scaled to a sum of 1.
- Steps between layers that hold nothing are joined: one blur with their variances added.
- Blur is Gaussian whatever the shape of the aperture. `Aperture.gaussian()` gives the reference a lens to match.
- Surfaces are exact layers: coplanar duplicates, which depth peeling drops, are kept.
- Box and pyramid filters and k-means are only named in the paper: see `refdof.methods.cascaded.fast_blurs`,
  `cluster_layers`.

What lies in the focal plane has weight in the layers next to it, too: with anything in front of it, a copy blurred by
one step lies over it. That is the paper's.

References
----------
.. [1] Schedl & Wimmer (2012), A Layered Depth-of-Field Method for Solving Partial Occlusion, Journal of WSCG 20(3).
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from refdof._check import (
    Float,
    InputError,
    as_bool,
    as_choice,
    as_depth,
    as_image,
    as_instance,
    as_integer,
    as_number,
)
from refdof.methods._contract import Method
from refdof.methods.cascaded.blend import blend_over, blur_apart, cascade, layer_alone, normalized, source_of
from refdof.methods.cascaded.fast_blurs import box_blur, pyramid_blur
from refdof.methods.cascaded.gaussian import gaussian_blur
from refdof.methods.cascaded.layers import Layering, cluster_layers, filter_layers, without_foremost
from refdof.methods.cascaded.matting import RAMPS
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.raster.filters.n_buffer import n_buffer
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["METHOD", "Params", "blur_buffers", "buffers_of", "layering_of", "render"]


_FILTERS = {"gaussian": gaussian_blur, "box": box_blur, "pyramid": pyramid_blur}
_RANGE_BLOCK_PX = 16


@dataclass(frozen=True)
class Params:
    """What the paper leaves open, and its alternatives.

    Parameters
    ----------
    buffers : int or "all"
        M, peeled surfaces per pixel; "all": as many as there are.
    cascade : bool
        Blur between compositions; False: blur every layer by itself, Eq. (11).
    filter : "gaussian", "box" or "pyramid"
        Cheaper filters have the same standard deviation.
    placement : "filter" or "kmeans"
        Layers where the filter sizes put them, Eq. (9), or where the surfaces are (at most as many).
    ramp : "corrected", "as_printed" or "none"
        Matting by Eq. (4) as meant, as printed, or not at all.
    boundary : "hard", "extrapolate" or "as_printed"
        What the matting of the first and last layers does.
    border : "clamp" or "transparent"
        What blurs see outside the picture: its nearest pixel, or nothing.
    normalize : bool
        Divide by alpha.
    sigma_step : float
        Standard deviation of the first blur [px], 0.5 .. 65536; 1 in Eq. (14). Smaller means more layers.
    """

    buffers: int | str = 4
    cascade: bool = True
    filter: str = "gaussian"
    placement: str = "filter"
    ramp: str = "corrected"
    boundary: str = "hard"
    border: str = "clamp"
    normalize: bool = True
    sigma_step: float = 1.0

    def __post_init__(self) -> None:
        if isinstance(self.buffers, str) and self.buffers != "all":
            raise InputError(f"buffers: got {self.buffers!r}; allowed are a whole number >= 1 and all")
        if not isinstance(self.buffers, str):
            object.__setattr__(self, "buffers", as_integer("buffers", self.buffers, minimum=1, maximum=1024))
        as_choice("filter", self.filter, _FILTERS)
        as_choice("placement", self.placement, ("filter", "kmeans"))
        as_choice("ramp", self.ramp, RAMPS)
        as_choice("boundary", self.boundary, ("hard", "extrapolate", "as_printed"))
        as_choice("border", self.border, ("clamp", "transparent"))
        for name in ("cascade", "normalize"):
            as_bool(name, getattr(self, name))
        object.__setattr__(self, "sigma_step", as_number("sigma_step", self.sigma_step, minimum=0.5, maximum=65536.0))


METHOD = Method(
    citation="schedl2012",
    source="Schedl, Wimmer 2012",
    kind="layers",
    inputs=("peeled layers",),
    params=Params,
    promises=("constant", "pinhole", "convexity", "symmetry", "occlusion"),
    texture_reads=None,
    kernel=(0.78, 1.0),
    known_defects=(
        "What is in focus lies under a slightly blurred copy of itself wherever anything is in front of it.",
        "Energy is not kept: the matting shows every surface in two layers.",
        "Blur is Gaussian, whatever the shape of the aperture.",
        "Surfaces behind the last buffer are missing.",
    ),
    paper={
        "ramp": "as_printed",  # Eq. (4), which climbs where figure 4(a) falls
        "boundary": "as_printed",  # section 3.2.1: z_0, too, is at -inf
    },
    tradeoff=("buffers", (1, 2, 3, 4, 6, 8)),
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    return _blend(*buffers_of(view, params), view.camera, view.lens, params, recorder)


def buffers_of(view: View, params: Params = Params()) -> tuple[Float, Float]:
    """What `blur_buffers` is given of a view: color (M, H, W, 3) float32 and depth (M, H, W), NaN for no surface."""
    layers = view.layers(None if isinstance(params.buffers, str) else params.buffers)
    color, depth, empty = layers.color, layers.depth, layers.triangle < 0
    if params.buffers == "all" and not empty[-1].all():  # room for the background of the deepest pixel
        color, depth, empty = (
            np.concatenate([part, np.full((1, *part.shape[1:]), value, part.dtype)])
            for part, value in ((color, 0), (depth, np.inf), (empty, True))
        )
    depth = np.where(empty, np.inf, depth)
    depth[1:][empty[:-1]] = np.nan  # the background is there once
    return np.where(empty[..., None], np.asarray(view.scene.background, dtype=np.float32), color), depth


def blur_buffers(
    color: Float,
    depth: Float,
    camera: Camera,
    lens: ThinLens,
    params: Params = Params(),
    recorder: StageRecorder | None = None,
) -> Float:
    """Blur peeled buffers of your own.

    Parameters
    ----------
    color : (M, H, W, 3) float32 or float64
        Linear RGB, front to back; its type is the type of all arithmetic.
    depth : (M, H, W)
        Planar depth [scene units], > 0; inf is background, NaN is no surface.
    camera, lens
        Their picture size must be that of the buffers.
    params : Params
        `buffers` is not used.

    Returns
    -------
    (H, W, 3) of the type of `color`.

    Raises
    ------
    InputError
        If shapes disagree, a colour is not finite, a depth is not above 0, or there is no surface at all.
    """
    for name, value, kind in (("camera", camera, Camera), ("lens", lens, ThinLens), ("params", params, Params)):
        as_instance(name, value, kind)
    recorder = StageRecorder() if recorder is None else as_instance("recorder", recorder, StageRecorder)
    color = as_image("color", color, (None, camera.height, camera.width, 3))
    depth = as_depth(depth, color.shape[:3], dtype=np.float64, nan=True)
    if np.isnan(depth).all():
        raise InputError("depth: has no surface, all values are NaN; at least one must be a depth")
    return _blend(color, depth, camera, lens, params, recorder)


def layering_of(depth: Float, camera: Camera, lens: ThinLens, params: Params = Params()) -> Layering:
    """The layers that surfaces at `depth` (M, H, W), NaN for none, call for."""
    depth, lens = lens.as_thin(depth, camera)
    near, far = _depth_range(depth)
    scale = camera.pixels_per_tangent * lens.radius
    nearest, farthest = (float(c) for c in lens.coc_px(np.array([near, far]), camera))
    layering = filter_layers(nearest, farthest, scale, lens.focus_distance, params.sigma_step, max(camera.size))
    if params.placement == "kmeans":
        coc = lens.coc_px(depth[~np.isnan(depth)], camera)
        coc = np.clip(coc, -2.0 * max(camera.size), 2.0 * max(camera.size))
        layering = cluster_layers(coc, len(layering.deviation), scale, lens.focus_distance, params.sigma_step)
    return without_foremost(layering) if params.boundary == "as_printed" else layering


def _depth_range(depth: Float) -> tuple[float, float]:
    """The nearest and the farthest surface; a background is at inf."""
    buffer = n_buffer(np.where(np.isnan(depth), np.inf, depth), block=_RANGE_BLOCK_PX)
    near, far = float(buffer.lowest[-1, 0, 0]), float(buffer.highest[-1, 0, 0])
    return (near, np.inf if np.isinf(depth).any() else far)


def _blend(
    color: Float, depth: Float, camera: Camera, lens: ThinLens, params: Params, recorder: StageRecorder
) -> Float:
    """`blur_buffers` after validation."""
    depth, lens = lens.as_thin(depth, camera)
    used = 1 + int(np.flatnonzero(~np.isnan(depth).all(axis=(1, 2)))[-1])
    layering = layering_of(depth, camera, lens, params)
    boundary = "extrapolate" if params.boundary == "extrapolate" else "hard"
    source = source_of(color[:used], depth[:used], layering, params.ramp, boundary)
    count, focus = len(layering.deviation), layering.focus
    blur = partial(_FILTERS[params.filter], clamp=params.border == "clamp")
    recorder.record("bounds", lambda: layering.bounds)
    recorder.record("deviation", lambda: layering.deviation)
    recorder.record("coordinate", lambda: source.coordinate)
    recorder.record("layers", lambda: np.stack([layer_alone(source, k) for k in range(count)]))

    back, front, scratch = (np.zeros((4, *depth.shape[1:]), dtype=color.dtype) for _ in range(3))
    if params.cascade:
        cascade(source, range(count - 1, focus, -1), layering, True, blur, back, scratch)
        cascade(source, range(focus), layering, False, blur, front, scratch)
        recorder.record("back", lambda: np.moveaxis(back, 0, -1))
        recorder.record("front", lambda: np.moveaxis(front, 0, -1))
        if focus >= 0:
            source.blend(focus, True, back)
        blend_over(front, back)  # Eq. (12)
    else:
        blur_apart(source, layering, blur, back, front, scratch)
    recorder.record("composite", lambda: np.moveaxis(back, 0, -1))
    return normalized(back, params.normalize)
