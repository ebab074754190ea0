"""Layer trace: all lens rays of every pixel, through packed layers, averaged.

1. the rays of a pixel                                       `_aim_thin_lens`
2. the depths at which they can hit each pack                `refdof.methods.lensblur.footprint`
3. the nearest hit of each ray over all packs, or a miss     `_hit`
4. its colour, or its attributes shaded                      `_hit_color`

A ray that meets nothing sees the background where that is certain. It is a miss

- if it ends outside the picture,
- if it comes into the picture behind the surfaces at its border: what it met outside is not known,
- if it ends behind a stack that is full, where layers may be missing.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, run_tasks, tile_kernel
from refdof.image.bilinear import bilinear
from refdof.methods.lensblur.footprint import narrow, ray_bounds
from refdof.methods.lensblur.texel_walk import PACK, Hit, Ray, enter_picture, first_hit, neighbours, pack_layers
from refdof.optics.pixel_samples import LensPointSets
from refdof.optics.projection import Projection
from refdof.raster.filters.n_buffer import n_buffer
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS, shade_gbuffer
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces

__all__ = ["MISSES", "Choices", "Stack", "Traced", "new_stack", "trace_layers"]

MISSES = ("renormalise", "black", "pinhole")
_RENORMALISE, _BLACK, _PINHOLE = range(3)
_MISS, _BACKGROUND = -2, -1
_ROWS_PER_TASK = 4


class Stack(NamedTuple):
    """Packed layers of a picture, and their N-buffers.

    packs (G, H, W, 4) in px of parallax, -inf is empty; lowest, highest (G, L, h, w) of blocks of `block` px; extension
    [px of parallax] as in `first_hit`; last: the layer behind which more may be, -1 if all are here.
    """

    packs: Float
    lowest: Float
    highest: Float
    block: int
    extension: float
    last: int


class Choices(NamedTuple):
    """How to trace: stride and iterations of `narrow`; misses, one of `MISSES`; whether to read values bilinearly."""

    stride: int = 0
    iterations: int = 3
    misses: str = "renormalise"
    linear: bool = False


class _Shared(NamedTuple):
    """What all pixels share. points (K, R, 2) [right and down per px of parallax], weights (K, R), sets as in
    `LensPointSets`; focus [px of parallax]; top (G,): each pack's greatest parallax; misses: an index of `MISSES`.
    """

    points: Float
    weights: Float
    sets: Any
    focus: float
    top: Float
    stride: int
    iterations: int
    misses: int
    linear: bool


class Traced(NamedTuple):
    """image (H, W, 3) float32; near, far (G, H, W) px of parallax; steps (H, W) per ray; missed (H, W), a share."""

    image: Float
    near: Float
    far: Float
    steps: Float
    missed: Float


def new_stack(parallax: Float, extension: float, complete: bool, block: int = 2) -> Stack:
    """Pack layers (N, H, W) [px of parallax], -inf where empty, front to back, with an N-buffer for each pack.

    `complete`: there are no more layers than these.
    """
    packs = pack_layers(parallax)
    buffers = [n_buffer(pack.transpose(2, 0, 1), block=block) for pack in packs]
    lowest = np.stack([buffer.lowest for buffer in buffers])
    highest = np.stack([buffer.highest for buffer in buffers])
    return Stack(packs, lowest, highest, block, extension, -1 if complete else len(parallax) - 1)


def trace_layers(
    stack: Stack,
    values: Float,
    surfaces: Surfaces,
    projection: Projection,
    focus: float,
    pattern: LensPointSets,
    pinhole: Float,
    choices: Choices = Choices(),
) -> Traced:
    """Trace a thin lens's rays.

    Parameters
    ----------
    stack : Stack
    values : (N, H, W, 3) or (N, H, W, 13) float32
        Colours, or attributes to be shaded.
    surfaces : Surfaces
        Lights and background.
    projection : Projection
    focus : float
        The focal plane [px of parallax].
    pattern : LensPointSets
    pinhole : (H, W, 3) float32
        What missed rays see if misses are "pinhole", or if they are "renormalise" and no ray is left.
    choices : Choices
    """
    groups, height, width, _ = stack.packs.shape
    dtype = stack.packs.dtype
    points = pattern.points * [1.0, -1.0]  # x right, y down
    traced = Traced(
        np.empty((height, width, 3), dtype=np.float32),
        np.empty((groups, height, width), dtype=dtype),
        np.empty((groups, height, width), dtype=dtype),
        np.empty((height, width), dtype=np.float32),
        np.empty((height, width), dtype=np.float32),
    )
    scalar: Any = dtype.type
    top = np.maximum(stack.highest.reshape(groups, -1).max(axis=1), -1.0)
    shared = _Shared(
        points.astype(dtype), pattern.weights, pattern.set, scalar(focus), top, choices.stride, choices.iterations,
        MISSES.index(choices.misses), bool(choices.linear),
    )  # fmt: skip
    stack = stack._replace(extension=scalar(stack.extension))

    def band(first: int) -> None:
        last = min(first + _ROWS_PER_TASK, height)
        _trace_rows(stack, values, surfaces, projection, shared, pinhole, first, last, traced)

    run_tasks(band, range(0, height, _ROWS_PER_TASK))
    return traced


@tile_kernel
def _trace_rows(stack, values, surfaces, projection, shared, pinhole, first, last, traced):
    """Trace rows first .. last - 1."""
    stack = Stack(
        borrow(stack.packs), borrow(stack.lowest), borrow(stack.highest), stack.block, stack.extension, stack.last
    )
    surfaces, values = borrow_surfaces(surfaces), borrow(values)
    points, weights, sets = borrow(shared.points), borrow(shared.weights), shared.sets
    packs, focus, top, misses = stack.packs, shared.focus, shared.top, shared.misses
    scalar = packs.dtype.type
    groups, height, width = packs.shape[:3]
    rays = np.empty((4, points.shape[1]), dtype=packs.dtype)
    near, far = np.empty(groups, dtype=packs.dtype), np.empty(groups, dtype=packs.dtype)
    for y in range(first, last):
        for x in range(width):
            chosen = sets[y % len(sets), x % len(sets)]
            center = scalar(x) + scalar(0.5), scalar(y) + scalar(0.5), focus
            _aim_thin_lens(points[chosen], center, rays)
            inside = _all_inside(rays, max(top.max(), scalar(0.0)), width, height)
            for group in range(groups):
                near[group], far[group] = narrow(
                    stack, group, rays, shared.stride, center, top[group], scalar(0.0), shared.iterations
                )
                traced.near[group, y, x], traced.far[group, y, x] = near[group], far[group]
            total, missed, steps = 0.0, 0.0, 0
            red = green = blue = 0.0
            for n in range(rays.shape[1]):
                weight = weights[chosen, n]
                if weight == 0.0:
                    continue
                ray = Ray(rays[0, n], rays[1, n], rays[2, n], rays[3, n])
                layer, at_x, at_y, u, walked = _hit(stack, ray, near, far, inside)
                steps += walked
                if layer == _MISS:
                    missed += weight
                    continue
                if layer == _BACKGROUND:
                    r, g, b = surfaces.light[5, 0], surfaces.light[5, 1], surfaces.light[5, 2]
                else:
                    hit = Hit(layer, at_x, at_y, u)
                    r, g, b = _hit_color(surfaces, projection, packs, values, shared.linear, hit, ray)
                red, green, blue, total = red + weight * r, green + weight * g, blue + weight * b, total + weight
            if misses == _PINHOLE or (misses == _RENORMALISE and total == 0.0):
                red += missed * pinhole[y, x, 0]
                green += missed * pinhole[y, x, 1]
                blue += missed * pinhole[y, x, 2]
            if misses != _RENORMALISE or total == 0.0:
                total += missed
            image = traced.image[y, x]
            image[0], image[1], image[2] = red / total, green / total, blue / total
            traced.steps[y, x], traced.missed[y, x] = steps / rays.shape[1], missed / rays.shape[1]


@inline
def _aim_thin_lens(lens, center, rays):
    """Rays (4, R): through the pixel's centre at u = focus, apart by the lens points (R, 2) per px of parallax."""
    for n in range(len(lens)):
        wx, wy = lens[n, 0], lens[n, 1]
        rays[0, n], rays[1, n] = center[0] - center[2] * wx, center[1] - center[2] * wy
        rays[2, n], rays[3, n] = wx, wy


@inline
def _all_inside(rays, near, width, height):
    """Whether no ray (4, R) leaves the picture between u = near and infinity (u = 0)."""
    x0, y0, x1, y1 = ray_bounds(rays, 1, near, rays.dtype.type(0.0))
    return x0 >= 0.0 and y0 >= 0.0 and x1 < width and y1 < height


@inline
def _hit(stack, ray, near, far, inside):
    """What a ray meets: layer (_BACKGROUND, _MISS), x, y, u, and the texels walked."""
    packs, last, scalar = stack.packs, stack.last, stack.packs.dtype.type
    height, width = packs.shape[1], packs.shape[2]
    border = scalar(np.inf)
    if not inside:
        border = enter_picture(width, height, ray)
        if border < 0.0:
            return _MISS, 0, 0, border, 0
        if border < np.inf:
            x = int(min(max(ray.ax + border * ray.wx, scalar(0.0)), scalar(width - 1)))
            y = int(min(max(ray.ay + border * ray.wy, scalar(0.0)), scalar(height - 1)))
            if packs[0, y, x, 0] > border:
                return _MISS, 0, 0, border, 0
    layer, x, y, best, steps = _BACKGROUND, 0, 0, scalar(-1.0), 0
    for group in range(len(packs)):
        begin, end = min(near[group], border), max(far[group], best)
        if begin < end:
            continue
        slot, at_x, at_y, u, walked = first_hit(packs, group, ray, begin, end, stack.extension)
        steps += walked
        if slot >= 0 and u > best:
            layer, x, y, best = group * PACK + slot, at_x, at_y, u
    if layer == _BACKGROUND and not (inside and last < 0):
        if not (0.0 <= ray.ax < width and 0.0 <= ray.ay < height):
            return _MISS, 0, 0, best, steps
        if last >= 0 and packs[last // PACK, int(ray.ay), int(ray.ax), last % PACK] > 0.0:
            return _MISS, 0, 0, best, steps
    return layer, x, y, best, steps


@inline
def _hit_color(surfaces, projection, packs, values, linear, hit, ray):
    """Linear RGB of what a ray meets."""
    ax, ay, scalar = ray.ax, ray.ay, packs.dtype.type
    r, g, b = _radiance(surfaces, projection, values, hit.layer, hit.x, hit.y, ax, ay)
    if linear:
        right = ax + hit.u * ray.wx - scalar(hit.x) - scalar(0.5)
        down = ay + hit.u * ray.wy - scalar(hit.y) - scalar(0.5)
        across, along, corner, fx, fy = neighbours(packs, hit, right, down)
        r1, g1, b1 = _radiance(surfaces, projection, values, *across, ax, ay)
        r2, g2, b2 = _radiance(surfaces, projection, values, *along, ax, ay)
        r3, g3, b3 = _radiance(surfaces, projection, values, *corner, ax, ay)
        r = bilinear(r, r1, r2, r3, fx, fy)
        g = bilinear(g, g1, g2, g3, fx, fy)
        b = bilinear(b, b1, b2, b3, fx, fy)
    return r, g, b


@inline
def _radiance(surfaces, projection, values, layer, x, y, ax, ay):
    """Linear RGB of a sample: its colour, or its attributes seen along the ray that ends at (ax, ay)."""
    value = values[layer, y, x]
    if len(value) != GBUFFER_CHANNELS:
        return value[0], value[1], value[2]
    dx, dy = (
        (ax - 0.5 * projection.width) / projection.pixels_per_tangent,
        (0.5 * projection.height - ay) / projection.pixels_per_tangent,
    )
    return shade_gbuffer(surfaces, value, dx, dy, -1.0)
