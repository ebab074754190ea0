"""Lens rays: generate, trace and shade every lens sample of a tile of pixels, fused, in bounded memory.

For 16 pixels and one cell of the lens at a time:

1. every pixel draws its own point of that cell, once per replicate   `_square_points`, `_through_lens`
2. 16 rays are a packet                                               `_fill_packets`
3. Embree finds the triangle each ray meets first
4. depth, barycentrics and colour follow in float64                   `_gather`

A packet is fast if its rays meet the same triangles. The replicates of one pixel in one cell do; where there are fewer
replicates than rays in a packet, so do neighbouring cells of neighbouring pixels. The layout changes no bit.

A ray starts at the lens point (E vx, E vy, 0) and passes its pixel's point on the focal plane; its direction has
z = -1, so that the ray parameter is the planar depth.
"""

import numpy as np

from refdof._check import Index
from refdof._jit import borrow, call_address, inline, tile_kernel
from refdof.opening import borrow_opening, lens_point
from refdof.owen import borrow_block, mix, reverse_bits, scramble
from refdof.raster.raycast import LANES, ROWS, Row
from refdof.shading import shade
from refdof.surfaces import borrow_surfaces, intersect

__all__ = ["tile_order", "trace_block"]

_UNIT = 2.0**-32
_MANY_CELLS = 64  # from here on, 4 pixels x 4 cells are traced faster than 16 pixels x 1 cell (measured)
_X, _Y, _Z, _NEAR = Row.ORG_X, Row.ORG_Y, Row.ORG_Z, Row.TNEAR
_DX, _DY, _DZ, _FAR = Row.DIR_X, Row.DIR_Y, Row.DIR_Z, Row.TFAR
_MASK, _PRIM, _GEOM, _INST = Row.MASK, Row.PRIM, Row.GEOM, Row.INST


def tile_order(x0: int, y0: int, x1: int, y1: int) -> Index:
    """Pixels (N, 2) of a tile in blocks of 4 x 4, so that a packet of 16 is a small square."""
    y, x = np.mgrid[y0:y1, x0:x1]
    order = np.lexsort((x.ravel(), y.ravel(), x.ravel() // 4, y.ravel() // 4))
    return np.stack([x.ravel()[order], y.ravel()[order]], axis=1).astype(np.int64)


@tile_kernel
def trace_block(surfaces, scene, packet, query, shot, opening, block, pixels, seed, shared, box, packets, sums):
    """Add the radiance of one block of points per replicate to sums (R, N, 3), for N pixels (N, 2).

    seed: uint32. shared: one pattern for all pixels. box: sample the pixel's area, not its centre. packets
    (K, ROWS, 16) float32 is aligned working memory; query (32,) int32 is Embree's, aligned.
    """
    lanes = len(packets) * LANES
    group = min(sums.shape[0], LANES)
    cells = 4 if group == 1 and len(block.cells) >= _MANY_CELLS else 1
    chunk = lanes // (group * cells)
    rays = np.zeros((4, lanes))
    tangents = np.zeros((2, chunk))
    seeds = np.zeros((group, 4, chunk), dtype=np.uint32)
    column_of = np.zeros((group, 1 << block.column_bits, chunk), dtype=np.uint32)
    row_of = np.zeros((group, 1 << block.row_bits, chunk), dtype=np.uint32)
    work = (packets, query, rays, tangents, seeds, column_of, row_of)
    for first in range(0, len(pixels), chunk):
        part, total = pixels[first : first + chunk], sums[:, first : first + chunk]
        _trace(surfaces, scene, packet, shot, opening, block, part, cells, seed, shared, box, work, total)


@tile_kernel
def _trace(surfaces, scene, packet, shot, opening, block, pixels, cells, seed, shared, box, work, sums):
    """The loops of `trace_block` for as many pixels as the working memory holds, on borrowed arrays."""
    surfaces, opening, block = borrow_surfaces(surfaces), borrow_opening(opening), borrow_block(block)
    packets, rays, tangents, seeds = borrow(work[0]), borrow(work[2]), borrow(work[3]), borrow(work[4])
    column_of, row_of, pixels, sums = borrow(work[5]), borrow(work[6]), borrow(pixels), borrow(sums)
    integers = borrow(work[0].view(np.int32))
    start, stride = work[0].ctypes.data, 4 * ROWS * LANES
    valid, arguments = work[1].ctypes.data, work[1].ctypes.data + 64
    count = len(pixels)
    _fill_constants(shot, pixels, packets, integers, tangents)
    for replicate in range(0, len(sums), len(seeds)):
        group = min(len(seeds), len(sums) - replicate)
        slots = group * cells
        used = (count * slots + LANES - 1) // LANES
        for g in range(group):
            _start_replicate(pixels, shot.width, seed, replicate + g, shared, seeds[g], column_of[g], row_of[g])
        for first in range(0, len(block.cells), cells):
            for slot in range(slots):
                g, cell = slot // cells, first + slot % cells
                column, row = block.cells[cell, 0], block.cells[cell, 1]
                part = rays[:, slot * count : (slot + 1) * count]
                _square_points(block, column_of[g, column], row_of[g, row], seeds[g], box, part)
                _through_lens(shot, opening, box, tangents, part)
            _fill_packets(rays, count, slots, used, packets, integers)
            for k in range(used):
                call_address(packet, valid, scene, start + k * stride, arguments)
            _gather(surfaces, integers, rays, slots, cells, sums[replicate : replicate + group])


@inline
def _fill_constants(shot, pixels, packets, integers, tangents):
    """Write what no sample changes."""
    scale = 1.0 / shot.pixels_per_tangent
    for p in range(len(pixels)):
        tangents[0, p] = (pixels[p, 0] - 0.5 * shot.width) * scale
        tangents[1, p] = (0.5 * shot.height - pixels[p, 1]) * scale
    for k in range(len(packets)):
        for lane in range(LANES):
            packets[k, _Z, lane] = 0.0
            packets[k, _NEAR, lane] = 0.0
            packets[k, _DZ, lane] = -1.0
            integers[k, _MASK, lane] = -1
            integers[k, _INST, lane] = -1


@inline
def _start_replicate(pixels, width, seed, replicate, shared, seeds, column_of, row_of):
    """Draw every pixel's scramble and note where it sends the columns and rows of lens cells."""
    for p in range(len(pixels)):
        identity = 0 if shared else pixels[p, 1] * width + pixels[p, 0]
        state = mix(mix(np.uint32(seed), np.uint32(replicate)), np.uint32(identity))
        for k in range(4):
            seeds[k, p] = mix(state, np.uint32(k))
        _invert_cells(column_of, p, seeds[0, p])
        _invert_cells(row_of, p, seeds[1, p])


@inline
def _invert_cells(inverse, p, seed):
    """inverse[scrambled low bits, p] = low bits before scrambling."""
    mask = np.uint32(inverse.shape[0] - 1)
    for low in range(inverse.shape[0]):
        inverse[scramble(np.uint32(low), seed) & mask, p] = np.uint32(low)


@inline
def _square_points(block, columns, rows, seeds, box, rays):
    """rays (4, N): every pixel's point of this cell of the unit square, then its place inside the pixel."""
    shift = np.uint32(block.column_bits)
    for p in range(rays.shape[1]):
        point = block.point_of_cell[np.uint32(rows[p] << shift) + columns[p]]
        u = reverse_bits(scramble(block.reversed_points[0, point], seeds[0, p]))
        v = reverse_bits(scramble(block.reversed_points[1, point], seeds[1, p]))
        rays[0, p] = (np.float64(u) + 0.5) * _UNIT
        rays[1, p] = (np.float64(v) + 0.5) * _UNIT
        if box:
            i = reverse_bits(scramble(block.reversed_points[2, point], seeds[2, p]))
            j = reverse_bits(scramble(block.reversed_points[3, point], seeds[3, p]))
            rays[2, p] = (np.float64(i) + 0.5) * _UNIT
            rays[3, p] = (np.float64(j) + 0.5) * _UNIT


@inline
def _through_lens(shot, opening, box, tangents, rays):
    """Turn rays (4, N) from square points into origin x, y and direction x, y."""
    scale = 1.0 / shot.pixels_per_tangent
    for p in range(rays.shape[1]):
        x, y = lens_point(opening, rays[0, p], rays[1, p])
        right = rays[2, p] if box else 0.5
        down = rays[3, p] if box else 0.5
        rays[0, p] = x * shot.lens_radius
        rays[1, p] = y * shot.lens_radius
        rays[2, p] = tangents[0, p] + right * scale - rays[0, p] * shot.inverse_focus
        rays[3, p] = tangents[1, p] - down * scale - rays[1, p] * shot.inverse_focus


@inline
def _fill_packets(rays, count, slots, used, packets, integers):
    """Write origins and directions, pixel after pixel, and forget the last hits; lanes left over repeat a ray."""
    last = count * slots - 1
    for k in range(used):
        for lane in range(LANES):
            entry = min(k * LANES + lane, last)
            p = entry % slots * count + entry // slots
            packets[k, _X, lane] = rays[0, p]
            packets[k, _Y, lane] = rays[1, p]
            packets[k, _DX, lane] = rays[2, p]
            packets[k, _DY, lane] = rays[3, p]
            packets[k, _FAR, lane] = np.inf
            integers[k, _GEOM, lane] = -1


@inline
def _gather(surfaces, integers, rays, slots, cells, sums):
    """Add what every ray sees to sums (replicates, N, 3), cell after cell."""
    count = sums.shape[1]
    for p in range(count):
        for slot in range(slots):
            k, lane = (p * slots + slot) // LANES, (p * slots + slot) % LANES
            g, source = slot // cells, slot * count + p
            if integers[k, _GEOM, lane] == -1:
                for c in range(3):
                    sums[g, p, c] += surfaces.light[5, c]
                continue
            face = integers[k, _PRIM, lane]
            ox, oy, dx, dy = rays[0, source], rays[1, source], rays[2, source], rays[3, source]
            _, u, v = intersect(surfaces.corner, face, ox, oy, 0.0, dx, dy, -1.0)
            red, green, blue = shade(surfaces, face, u, v, dx, dy, -1.0)
            sums[g, p, 0] += red
            sums[g, p, 1] += green
            sums[g, p, 2] += blue
