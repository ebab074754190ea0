"""Texture reads of many points: chunks of points, and every step a loop over the points of a chunk.

1. find the finer of two levels, and the share of the coarser    `_choose_levels`
2. find the four texels around each point, and weights           `_find_texels`
3. blend them by plain arithmetic, and blend in the coarser      `_blend_chunk`
4. by the model's rules, if that may not do, or did not          `_read_by_rules`

Plain arithmetic differs from the strict rules only where it gives infinities or NaN, or a weight is rounded to 1.
Models that fuse or flush, rounded weights and borders always take the rules.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._jit.texel_registers import blend_over, blend_to
from refdof.image.bilinear import first_of_two, four_around
from refdof.raster.gpu.texture_sampling import bilinear_at, lerp, split

__all__ = ["Chain", "read_chain"]

_CHUNK = 512  # points: what a chunk keeps fits the nearest cache
_MOST_TEXELS = 2**31 - 1  # whose numbers are int32; beyond, reads are slow


class Chain(NamedTuple):
    """Levels, one after the other, and what coordinates are multiplied by to be in texels, in their type.

    Of several levels those are widths and heights.
    """

    texels: Float  # (T, C)
    start: Index  # (L,) first texel
    width: Index  # (L,)
    height: Index  # (L,)
    scale_x: Float  # (L,)
    scale_y: Float  # (L,)


class _Chunk(NamedTuple):
    """Per point: finer level; the four texels around it; weights of the right and lower ones, and of the coarser."""

    level: Index  # (n,), or (0,) if there is one level
    sizes: Index  # (3, n) int32: the level's first texel, width and height; or (3, 0)
    around: Index  # (4, n) int32
    weights: Float  # (3, n), or (2, n) if there is one level


@kernel
def read_chain(chain, points, rounded, border, bordered, rules, out):
    """Write reads out (N, C) at points u, v (N,), lod (N,) in 0 .. L - 1, or (0,) if there is only one level.

    Whether all u and v are finite: chunks with others are left as they are.
    Texels, out and the border's colour (C,) are of one type; coordinates and scales are of one type, too.
    """
    u, v, lod = points
    plain = not (rounded or bordered or rules.fused or rules.flush) and len(chain.texels) <= _MOST_TEXELS
    several, fit = len(chain.start) > 1, np.ones((len(u) + _CHUNK - 1) // _CHUNK, np.bool_)
    for chunk in prange((len(u) + _CHUNK - 1) // _CHUNK):
        begin, end = chunk * _CHUNK, min((chunk + 1) * _CHUNK, len(u))
        count = end - begin
        levels = Chain(
            borrow(chain.texels),
            borrow(chain.start),
            borrow(chain.width),
            borrow(chain.height),
            borrow(chain.scale_x),
            borrow(chain.scale_y),
        )
        how = (rounded, borrow(border), bordered, rules)
        x, y, z = borrow(u)[begin:end], borrow(v)[begin:end], borrow(lod)[begin:end]
        reads = borrow(out)[begin:end]
        level, sizes = np.empty(count if several else 0, np.int32), np.empty((3, count if several else 0), np.int32)
        around, weights = np.empty((4, count), np.int32), np.empty((3, count), out.dtype)
        work = _Chunk(borrow(level), borrow(sizes), borrow(around), borrow(weights))
        if not (plain and _read_plainly(levels, x, y, z, work, reads)):
            if _unbounded(x) + _unbounded(y) > 0:
                fit[chunk] = False
            else:
                _read_by_rules(levels, x, y, z, how, reads)
    return fit.all()


@inline
def _read_plainly(chain, u, v, lod, work, out):
    """Read a chunk of points; False: plain arithmetic does not do."""
    if len(work.level) == 0:
        if _find_texels(chain, u, v, work) > 0:
            return False
        _blend_chunk(chain.texels, work, out)
        return _unbounded(out) == 0
    some = _choose_levels(lod, work.level, work.weights[2])
    if _find_texels_of_levels(chain, u, v, work) > 0:
        return False
    _blend_chunk(chain.texels, work, out)
    if some > 0:
        last, share, ones = np.int32(len(chain.start) - 1), work.weights[2], np.int32(0)
        for k in range(len(share)):
            work.level[k] = min(work.level[k] + 1, last)
            ones = np.int32(ones + np.int32(share[k] >= 1))
        if ones + _find_texels_of_levels(chain, u, v, work) > 0:
            return False
        _blend_over_chunk(chain.texels, work, out)
    return _unbounded(out) == 0


@inline
def _choose_levels(lod, level, share):
    """Fill the finer level and the share of the coarser; of how many points that is above 0."""
    some = np.int32(0)
    for k in range(len(lod)):
        finer = np.floor(lod[k])
        level[k] = np.int32(finer)
        share[k] = lod[k] - finer
        some = np.int32(some + np.int32(share[k] > 0))
    return some


@inline
def _find_texels(chain, u, v, work):
    """Fill the texels around and the weights; of how many points a coordinate is not finite, or a weight is 1.

    Texels around those that are not finite may be outside the image.
    """
    a, b, c, d = work.around
    across, down = work.weights[0], work.weights[1]
    start, width, height = np.int32(chain.start[0]), np.int32(chain.width[0]), np.int32(chain.height[0])
    scale_x, scale_y, faults = chain.scale_x[0], chain.scale_y[0], np.int32(0)
    for k in range(len(u)):
        column, across[k] = first_of_two(u[k] * scale_x, width)
        row, down[k] = first_of_two(v[k] * scale_y, height)
        a[k], b[k], c[k], d[k] = four_around(start, width, height, column, row)
        faults = np.int32(faults + _is_fault(u[k], v[k], across[k], down[k]))
    return faults


@inline
def _find_texels_of_levels(chain, u, v, work):
    """As `_find_texels`, each point at its level."""
    a, b, c, d = work.around
    across, down, faults, real = work.weights[0], work.weights[1], np.int32(0), u.dtype.type
    starts, widths, heights = work.sizes
    for k in range(len(u)):  # look-ups do not vectorise, what follows does
        n = np.uint64(work.level[k])
        starts[k], widths[k], heights[k] = chain.start[n], chain.width[n], chain.height[n]
    for k in range(len(u)):
        width, height = widths[k], heights[k]
        column, across[k] = first_of_two(u[k] * real(width), width)
        row, down[k] = first_of_two(v[k] * real(height), height)
        a[k], b[k], c[k], d[k] = four_around(starts[k], width, height, column, row)
        faults = np.int32(faults + _is_fault(u[k], v[k], across[k], down[k]))
    return faults


@inline
def _is_fault(u, v, across, down):
    return np.int32((u - u) + (v - v) != 0) | np.int32(max(across, down) >= 1)


@inline
def _blend_chunk(texels, work, out):
    """Write the blends of four texels."""
    across, down = work.weights[0], work.weights[1]
    for k in range(len(out)):
        a, b, c, d = _around(work, k)
        if texels.shape[1] == 4:
            blend_to(texels, a, b, c, d, across[k], down[k], out, k)
        else:
            for n in range(texels.shape[1]):
                out[k, n] = _blend(texels, a, b, c, d, across[k], down[k], n)


@inline
def _blend_over_chunk(texels, work, out):
    """Blend shares of the blends of four texels over what is there."""
    across, down, share = work.weights[0], work.weights[1], work.weights[2]
    for k in range(len(out)):
        a, b, c, d = _around(work, k)
        if share[k] > 0 and texels.shape[1] == 4:
            blend_over(texels, a, b, c, d, across[k], down[k], share[k], out, k)
        elif share[k] > 0:
            for n in range(texels.shape[1]):
                value = _blend(texels, a, b, c, d, across[k], down[k], n)
                out[k, n] += (value - out[k, n]) * share[k]


@inline
def _around(work, k):
    a, b, c, d = work.around
    return np.int64(a[k]), np.int64(b[k]), np.int64(c[k]), np.int64(d[k])


@inline
def _blend(texels, a, b, c, d, across, down, n):
    upper = texels[a, n] + (texels[b, n] - texels[a, n]) * across
    lower = texels[c, n] + (texels[d, n] - texels[c, n]) * across
    return upper + (lower - upper) * down


@inline
def _unbounded(out):
    """How many numbers are infinite or NaN."""
    values, count = out.reshape(-1), np.int32(0)
    for k in range(len(values)):
        count = np.int32(count + np.int32(values[k] - values[k] != 0))
    return count


@tile_kernel
def _read_by_rules(chain, u, v, lod, how, out):
    """Read a chunk of points as the model does."""
    rounded, border, bordered, rules = how
    scalar, real = out.dtype.type, u.dtype.type
    for k in range(len(u)):
        finer = int(np.floor(lod[k])) if len(lod) > 0 else 0
        share = lod[k] - real(finer) if len(lod) > 0 else real(0)
        for level in range(finer, finer + 1 if share == 0 else finer + 2):
            first, width, height = chain.start[level], chain.width[level], chain.height[level]
            image = chain.texels[first : first + width * height].reshape(height, width, chain.texels.shape[1])
            column, right = split(u[k] * chain.scale_x[level], width, rounded, bordered, real)
            row, below = split(v[k] * chain.scale_y[level], height, rounded, bordered, real)
            across, down = scalar(right), scalar(below)
            for c in range(image.shape[2]):
                value = bilinear_at(image, column, row, across, down, c, border, bordered, rules)
                out[k, c] = value if level == finer else lerp(out[k, c], value, scalar(share), rules)
