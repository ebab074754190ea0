"""Exact layers: every surface that the ray through a pixel's centre meets, front to back.

Embree reports each triangle along a ray once, in one traversal, without stepping; depth and barycentrics are then
computed in float64. Surfaces are ordered by (depth, triangle id), so coplanar duplicates, where two triangles meet a
ray at the same depth, have one stated order. A ray through an edge or a corner that triangles of one surface share
meets that surface once: the lowest triangle id is kept. At a silhouette, front and back meet the ray in one point and
both count.

A hole is no surface. A transparent surface is one, whose colour is what its pixel's ray sees through it: its own over
the next one's, by its opacity, and so on up to the first opaque one or the background [1].

With an umbra step, only the surfaces that the lens can see past the one before are kept, as `refdof.raster.rays.umbra`
has it: what is dropped is never stored.

References
----------
.. [1] Everitt (2001), Interactive Order-Independent Transparency (depth peeling).
.. [2] Shade et al. (1998), Layered Depth Images, SIGGRAPH.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index, as_integer
from refdof._jit import call_address, inline, run_tasks, tile_kernel
from refdof.optics.projection import Projection, pixel_ray
from refdof.raster.materials.cutouts import opacity_at
from refdof.raster.rays.embree import Tracer, new_collector
from refdof.raster.rays.shading import shade, shading_normal
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces, cutouts_in, intersect
from refdof.raster.rays.umbra import reach_beyond

__all__ = ["Layers", "count_surfaces", "exact_layers"]

_FIRST_CAPACITY = 256
_ROWS_PER_TASK = 8
_MANY = 16  # layers: to count them first is cheaper than memory for empty ones
_SAME_DEPTH = 1e-12  # relative: float64 roundings of one point's depth on two planes
_ON_RIM = 1e-9  # barycentric: nearer to an edge than this, float32 and float64 may disagree on the side


class Layers(NamedTuple):
    """N surfaces per pixel, front to back; an empty slot has depth inf, triangle -1 and zeros.

    color (N, H, W, 3) float32, linear RGB; depth (N, H, W) float64 [scene units]; normal (N, H, W, 3) float32,
    camera space, towards the viewer; triangle (N, H, W) int32.
    """

    color: Float
    depth: Float
    normal: Float
    triangle: Index


def exact_layers(
    surfaces: Surfaces, tracer: Tracer, projection: Projection, count: int | None = None, umbra_step: float = 0.0
) -> Layers:
    """The nearest `count` surfaces at every pixel centre; None: as many as the deepest pixel has.

    Of a count above 16 no more layers are made than the deepest pixel has, and one empty one.

    umbra_step is how far a kept surface hides those behind it, in inverse depth [1 / unit of `surfaces`]: 0 keeps all,
    coplanar ones included.

    Raises
    ------
    InputError
        If count < 1.
    """
    if count is None:
        count = max(1, int(count_surfaces(surfaces, tracer, projection, umbra_step).max(initial=0)))
    count = as_integer("count", count, minimum=1)
    if count > _MANY:  # one empty layer more than the deepest pixel needs shows that nothing is left
        count = min(count, 1 + int(count_surfaces(surfaces, tracer, projection, umbra_step).max(initial=0)))
    shape = (count, projection.height, projection.width)
    layers = Layers(
        np.zeros((*shape, 3), dtype=np.float32),
        np.full(shape, np.inf),
        np.zeros((*shape, 3), dtype=np.float32),
        np.full(shape, -1, dtype=np.int32),
    )
    _run(surfaces, tracer, projection, layers, umbra_step)
    return layers


def count_surfaces(surfaces: Surfaces, tracer: Tracer, projection: Projection, umbra_step: float = 0.0) -> Index:
    """How many surfaces the ray through each pixel's centre meets, or the lens can see: (H, W) int32."""
    empty = (0, projection.height, projection.width)
    layers = Layers(
        np.zeros((*empty, 3), dtype=np.float32),
        np.zeros(empty),
        np.zeros((*empty, 3), dtype=np.float32),
        np.zeros(empty, dtype=np.int32),
    )
    return _run(surfaces, tracer, projection, layers, umbra_step)


def _run(surfaces: Surfaces, tracer: Tracer, projection: Projection, layers: Layers, umbra_step: float) -> Index:
    """Fill `layers` in bands of rows; a band with more surfaces than expected is run again with more room."""
    counts = np.zeros((projection.height, projection.width), dtype=np.int32)

    def band(first: int) -> None:
        last, capacity = min(first + _ROWS_PER_TASK, projection.height), _FIRST_CAPACITY
        while True:
            memory = new_collector(capacity)
            call = tracer.scene, tracer.single
            found = _layers_of_rows(surfaces, call, projection, umbra_step, first, last, memory, layers, counts)
            if found <= capacity:
                return
            capacity = 2 * found

    run_tasks(band, range(0, projection.height, _ROWS_PER_TASK))
    return counts


@tile_kernel
def _layers_of_rows(surfaces, call, projection, umbra_step, first, last, memory, layers, counts):
    """Peel rows first .. last - 1. `memory` is laid out by `new_collector`. Returns the most hits of a pixel.

    call: addresses of Embree's scene and of the function that traces one ray.
    """
    surfaces, (scene, single) = borrow_surfaces(surfaces), call
    capacity = memory.room
    triangle = np.empty(capacity, dtype=np.int32)
    depth = np.empty(capacity)
    place = np.arange(capacity)
    seen = np.empty((capacity if surfaces.blends else 0, 3))
    unit = 2.0**surfaces.exponent
    most = 0
    for y in range(first, last):
        for x in range(projection.width):
            dx, dy = pixel_ray(projection, x, y)
            _aim(memory, dx, dy)
            call_address(single, scene, memory.ray_address, memory.arguments_address, 0)
            found = min(memory.context[3], capacity)
            kept = 0
            for k in range(found):
                face = memory.context[4 + k]
                t, u, v = intersect(surfaces.corner, face, 0.0, 0.0, 0.0, dx, dy, -1.0)
                if t > 0.0 and t < np.inf and opacity_at(cutouts_in(surfaces), face, u, v) > 0.0:
                    kept = _insert(depth, triangle, kept, t, face)
            most = max(most, memory.context[3])
            kept = _once_per_surface(surfaces.corner, depth, triangle, kept, dx, dy)
            if surfaces.blends and len(layers.depth) > 0:  # not where surfaces are only counted
                _see_through(surfaces, triangle, kept, dx, dy, seen)
            if umbra_step > 0.0:
                kept = _drop_hidden(depth, triangle, place, kept, umbra_step)
            counts[y, x] = kept
            for k in range(min(kept, len(layers.depth))):
                face = triangle[k]
                _, u, v = intersect(surfaces.corner, face, 0.0, 0.0, 0.0, dx, dy, -1.0)
                layers.depth[k, y, x] = depth[k] * unit
                layers.triangle[k, y, x] = face
                if surfaces.blends:
                    red, green, blue = seen[place[k], 0], seen[place[k], 1], seen[place[k], 2]
                else:
                    red, green, blue = shade(surfaces, face, u, v, dx, dy, -1.0)
                layers.color[k, y, x, 0], layers.color[k, y, x, 1], layers.color[k, y, x, 2] = (
                    red,
                    green,
                    blue,
                )
                nx, ny, nz = shading_normal(surfaces, face, 1.0 - u - v, u, v, dx, dy, -1.0)
                layers.normal[k, y, x, 0], layers.normal[k, y, x, 1], layers.normal[k, y, x, 2] = nx, ny, nz
    return most


@inline
def _aim(memory, dx, dy):
    """Write a fresh ray from the eye along (dx, dy, -1) and empty the list of hits."""
    ray = memory.ray
    for k in range(24):
        ray[k] = 0.0
    ray[4], ray[5], ray[6], ray[8] = dx, dy, -1.0, np.inf
    memory.ray_integers[9] = -1  # mask
    memory.ray_integers[18] = -1  # geometry
    memory.ray_integers[19] = -1  # instance
    memory.context[3] = 0


@inline
def _insert(depth, triangle, count, t, face):
    """Insert a hit into lists of `count` hits ordered by (depth, triangle); returns the new count.

    Embree may report a triangle twice where its tree splits it.
    """
    k = count
    while k > 0 and (depth[k - 1] > t or (depth[k - 1] == t and triangle[k - 1] >= face)):
        k -= 1
    if k < count and depth[k] == t and triangle[k] == face:
        return count
    for i in range(count, k, -1):
        depth[i], triangle[i] = depth[i - 1], triangle[i - 1]
    depth[k], triangle[k] = t, face
    return count + 1


@inline
def _once_per_surface(corner, depth, triangle, count, dx, dy):
    """Drop hits on an edge or corner that a kept hit of the same surface shares; returns the new count."""
    kept = 0
    for k in range(count):
        again = False
        for j in range(kept - 1, -1, -1):
            if depth[k] - depth[j] > _SAME_DEPTH * depth[k]:
                break
            again = again or _share_point(corner, triangle[j], triangle[k], dx, dy)
        if not again:
            depth[kept], triangle[kept] = depth[k], triangle[k]
            kept += 1
    return kept


@inline
def _see_through(surfaces, triangle, count, dx, dy, seen):
    """Write the colour of each surface and of what shows through it to seen (count, 3), from back to front."""
    red, green, blue = surfaces.light[5, 0], surfaces.light[5, 1], surfaces.light[5, 2]
    for k in range(count - 1, -1, -1):
        face = triangle[k]
        _, u, v = intersect(surfaces.corner, face, 0.0, 0.0, 0.0, dx, dy, -1.0)
        opacity = opacity_at(cutouts_in(surfaces), face, u, v)
        r, g, b = shade(surfaces, face, u, v, dx, dy, -1.0)
        if opacity == 1.0:  # to the bit, as in an opaque scene
            red, green, blue = r, g, b
        else:
            rest = 1.0 - opacity
            red, green, blue = opacity * r + rest * red, opacity * g + rest * green, opacity * b + rest * blue
        seen[k, 0], seen[k, 1], seen[k, 2] = red, green, blue


@inline
def _drop_hidden(depth, triangle, place, count, umbra_step):
    """Drop surfaces in the umbra of the kept one before and note where the others were; returns the new count."""
    kept, reach = 0, np.inf
    for k in range(count):
        nearness = 1.0 / depth[k]
        if nearness > 0.0 and nearness < reach:
            reach = reach_beyond(nearness, umbra_step)
            depth[kept], triangle[kept], place[kept] = depth[k], triangle[k], k
            kept += 1
    return kept


@inline
def _share_point(corner, a, b, dx, dy):
    """Whether two triangles face the ray alike, share one or two corners, and the ray runs along their rims."""
    _, ua, va = intersect(corner, a, 0.0, 0.0, 0.0, dx, dy, -1.0)
    _, ub, vb = intersect(corner, b, 0.0, 0.0, 0.0, dx, dy, -1.0)
    if min(ua, va, 1.0 - ua - va) > _ON_RIM or min(ub, vb, 1.0 - ub - vb) > _ON_RIM:
        return False
    shared = 0
    for i in range(0, 9, 3):
        for j in range(0, 9, 3):
            same = corner[a, i] == corner[b, j] and corner[a, i + 1] == corner[b, j + 1]
            if same and corner[a, i + 2] == corner[b, j + 2]:
                shared += 1
    return (shared == 1 or shared == 2) and _faces(corner, a, dx, dy) == _faces(corner, b, dx, dy)


@inline
def _faces(corner, face, dx, dy):
    """Whether the ray (dx, dy, -1) meets the side from which the corners run clockwise."""
    c = corner[face]
    ex, ey, ez = c[3] - c[0], c[4] - c[1], c[5] - c[2]
    fx, fy, fz = c[6] - c[0], c[7] - c[1], c[8] - c[2]
    return (ey * fz - ez * fy) * dx + (ez * fx - ex * fz) * dy - (ex * fy - ey * fx) > 0.0
