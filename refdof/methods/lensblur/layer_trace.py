"""Layer trace: all lens rays of every pixel, through packed layers, averaged.

All this is done for a tile of neighbouring pixels, one ray of each at a time:

1. the depths at which the pixels' rays can hit each pack    `refdof.methods.lensblur.footprint`
2. the rays                                                  `refdof.methods.lensblur.tile_rays`
3. the nearest hit of each over all packs, or a miss         `refdof.methods.lensblur.tile_walk`
4. its colour, or its attributes shaded                      `refdof.methods.lensblur.tile_color`, `_hit_color`

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
from refdof.methods.lensblur.texel_walk import Hit, Ray, neighbours, pack_layers
from refdof.methods.lensblur.tile_color import add_beside, look_beside, new_beside
from refdof.methods.lensblur.tile_rays import (
    aim,
    brightness,
    cut_rays,
    enter,
    is_mapped,
    is_missed,
    new_mapped_memory,
)
from refdof.methods.lensblur.tile_walk import LANES, PLACES, TILE, new_lanes, walk_tile
from refdof.optics.pixel_samples import LensPointSets
from refdof.optics.projection import Projection
from refdof.optics.ray_map import RayMap
from refdof.raster.filters.n_buffer import n_buffer
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS, shade_gbuffer
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces

__all__ = ["MISSES", "Choices", "Stack", "Traced", "new_stack", "trace_layers"]

MISSES = ("renormalise", "black", "pinhole")
_RENORMALISE, _BLACK, _PINHOLE = range(3)
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
    `LensPointSets`; spread: the points' largest coordinate; focus [px of parallax]; top (G,): each pack's greatest
    parallax; misses: an index of `MISSES`; ray_map, wavelength: as in `trace_layers`.
    """

    points: Float
    weights: Float
    sets: Any
    spread: float
    focus: float
    top: Float
    stride: int
    iterations: int
    misses: int
    linear: bool
    projection: Projection
    ray_map: RayMap | None
    wavelength: int


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
    ray_map: RayMap | None = None,
    wavelength: int = 0,
) -> Traced:
    """Trace a lens's rays.

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
        A map needs a stride.
    ray_map, wavelength : RayMap, int
        A lens's map, whose rays `pattern` names by points of the unit square, and the index of its wavelength; None:
        a thin lens, whose points they are.
    """
    groups, height, width, _ = stack.packs.shape
    dtype = stack.packs.dtype
    points = pattern.points if ray_map is not None else pattern.points * [1.0, -1.0]  # x right, y down
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
        points.astype(dtype), pattern.weights, pattern.set, float(np.abs(points).max(initial=0.0)), scalar(focus), top,
        choices.stride, choices.iterations, MISSES.index(choices.misses), bool(choices.linear),
        projection, ray_map, wavelength,
    )  # fmt: skip
    tops = np.ascontiguousarray(stack.packs[..., 0])
    if values.shape[3] == 3:  # a fourth number, which sums up the weights
        color, values = values, np.ones((*values.shape[:3], 4), dtype=values.dtype)
        values[..., :3] = color
    stack = stack._replace(extension=scalar(stack.extension))

    def band(first: int) -> None:
        last = min(first + _ROWS_PER_TASK, height)
        _trace_rows(stack, tops, values, surfaces, shared, pinhole, first, last, traced)

    run_tasks(band, range(0, height, _ROWS_PER_TASK))
    return traced


@tile_kernel
def _trace_rows(stack, tops, values, surfaces, shared, pinhole, first, last, traced):
    """Trace rows first .. last - 1."""
    stack = Stack(
        borrow(stack.packs), borrow(stack.lowest), borrow(stack.highest), stack.block, stack.extension, stack.last
    )
    surfaces, values, tops = borrow_surfaces(surfaces), borrow(values), borrow(tops)
    texels = values.reshape(-1, values.shape[3])
    points, weights, sets = borrow(shared.points), borrow(shared.weights), shared.sets
    packs, misses = stack.packs, shared.misses
    groups, width, scalar = packs.shape[0], packs.shape[2], packs.dtype.type
    numbers, places = np.empty(LANES * TILE, dtype=packs.dtype), np.empty(PLACES * TILE, dtype=np.uint32)
    lanes, beside = new_lanes(borrow(numbers), borrow(places)), new_beside(borrow(numbers), borrow(places))
    projection, ray_map = shared.projection, shared.ray_map
    own = new_mapped_memory(ray_map, TILE, points.shape[1])
    chosen, inside, weight = np.empty(TILE, np.int64), np.empty(TILE, np.bool_), np.empty(TILE)
    sums, missed = np.empty((TILE, 4)), np.empty(TILE)
    for y in range(first, last):
        for left in range(0, width, TILE):
            count = min(TILE, width - left)
            near = borrow(traced.near)[:, y, left : left + count]
            far = borrow(traced.far)[:, y, left : left + count]
            for k in range(count):
                chosen[k] = sets[y % len(sets), (left + k) % len(sets)]
                lanes.center[k], lanes.walked[k] = scalar(left + k) + scalar(0.5), scalar(0.0)
            within = cut_rays(stack, shared, own, points, chosen, left, y, near, far, inside)
            sums[:], missed[:] = 0.0, 0.0
            for n in range(points.shape[1]):
                aim(ray_map, own, shared.focus, points, weights, chosen, n, y, lanes, weight, count)
                if not within:
                    enter(tops[0], shared, inside, lanes, count)
                for group in range(groups):
                    walk_tile(packs, group, tops[group], lanes, near[group], far[group], stack.extension)
                if shared.linear and values.shape[3] == 4:
                    look_beside(tops[0], lanes, beside, count)
                else:
                    beside.same[:] = scalar(0.0)
                for k in range(count):
                    if beside.same[k] > 0.0:
                        add_beside(sums, k, weight[k], texels, beside)
                    elif weight[k] != 0.0:
                        ray = Ray(lanes.ax[k], lanes.ay[k], lanes.wx[k], lanes.wy[k])
                        if lanes.layer[k] < 0.0:
                            if is_missed(stack, ray, lanes.border[k], inside[k]):
                                missed[k] += weight[k]
                                continue
                            r, g, b = surfaces.light[5, 0], surfaces.light[5, 1], surfaces.light[5, 2]
                        else:
                            hit = Hit(int(lanes.layer[k]), int(lanes.hit_x[k]), int(lanes.hit_y[k]), lanes.best[k])
                            r, g, b = _hit_color(surfaces, projection, packs, values, shared.linear, hit, ray)
                        sums[k, 0] += weight[k] * r
                        sums[k, 1] += weight[k] * g
                        sums[k, 2] += weight[k] * b
                        sums[k, 3] += weight[k]
            for k in range(count):
                x, (red, green, blue, total) = left + k, (sums[k, 0], sums[k, 1], sums[k, 2], sums[k, 3])
                if misses == _PINHOLE or (misses == _RENORMALISE and total == 0.0):
                    red += missed[k] * pinhole[y, x, 0]
                    green += missed[k] * pinhole[y, x, 1]
                    blue += missed[k] * pinhole[y, x, 2]
                if misses != _RENORMALISE or total == 0.0:
                    total += missed[k]
                image = traced.image[y, x]
                if is_mapped(ray_map):
                    total = max(total, 1e-300) / brightness(ray_map, own, k, points.shape[1])  # no light: all are 0
                image[0], image[1], image[2] = red / total, green / total, blue / total
                traced.steps[y, x], traced.missed[y, x] = lanes.walked[k] / points.shape[1], missed[k] / points.shape[1]
    numbers[0], places[0] = scalar(0.0), np.uint32(0)  # memory that is lent must not be freed before


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
