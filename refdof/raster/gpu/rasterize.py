"""Triangles to pixels as a GPU draws them: clip, project, snap, cover by integer edge functions, keep the nearest.

1. clip, project and snap every triangle         `refdof.raster.gpu.clip`
2. sort the clipped triangles into tiles                    `refdof.raster.gpu.tile_bins`
3. draw each tile                                `refdof.raster.gpu.tile_drawing`

Fill rule: a pixel centre on an edge belongs to the triangle whose left edge it is, or whose horizontal edge of lowest
row; with row 0 on top that is the top edge (the top-left rule). So triangles that share an edge never share a pixel
and never miss one. Faces have two sides. Fragments of opacity 0, by a texture read at their own barycentrics, are
discarded. The same bits come out on any number of threads.
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
from refdof._jit import run_tasks
from refdof.optics.camera import Camera
from refdof.raster.gpu.clip import clip_triangles, snapped
from refdof.raster.gpu.depth_format import DEPTH_FORMATS, depth_code, depths_of, keys_of
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.tile_bins import TILE_PX, TileBins, bin_triangles
from refdof.raster.gpu.tile_drawing import Raster, Triangles, draw_tile
from refdof.raster.materials.cutouts import OPAQUE, Cutouts

__all__ = ["FINEST_BITS", "NEAR", "Raster", "rasterize"]

FINEST_BITS = 12  # of the exact model; finer, an edge function of the guard band could overflow 64 bits
NEAR = 1e-6  # default, of the largest coordinate: far below every scene's own near end, far above rounding


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
    cutouts: Cutouts = OPAQUE,
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
    cutouts : Cutouts
        How opaque the same triangles are; of a view: `view.surfaces().cutouts`.

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
    drawing = prepare(
        vertices,
        faces,
        camera,
        near=near,
        far=far,
        model=model,
        precision=precision,
        depth_format=depth_format,
        cutouts=cutouts,
    )
    return draw(drawing, previous_depth)


class Drawing(NamedTuple):
    """Triangles in tiles: what all layers of a peeling share.

    Lengths are in units of 2^exponent; keys: the type in which depths are kept.
    """

    triangles: Triangles
    bins: TileBins
    exponent: int
    keys: Any


def prepare(
    vertices: Float,
    faces: Index,
    camera: Camera,
    *,
    near: float | None = None,
    far: float = math.inf,
    model: GpuModel = EXACT,
    precision: str | None = None,
    depth_format: str = "linear",
    cutouts: Cutouts = OPAQUE,
) -> Drawing:
    """Clip, project and snap triangles and sort them into tiles. Arguments and errors: `rasterize`."""
    as_instance("camera", camera, Camera)
    as_instance("model", model, GpuModel)
    as_choice("depth_format", depth_format, DEPTH_FORMATS)
    bound = LARGEST_LENGTH
    vertices = as_float("vertices", vertices, (None, 3), dtype=np.float64, minimum=-bound, maximum=bound)
    faces = as_index("faces", faces, (None, 3), end=len(vertices))
    as_instance("cutouts", cutouts, Cutouts)
    if len(cutouts.material) not in (0, len(faces)):
        raise InputError(f"cutouts: got {len(cutouts.material)} triangles; allowed are {len(faces)}, those of `faces`")
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

    # Work in a unit of length near the largest coordinate: a power of two changes no bit, and nothing underflows.
    exponent = int(math.frexp(largest)[1])
    vertices, near, far = _shifted(vertices, -exponent), _scaled(near, -exponent), _scaled(far, -exponent)
    clipped = clip_triangles(vertices, faces, camera, near, bits, exact)
    bins = bin_triangles(clipped, camera.width, camera.height)
    if model.attributes_from_snapped:
        vertices = snapped(vertices, camera, near, bits, exact)
    scale = 1.0 / camera.pixels_per_tangent
    across = (np.arange(camera.width) + 0.5 - 0.5 * camera.width) * scale
    up = (0.5 * camera.height - np.arange(camera.height) - 0.5) * scale
    code, across, up = depth_code(depth_format, near, far), across.astype(kind), up.astype(kind)
    holes = cutouts if len(cutouts.material) else None  # None is compiled by itself, without a look at holes
    triangles = Triangles(vertices.astype(kind, copy=False), faces, clipped, bits, near, far, code, across, up, holes)
    return Drawing(triangles, bins, exponent, kind if depth_format == "linear" else np.dtype(np.float64))


def draw(drawing: Drawing, previous_depth: Float | None = None) -> Raster:
    """Draw what was prepared, behind `previous_depth` if there is one: `rasterize`."""
    triangles, bins, exponent, keys = drawing
    shape, code = (len(triangles.up), len(triangles.across)), triangles.code
    if previous_depth is None:
        previous = np.full(shape, -np.inf, dtype=keys)
    else:
        previous = as_float("previous_depth", previous_depth, shape, dtype=keys, finite=False)
        previous = keys_of(_shifted(previous, -exponent), code)
    raster = Raster(
        np.full(shape, np.inf, dtype=keys),
        np.full(shape, -1, dtype=np.int32),
        np.zeros((*shape, 2), dtype=triangles.vertices.dtype),
    )

    def draw_row(row: int) -> None:
        for column in range(bins.columns):
            tile = row * bins.columns + column
            chosen = bins.triangle[bins.first[tile] : bins.first[tile + 1]]
            if len(chosen):
                draw_tile(triangles, previous, chosen, row, column, raster)

    run_tasks(draw_row, range(-(-shape[0] // TILE_PX)))
    return raster._replace(depth=_shifted(depths_of(raster.depth, code), exponent))


def _shifted(values: Float, exponent: int) -> Float:
    """values 2^exponent. A product is four times as fast as `np.ldexp`, where float32 holds the factor."""
    if abs(exponent) < 100:
        return values * 2.0**exponent
    shifted: Float = np.ldexp(values, exponent)
    return shifted


def _scaled(length: float, exponent: int) -> float:
    """length 2^exponent, at most the largest number if it was finite."""
    with np.errstate(over="ignore"):
        scaled = float(np.ldexp(length, exponent))
    return scaled if math.isinf(length) else min(scaled, sys.float_info.max)
