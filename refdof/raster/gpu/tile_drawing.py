"""Draw a tile: cover pixel centres by integer edge functions, keep the nearest triangle at each.

1. cover the tile's pixel centres, row by row     `draw_tile`, edge functions [1]
2. depth and barycentrics of the triangle's plane `_plane`, homogeneous [2]
3. discard what is a hole                         `_keep_solid`, `refdof.raster.materials.cutouts`
4. store depth, keep the nearest                  `_keep_run`, `refdof.raster.gpu.depth_format`

References
----------
.. [1] Pineda (1988), A Parallel Algorithm for Polygon Rasterization, SIGGRAPH.
.. [2] Olano & Greer (1997), Triangle Scan Conversion using 2D Homogeneous Coordinates, Graphics Hardware.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline, tile_kernel
from refdof.raster.gpu.clip import ClippedTriangles
from refdof.raster.gpu.depth_format import DepthCode, key_of
from refdof.raster.gpu.tile_bins import TILE_PX
from refdof.raster.materials.cutouts import Cutouts, borrow_cutouts, opacity_at

__all__ = ["Raster", "Triangles", "draw_tile"]


class Raster(NamedTuple):
    """The nearest triangle at every pixel centre; an empty pixel has depth inf, triangle -1 and zeros.

    depth (H, W) [scene units], as read back from its format; triangle (H, W) int32; barycentric (H, W, 2): the weights
    of the second and third corner. A centre that only the snapped triangle covers has a weight outside [0, 1], far
    outside if seen edge-on.
    """

    depth: Float
    triangle: Index
    barycentric: Float


class Triangles(NamedTuple):
    """What is drawn, and how, in one unit of length.

    vertices (V, 3), of the type of the precision; bits: of the sub-pixel grid; near, far: planes; across (W,) and
    up (H,): tangents of the rays through pixel centres; cutouts: what is discarded, None: nothing.
    """

    vertices: Float
    faces: Index
    clipped: ClippedTriangles
    bits: int
    near: float
    far: float
    code: DepthCode
    across: Float
    up: Float
    cutouts: Cutouts | None


@tile_kernel
def draw_tile(triangles, previous, chosen, row, column, raster):
    """Draw the `chosen` clipped triangles, ascending, into the pixels of one tile.

    raster.depth and previous (H, W) hold keys; fragments must lie behind the latter.
    """
    vertices, faces, clipped = borrow(triangles.vertices), borrow(triangles.faces), triangles.clipped
    corners, boxes, numbers = borrow(clipped.corner), borrow(clipped.box), borrow(clipped.face)
    across, up, previous = borrow(triangles.across), borrow(triangles.up), borrow(previous)
    depth, triangle, barycentric = borrow(raster.depth), borrow(raster.triangle), borrow(raster.barycentric)
    room = np.empty(11, dtype=vertices.dtype)
    plane, cutouts = borrow(room), _borrowed(triangles.cutouts)
    for n in chosen:
        box, corner, face = boxes[n], corners[n], numbers[n]
        first_x, last_x = max(box[0], column * TILE_PX), min(box[1], (column + 1) * TILE_PX - 1)
        first_y, last_y = max(box[2], row * TILE_PX), min(box[3], (row + 1) * TILE_PX - 1)
        u_row, u_x, u_y = _edge(corner, 2, 4, first_x, first_y, triangles.bits)
        v_row, v_x, v_y = _edge(corner, 4, 0, first_x, first_y, triangles.bits)
        w_row, w_x, w_y = _edge(corner, 0, 2, first_x, first_y, triangles.bits)
        ready = False
        for y in range(first_y, last_y + 1):
            # A triangle covers one run of a row: find its begin and length.
            u, v, w = u_row, v_row, w_row
            begin, count = last_x + 1, 0
            for x in range(first_x, last_x + 1):
                inside = (u | v | w) >= 0  # none is negative
                begin, count = min(begin, x if inside else last_x + 1), count + inside
                u, v, w = u + u_x, v + v_x, w + w_x
            u_row, v_row, w_row = u_row + u_y, v_row + v_y, w_row + w_y
            if count == 0:
                continue
            if not ready:
                _plane(vertices, faces[face], triangles.near, plane)
                ready = True
            run = slice(begin, begin + count)
            pixels = Raster(depth[y, run], triangle[y, run], barycentric[y, run])
            behind, far, code = previous[y, run], triangles.far, triangles.code
            _keep_solid(cutouts, plane, across[run], up[y], face, far, code, behind, pixels)


@inline
def _edge(corner, a, b, x, y, bits):
    """Edge function of a -> b, [1], at the centre of pixel (x, y), and its steps to the next column and row.

    Positive inside. A centre on the edge gives 0 where the edge is a left or top one, else -1.
    """
    ax, ay = np.int64(corner[a]), np.int64(corner[a + 1])
    dx, dy = np.int64(corner[b]) - ax, np.int64(corner[b + 1]) - ay
    value = dx * ((np.int64(y) << bits) - ay) - dy * ((np.int64(x) << bits) - ax)
    if not (dy < 0 or (dy == 0 and dx > 0)):
        value -= 1
    return value, -(dy << bits), dx << bits


@inline
def _plane(vertices, face, near, plane):
    """Write what 1 / depth and the two barycentrics over depth are, as linear functions of the ray (dx, dy, -1), [2].

    plane (11,): three vectors for 1 / depth and for the weights of the second and third corner, then the smallest
    and the largest 1 / depth of the triangle in front of the near plane.
    """
    ax, ay, az = vertices[face[0], 0], vertices[face[0], 1], vertices[face[0], 2]
    bx, by, bz = vertices[face[1], 0], vertices[face[1], 1], vertices[face[1], 2]
    cx, cy, cz = vertices[face[2], 0], vertices[face[2], 1], vertices[face[2], 2]
    ex, ey, ez, fx, fy, fz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    plane[9], plane[10] = -1.0 / min(az, bz, cz), -1.0 / min(max(az, bz, cz), -near)
    plane[0], plane[1], plane[2] = fy * ez - fz * ey, fz * ex - fx * ez, fx * ey - fy * ex
    plane[3], plane[4], plane[5] = ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx
    plane[6], plane[7], plane[8] = ey * az - ez * ay, ez * ax - ex * az, ex * ay - ey * ax
    volume = plane[0] * ax + plane[1] * ay + plane[2] * az
    # A triangle seen edge-on has no plane: it takes its nearest depth.
    if volume == 0.0:
        plane[:9] = 0.0
        plane[2] = -plane[10]
        return
    for k in range(9):
        plane[k] /= volume


@inline
def _keep_run(plane, across, up, face, far, code, previous, pixels):
    """Write fragments of a row whose keys are nearer than what pixels hold and behind the previous layer."""
    low, high = plane[9], plane[10]
    for i in range(len(across)):
        slope = plane[0] * across[i] + plane[1] * up - plane[2]
        nearness = min(max(slope, low), high)
        depth = 1.0 / nearness
        key = pixels.depth.dtype.type(key_of(nearness, code))  # as stored, or peeling would meet a surface again
        if key < pixels.depth[i] and key > previous[i] and depth <= far:
            pixels.depth[i], pixels.triangle[i] = key, face
            pixels.barycentric[i, 0] = (plane[3] * across[i] + plane[4] * up - plane[5]) * depth
            pixels.barycentric[i, 1] = (plane[6] * across[i] + plane[7] * up - plane[8]) * depth


@inline
def _keep_solid(cutouts, plane, across, up, face, far, code, previous, pixels):
    """`_keep_run`, of one fragment after the other for a triangle with holes."""
    if cutouts is None or cutouts.material[face] < 0:
        _keep_run(plane, across, up, face, far, code, previous, pixels)
        return
    for i in range(len(across)):
        nearness = min(max(plane[0] * across[i] + plane[1] * up - plane[2], plane[9]), plane[10])
        u = (plane[3] * across[i] + plane[4] * up - plane[5]) / nearness
        v = (plane[6] * across[i] + plane[7] * up - plane[8]) / nearness
        if opacity_at(cutouts, face, u, v) > 0.0:
            one = slice(i, i + 1)
            pixel = Raster(pixels.depth[one], pixels.triangle[one], pixels.barycentric[one])
            _keep_run(plane, across[one], up, face, far, code, previous[one], pixel)


@inline
def _borrowed(cutouts):
    return None if cutouts is None else borrow_cutouts(cutouts)
