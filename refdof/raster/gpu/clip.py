"""Clipped triangles: clipped in camera space, projected and snapped to the sub-pixel grid, as a GPU does.

1. `_project`   project every vertex and round it to the grid, in float32 or exactly
2. `_polygon`   clip a triangle at the near plane and at a guard band far outside the picture [1]
3. `_set_up`    one snapped triangle per clipped triangle, counter-clockwise in (x, row), with its box of pixels

Two triangles cut their shared edge at the same bits, since each cut runs from the inside to the outside.

References
----------
.. [1] Sutherland & Hodgman (1974), Reentrant Polygon Clipping, Communications of the ACM 17(1).
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline, kernel, prange
from refdof.optics.camera import Camera

__all__ = ["ClippedTriangles", "clip_triangles", "snapped"]

_GUARD_PX = 32768.0  # farther from the picture's centre, float32 has no sub-pixels left and edges could overflow
_MOST_CORNERS = 8  # a triangle cut by five planes


class ClippedTriangles(NamedTuple):
    """T snapped triangles in order of their face, from zero to six for a face.

    corner (T, 6) int32: x, y of three corners [2^-bits px, from the centre of pixel (0, 0), y down], never clockwise
    as x right and y down make it; face (T,) int32; box (T, 4) int32: first and last column, first and last row with
    pixel centres in it, first > last: none.
    """

    corner: Index
    face: Index
    box: Index


class Grid(NamedTuple):
    """Sub-pixel grid of 2^-bits px. scale [px]: that of tangents; exact: positions are not rounded to float32 first."""

    scale: float
    width: int
    height: int
    bits: int
    exact: bool


class Projected(NamedTuple):
    """Vertices on the grid: place (V, 2) int32; outside (V,) uint8: bits of the planes that exclude it."""

    place: Index
    outside: Index


def clip_triangles(
    vertices: Float, faces: Index, camera: Camera, near: float, bits: int, exact: bool
) -> ClippedTriangles:
    """Clip, project and snap: vertices (V, 3) float64 in camera space, near [scene units] > 0.

    exact: window positions are not rounded to float32 before they snap to 2^-bits px.
    """
    grid = Grid(camera.pixels_per_tangent, camera.width, camera.height, bits, exact)
    projected = Projected(np.zeros((len(vertices), 2), dtype=np.int32), np.zeros(len(vertices), dtype=np.uint8))
    _project(vertices, near, grid, *projected)
    counts = _count(vertices, faces, projected.outside, near, grid.scale)
    first = np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(counts)])
    total = int(first[-1])
    clipped = ClippedTriangles(
        np.empty((total, 6), dtype=np.int32), np.empty(total, dtype=np.int32), np.empty((total, 4), dtype=np.int32)
    )
    _set_up(vertices, faces, projected, near, grid, first, clipped)
    return clipped


def snapped(vertices: Float, camera: Camera, near: float, bits: int, exact: bool) -> Float:
    """Vertices (V, 3) moved in their own depth to where the grid has them; those behind the near plane stay."""
    moved = vertices.copy()
    _move(moved, near, Grid(camera.pixels_per_tangent, camera.width, camera.height, bits, exact))
    return moved


@kernel
def _move(vertices, near, grid):
    """`snapped`, in place."""
    unit = 2.0**grid.bits
    for k in prange(len(vertices)):
        depth = -vertices[k, 2]
        if depth >= near:
            x, y = _snap(vertices[k, 0], vertices[k, 1], depth, grid)
            vertices[k, 0] = (x / unit + 0.5 - 0.5 * grid.width) * depth / grid.scale
            vertices[k, 1] = (0.5 * grid.height - y / unit - 0.5) * depth / grid.scale


@kernel
def _project(vertices, near, grid, place, outside):
    """Fill `Projected`."""
    for k in prange(len(vertices)):
        x, y, z = vertices[k, 0], vertices[k, 1], vertices[k, 2]
        outside[k] = _planes_outside(x, y, z, near, grid.scale)
        if outside[k] == 0:
            place[k, 0], place[k, 1] = _snap(x, y, -z, grid)


@kernel
def _count(vertices, faces, outside, near, scale):
    """Clipped triangles of each face: (F,) int64."""
    counts = np.zeros(len(faces), dtype=np.int64)
    for i in prange(len(faces)):
        a, b, c = outside[faces[i, 0]], outside[faces[i, 1]], outside[faces[i, 2]]
        if (a | b | c) == 0:
            counts[i] = 1
        elif (a & b & c) == 0:
            counts[i] = max(_polygon(vertices, faces, i, near, scale, np.empty((2, _MOST_CORNERS, 3)))[0] - 2, 0)
    return counts


@kernel
def _set_up(vertices, faces, projected, near, grid, first, clipped):
    """Fill `clipped`; `first` (F + 1,) says where those of each face begin."""
    for i in prange(len(faces)):
        if first[i + 1] == first[i]:
            continue
        p, q, r = faces[i, 0], faces[i, 1], faces[i, 2]
        if (projected.outside[p] | projected.outside[q] | projected.outside[r]) == 0:
            place = projected.place
            _store(clipped, first[i], i, _place(place, p), _place(place, q), _place(place, r), grid)
            continue
        # Cut the polygon that the planes leave of it into a fan around its first corner.
        room = np.empty((2, _MOST_CORNERS, 3))
        count, side = _polygon(vertices, faces, i, near, grid.scale, room)
        a, b = _snap_corner(room[side, 0], grid), _snap_corner(room[side, 1], grid)
        for k in range(2, count):
            c = _snap_corner(room[side, k], grid)
            _store(clipped, first[i] + k - 2, i, a, b, c, grid)
            b = c


@inline
def _place(place, vertex):
    """A vertex's place on the grid, in whole numbers whose products do not overflow."""
    return np.int64(place[vertex, 0]), np.int64(place[vertex, 1])


@inline
def _distance(x, y, z, plane, near, scale):
    """How far a point lies inside a plane: 0 near, 1 right, 2 left, 3 top, 4 bottom of the guard band."""
    if plane == 0:
        return -z - near
    if plane == 1:
        return -z * _GUARD_PX - x * scale
    if plane == 2:
        return -z * _GUARD_PX + x * scale
    if plane == 3:
        return -z * _GUARD_PX - y * scale
    return -z * _GUARD_PX + y * scale


@inline
def _planes_outside(x, y, z, near, scale):
    """Bit set of the planes that exclude a point."""
    outside = 0
    for plane in range(5):
        if _distance(x, y, z, plane, near, scale) < 0.0:
            outside |= 1 << plane
    return outside


@inline
def _polygon(vertices, faces, i, near, scale, room):
    """Clip face i into room[side]: (corners, side). `room` is (2, 8, 3), one side for the polygon before a plane."""
    for k in range(3):
        for axis in range(3):
            room[0, k, axis] = vertices[faces[i, k], axis]
    count, side = 3, 0
    for plane in range(5):
        kept = 0
        for k in range(count):
            a, b = room[side, k], room[side, (k + 1) % count]
            in_a = _distance(a[0], a[1], a[2], plane, near, scale)
            in_b = _distance(b[0], b[1], b[2], plane, near, scale)
            if in_a >= 0.0:
                for axis in range(3):
                    room[1 - side, kept, axis] = a[axis]
                kept += 1
            if (in_a >= 0.0) != (in_b >= 0.0):
                # Cut from the inside to the outside.
                if in_a < 0.0:
                    a, b, in_a, in_b = b, a, in_b, in_a
                t = in_a / (in_a - in_b)
                for axis in range(3):
                    room[1 - side, kept, axis] = a[axis] + t * (b[axis] - a[axis])
                if plane == 0:
                    room[1 - side, kept, 2] = -near
                kept += 1
        count, side = kept, 1 - side
    return count, side


@inline
def _snap_corner(corner, grid):
    """`_snap` of a corner (3,) in camera space."""
    return _snap(corner[0], corner[1], -corner[2], grid)


@inline
def _snap(x, y, depth, grid):
    """A point's place on the grid: (x, y) int64, row 0 on top; ties go to even."""
    # Clipping leaves corners inside the guard band but for roundings, which a plane very near magnifies.
    x, y = _in_guard(x * grid.scale / depth), _in_guard(y * grid.scale / depth)
    x, y, unit = 0.5 * grid.width + x, 0.5 * grid.height - y, 2.0**grid.bits
    if grid.exact:
        return np.int64(np.rint((x - 0.5) * unit)), np.int64(np.rint((y - 0.5) * unit))
    half = np.float32(0.5)
    column, row = (np.float32(x) - half) * np.float32(unit), (np.float32(y) - half) * np.float32(unit)
    return np.int64(np.rint(column)), np.int64(np.rint(row))


@inline
def _in_guard(place):
    """A distance from the picture's centre [px], cut so that whole numbers of 32 bits hold it."""
    return min(max(place, -2.0 * _GUARD_PX), 2.0 * _GUARD_PX)


@inline
def _store(clipped, n, face, a, b, c, grid):
    """Write triangle n with corners (x, y), turned so that its area is positive; one without area gets an empty box."""
    (ax, ay), (bx, by), (cx, cy), bits = a, b, c, grid.bits
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area < 0:
        bx, by, cx, cy = cx, cy, bx, by
    corner, box = clipped.corner[n], clipped.box[n]
    corner[0], corner[1], corner[2], corner[3], corner[4], corner[5] = ax, ay, bx, by, cx, cy
    clipped.face[n] = face
    box[0], box[1] = max(0, -(-min(ax, bx, cx) >> bits)), min(grid.width - 1, max(ax, bx, cx) >> bits)
    box[2], box[3] = max(0, -(-min(ay, by, cy) >> bits)), min(grid.height - 1, max(ay, by, cy) >> bits)
    if area == 0 or box[0] > box[1] or box[2] > box[3]:
        box[0], box[1] = 1, 0
