"""Walk: the spiral, the padded pictures that it runs over, and the kernel that runs it.

1. Lay out the taps                                              `spiral`
2. Make of depth what is compared, and of circles what is read    `walk_of`
3. Run the taps over all pixels                                  `spread`
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, InputError
from refdof._jit import borrow, inline, kernel, prange
from refdof.methods.singlepass.params import Params
from refdof.methods.singlepass.planar import blend_of_four, mix_of_four, pad_each, tap_of, window

__all__ = [
    "BY_DEPTH",
    "NEAREST",
    "Walk",
    "bands",
    "read_color",
    "read_guides",
    "sizes_of",
    "spiral",
    "spread",
    "texels_of",
    "walk_of",
]

NEAREST, BILINEAR, BY_DEPTH, BY_DEPTH_SIZE = range(4)  # how a tap's order and size are read
_BAND = 16384  # pixels
_SLACK = 1e-3  # px: circles that are a line over inverse depth but for roundings, and 1e-6 of the largest


class Walk(NamedTuple):
    """All that the kernel needs; everything but whole numbers has the colour's type.

    Attributes
    ----------
    planes : (5, h, w)
        Padded: red, green, blue; what is compared, less behind; size or circle [px].
    center : (5, h, w)
        The same for the pixels themselves; mostly the same array.
    offsets : (N, 4) int
        Whole texels of every tap, x and y, of colour and of depth.
    weights : (N, 4)
        Bilinear weights of the texels right and below, of colour and of depth.
    inner : (N,)
        Radius - 0.5 [px].
    numbers : (4,)
        Factor for taps from behind; largest size [px]; circle at infinity [px] and its fall with inverse depth.
    mode : int
        NEAREST, BILINEAR, BY_DEPTH or BY_DEPTH_SIZE.
    margin : int
        Texels around the planes.
    """

    planes: Float
    center: Float
    offsets: Index
    weights: Float
    inner: Float
    numbers: Float
    mode: int
    margin: int


def spiral(params: Params = Params(), beyond: float = 0.0) -> Float:
    """The taps (N, 3): x, y [px], y down, and radius. By default 398, one per pi px^2. The bound moves by `beyond`."""
    own: Any = np.float32 if params.precision == "float32" else float
    radius, angle = own(params.first_radius), own(params.angle_start)
    taps: list[tuple[float, float, float]] = []
    step, growth, bound = own(params.angle_step), own(params.rad_scale), own(params.bound + beyond)
    most = math.inf if params.max_taps is None else params.max_taps
    down = params.scale_y if params.row_order == "down" else -params.scale_y
    while radius < bound and len(taps) < most:
        reach = float(radius)
        taps.append((math.cos(angle) * reach * params.scale_x, math.sin(angle) * reach * down, reach))
        radius += growth / radius
        angle += step
    return np.array(taps).reshape(-1, 3)


def sizes_of(coc: Float, largest: float) -> Float:
    """getBlurSize of the article: |coc|, at most the largest blur [px]."""
    return np.minimum(np.abs(coc), coc.dtype.type(largest))


def walk_of(color: Float, depth: Float, coc: Float, params: Params, beyond: float = 0.0) -> Walk:
    """Prepare validated pictures of one type: color (H, W, 3), depth (H, W), coc (H, W) [px], for `spiral`.

    Raises
    ------
    InputError
        If `coc` is no line over inverse depth where the depth filter needs one.
    """
    own, taps = color.dtype.type, spiral(params, beyond)
    places = taps[:, :2] + (params.shift_x, params.shift_y)
    margin = int(np.abs(places).max(initial=max(abs(params.shift_x), abs(params.shift_y)))) + 2
    mode, order, circle, line = _guides(depth, coc, params)
    planes = pad_each([*np.moveaxis(color, -1, 0), order, circle], margin, params.border)
    offsets, weights = texels_of(places, params, own)
    walk = Walk(
        planes,
        planes,
        offsets,
        weights,
        (taps[:, 2] - 0.5).astype(color.dtype),
        np.array([params.behind_factor, params.max_blur_size, *line], dtype=color.dtype),
        mode,
        margin,
    )
    return walk._replace(center=_center(walk, params))


def spread(walk: Walk, count: int | None = None) -> Float:
    """Run the first `count` taps, or all: (H, W, 3). A port's loop with a lower bound ends after as many."""
    first = slice(count)
    return _spread(walk.planes, walk.center, walk.offsets[first], walk.weights[first], walk.inner[first], *walk[5:])


def bands(walk: Walk) -> Iterator[tuple[slice, Walk]]:
    """The walk in bands of rows that fit a cache, for work in NumPy."""
    height, width = (side - 2 * walk.margin for side in walk.planes.shape[1:])
    step = max(1, _BAND // width)
    for top in range(0, height, step):
        rows = slice(top, min(top + step, height))
        part = np.s_[:, rows.start : rows.stop + 2 * walk.margin]
        yield rows, walk._replace(planes=walk.planes[part], center=walk.center[part])


def read_color(walk: Walk, offsets: Index, weights: Float) -> Float:
    """The colour that all pixels read at one offset, as `_spread` does: (3, H, W)."""
    x, y = offsets[:2].tolist()
    return blend_of_four(walk.planes[:3], walk.margin, x, y, weights[:2])


def read_guides(walk: Walk, offsets: Index, weights: Float) -> Float:
    """What all pixels read of depth at one offset, as `_spread` does: order, and size or circle (2, H, W)."""
    (x, y), planes = offsets[2:].tolist(), walk.planes[3:]
    if walk.mode == NEAREST:
        return window(planes, walk.margin, x, y)
    if walk.mode == BILINEAR:
        return blend_of_four(planes, walk.margin, x, y, weights[2:])
    (order,) = mix_of_four(planes[:1], walk.margin, x, y, weights[2:])
    circle = walk.numbers[2] + walk.numbers[3] / order
    if walk.mode == BY_DEPTH_SIZE:
        order = -np.clip(circle, -walk.numbers[1], walk.numbers[1])
    return np.stack([order, circle])


def _guides(depth: Float, coc: Float, params: Params) -> tuple[int, Float, Float, tuple[float, float]]:
    """Mode, what is compared, what is read as size, and the line that makes circles of depths."""
    signed_size = np.clip(coc, -coc.dtype.type(params.max_blur_size), coc.dtype.type(params.max_blur_size))
    by_size = params.order == "size"
    if params.depth_filter == "nearest":
        return NEAREST, -signed_size if by_size else -depth, sizes_of(coc, params.max_blur_size), (0.0, 0.0)
    if params.depth_filter == "bilinear":  # signed, so that a blend across the focal plane passes through 0
        nearness = 1.0 / np.maximum(depth, np.finfo(depth.dtype).tiny)
        return BILINEAR, -signed_size if by_size else nearness, coc, (0.0, 0.0)
    scaled, line = _line(depth, coc, params.max_blur_size)
    # A blend with the background is the background: so great a number that its inverse is nothing.
    finite = np.minimum(scaled, np.finfo(depth.dtype).max / 4)
    return BY_DEPTH_SIZE if by_size else BY_DEPTH, -finite, coc, line


def _line(depth: Float, coc: Float, largest: float) -> tuple[Float, tuple[float, float]]:
    """Depth in a unit that brings the nearest to 0.5 .. 1; a and b of circles a - b / depth."""
    nearest = float(depth.min(initial=np.inf))
    with np.errstate(over="ignore"):
        scaled = depth.astype(np.float64)
        scaled = np.ldexp(scaled, -int(np.frexp(nearest)[1])) if np.isfinite(nearest) else scaled
    nearness, circles = 1.0 / scaled, coc.astype(np.float64)
    far, near = (np.unravel_index(k, depth.shape) for k in (nearness.argmin(), nearness.argmax()))
    span = nearness[near] - nearness[far]
    fall = (circles[far] - circles[near]) / span if span > 0.0 else 0.0
    start = circles[far] + fall * nearness[far]
    off = np.abs(np.clip(start - fall * nearness, -largest, largest) - np.clip(circles, -largest, largest)).max()
    if off > _SLACK + 1e-6 * np.abs(circles).max():
        raise InputError(
            f"coc: is up to {off:.3g} px from a line over 1 / depth; allowed with depth_filter='bilinear_depth' is a "
            "thin lens's own"
        )
    return scaled, (float(start), float(fall))


def texels_of(places: Float, params: Params, own: type) -> tuple[Index, Float]:
    """Whole texels (N, 4) and bilinear weights (N, 4) of places [px], of colour and of depth."""
    split = [tap_of(dx, dy) for dx, dy in places]
    linear = np.array([t[:2] for t in split], dtype=np.int64).reshape(-1, 2)
    between: Float = np.array([t[2:] for t in split], dtype=own).reshape(-1, 2)
    nearest = np.floor(places + 0.5).astype(np.int64)
    color = (nearest, np.zeros_like(between)) if params.color_filter == "nearest" else (linear, between)
    depth = (nearest, np.zeros_like(between)) if params.depth_filter == "nearest" else (linear, between)
    offsets, weights = (np.concatenate(pair, axis=1) for pair in zip(color, depth, strict=True))
    return offsets, weights


def _center(walk: Walk, params: Params) -> Float:
    """What pixels read of themselves: the planes, but for shifts, sizes made of depths, and an order of nothing."""
    if not (params.shift_x or params.shift_y or params.order == "always" or walk.mode >= BY_DEPTH):
        return walk.planes
    offsets, weights = texels_of(np.array([[params.shift_x, params.shift_y]]), params, walk.inner.dtype.type)
    center = walk.planes.copy()
    inside = window(center, walk.margin, 0, 0)
    inside[:3], inside[3:] = read_color(walk, offsets[0], weights[0]), read_guides(walk, offsets[0], weights[0])
    if params.order == "always":
        inside[3] = np.inf
    return center


@kernel
def _spread(planes, center, offsets, weights, inner, numbers, mode, margin):
    """Run the spiral over all pixels, taps outside, pixels of a row inside: fields of `Walk` -> (H, W, 3)."""
    height, width = planes.shape[1] - 2 * margin, planes.shape[2] - 2 * margin
    out = np.empty((height, width, 3), dtype=planes.dtype)
    for y in prange(height):
        texels, pixels = borrow(planes), borrow(center)
        scalar = planes.dtype.type
        behind, largest = numbers[0], numbers[1]
        mean = np.empty((3, width), dtype=planes.dtype)
        cover = np.empty(width, dtype=planes.dtype)
        depth = np.empty(width, dtype=planes.dtype)
        size = np.empty(width, dtype=planes.dtype)
        here = pixels[3, y + margin, margin : margin + width]
        limit = pixels[4, y + margin, margin : margin + width].copy()
        for x in range(width):
            limit[x] = behind * min(abs(limit[x]), largest)
        for c in range(3):
            for x in range(width):
                mean[c, x] = pixels[c, y + margin, margin + x]
        for k in range(len(offsets)):
            nx, ny = offsets[k, 2] + margin, offsets[k, 3] + margin + y
            if mode == NEAREST:
                last = nx + width
                _reach(texels[3, ny, nx:last], texels[4, ny, nx:last], here, limit, inner[k], cover)
            else:
                last = nx + width + 1
                wx, wy = weights[k, 2], weights[k, 3]
                if mode == BILINEAR:
                    _filter(texels[3, ny, nx:last], texels[3, ny + 1, nx:last], wx, wy, depth)
                    _filter(texels[4, ny, nx:last], texels[4, ny + 1, nx:last], wx, wy, size)
                else:
                    _mix(texels[3, ny, nx:last], texels[3, ny + 1, nx:last], wx, wy, depth)
                    for x in range(width):
                        size[x] = numbers[2] + numbers[3] / depth[x]
                        if mode == BY_DEPTH_SIZE:
                            depth[x] = -min(max(size[x], -largest), largest)
                for x in range(width):
                    size[x] = min(abs(size[x]), largest)
                _reach(depth, size, here, limit, inner[k], cover)
            dx, dy, total = offsets[k, 0] + margin, offsets[k, 1] + margin + y, scalar(k + 1)
            for c in range(3):
                top, bottom = texels[c, dy, dx : dx + width + 1], texels[c, dy + 1, dx : dx + width + 1]
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
def _mix(top, bottom, wx, wy, out):
    """`_filter` for numbers of any ratio: a weight of 1 gives the second one, to the bit."""
    one = out.dtype.type(1)
    for x in range(len(out)):
        a = top[x] * (one - wx) + top[x + 1] * wx
        b = bottom[x] * (one - wx) + bottom[x + 1] * wx
        out[x] = a * (one - wy) + b * wy


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
