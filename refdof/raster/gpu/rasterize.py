"""Triangles to pixels as a GPU draws them: clip, project, snap, cover by integer edge functions, keep the nearest.

1. clip, project and snap every triangle         `refdof.raster.gpu.clip`
2. sort the clipped triangles into tiles                    `refdof.raster.gpu.tile_bins`
3. cover each tile's pixel centres               `_draw_tile`, edge functions [1]
4. depth and barycentrics of the triangle's plane `_plane`, homogeneous [2]
5. store depth, keep the nearest                 `_keep`, `refdof.raster.gpu.depth_format`

Fill rule: a pixel centre on an edge belongs to the triangle whose left edge it is, or whose horizontal edge of lowest
row; with row 0 on top that is the top edge (the top-left rule). So triangles that share an edge never share a pixel
and never miss one. Faces have two sides. The same bits come out on any number of threads.

References
----------
.. [1] Pineda (1988), A Parallel Algorithm for Polygon Rasterization, SIGGRAPH.
.. [2] Olano & Greer (1997), Triangle Scan Conversion using 2D Homogeneous Coordinates, Graphics Hardware.
"""

import math
import sys
from typing import Any, NamedTuple

import numpy as np

from refdof._check import (
    LARGEST_LENGTH,
    Float,
    Index,
    InputError,
    as_choice,
    as_float,
    as_index,
    as_instance,
    as_number,
)
from refdof._jit import inline, run_tasks, tile_kernel
from refdof.optics.camera import Camera
from refdof.raster.gpu.clip import ClippedTriangles, clip_triangles, snapped
from refdof.raster.gpu.depth_format import DEPTH_FORMATS, depth_code, depths_of, key_of, keys_of
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.tile_bins import TILE_PX, bin_triangles

__all__ = ["FINEST_BITS", "NEAR", "Raster", "rasterize"]

FINEST_BITS = 12  # of the exact model; finer, an edge function of the guard band could overflow 64 bits
NEAR = 1e-6  # default, of the largest coordinate: far below every scene's own near end, far above rounding


class Raster(NamedTuple):
    """The nearest triangle at every pixel centre; an empty pixel has depth inf, triangle -1 and zeros.

    depth (H, W) [scene units], as read back from its format; triangle (H, W) int32; barycentric (H, W, 2): the weights
    of the second and third corner. A centre that only the snapped triangle covers has a weight outside [0, 1], far
    outside if seen edge-on.
    """

    depth: Float
    triangle: Index
    barycentric: Float


def rasterize(
    vertices: Float,
    faces: Index,
    camera: Camera,
    *,
    near: float | None = None,
    far: float = math.inf,
    model: GpuModel = EXACT,
    precision: str | None = None,
    depth_format: str = "linear",
    previous_depth: Float | None = None,
) -> Raster:
    """Draw triangles into one depth buffer; the nearest wins, and of equally near ones the first.

    Parameters
    ----------
    vertices : (V, 3)
        Camera space [scene units]: x right, y up, looking down -z.
    faces : (F, 3) int
    camera : Camera
        Its size and angle; `vertices` are relative to it already.
    near, far : float
        Planar depths of the clipping planes [scene units], 0 < near < far; None: a millionth of the largest coordinate.
    model : GpuModel
        Gives the grid that corners snap to. The exact model has no grid: its corners keep 2^-12 px, the finest step for
        which whole numbers decide coverage.
    precision : "float64", "float32" or None
        Of depth and barycentrics; None: float64 with the exact model, which alone has it, else float32.
    depth_format : one of `refdof.raster.gpu.depth_format.DEPTH_FORMATS`
        How depths are stored and compared.
    previous_depth : (H, W), or None
        Fragments that are stored as this depth or as a nearer one are rejected: depth peeling.

    Returns
    -------
    Raster
        Depth is float64 for formats other than linear.

    Raises
    ------
    InputError
        If a shape, index or number is not as stated.

    Notes
    -----
    Depth is kept within the triangle's own, since the plane of one seen edge-on says nothing at a centre that only
    its snapped shape covers. With `attributes_from_snapped`, corners behind the near plane keep their places: they have
    none on the grid.
    """
    as_instance("camera", camera, Camera)
    as_instance("model", model, GpuModel)
    as_choice("depth_format", depth_format, DEPTH_FORMATS)
    bound = LARGEST_LENGTH
    vertices = as_float("vertices", vertices, (None, 3), dtype=np.float64, minimum=-bound, maximum=bound)
    faces = as_index("faces", faces, (None, 3), end=len(vertices))
    largest = float(np.abs(vertices).max(initial=0.0)) or 1.0
    near = NEAR * largest if near is None else as_number("near", near, above=0.0)
    far = as_number("far", far, above=0.0, finite=False)
    if not near < far:
        raise InputError(f"far: got {far:g}; allowed are values beyond near, {near:g}")
    exact = model.subpixel_bits == 0
    bits = FINEST_BITS if exact else model.subpixel_bits
    if precision is None:
        precision = "float64" if model == EXACT else "float32"
    kind: Any = np.dtype(as_choice("precision", precision, ("float64", "float32")))
    if kind == np.float64 and model != EXACT:
        raise InputError("precision: got 'float64'; allowed is 'float32' for a model other than EXACT")
    key_kind = kind if depth_format == "linear" else np.dtype(np.float64)
    shape = (camera.height, camera.width)
    if previous_depth is None:
        previous = np.full(shape, -np.inf, dtype=key_kind)
    else:
        previous = as_float("previous_depth", previous_depth, shape, dtype=key_kind, finite=False)

    # Work in a unit of length near the largest coordinate: a power of two changes no bit, and nothing underflows.
    exponent = int(math.frexp(largest)[1])
    vertices, near, far = np.ldexp(vertices, -exponent), _scaled(near, -exponent), _scaled(far, -exponent)
    code = depth_code(depth_format, near, far)
    previous = keys_of(np.ldexp(previous, -exponent), code)
    clipped = clip_triangles(vertices, faces, camera, near, bits, exact)
    tile_bins = bin_triangles(clipped, camera.width, camera.height)
    raster = Raster(
        np.full(shape, np.inf, dtype=key_kind), np.full(shape, -1, dtype=np.int32), np.zeros((*shape, 2), dtype=kind)
    )
    if model.attributes_from_snapped:
        vertices = snapped(vertices, camera, near, bits, exact)
    scale = 1.0 / camera.pixels_per_tangent
    drawing = _Drawing(vertices.astype(kind), faces, clipped, bits, near, far, code, scale, previous)

    def draw_row(row: int) -> None:
        for column in range(tile_bins.columns):
            tile = row * tile_bins.columns + column
            chosen = tile_bins.triangle[tile_bins.first[tile] : tile_bins.first[tile + 1]]
            if len(chosen):
                _draw_tile(drawing, chosen, row, column, raster)

    run_tasks(draw_row, range(-(-camera.height // TILE_PX)))
    return raster._replace(depth=np.ldexp(depths_of(raster.depth, code), exponent))


def _scaled(length: float, exponent: int) -> float:
    """length 2^exponent, at most the largest number if it was finite."""
    with np.errstate(over="ignore"):
        scaled = float(np.ldexp(length, exponent))
    return scaled if math.isinf(length) else min(scaled, sys.float_info.max)


class _Drawing(NamedTuple):
    """What is drawn, and how. The vertices' type is the precision; `previous` holds keys; scale: tangents per px."""

    vertices: Float
    faces: Index
    clipped: ClippedTriangles
    bits: int
    near: float
    far: float
    code: Any
    scale: float
    previous: Float


@tile_kernel
def _draw_tile(drawing, chosen, row, column, raster):
    """Draw the `chosen` clipped triangles, ascending, into the pixels of one tile. raster.depth holds keys."""
    vertices, faces, clipped, bits, near, far, code, scale, previous = drawing
    height, width = raster.depth.shape
    plane, ray = np.empty(11, dtype=vertices.dtype), np.empty(2, dtype=vertices.dtype)
    for n in chosen:
        first_x, last_x = max(clipped.box[n, 0], column * TILE_PX), min(clipped.box[n, 1], (column + 1) * TILE_PX - 1)
        first_y, last_y = max(clipped.box[n, 2], row * TILE_PX), min(clipped.box[n, 3], (row + 1) * TILE_PX - 1)
        u_row, u_x, u_y = _edge(clipped.corner[n], 2, 4, first_x, first_y, bits)
        v_row, v_x, v_y = _edge(clipped.corner[n], 4, 0, first_x, first_y, bits)
        w_row, w_x, w_y = _edge(clipped.corner[n], 0, 2, first_x, first_y, bits)
        ready = False
        for y in range(first_y, last_y + 1):
            u, v, w = u_row, v_row, w_row
            for x in range(first_x, last_x + 1):
                if (u | v | w) >= 0:  # none is negative
                    if not ready:
                        _plane(vertices, faces[clipped.face[n]], near, plane)
                        ready = True
                    ray[0], ray[1] = (x + 0.5 - 0.5 * width) * scale, (0.5 * height - y - 0.5) * scale
                    _keep(plane, ray, clipped.face[n], x, y, far, code, previous, raster)
                u, v, w = u + u_x, v + v_x, w + w_x
            u_row, v_row, w_row = u_row + u_y, v_row + v_y, w_row + w_y


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
def _keep(plane, ray, face, x, y, far, code, previous, raster):
    """Write a fragment if its key is nearer than what the pixel holds and behind the previous layer."""
    dx, dy = ray[0], ray[1]
    slope = plane[0] * dx + plane[1] * dy - plane[2]
    nearness = min(max(slope, plane[9]), plane[10])
    depth = 1.0 / nearness
    key = raster.depth.dtype.type(key_of(nearness, code))  # as stored, or peeling would meet a surface again
    if key < raster.depth[y, x] and key > previous[y, x] and depth <= far:
        raster.depth[y, x], raster.triangle[y, x] = key, face
        raster.barycentric[y, x, 0] = (plane[3] * dx + plane[4] * dy - plane[5]) * depth
        raster.barycentric[y, x, 1] = (plane[6] * dx + plane[7] * dy - plane[8]) * depth
