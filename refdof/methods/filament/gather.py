"""Gather: what the taps of each tile give: all circles alike, else background, and foreground over it.

Tiles of a row that take as many rings are done together, `MOST_LANES` pixels at a time.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.texel_lanes import LANES
from refdof.methods.filament.alike import alike
from refdof.methods.filament.background import background
from refdof.methods.filament.foreground import foreground
from refdof.methods.filament.lanes import MOST_LANES, clipped, lanes_of, place_taps, ring_pairs

__all__ = ["ALIKE", "gather"]

ALIKE = 0.05  # of the greatest circle
_TILE = 8
_ALIKE, _BEHIND, _BEFORE = range(3)


def gather(texels, places, least, greatest, moved, most_rings):
    """Blur at half the size: (h, w, 4), colour times alpha, and alpha.

    texels (T, 4), places (3, levels) starts, widths and heights; least and greatest (h / 8, w / 8); moved (h, w, 2).
    """
    kind = texels.dtype.type
    blurred = np.maximum(np.abs(least), np.abs(greatest)) >= 1
    same = greatest - least <= kind(ALIKE) * np.abs(greatest)
    reach = np.stack([(np.abs(least) + np.abs(greatest)) * kind(0.5), greatest, -least])
    takes = blurred & np.stack([same, ~same & (greatest > 0), ~same & (least < 0)])
    rings = np.where(takes, np.minimum(np.ceil(reach * kind(0.5) + kind(0.5)), most_rings), 0).astype(np.int32)
    return _gather(texels, places.astype(np.int32), reach, rings, moved, most_rings, ring_pairs().astype(texels.dtype))


@kernel
def _gather(texels, levels, reach, rings, moved, most_rings, table):
    """reach and rings (3, h / 8, w / 8): circles, and how many rings they take, none where a tile takes no part."""
    height, width = moved.shape[:2]
    out = np.empty((height, width, 4), dtype=texels.dtype)
    for y in prange(height):
        whole, numbers = np.empty((6, MOST_LANES), dtype=np.int32), np.empty((34, MOST_LANES), dtype=texels.dtype)
        totals = np.empty((MOST_LANES, 4), dtype=texels.dtype)
        picture = borrow(texels), borrow(levels), borrow(table), borrow(moved)[y]
        buffers = borrow(whole), borrow(numbers), borrow(totals)
        borrow(out)[y, :, :] = texels.dtype.type(0)
        for sort in range(3):
            tiles = borrow(rings)[sort, y // _TILE], borrow(reach)[sort, y // _TILE]
            for count in range(1, most_rings + 1):
                _row(picture, tiles, (sort, count, y), buffers, borrow(out)[y])
    return out


@inline
def _row(picture, tiles, work, buffers, row):
    """One row's tiles that take a number of rings for one sort of gather."""
    source, levels, table, moved = picture
    (rings, reach), (sort, many, y), (whole, numbers, totals) = tiles, work, buffers
    lanes, one = lanes_of(whole[:3], numbers[:11]), source.dtype.type(1)
    count = 0
    for tile in range(len(rings)):
        if rings[tile] == many:
            for x in range(_TILE * tile, _TILE * (tile + 1)):
                circle = abs(source[y * levels[1, 0] + x, 3]) if sort == _BEHIND else reach[tile]
                if sort != _BEHIND or circle > one:
                    lanes.column[count], lanes.circle[count] = x, circle
                    count += 1
        if count > 0 and (count > MOST_LANES - _TILE or tile == len(rings) - 1):
            full = -(-count // LANES) * LANES
            for n in range(count, full):
                lanes.column[n], lanes.circle[n] = lanes.column[count - 1], lanes.circle[count - 1]
            place_taps(lanes, full, many, y, moved, levels)
            sums = numbers[11:21]
            if sort == _ALIKE:
                alike(source, lanes, full, many, table, (whole[3:], numbers[21:], totals, sums))
            else:
                scratch = whole[3:], numbers[24:32], sums, numbers[21], numbers[22], numbers[23]
                if sort == _BEHIND:
                    background(source, lanes, full, many, table, scratch)
                else:
                    foreground(source, lanes, full, many, table, scratch)
                    _fill(source[y * levels[1, 0] :], lanes, count, row, sums)
            for n in range(count):
                rest = one - sums[3, n] if sort == _BEFORE else source.dtype.type(0)
                for c in range(4):
                    row[lanes.column[n], c] = sums[c, n] + rest * row[lanes.column[n], c]
            count = 0


@inline
def _fill(texels, lanes, count, row, sums):
    """Where nothing is behind, the foreground covers as much as the pixel's own circle says, at least."""
    zero, one = sums.dtype.type(0), sums.dtype.type(1)
    for n in range(count):
        alpha = sums[3, n]
        if zero < alpha < one and row[lanes.column[n], 3] == zero:
            more = max(alpha, clipped(abs(texels[lanes.column[n], 3]) - one))
            for c in range(3):
                sums[c, n] *= more / alpha
            sums[3, n] = more
