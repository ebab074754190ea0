"""Ambiguous pixels: those at which two correct programs may see different triangles.

A pixel is ambiguous if its centre lies so near to a projected edge of any triangle, hidden or not, that the rounding
of corners or rays may move the edge over it, or if two surfaces along its ray have the same depth but for roundings.
Elsewhere rasterised layers and exact layers are the same, triangle by triangle.
"""

import numpy as np

from refdof._check import Float, Index, as_float, as_index, as_instance, as_number
from refdof._jit import inline, tile_kernel
from refdof.optics.camera import Camera
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.rasterize import FINEST_BITS, NEAR

__all__ = ["ambiguous_pixels", "near_edges", "tied_depths"]

_RAY_ERROR = 2.0**-21  # of the picture's extent: eight float32 roundings of a ray's tangents
_MOST_REACH = 65536.0  # px: beyond every picture
_SAME_DEPTH = 1e-9  # relative: float64 roundings, magnified by planes seen at flat angles


def ambiguous_pixels(
    vertices: Float, faces: Index, camera: Camera, depth: Float, model: GpuModel = EXACT
) -> np.ndarray:
    """Pixels where layers rasterised under `model` and exact layers may differ.

    Parameters
    ----------
    vertices : (V, 3)
        Camera space [scene units].
    faces : (F, 3) int
    camera : Camera
    depth : (N, H, W)
        Exact layers, front to back [scene units], one more than are to be compared; inf is empty.
    model : GpuModel
        Gives the grid that corners snap to.

    Returns
    -------
    (H, W) bool

    Raises
    ------
    InputError
        If a shape, index or number is not as stated.
    """
    as_instance("camera", camera, Camera)
    as_instance("model", model, GpuModel)
    depth = as_float("depth", depth, (None, camera.height, camera.width), dtype=np.float64, finite=False)
    grid = 2.0 ** -(model.subpixel_bits or FINEST_BITS)  # half a step in x and y, and float32 besides
    extent = max(camera.width, camera.height, camera.pixels_per_tangent)
    return near_edges(vertices, faces, camera, grid + _RAY_ERROR * extent) | tied_depths(depth)


def near_edges(vertices: Float, faces: Index, camera: Camera, reach_px: float) -> np.ndarray:
    """(H, W) bool: pixels whose centre is within `reach_px` of a projected edge, hidden by others or not.

    Edges are cut at `rasterize`'s default near plane.
    """
    vertices = as_float("vertices", vertices, (None, 3), dtype=np.float64)
    faces = as_index("faces", faces, (None, 3), end=len(vertices))
    as_instance("camera", camera, Camera)
    reach_px = as_number("reach_px", reach_px, minimum=0.0, maximum=_MOST_REACH)
    mask = np.zeros((camera.height, camera.width), dtype=np.bool_)
    near = NEAR * float(np.abs(vertices).max(initial=0.0))
    _mark(vertices, faces, camera.pixels_per_tangent, near, reach_px, mask)
    return mask


def tied_depths(depth: Float) -> np.ndarray:
    """(H, W) bool: pixels where two neighbours among the layers (N, H, W) have one depth but for roundings."""
    front, back = depth[:-1], depth[1:]
    finite = np.isfinite(back)
    front, back = np.where(finite, front, 0.0), np.where(finite, back, 0.0)
    return np.asarray((finite & (back - front <= _SAME_DEPTH * front)).any(axis=0))


@tile_kernel
def _mark(vertices, faces, scale, near, reach, mask):
    """Mark the pixels within reach of every edge, cut at depth `near`."""
    for i in range(len(faces)):
        for k in range(3):
            a, b = vertices[faces[i, k]], vertices[faces[i, (k + 1) % 3]]
            if a[2] > b[2]:
                a, b = b, a  # a is the farther one
            if a[2] >= -near:
                continue
            part = min(1.0, (-near - a[2]) / (b[2] - a[2])) if b[2] > -near else 1.0
            x, y, z = a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2])
            _mark_edge(
                a[0] * scale / -a[2] + 0.5 * mask.shape[1] - 0.5,
                0.5 * mask.shape[0] - a[1] * scale / -a[2] - 0.5,
                x * scale / -z + 0.5 * mask.shape[1] - 0.5,
                0.5 * mask.shape[0] - y * scale / -z - 0.5,
                reach,
                mask,
            )


@inline
def _mark_edge(ax, ay, bx, by, reach, mask):
    """Mark the centres within reach of the segment a b [px from the centre of pixel (0, 0), y down]."""
    steep = abs(by - ay) > abs(bx - ax)
    if steep:
        ax, ay, bx, by = ay, ax, by, bx
    if ax > bx:
        ax, ay, bx, by = bx, by, ax, ay
    along, across = mask.shape[0] if steep else mask.shape[1], mask.shape[1] if steep else mask.shape[0]
    length = (bx - ax) ** 2 + (by - ay) ** 2
    slope = (by - ay) / (bx - ax) if bx > ax else 0.0
    for x in range(int(np.ceil(max(ax - reach, 0.0))), int(np.floor(min(bx + reach, along - 1.0))) + 1):
        # The segment crosses the column at y, and its part within reach of the column stays within 2 reach of that.
        y = ay + slope * (min(max(float(x), ax), bx) - ax)
        first, last = max(y - 2.0 * reach, 0.0), min(y + 2.0 * reach, across - 1.0)
        for row in range(int(np.ceil(first)), int(np.floor(last)) + 1):
            t = ((x - ax) * (bx - ax) + (row - ay) * (by - ay)) / length if length > 0.0 else 0.0
            t = min(max(t, 0.0), 1.0)
            if (x - ax - t * (bx - ax)) ** 2 + (row - ay - t * (by - ay)) ** 2 <= reach * reach:
                if steep:
                    mask[x, row] = True
                else:
                    mask[row, x] = True
