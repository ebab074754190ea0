"""Lens rays: generate, trace and shade every lens sample of a tile of pixels, fused, in bounded memory.

For 16 pixels and one cell of the lens at a time:

1. every pixel draws its own point of that cell, once per replicate   `_square_points`, `_on_lens`, `_towards_focus`
2. 16 rays are a packet, or 8                                         `_fill_packets`
3. Embree finds the triangle each ray meets first
4. depth, barycentrics and colour follow in float64                   `_gather`

A packet is fast if its rays meet the same triangles. The replicates of one pixel in one cell do; where there are fewer
replicates than rays in a packet, so do neighbouring cells of neighbouring pixels. The layout changes no bit.

A thin lens's ray starts at the lens point (E vx, E vy, 0) and passes its pixel's point on the focal plane. A system's
ray starts where it crosses the plane of the entrance pupil, and has a weight, `refdof.optics.systems.lens_map`; that of
an expressive lens is bent by the place in the aperture, `refdof.optics.expressive_map`. All directions have z = -1, so
that the ray parameter is the planar depth.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, call_address, fetch_row, inline, tile_kernel
from refdof.optics.aperture import concentric_disc
from refdof.optics.aperture_sampling import ApertureSampler, borrow_aperture_sampler, is_plain_disc, lens_point
from refdof.optics.owen_sobol import axis_seed, borrow_block, mix64, reverse_bits, scramble, scramble_state
from refdof.optics.projection import Projection
from refdof.optics.ray_map import RayMap, borrow_ray_map, ray_block
from refdof.optics.systems.lens_map import new_scratch
from refdof.raster.rays.embree import LANES, ROWS, Row
from refdof.raster.rays.shading import shade
from refdof.raster.rays.surfaces import borrow_surfaces, intersect

__all__ = ["Aim", "Traversal", "trace_block"]

_UNIT = 2.0**-32
_LEAST = 1e-18  # of a slope: Embree inverts a smaller one as if it were above 0, and where it is not, rays go astray
_NEAREST = float(np.finfo(np.float32).tiny)  # depth: what lies in the plane of the lens is not seen
_FINE = 16  # so many times as many cells as share a packet: fewer are too far apart
_X, _Y, _Z, _NEAR = Row.ORG_X, Row.ORG_Y, Row.ORG_Z, Row.TNEAR
_DX, _DY, _DZ, _FAR = Row.DIR_X, Row.DIR_Y, Row.DIR_Z, Row.TFAR
_MASK, _ID, _PRIM, _GEOM, _INST = Row.MASK, Row.ID, Row.PRIM, Row.GEOM, Row.INST


class Aim(NamedTuple):
    """How rays leave the lens. shared: one pattern for all pixels; box: sample the pixel's area, not its centre.

    ray_map: of any other lens than a plain thin one, and the index of its wavelength; None for that.
    """

    projection: Projection
    aperture_sampler: ApertureSampler
    seed: np.uint32
    shared: bool
    box: bool
    ray_map: RayMap | None = None
    wavelength: int = 0


class Traversal(NamedTuple):
    """What Embree is called with: addresses of scene and function, (32,) int32 arguments and packets, both aligned.

    packets (K, ROWS, LANES) float32 is working memory.
    """

    scene: int
    packet: int
    query: Any
    packets: Float


@tile_kernel
def trace_block(surfaces, traversal, aim, block, pixels, sums):
    """Add the radiance of one block of points per replicate to sums (R, N, 3), for N pixels (N, 2)."""
    group = min(sums.shape[0], LANES)
    cells = _cells_together(len(block.cells), group)
    strands = len(traversal.packets) * LANES // cells
    rays, weights = np.zeros((4, strands * cells)), _new_weights(aim.ray_map, strands * cells)
    tangents = np.zeros((2, strands))
    seeds = np.zeros((4, strands), dtype=np.uint32)
    column_of = np.zeros((1 << block.column_bits, strands), dtype=np.uint32)
    row_of = np.zeros((1 << block.row_bits, strands), dtype=np.uint32)
    totals = np.zeros((strands, 3))
    work = (rays, weights, tangents, seeds, column_of, row_of, totals)
    chunk = strands // group
    for first in range(0, len(pixels), chunk):
        for replicate in range(0, len(sums), group):
            part = pixels[first : first + chunk]
            total = sums[replicate : replicate + group, first : first + chunk]
            _trace(surfaces, traversal, aim, block, part, replicate, cells, work, total)


@inline
def _cells_together(cells, group):
    """How many neighbouring cells of a net share a packet, a power of two; the rest of its rays are other pixels'."""
    together = 1
    while together * group < LANES and _FINE * together < cells:
        together *= 2
    return together


@tile_kernel
def _trace(surfaces, traversal, aim, block, pixels, replicate, cells, work, sums):
    """Trace one block for sums (G, N, 3), from a replicate on, as many pixels and replicates as the memory holds.

    A strand is one pixel in one replicate; strand p G + g.
    """
    surfaces, aperture_sampler, block = (
        borrow_surfaces(surfaces),
        borrow_aperture_sampler(aim.aperture_sampler),
        borrow_block(block),
    )
    packets, integers = borrow(traversal.packets), borrow(traversal.packets.view(np.int32))
    projection, ray_map, pixels = aim.projection, _borrow_rays(aim.ray_map), borrow(pixels)
    first_packet, stride = traversal.packets.ctypes.data, 4 * ROWS * LANES
    valid, arguments = traversal.query.ctypes.data, traversal.query.ctypes.data + 64
    group, strands = sums.shape[0], sums.shape[0] * sums.shape[1]
    rays, weights, tangents, seeds = borrow(work[0]), borrow(work[1]), borrow(work[2]), borrow(work[3])
    column_of, row_of, totals = borrow(work[4]), borrow(work[5]), borrow(work[6])[:strands]
    memory = _new_scratch(ray_map)
    scratch = borrow(memory)
    used = (strands * cells + LANES - 1) // LANES
    totals[:] = 0.0
    _start_strands(aim, pixels, group, replicate, tangents, seeds, column_of, row_of)
    _fill_constants(packets, integers)
    for first in range(0, len(block.cells), cells):
        for k in range(cells):
            column, row = block.cells[first + k, 0], block.cells[first + k, 1]
            begin, end = k * strands, (k + 1) * strands
            x, y, dx, dy = rays[0, begin:end], rays[1, begin:end], rays[2, begin:end], rays[3, begin:end]
            _square_points(block, 0, column_of[column], row_of[row], seeds[0], seeds[1], x, y)
            if aim.box:
                _square_points(block, 2, column_of[column], row_of[row], seeds[2], seeds[3], dx, dy)
            else:
                dx[:], dy[:] = 0.5, 0.5
            weight = weights[begin:end]
            _aim_rays(ray_map, scratch, aim.wavelength, aperture_sampler, projection, tangents, x, y, dx, dy, weight)
        _fill_packets(rays, strands, cells, used, packets, integers)
        if surfaces.blends:
            _name_rays(borrow(work[0].view(np.uint64)), strands, cells, used, integers)
        for k in range(used):
            call_address(traversal.packet, valid, traversal.scene, first_packet + k * stride, arguments)
        _gather(surfaces, integers, rays, weights, ray_map, cells, totals)
    for p in range(len(pixels)):
        for g in range(group):
            for c in range(3):
                sums[g, p, c] += totals[p * group + g, c]
    memory[:] = 0.0  # memory that is lent must not be freed before


@inline
def _start_strands(aim, pixels, group, replicate, tangents, seeds, column_of, row_of):
    """Draw every strand's scramble and note where it sends the columns and rows of lens cells."""
    projection, scale = aim.projection, 1.0 / aim.projection.pixels_per_tangent
    for p in range(len(pixels)):
        identity = 0 if aim.shared else pixels[p, 1] * projection.width + pixels[p, 0]
        for g in range(group):
            s = p * group + g
            tangents[0, s] = (pixels[p, 0] - 0.5 * projection.width) * scale
            tangents[1, s] = (0.5 * projection.height - pixels[p, 1]) * scale
            state = scramble_state(aim.seed, replicate + g, identity)
            for k in range(4):
                seeds[k, s] = axis_seed(state, k)
            _invert_cells(column_of, s, seeds[0, s])
            _invert_cells(row_of, s, seeds[1, s])


@inline
def _fill_constants(packets, integers):
    """Write what no sample changes."""
    for k in range(len(packets)):
        for lane in range(LANES):
            packets[k, _Z, lane] = 0.0
            packets[k, _NEAR, lane] = _NEAREST
            packets[k, _DZ, lane] = -1.0
            integers[k, _MASK, lane] = -1
            integers[k, _INST, lane] = -1


@inline
def _invert_cells(inverse, p, seed):
    """inverse[scrambled low bits, p] = low bits before scrambling."""
    mask = np.uint32(inverse.shape[0] - 1)
    for low in range(inverse.shape[0]):
        inverse[scramble(np.uint32(low), seed) & mask, p] = np.uint32(low)


@inline
def _square_points(block, axis, columns, rows, seeds_x, seeds_y, x, y):
    """Every strand's point (x, y) of a cell of the unit square; axes `axis` and `axis` + 1 of the sequence."""
    shift = np.uint32(block.column_bits)
    for s in range(len(x)):
        point = block.point_of_cell[np.uint32(rows[s] << shift) + columns[s]]
        u = reverse_bits(scramble(block.reversed_points[axis, point], seeds_x[s]))
        v = reverse_bits(scramble(block.reversed_points[axis + 1, point], seeds_y[s]))
        x[s] = (np.float64(u) + 0.5) * _UNIT
        y[s] = (np.float64(v) + 0.5) * _UNIT


@inline
def _new_weights(ray_map, count):
    """Memory for the weights of rays: all rays of a thin lens weigh the same."""
    return np.zeros(0) if ray_map is None else np.zeros(count)


@inline
def _new_scratch(ray_map):
    return np.zeros(0) if ray_map is None else new_scratch()


@inline
def _borrow_rays(ray_map):
    return None if ray_map is None else borrow_ray_map(ray_map)


@inline
def _aim_rays(ray_map, scratch, wavelength, aperture_sampler, projection, tangents, x, y, dx, dy, weights):
    """Turn square points and places in the pixel into origins and directions, in place, and write the rays' weights."""
    if ray_map is None:
        _on_lens(aperture_sampler, x, y)
        _towards_focus(projection, tangents[0], tangents[1], x, y, dx, dy)
    else:
        pixels = projection.pixels_per_tangent
        for s in range(len(x)):
            column = 0.5 * projection.width + tangents[0, s] * pixels + dx[s]
            row = 0.5 * projection.height - tangents[1, s] * pixels + dy[s]
            dx[s], dy[s] = column, row
        ray_block(ray_map, wavelength, scratch, dx, dy, x, y, dx, dy, weights)


@inline
def _on_lens(aperture_sampler, x, y):
    """Turn square points into lens points, in units of the radius, in place."""
    if is_plain_disc(aperture_sampler):
        for s in range(len(x)):
            x[s], y[s] = concentric_disc(x[s], y[s])
    else:
        for s in range(len(x)):
            x[s], y[s] = lens_point(aperture_sampler, x[s], y[s])


@inline
def _towards_focus(projection, right, up, x, y, dx, dy):
    """Turn lens points and places in the pixel into origins and directions, in place."""
    scale, radius, focus = 1.0 / projection.pixels_per_tangent, projection.lens_radius, projection.inverse_focus
    for s in range(len(x)):
        x[s] *= radius
        dx[s] = right[s] + dx[s] * scale - x[s] * focus
    for s in range(len(y)):
        y[s] *= radius
        dy[s] = up[s] - dy[s] * scale - y[s] * focus


@inline
def _fill_packets(rays, strands, cells, used, packets, integers):
    """Write origins and directions, a strand's cells side by side, and forget the last hits.

    Lanes left over repeat a ray.
    """
    last = strands * cells - 1
    shift = 0
    while (1 << shift) < cells:
        shift += 1
    for k in range(used):
        for lane in range(LANES):
            entry = min(k * LANES + lane, last)
            source = entry if cells == 1 else (entry & (cells - 1)) * strands + (entry >> shift)
            packets[k, _X, lane] = rays[0, source]
            packets[k, _Y, lane] = rays[1, source]
            packets[k, _DX, lane] = rays[2, source] if abs(rays[2, source]) >= _LEAST else 0.0
            packets[k, _DY, lane] = rays[3, source] if abs(rays[3, source]) >= _LEAST else 0.0
            packets[k, _FAR, lane] = np.inf
            integers[k, _GEOM, lane] = -1


@inline
def _name_rays(bits, strands, cells, used, integers):
    """Write ids that hang on all bits of a ray, from which it draws whether a transparent surface stops it."""
    for k in range(used):
        for lane in range(LANES):
            entry = min(k * LANES + lane, strands * cells - 1)
            source = entry % cells * strands + entry // cells
            name = mix64(bits[0, source])
            for row in range(1, 4):
                name = mix64(name ^ bits[row, source])
            integers[k, _ID, lane] = np.int32(name & np.uint64(0x7FFFFFFF))


@inline
def _weight(ray_map, weights, ray):
    """A ray's weight; a constant for a thin lens, which the compiler takes out."""
    return 1.0 if ray_map is None else weights[ray]


@inline
def _gather(surfaces, integers, rays, weights, ray_map, cells, totals):
    """Add what every ray sees to totals (strands, 3), cell after cell."""
    strands = len(totals)
    for k in range((strands * cells + LANES - 1) // LANES):
        for lane in range(LANES):
            if integers[k, _GEOM, lane] != -1:
                fetch_row(surfaces.corner, integers[k, _PRIM, lane])
                fetch_row(surfaces.attribute, integers[k, _PRIM, lane])
    for s in range(strands):
        red, green, blue = totals[s, 0], totals[s, 1], totals[s, 2]
        for c in range(cells):
            k, lane, source = (s * cells + c) // LANES, (s * cells + c) % LANES, c * strands + s
            weight = _weight(ray_map, weights, source)
            if weight == 0.0:
                continue
            if integers[k, _GEOM, lane] == -1:
                r, g, b = surfaces.light[5, 0], surfaces.light[5, 1], surfaces.light[5, 2]
            else:
                face = integers[k, _PRIM, lane]
                ox, oy, dx, dy = rays[0, source], rays[1, source], rays[2, source], rays[3, source]
                _, u, v = intersect(surfaces.corner, face, ox, oy, 0.0, dx, dy, -1.0)
                r, g, b = shade(surfaces, face, u, v, dx, dy, -1.0)
            red, green, blue = red + weight * r, green + weight * g, blue + weight * b
        totals[s, 0], totals[s, 1], totals[s, 2] = red, green, blue
