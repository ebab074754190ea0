"""Depth peeling: layers of the GPU kind, one drawing per layer, each behind the depth of the last.

1. prepare triangles once, and draw the nearest surfaces            `refdof.raster.gpu.rasterize`
2. draw again what lies behind them, or behind their umbra [2]      `_floor`
3. stop when nothing is left

Unlike exact layers, triangles at one depth in one pixel count once, as on a GPU.

References
----------
.. [1] Everitt (2001), Interactive Order-Independent Transparency.
.. [2] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control; see `refdof.raster.rays.umbra`.
"""

from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError, as_integer, as_number
from refdof.optics.camera import Camera
from refdof.raster.gpu.rasterize import Raster, draw, prepare

__all__ = ["peel_raster"]


def peel_raster(
    vertices: Float, faces: Index, camera: Camera, count: int | None = None, *, umbra: float = 0.0, **options: Any
) -> Raster:
    """The nearest `count` layers, front to back: as `rasterize`, with a first axis of M layers.

    Parameters
    ----------
    vertices, faces, camera
        As in `rasterize`. For a view: `peel_raster(*view.triangles(), view.camera, 4)`.
    count : int, or None
        Most layers to make; None: all. Layers that would be empty are not made, but for the first.
    umbra : float
        What `refdof.raster.rays.umbra.umbra_step` gives [1 / scene unit]: surfaces within the umbra of the last layer
        are left out. 0 leaves out none; infinite leaves one layer.
    **options
        Those of `rasterize`, but for `previous_depth`.

    Raises
    ------
    InputError
        If count < 1 or umbra < 0, or as `rasterize`.
    """
    if "previous_depth" in options:
        raise InputError("previous_depth: got a depth; peeling sets it by itself, so it must not be given")
    most = np.inf if count is None else as_integer("count", count, minimum=1)
    umbra = as_number("umbra", umbra, minimum=0.0, finite=False)
    drawing = prepare(vertices, faces, camera, **options)
    layers = [draw(drawing)]
    while len(layers) < most:
        behind = draw(drawing, _floor(layers[-1].depth, umbra))
        if (behind.triangle < 0).all():
            break
        layers.append(behind)
    depth, triangle, barycentric = (np.stack(parts) for parts in zip(*layers, strict=True))
    return Raster(depth, triangle, barycentric)


def _floor(depth: Float, umbra: float) -> Float:
    """The depth that the next layer must lie behind: 1 / floor = 1 / depth - umbra."""
    if umbra == 0.0:
        return depth
    reach = 1.0 / depth.astype(np.float64) - umbra
    return np.where(reach > 0.0, 1.0 / np.where(reach > 0.0, reach, 1.0), np.inf)
