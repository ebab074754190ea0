"""Decomposition: a scene as layers of depth, each with a depth buffer of its own, from two passes over its triangles.

1. Space the layers evenly in the circle of confusion                        `layer_bounds`, Eq. (4) of [1]
2. Draw each triangle whole into the layer of its farthest vertex            `_draw_sources`
3. Move every fragment to the layer that its own depth belongs to, and
   copy those near a bound to the neighbour, too: layers overlap             `_move`
4. Keep the layers that something fell into                                  `decompose`

A layer is a height field: its height is the signed circle of confusion, in which a lens ray is a straight line.

Departures from the paper
-------------------------
- The second pass is a gather: of all fragments that belong to a layer at a pixel the nearest is kept, and of equally
  near ones that from the nearest layer. A pass that writes while it reads depends on the order of layers.
- A layer keeps only fragments of its own (overlapping) interval. The text copies strays and does not say whether they
  stay behind, too; a height outside the interval could never be hit by the ray's segment there.
- Eq. (4) recomputed for a depth on a bound may round to either side; fragments are classified by the stored bounds.
- Eq. (4) gives as many layers as there are at the far end, where its index is one too high: the last layer is closed.
- `overlap` is a share of the spacing, added on each side; "10 %" may also mean half of that.
- Rays are tested from a layer's least height to its greatest, not between its bounds: where it holds one flat card,
  that is a point.
- The near plane is the nearest fragment and the far plane the farthest vertex, so that layers begin with the scene.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Sections 4.1, 4.2.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, InputError
from refdof._jit import inline, kernel, prange, tile_kernel
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens
from refdof.raster.gpu.rasterize import rasterize
from refdof.raster.materials.cutouts import OPAQUE, Cutouts, some_of

__all__ = ["Decomposition", "Sources", "copies", "decompose", "layer_bounds"]

_MOST_LAYERS = 65536
_MOST_BYTES = 8 * 2**30
_BYTES_PER_TEXEL = 32  # heights, triangles, colours and search structures
_LARGEST = float(np.finfo(np.float32).max) / 8  # [px]: sums and differences of a few heights stay finite
_ROUNDING = 1e-6  # of the spacing: a range this little above a whole number of layers makes no further one


class Sources(NamedTuple):
    """The first pass: S depth buffers. coc (S, H, W) float32 [px], inf: empty; triangle (S, H, W) int32, -1: empty;
    layer (S,) int64, the layer that each was drawn for.
    """

    coc: Float
    triangle: Index
    layer: Index


class Decomposition(NamedTuple):
    """K layers that are not empty, front to back, out of L.

    coc (K, H, W) float32: signed circle of confusion [px], inf: empty; triangle (K, H, W) int32, -1: empty;
    near, far (K,) float32: least and greatest height of each layer [px]; layer (K,) int64: its number among the L;
    bounds (L + 1,) float32: intervals without overlap [px].
    """

    coc: Float
    triangle: Index
    near: Float
    far: Float
    layer: Index
    bounds: Float


def decompose(
    vertices: Float,
    faces: Index,
    camera: Camera,
    lens: ThinLens,
    spacing: float = 3.0,
    count: int | None = None,
    overlap: float = 0.1,
    depths: tuple[float | None, float | None] = (None, None),
    texel_bytes: int = _BYTES_PER_TEXEL,
    cutouts: Cutouts = OPAQUE,
) -> tuple[Decomposition, Sources]:
    """Decompose triangles into layers.

    Parameters
    ----------
    vertices : (V, 3) float64
        Camera space [scene units].
    faces : (F, 3) int64
    camera, lens
    spacing : float
        Growth of the circle of confusion from bound to bound [px], > 0.
    count : int, optional
        This many layers instead, at equal spacing.
    overlap : float
        Share of the spacing by which a layer reaches past each of its bounds, 0 .. 0.5.
    depths : (float or None, float or None)
        Near and far plane [scene units], outside which nothing is drawn; None: the scene's own.
    texel_bytes : int
        What will be stored for each texel of a layer, to tell early whether it fits.
    cutouts : Cutouts
        Which fragments the rasteriser discards.

    Raises
    ------
    InputError
        If `depths` are given and nothing lies between them, or the layers would not fit into memory.
    """
    near, far = depths
    nearest, farthest = _depth_range(vertices, faces, camera, near, far, cutouts)
    if not (nearest < np.inf and nearest <= farthest):
        return _nothing(camera, near, far, nearest, farthest)
    span = _coc(lens, np.array([nearest, farthest]), camera)
    bounds = layer_bounds(float(span[0]), float(span[1]), spacing, count)
    sources = _draw_sources(vertices, faces, camera, lens, near, bounds, texel_bytes, cutouts)
    if far is None:
        inside = sources.coc < np.inf
        np.minimum(sources.coc, bounds[-1], out=sources.coc, where=inside)  # roundings
    beyond = sources.coc > bounds[-1]
    sources.coc[beyond], sources.triangle[beyond] = np.inf, -1

    margin = bounds.dtype.type(overlap * (span[1] - span[0]) / (len(bounds) - 1) if count else overlap * spacing)
    low, high = bounds[:-1] - margin, bounds[1:] + margin
    used = np.zeros(len(low), dtype=np.bool_)
    _mark(sources.coc, bounds, low, high, used)
    layer = np.flatnonzero(used)
    if not len(layer):
        return _nothing(camera, near, far, nearest, farthest)
    _check_memory(len(layer), camera, texel_bytes)
    slot = np.cumsum(used) - 1
    coc = np.full((len(layer), camera.height, camera.width), np.inf, dtype=np.float32)
    triangle = np.full(coc.shape, -1, dtype=np.int32)
    _move(sources.coc, sources.triangle, bounds, low, high, slot, coc, triangle)
    nearest, farthest = coc.min(axis=(1, 2)), np.where(coc < np.inf, coc, -np.inf).max(axis=(1, 2))
    return Decomposition(coc, triangle, nearest, farthest, layer, bounds), sources


def layer_bounds(nearest: float, farthest: float, spacing: float, count: int | None = None) -> Float:
    """Bounds (L + 1,) float32 of layers between two circles of confusion [px], Eq. (4); no span: one layer.

    Raises
    ------
    InputError
        If more layers would be needed than can be stored.
    """
    span = farthest - nearest
    if count is None:
        wanted = span / spacing
        if not wanted <= _MOST_LAYERS:
            raise InputError(
                f"spacing_px: got {spacing:g} for circles of confusion of {nearest:g} .. {farthest:g} px, which makes "
                f"{wanted:g} layers; allowed are at most {_MOST_LAYERS}: use a wider spacing or set `layers`"
            )
        bounds = nearest + spacing * np.arange(max(1, math.ceil(wanted - _ROUNDING)) + 1)  # Eq. (4)
    else:
        bounds = np.linspace(nearest, farthest, (count if span > 0.0 else 1) + 1)
    bounds[-1] = farthest
    return bounds.astype(np.float32)


def copies(layers: Decomposition) -> Any:
    """Fragments that the layer before holds, too: (K, H, W) bool."""
    out = np.zeros(layers.coc.shape, dtype=np.bool_)
    for k in np.flatnonzero(np.diff(layers.layer) == 1) + 1:
        same = (layers.coc[k] == layers.coc[k - 1]) & (layers.triangle[k] == layers.triangle[k - 1])
        out[k] = same & (layers.coc[k] < np.inf)
    return out


def _depth_range(
    vertices: Float, faces: Index, camera: Camera, near: float | None, far: float | None, cutouts: Cutouts
) -> tuple[float, float]:
    """Near and far plane; the scene's own are its nearest fragment and its farthest vertex."""
    nearest = float(rasterize(vertices, faces, camera, cutouts=cutouts).depth.min()) if near is None else near
    if far is not None:
        return nearest, far
    farthest = float(-vertices[faces, 2].min(initial=0.0)) if len(faces) else 0.0
    # A fragment's depth is 1 / (1 / depth): of a scene at one depth it may round to behind the vertices.
    return nearest, max(farthest, nearest) if near is None else farthest


def _coc(lens: ThinLens, depth: Float, camera: Camera) -> Float:
    """Circles of confusion [px] that float32 can hold."""
    return np.clip(lens.coc_px(depth, camera), -_LARGEST, _LARGEST)


def _nothing(
    camera: Camera, near: float | None, far: float | None, nearest: float, farthest: float
) -> tuple[Decomposition, Sources]:
    """No layers, unless that is the fault of `near` or `far`."""
    if near is not None or far is not None:
        raise InputError(
            f"near, far: got {nearest:g} and {farthest:g}, with no visible surface in between; "
            f"allowed is a range that contains surfaces"
        )
    coc, triangle = (
        np.zeros((0, camera.height, camera.width), np.float32),
        np.zeros((0, camera.height, camera.width), np.int32),
    )
    none, index = np.zeros(0, np.float32), np.zeros(0, np.int64)
    return Decomposition(coc, triangle, none, none, index, np.zeros(1, np.float32)), Sources(coc, triangle, index)


def _draw_sources(
    vertices: Float,
    faces: Index,
    camera: Camera,
    lens: ThinLens,
    near: float | None,
    bounds: Float,
    texel_bytes: int,
    cutouts: Cutouts,
) -> Sources:
    """Draw each triangle into the layer of its farthest vertex; layers without triangles are left out."""
    farthest = -vertices[faces, 2].min(axis=1)
    ahead = np.flatnonzero(farthest > (near or 0.0))
    coc = _coc(lens, farthest[ahead], camera).astype(np.float32)
    home = np.clip(np.searchsorted(bounds, coc, side="right") - 1, 0, len(bounds) - 2)
    layers = np.unique(home)
    _check_memory(len(layers), camera, texel_bytes)
    shape = (len(layers), camera.height, camera.width)
    sources = Sources(np.full(shape, np.inf, np.float32), np.full(shape, -1, np.int32), layers)
    for k, layer in enumerate(layers):
        chosen = ahead[home == layer]
        drawn = rasterize(vertices, faces[chosen], camera, near=near, cutouts=some_of(cutouts, chosen))
        filled = drawn.triangle >= 0
        sources.coc[k][filled] = _coc(lens, drawn.depth[filled], camera)
        sources.triangle[k][filled] = chosen[drawn.triangle[filled]]
    return sources


def _check_memory(count: int, camera: Camera, texel_bytes: int) -> None:
    needed = count * camera.width * camera.height * texel_bytes
    if needed > _MOST_BYTES:
        raise InputError(
            f"spacing_px: got {count} layers of {camera.width}x{camera.height} px, about {needed / 2**30:.1f} GiB; "
            f"allowed are {_MOST_BYTES / 2**30:g} GiB: use a wider spacing, fewer `layers` or a smaller image"
        )


@inline
def _home(bounds, coc):
    """The layer of a circle of confusion, by the stored bounds; the first and the last are closed."""
    return min(max(np.searchsorted(bounds, coc, side="right") - 1, 0), len(bounds) - 2)


@tile_kernel
def _mark(source, bounds, low, high, used):
    """Set used (L,) where a fragment of source (S, H, W) belongs."""
    for coc in source.flat:
        if coc < np.inf:
            home = _home(bounds, coc)
            for k in range(max(home - 1, 0), min(home + 2, len(used))):
                used[k] = used[k] or k == home or low[k] <= coc < high[k]


@kernel
def _move(source, source_triangle, bounds, low, high, slot, out, out_triangle):
    """Fill out (K, H, W) with the nearest fragment of each layer's interval; slot (L,) is a layer's place in it."""
    for y in prange(source.shape[1]):
        for x in range(source.shape[2]):
            for s in range(len(source)):
                coc = source[s, y, x]
                if coc == np.inf:
                    continue
                home = _home(bounds, coc)
                for layer in range(max(home - 1, 0), min(home + 2, len(low))):
                    k = slot[layer]
                    if (layer == home or low[layer] <= coc < high[layer]) and coc < out[k, y, x]:
                        out[k, y, x], out_triangle[k, y, x] = coc, source_triangle[s, y, x]
