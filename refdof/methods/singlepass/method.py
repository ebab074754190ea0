"""Single pass: every pixel gathers taps on a golden-angle spiral; a tap that does not reach it repeats the mean.

1. Clamp every pixel's circle of confusion to the largest blur               `_sizes`
2. Walk the spiral outwards from the pixel                                   `spiral`
3. Shrink taps that lie behind the pixel to twice the pixel's own size       `_reach`
4. Blend in each tap by how far its disc covers the pixel, or else the mean   `_blend`

Stages: "coc" (H, W) px, "size" (H, W) px, "taps" (N, 2) px, y down.

Departures from the paper
-------------------------
- The published listing reads the centre colour at `vTexCoord` where `texCoord` is meant.
- The pseudo-code's ``nextcolor /= total`` is two lines: ``next`` and ``color /= total``.
- The text first clamps taps from behind to 1.0 times the centre's size; the listing and the closing note use 2.0.
- ``focusScale`` is P E / 20 for a thin lens, so that a size is the circle of confusion in pixels, cut at 20.
- The listing leaves texture filters to the host. Colour is bilinear, clamped to the edge. Depth is read at the nearest
  texel: a blend of near and far depth is a surface that nobody saw. `depth_filter="bilinear"` blends inverse depth and
  circle of confusion, which is what a linearly filtered z-buffer gives.
- Offsets are computed once in float64; the listing adds up angles in float32 (less than 0.0007 px apart).
- The spiral runs as the listing's texture coordinates do if row 0 is the top: x right, y down, clockwise on the screen.
  Where row 0 is the bottom, as in OpenGL, the same listing walks the mirrored spiral: another picture, as correct.
- With depth at the nearest texel and colour bilinear, a tap beside an edge has up to half a texel of the colour across.
- The half-resolution variant that the article mentions is not described well enough to be rebuilt.

References
----------
.. [1] Gustafsson (2018), Bokeh Depth of Field in a Single Pass, Tuxedo Labs.
"""

import math
from dataclasses import dataclass

import numpy as np

from refdof._check import Float, as_choice, as_instance
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods._contract import Method
from refdof.methods._image_validation import as_images, depth_in_range, within
from refdof.methods.singlepass.planar import pad_planes, tap_of
from refdof.stages import StageRecorder
from refdof.view import View

__all__ = ["MAX_BLUR_SIZE", "METHOD", "Params", "blur", "render", "spiral", "texture_reads"]


GOLDEN_ANGLE = 2.39996323  # [1], listing
MAX_BLUR_SIZE = 20.0  # px, [1], listing
RAD_SCALE = 0.5  # [1], listing: smaller is nicer, larger is faster
_BEHIND = 2.0  # [1], listing: a tap from behind counts up to this many times the centre's size
_MARGIN = int(MAX_BLUR_SIZE) + 2  # texels that a tap can reach beyond the border


@dataclass(frozen=True)
class Params:
    """What the article leaves open.

    Parameters
    ----------
    depth_filter : "nearest" or "bilinear"
        How taps read depth.
    """

    depth_filter: str = "nearest"

    def __post_init__(self) -> None:
        as_choice("depth_filter", self.depth_filter, ("nearest", "bilinear"))


def texture_reads(params: Params, width: int, height: int) -> float:
    """Texture reads per pixel: colour and depth at every tap."""
    return 2.0 * len(spiral())


METHOD = Method(
    citation="gustafsson2018",
    source="Gustafsson 2018",
    kind="single image",
    inputs=("pinhole colour", "pinhole depth"),
    params=Params,
    promises=("constant", "pinhole", "convexity"),
    texture_reads=texture_reads,
    known_defects=(
        "Energy is not kept: the mean runs along the spiral, so that the order of taps matters.",
        "The mirrored scene does not give the mirrored picture: the spiral turns one way.",
        "Circles of confusion are cut at 20 px.",
    ),
    paper={},  # the listing leaves texture filters to the host, and nothing else is a parameter
)


def render(view: View, params: Params, recorder: StageRecorder) -> Float:
    """Render `view`: (H, W, 3) float32 linear RGB."""
    pinhole, coc = view.pinhole(), view.coc_px()
    recorder.record("coc", lambda: coc)
    recorder.record("size", lambda: _sizes(coc))
    recorder.record("taps", lambda: spiral()[:, :2])
    return blur(pinhole.color, depth_in_range(pinhole.depth), within(np.float32, coc), params)


def blur(color: Float, depth: Float, coc: Float, params: Params = Params()) -> Float:
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
    Costs 398 taps a pixel, whatever the blur. The mean is a running one: order matters, energy is not kept.
    """
    as_instance("params", params, Params)
    color, depth, coc = as_images(color, depth, coc)
    taps = spiral()
    split = [tap_of(dx, dy) for dx, dy, _ in taps]
    if params.depth_filter == "bilinear":  # signed, so that a blend across the focal plane passes through 0
        nearness = 1.0 / np.maximum(depth, np.finfo(color.dtype).tiny)
        guides = np.stack([nearness, coc], axis=-1)
    else:
        guides = np.stack([-depth, _sizes(coc)], axis=-1)
    return _spread(
        pad_planes(color, _MARGIN),
        pad_planes(guides.astype(color.dtype), _MARGIN),
        np.array(
            [(t.x, t.y, math.floor(dx + 0.5), math.floor(dy + 0.5)) for t, (dx, dy, _) in zip(split, taps, strict=True)]
        ),
        np.array([(t.weight_x, t.weight_y) for t in split], dtype=color.dtype),
        (taps[:, 2] - 0.5).astype(color.dtype),
        params.depth_filter == "bilinear",
    )


def spiral() -> Float:
    """The taps (398, 3): x, y [px], y down, and radius. One tap per pi px^2."""
    taps, radius, angle = [], RAD_SCALE, 0.0
    while radius < MAX_BLUR_SIZE:
        taps.append((math.cos(angle) * radius, math.sin(angle) * radius, radius))
        radius += RAD_SCALE / radius
        angle += GOLDEN_ANGLE
    return np.array(taps)


def _sizes(coc: Float) -> Float:
    """getBlurSize of [1]: |coc|, at most the largest blur [px]."""
    return np.minimum(np.abs(coc), coc.dtype.type(MAX_BLUR_SIZE))


@kernel
def _spread(color, guides, offsets, weights, inner, bilinear):
    """Run the spiral over all pixels, taps outside, pixels of a row inside.

    color (3, h, w) and guides (2, h, w: nearness, size or coc) are padded; offsets (N, 4): whole and nearest texel;
    weights (N, 2); inner (N,): radius - 0.5. Returns (H, W, 3).
    """
    height, width = color.shape[1] - 2 * _MARGIN, color.shape[2] - 2 * _MARGIN
    out = np.empty((height, width, 3), dtype=color.dtype)
    for y in prange(height):
        planes, depths = borrow(color), borrow(guides)
        scalar = color.dtype.type
        mean = np.empty((3, width), dtype=color.dtype)
        cover = np.empty(width, dtype=color.dtype)
        depth = np.empty(width, dtype=color.dtype)
        size = np.empty(width, dtype=color.dtype)
        here = depths[0, y + _MARGIN, _MARGIN : _MARGIN + width]
        limit = depths[1, y + _MARGIN, _MARGIN : _MARGIN + width].copy()
        for x in range(width):
            limit[x] = scalar(_BEHIND) * min(abs(limit[x]), scalar(MAX_BLUR_SIZE))
        for c in range(3):
            mean[c] = planes[c, y + _MARGIN, _MARGIN : _MARGIN + width]
        for k in range(len(offsets)):
            dx, dy = offsets[k, 0] + _MARGIN, offsets[k, 1] + _MARGIN + y
            if bilinear:
                last = dx + width + 1
                _filter(depths[0, dy, dx:last], depths[0, dy + 1, dx:last], weights[k, 0], weights[k, 1], depth)
                _filter(depths[1, dy, dx:last], depths[1, dy + 1, dx:last], weights[k, 0], weights[k, 1], size)
                for x in range(width):
                    size[x] = min(abs(size[x]), scalar(MAX_BLUR_SIZE))
                _reach(depth, size, here, limit, inner[k], cover)
            else:
                nx, ny = offsets[k, 2] + _MARGIN, offsets[k, 3] + _MARGIN + y
                last = nx + width
                _reach(depths[0, ny, nx:last], depths[1, ny, nx:last], here, limit, inner[k], cover)
            total = scalar(k + 1)
            for c in range(3):
                top, bottom = planes[c, dy, dx : dx + width + 1], planes[c, dy + 1, dx : dx + width + 1]
                _blend(top, bottom, weights[k, 0], weights[k, 1], cover, total, mean[c])
        for c in range(3):
            for x in range(width):
                out[y, x, c] = mean[c, x] / scalar(len(offsets) + 1)
    return out


@inline
def _filter(top, bottom, wx, wy, out):
    """Bilinear taps of one row of pixels: x first, then y."""
    for x in range(len(out)):
        a = top[x] + (top[x + 1] - top[x]) * wx
        b = bottom[x] + (bottom[x + 1] - bottom[x]) * wx
        out[x] = a + (b - a) * wy


@inline
def _reach(depth, size, here, limit, inner, cover):
    """How far each tap covers its pixel: smoothstep(radius - 0.5, radius + 0.5, size). Nearer is greater."""
    one, two, three = cover.dtype.type(1), cover.dtype.type(2), cover.dtype.type(3)
    for x in range(len(cover)):
        s = min(size[x], limit[x]) if depth[x] < here[x] else size[x]
        t = min(max(s - inner, cover.dtype.type(0)), one)
        cover[x] = t * (t * (three - two * t))


@inline
def _blend(top, bottom, wx, wy, cover, total, mean):
    """color += mix(color / total, tap, cover), for one channel of one row."""
    one = mean.dtype.type(1)
    for x in range(len(mean)):
        a = top[x] + (top[x + 1] - top[x]) * wx
        b = bottom[x] + (bottom[x + 1] - bottom[x]) * wx
        tap = a + (b - a) * wy
        mean[x] += mean[x] / total * (one - cover[x]) + tap * cover[x]
