"""Depth peeling: layers of the GPU kind, one rasterisation per layer, each behind the depth of the last.

Unlike exact layers, triangles at one depth in one pixel count once, as on a GPU.

References
----------
.. [1] Everitt (2001), Interactive Order-Independent Transparency.
"""

from typing import Any

import numpy as np

from refdof._check import Float, Index, as_integer
from refdof.camera import Camera
from refdof.raster.triangles import Raster, rasterize

__all__ = ["peel_raster"]


def peel_raster(vertices: Float, faces: Index, camera: Camera, count: int, **options: Any) -> Raster:
    """The nearest `count` layers, front to back: as `rasterize`, with a first axis of length `count`.

    `options` are those of `rasterize`. For a view: `peel_raster(*view.triangles(), view.camera, 4)`.

    Raises
    ------
    InputError
        If count < 1, or as `rasterize`.
    """
    count = as_integer("count", count, minimum=1)
    layers = [rasterize(vertices, faces, camera, **options)]
    while len(layers) < count:
        layers.append(rasterize(vertices, faces, camera, **{**options, "previous_depth": layers[-1].depth}))
    depth, triangle, barycentric = (np.stack(parts) for parts in zip(*layers, strict=True))
    return Raster(depth, triangle, barycentric)
