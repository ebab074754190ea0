"""Rays of the multiview method through its layers: the mean of what they hit, and the hits themselves.

One task owns a band of rows; sums are taken in float64, in the order of the lens points.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline, run_tasks, tile_kernel
from refdof.methods.multiview.ambiguous_rays import ray_is_ambiguous
from refdof.methods.multiview.fields import Fields, Ray, Search, borrow_fields, visit
from refdof.methods.multiview.first_hits import borrow_first_hits, first_hits, first_hits_of
from refdof.methods.multiview.height_field import next_hit
from refdof.optics.pixel_samples import LensPointSets
from refdof.optics.projection import Projection, pixel_ray
from refdof.raster.rays.gbuffer import GBUFFER_CHANNELS, shade_gbuffer
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces
from refdof.stages import StageRecorder

__all__ = [
    "Hits",
    "Shared",
    "culled_layers",
    "gather",
    "light_of",
    "pinhole_light",
    "ray_tangents",
    "record_rays",
    "shared_of",
    "trace_hits",
]

_ROWS_PER_TASK = 8


class Hits(NamedTuple):
    """What each ray meets. layer (H, W, N) int32: -1 the background, -2 not known, as the ray leaves the image;
    texel (H, W, N) int32: row * W + column, -1: none; coc (H, W, N): where along the ray [px], inf: nowhere;
    ambiguous (H, W, N) bool: a walk over every texel may answer otherwise (`refdof.methods.multiview.ambiguous_rays`).
    """

    layer: Index
    texel: Index
    coc: Float
    ambiguous: Index


class Shared(NamedTuple):
    """What all pixels share: their rays, how those search the layers, and what lights a hit and what a miss shows."""

    pattern: LensPointSets
    search: Search
    projection: Projection
    surfaces: Surfaces
    background: tuple[float, float, float]


def shared_of(
    fields: Fields, pattern: LensPointSets, search: Search, projection: Projection, surfaces: Surfaces, background: Any
) -> Shared:
    """`Shared` with points of the type of the fields' heights."""
    red, green, blue = (float(c) for c in background)
    pattern = pattern._replace(points=pattern.points.astype(fields.coc.dtype))
    return Shared(pattern, search, projection, surfaces, (red, green, blue))


def gather(
    fields: Fields,
    surface: Float,
    pattern: LensPointSets,
    search: Search,
    projection: Projection,
    surfaces: Surfaces,
    background: Any,
) -> Float:
    """Mean over the lens: (H, W, 3) float32.

    `surface` (K, H, W, C) holds colours, C = 3, or attributes to be shaded along each ray.
    """
    height, width = fields.coc.shape[1:]
    out = np.empty((height, width, 3), dtype=np.float32)
    shared = shared_of(fields, pattern, search, projection, surfaces, background)

    def band(first: int) -> None:
        _gather_rows(fields, surface, shared, first, min(first + _ROWS_PER_TASK, height), out)

    run_tasks(band, range(0, height, _ROWS_PER_TASK))
    return out


def trace_hits(fields: Fields, pattern: LensPointSets, search: Search) -> Hits:
    """The hit of every ray."""
    shape = (*fields.coc.shape[1:], pattern.points.shape[1])
    hits = Hits(
        np.empty(shape, np.int32),
        np.empty(shape, np.int32),
        np.empty(shape, fields.coc.dtype),
        np.empty(shape, np.bool_),
    )
    points = pattern.points.astype(fields.coc.dtype)

    def band(first: int) -> None:
        last = min(first + _ROWS_PER_TASK, shape[0])
        _hit_rows(fields, points, pattern.set, search, first, last, hits)

    run_tasks(band, range(0, shape[0], _ROWS_PER_TASK))
    return hits


def culled_layers(fields: Fields, search: Search) -> Any:
    """Layers that early culling skips: (K, H, W) bool."""
    out = np.ones(fields.coc.shape, dtype=np.bool_)
    run_tasks(lambda first: _cull_rows(fields, search, first, out), range(0, fields.coc.shape[1], _ROWS_PER_TASK))
    return out


def record_rays(recorder: StageRecorder, fields: Fields, pattern: LensPointSets, search: Search) -> None:
    """Record what early culling skips and what every ray hits."""
    if not recorder.on:
        return
    recorder.record("culled", lambda: culled_layers(fields, search))
    hits = trace_hits(fields, pattern, search)
    recorder.record("hit_layer", lambda: hits.layer)
    recorder.record("hit_texel", lambda: hits.texel)
    recorder.record("hit_coc", lambda: hits.coc)
    recorder.record("ambiguous", lambda: hits.ambiguous)


@tile_kernel
def _gather_rows(fields, surface, shared, first, last, out):
    """Rows first .. last - 1 of out (H, W, 3)."""
    fields, surface, out = borrow_fields(fields), borrow(surface), borrow(out)
    surfaces = borrow_surfaces(shared.surfaces)
    points, weights, sets = borrow(shared.pattern.points), borrow(shared.pattern.weights), borrow(shared.pattern.set)
    texels = surface.reshape(len(surface), out.shape[0] * out.shape[1], surface.shape[3])
    memory = np.empty(max(len(fields.coc), 1), dtype=np.int64)
    layers = borrow(memory)
    first_memory = first_hits_of(fields, shared.search, points.shape[1])
    found = borrow_first_hits(first_memory)
    half = points.dtype.type(0.5)
    for y in range(first, last):
        for x in range(out.shape[1]):
            visited = visit(fields, x, y, shared.search, layers)
            chosen = sets[y % len(sets), x % len(sets)]
            px, py = points.dtype.type(x) + half, points.dtype.type(y) + half
            first_hits(fields, visited, px, py, points[chosen], found)
            red = green = blue = total = 0.0
            for n in range(points.shape[1]):
                weight, vx, vy = weights[chosen, n], points[chosen, n, 0], points[chosen, n, 1]
                if weight == 0.0:
                    continue
                place, texel = found.begin[n], found.texel[n]
                if texel < 0:
                    place, i, j, _ = next_hit(fields, visited, place, Ray(px, py, vx, vy), shared.search)
                    texel = j * out.shape[1] + i
                if place == -2:
                    continue
                total += weight
                if place == -1:
                    r, g, b = shared.background
                else:
                    dx, dy = ray_tangents(shared.projection, x, y, vx, vy)
                    k = layers[place] if layers[place] >= 0 else ~layers[place]
                    r, g, b = light_of(surfaces, texels[k, texel], dx, dy)
                red, green, blue = red + weight * r, green + weight * g, blue + weight * b
            if total == 0.0:  # every ray leaves the image
                red, green, blue = pinhole_light(fields, texels, shared, x, y)
                total = 1.0
            out[y, x, 0], out[y, x, 1], out[y, x, 2] = red / total, green / total, blue / total
    memory[0] = first_memory.begin[0] = 0  # what is lent must not be freed before


@inline
def ray_tangents(projection, x, y, vx, vy):
    """Direction (dx, dy, -1) of the ray of pixel (x, y) through lens point v."""
    dx, dy = pixel_ray(projection, x, y)
    bend = projection.lens_radius * projection.inverse_focus
    return dx - bend * vx, dy - bend * vy


@inline
def pinhole_light(fields, texels, shared, x, y):
    """What the pinhole sees at pixel (x, y) of layers whose texels (K, >= H W, C) begin with the full picture."""
    for k in range(len(fields.coc)):
        if fields.coc[k, y, x] < np.inf:
            dx, dy = ray_tangents(shared.projection, x, y, 0.0, 0.0)
            return light_of(shared.surfaces, texels[k, y * fields.coc.shape[2] + x], dx, dy)
    return shared.background


@inline
def light_of(surfaces, surface, dx, dy):
    """A texel's colour, or its attributes shaded along the ray; further channels have no part."""
    if len(surface) < GBUFFER_CHANNELS:
        return np.float64(surface[0]), np.float64(surface[1]), np.float64(surface[2])
    return shade_gbuffer(surfaces, surface, dx, dy, -1.0)


@tile_kernel
def _hit_rows(fields, points, sets, search, first, last, hits):
    """Rows first .. last - 1 of `hits`."""
    layers = np.empty(len(fields.coc), dtype=np.int64)
    half = points.dtype.type(0.5)
    for y in range(first, last):
        for x in range(fields.coc.shape[2]):
            visited = visit(fields, x, y, search, layers)
            chosen = sets[y % len(sets), x % len(sets)]
            px, py = points.dtype.type(x) + half, points.dtype.type(y) + half
            for n in range(points.shape[1]):
                ray = Ray(px, py, points[chosen, n, 0], points[chosen, n, 1])
                place, i, j, c = next_hit(fields, visited, 0, ray, search)
                k = layers[place] if place >= 0 else place
                hits.layer[y, x, n] = ~k if place >= 0 and k < 0 else k
                hits.texel[y, x, n] = j * fields.coc.shape[2] + i if place >= 0 else -1
                hits.coc[y, x, n] = c if place >= 0 else np.inf
                hits.ambiguous[y, x, n] = ray_is_ambiguous(fields, visited, ray, search)


@tile_kernel
def _cull_rows(fields, search, first, out):
    """A band of rows of out (K, H, W), which starts as True."""
    layers = np.empty(len(fields.coc), dtype=np.int64)
    for y in range(first, min(first + _ROWS_PER_TASK, out.shape[1])):
        for x in range(out.shape[2]):
            for k in layers[: visit(fields, x, y, search, layers).length]:
                out[k if k >= 0 else ~k, y, x] = False
