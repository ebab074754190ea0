"""Cones of the multiview method: rays with a width, that blend what covers them front to back.

1. average colours (or attributes) and coverage over squares of texels       `mip_chain`
2. follow each cone's middle ray from layer to layer, until nothing is left  `gather_cones`

A layer blends what covers the cone where its search ended, be the texel there filled or empty: if cones whose middle
ray meets a hole passed whole, thin objects would be dimmed twice.

A surface that slants goes on in the next layer. Where a cone's middle meets it, what other layers hold near its height
covers the cone as well: a cone that is cut where layers meet would see through an opaque plane.

Layers overlap. A layer does not count fragments that the layer before holds, too, or half-transparent squares would be
blended twice; its own ones cover their share of the part of the cone that is free of those copies.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.4.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline, run_tasks, tile_kernel
from refdof.image.bilinear import bilinear
from refdof.methods.multiview.coverage import coverage_mipmaps
from refdof.methods.multiview.decomposition import Decomposition, copies
from refdof.methods.multiview.fields import Fields, Ray, Search, borrow_fields, visit
from refdof.methods.multiview.gather import light_of, pinhole_light, ray_tangents, shared_of
from refdof.methods.multiview.height_field import next_hit
from refdof.optics.pixel_samples import LensPointSets
from refdof.optics.projection import Projection
from refdof.raster.rays.surfaces import Surfaces, borrow_surfaces

__all__ = ["FOOTPRINT", "MipChain", "chain_of", "gather_cones", "mip_chain"]

_ROWS_PER_TASK = 8
FOOTPRINT = 6.0  # How far beside a cone's middle the mip levels that it reads reach, at most [its diameter]
_CLOSE = 1e-3  # [px]: roundings of float32 positions up to 8192
_OF_COLORS = 5  # numbers of a texel: three colours, coverage by what is new and by all
_ROUNDING = 2.0**-22  # of coverage in float32: less than one hole in 1024 x 1024 texels


class MipChain(NamedTuple):
    """Mip levels of K layers in one list: texels (K, T, C + 2) float32, premultiplied, then coverage by fragments that
    the layer before lacks, and coverage by all; level (M, 3) int64: first texel, width and height; closed
    (K, T, C + 1): the same levels with fragments of other layers in the layer's holes, premultiplied, and coverage;
    T = 0: none.
    """

    texels: Float
    level: Index
    closed: Float


def chain_of(surface: Float, layers: Decomposition, widening: float, wall_px: float) -> MipChain:
    """Mip levels of layers' colours or attributes, as far as cones need them."""
    widest = widening * float(np.abs([layers.near, layers.far]).max(initial=0.0))
    reach = None if wall_px == np.inf else wall_px * _skirt(widening, layers)
    return mip_chain(surface, layers.coc, copies(layers), widest, reach)


def _skirt(widening: float, layers: Decomposition) -> Float:
    """How far [px] cones read beside a hit: the diagonal of a texel, or two diameters; (K,)."""
    return np.maximum(1.5, 2.0 * widening * np.maximum(np.abs(layers.near), np.abs(layers.far)))


def mip_chain(surface: Float, coc: Float, copied: Index, widest: float, reach: Float | None = None) -> MipChain:
    """Mip levels of layers' colours or attributes (K, H, W, C), as far as cones of `widest` diameter [px] need.

    `copied` (K, H, W) tells what the layer before holds, too; `reach` (K,) how far beyond a layer's heights surfaces
    close its holes [px].
    """
    most = 2 + math.ceil(math.log2(max(widest, 1.0)))

    def images() -> Iterator[list[Float]]:
        for values, filled, copy in zip(surface, np.isfinite(coc), copied, strict=True):
            uncopied = (filled & ~copy)[..., None]
            image = np.concatenate([np.where(uncopied, values, 0), uncopied], axis=-1, dtype=np.float32)
            yield coverage_mipmaps(image, filled)[:most]

    def without_holes() -> Iterator[list[Float]]:
        for k, far in enumerate([] if reach is None else reach):
            yield coverage_mipmaps(*_closed(surface, coc, k, float(far)))[:most]

    channels = surface.shape[3]
    texels, level = _packed(images(), len(coc), channels + 2)
    return MipChain(texels, level, _packed(without_holes(), len(coc), channels + 1)[0])


def _packed(chains: Iterable[list[Float]], count: int, channels: int) -> tuple[Float, Index]:
    """Texels of `count` chains, one below the other, and first texel, width and height of each level.

    Each chain is made, stored and dropped: they are most of the memory that the method needs.
    """
    texels, level = np.zeros((count, 0, channels), dtype=np.float32), np.zeros((0, 3), dtype=np.int64)
    for k, levels in enumerate(chains):
        if k == 0:
            shapes = [(values.shape[1], values.shape[0]) for values in levels]
            ends = np.cumsum([0, *(width * height for width, height in shapes)])
            level = np.array([(first, *shape) for first, shape in zip(ends, shapes, strict=False)], dtype=np.int64)
            texels = np.empty((count, ends[-1], channels), dtype=np.float32)
        for (first, width, height), values in zip(level, levels, strict=True):
            texels[k, first : first + width * height] = values.reshape(-1, channels)
    return texels, level


def _closed(surface: Float, coc: Float, k: int, reach: float) -> tuple[Float, Any]:
    """Layer k with its holes filled from the nearest layers, up to `reach` from its heights: (H, W, C), and where."""
    values, filled = surface[k].astype(np.float32), np.isfinite(coc[k])
    low, high = coc[k].min() - reach, coc[k][filled].max(initial=-np.inf) + reach
    for n in sorted(range(len(coc)), key=lambda n: abs(n - k))[1:]:
        more = ~filled & (coc[n] >= low) & (coc[n] <= high)
        values[more], filled = surface[n][more], filled | more
    return values, filled


def gather_cones(
    fields: Fields,
    chain: MipChain,
    widening: float,
    pattern: LensPointSets,
    search: Search,
    projection: Projection,
    surfaces: Surfaces,
    background: Any,
) -> Float:
    """Mean over the lens: (H, W, 3) float32. A cone at circle of confusion c has diameter widening |c| [px]."""
    height, width = fields.coc.shape[1:]
    out = np.empty((height, width, 3), dtype=np.float32)
    shared = shared_of(fields, pattern, search._replace(holes=True), projection, surfaces, background)

    def band(first: int) -> None:
        _cone_rows(fields, chain, widening, shared, first, min(first + _ROWS_PER_TASK, height), out)

    run_tasks(band, range(0, height, _ROWS_PER_TASK))
    return out


@tile_kernel
def _cone_rows(fields, chain, widening, shared, first, last, out):
    """Rows first .. last - 1 of out (H, W, 3)."""
    points, weights, sets = borrow(shared.pattern.points), borrow(shared.pattern.weights), borrow(shared.pattern.set)
    texels, level, closed = borrow(chain.texels), borrow(chain.level), borrow(chain.closed)
    fields, surfaces, out = borrow_fields(fields), borrow_surfaces(shared.surfaces), borrow(out)
    background = shared.background
    layers = np.empty(len(fields.coc), dtype=np.int64)
    found, whole = np.empty(texels.shape[2]), np.empty(closed.shape[2])
    half = points.dtype.type(0.5)
    for y in range(first, last):
        for x in range(out.shape[1]):
            visited = visit(fields, x, y, shared.search, layers)
            chosen = sets[y % len(sets), x % len(sets)]
            px, py = points.dtype.type(x) + half, points.dtype.type(y) + half
            red = green = blue = total = 0.0
            for n in range(points.shape[1]):
                weight, vx, vy = weights[chosen, n], points[chosen, n, 0], points[chosen, n, 1]
                ray, through, place = Ray(px, py, vx, vy), weight, -1  # through: the part of the cone that goes on
                while through > 0.0:
                    place, i, j, c = next_hit(fields, visited, place + 1, ray, shared.search)
                    if place < 0:
                        break
                    diameter = widening * abs(c)
                    k = layers[place] if layers[place] >= 0 else ~layers[place]
                    u, v = px - c * vx, py + c * vy
                    # A surface that goes on behind an edge is as in its last texel; beside that is the edge.
                    if _beside(u, i, fields.coc.shape[2]) or _beside(v, j, fields.coc.shape[1]):
                        u, v, diameter = i + 0.5, j + 0.5, 0.0
                    _read(texels[k], level, u, v, diameter, found)
                    covered, free = found[-2], 1.0 - (found[-1] - found[-2])
                    if covered <= 0.0:
                        continue
                    share = covered / free if covered < free - _ROUNDING else 1.0
                    if share < 1.0 and closed.shape[1] > 0 and fields.coc[k, j, i] < np.inf:
                        _read(closed[k], level, u, v, diameter, whole)
                        covered = whole[-1]
                        share = (covered + free - 1.0) / free if covered < 1.0 - _ROUNDING else 1.0
                        for channel in range(len(whole) - 1):
                            found[channel] = whole[channel]
                    for channel in range(len(found) - 2):
                        found[channel] /= covered
                    dx, dy = ray_tangents(shared.projection, x, y, vx, vy)
                    r, g, b = light_of(surfaces, found, dx, dy)
                    part = through * share
                    red, green, blue = red + part * r, green + part * g, blue + part * b
                    through -= part
                if place == -1:
                    red, green, blue = (
                        red + through * background[0],
                        green + through * background[1],
                        blue + through * background[2],
                    )
                    through = 0.0
                total += weight - through
            if total == 0.0:  # every ray leaves the image
                red, green, blue = pinhole_light(fields, texels, shared, x, y)
                total = 1.0
            out[y, x, 0], out[y, x, 1], out[y, x, 2] = red / total, green / total, blue / total


@inline
def _beside(u, i, count):
    """Whether u is not over texel i of `count`; the first and the last are endless."""
    return (u < i - _CLOSE and i > 0) or (u > i + 1 + _CLOSE and i + 1 < count)


@inline
def _read(texels, level, px, py, diameter, out):
    """Write the trilinear mean around (px, py) of level 0 into out (C + 2,), clamped at the border."""
    detail = min(math.log2(diameter), len(level) - 1.0) if diameter > 1.0 else 0.0
    coarse = min(int(detail) + 1, len(level) - 1)
    fine, blend = int(detail), detail - int(detail)
    out[:] = 0.0
    _add_bilinear(texels, level, fine, px, py, 1.0 - blend, out)
    if blend > 0.0:
        _add_bilinear(texels, level, coarse, px, py, blend, out)


@inline
def _add_bilinear(texels, level, k, px, py, weight, out):
    """Add weight times level k at (px, py) of level 0."""
    first, width, height = level[k, 0], level[k, 1], level[k, 2]
    across, down = (width / level[0, 1], height / level[0, 2]) if k > 0 else (1.0, 1.0)
    u = min(max(px * across - 0.5, -1.0), width + 0.0)  # beyond, the border goes on
    v = min(max(py * down - 0.5, -1.0), height + 0.0)
    i, j = math.floor(u), math.floor(v)
    a, b = u - i, v - j
    x0, x1 = min(max(i, 0), width - 1), min(max(i + 1, 0), width - 1)
    y0, y1 = first + min(max(j, 0), height - 1) * width, first + min(max(j + 1, 0), height - 1) * width
    p, q, r, s = y0 + x0, y0 + x1, y1 + x0, y1 + x1
    if len(out) == _OF_COLORS:  # a loop of known length: vector code
        for c in range(_OF_COLORS):
            out[c] += weight * bilinear(texels[p, c], texels[q, c], texels[r, c], texels[s, c], a, b)
    else:
        for c in range(len(out)):
            out[c] += weight * bilinear(texels[p, c], texels[q, c], texels[r, c], texels[s, c], a, b)
