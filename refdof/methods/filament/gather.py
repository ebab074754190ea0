"""Gather: what the taps of each tile give: all circles alike, else background, and foreground over it.

Tiles of a row that take as many rings are done together, `MOST_LANES` pixels at a time.
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.order import fair_step
from refdof._jit.texel_lanes import LANES
from refdof.methods.filament.alike import alike
from refdof.methods.filament.background import background
from refdof.methods.filament.foreground import foreground
from refdof.methods.filament.half import TILE
from refdof.methods.filament.lanes import MOST_LANES, lanes_of, place_taps
from refdof.methods.filament.rings import ALIKE, RING_TAPS, clipped, ring_taps

__all__ = ["gather"]

_ALIKE, _BEHIND, _BEFORE = range(3)


def gather(texels, places, least, greatest, moved, most_rings):
    """Blur at half the size: (h, w, 4), colour times alpha, and alpha.

    texels (T, 4), places (3, levels) starts, widths and heights; least and greatest (h / 8, w / 8); moved (h, w, 2).
    """
    kind = texels.dtype.type
    blurred = np.maximum(np.abs(least), np.abs(greatest)) >= 1
    same = greatest - least <= kind(ALIKE) * np.abs(greatest)
    circles = np.stack([(np.abs(least) + np.abs(greatest)) * kind(0.5), greatest, -least])
    takes = blurred & np.stack([same, ~same & (greatest > 0), ~same & (least < 0)])
    rings = np.where(takes, np.minimum(np.ceil(circles * kind(0.5) + kind(0.5)), most_rings), 0).astype(np.int32)
    table = ring_taps().astype(texels.dtype)
    return _gather(texels, places.astype(np.int32), circles, rings, moved, most_rings, table)


@kernel
def _gather(texels, levels, circles, rings, moved, most_rings, table):
    """circles and rings (3, h / 8, w / 8): of what is alike, behind and before; no rings where there is nothing."""
    height, width = moved.shape[:2]
    out, bands = np.zeros((height, width, 4), dtype=texels.dtype), height // TILE
    step = fair_step(bands)
    for turn in prange(bands):
        band = turn * step % bands
        whole, numbers = np.empty((5, MOST_LANES), dtype=np.int32), np.empty((32, MOST_LANES), dtype=texels.dtype)
        places, shares = np.empty((2, RING_TAPS), dtype=np.int32), np.empty((2, RING_TAPS), dtype=texels.dtype)
        sums = np.empty((1, 4), dtype=texels.dtype)
        buffers, spare = (borrow(whole), borrow(numbers)), (borrow(places), borrow(shares), borrow(sums))
        for y in range(TILE * band, TILE * (band + 1)):
            picture, row = (borrow(texels), borrow(levels), borrow(table), borrow(moved)[y]), borrow(out)[y]
            for tile in range(width // TILE):
                many = rings[_ALIKE, band, tile]
                if many > 0:
                    pixels = TILE * tile, TILE * (tile + 1), y
                    alike(picture, pixels, circles[_ALIKE, band, tile], many, spare, row)
            for sort in (_BEHIND, _BEFORE):
                tiles = borrow(rings)[sort, band], borrow(circles)[sort, band]
                for many in range(1, most_rings + 1):
                    _layer(picture, tiles, (sort, many, y), buffers, row)
    return out


@inline
def _layer(picture, tiles, work, buffers, row):
    """Background or foreground of a row's tiles that take so many rings."""
    source, levels, table, moved = picture
    (rings, circles), (sort, many, y), (whole, numbers) = tiles, work, buffers
    lanes, sums = lanes_of(whole[:3], numbers[:11]), numbers[19:29]
    scratch = whole[3:], numbers[11:19], sums, numbers[29], numbers[30], numbers[31]
    own, count = source[y * levels[1, 0] :, 3], 0
    for tile in range(len(rings)):
        if rings[tile] == many:
            for x in range(TILE * tile, TILE * (tile + 1)):
                circle = abs(own[x]) if sort == _BEHIND else circles[tile]
                if sort == _BEFORE or circle > source.dtype.type(1):
                    lanes.column[count], lanes.circle[count] = x, circle
                    count += 1
        if count > 0 and (count > MOST_LANES - TILE or tile == len(rings) - 1):
            full = -(-count // LANES) * LANES
            for n in range(count, full):
                lanes.column[n], lanes.circle[n] = lanes.column[count - 1], lanes.circle[count - 1]
            place_taps(lanes, full, many, y, moved, levels)
            if sort == _BEHIND:
                background(source, lanes, full, many, table, scratch)
            else:
                foreground(source, lanes, full, many, table, scratch)
            _lay(own, lanes, count, sort == _BEFORE, sums, row)
            count = 0


@inline
def _lay(own, lanes, count, before, sums, row):
    """Lay sums over row. Where nothing is behind, near ones cover as much as the pixel's circle says, at least."""
    zero, one = sums.dtype.type(0), sums.dtype.type(1)
    for n in range(count):
        x, alpha, scale = lanes.column[n], sums[3, n], one
        if before and zero < alpha < one and row[x, 3] == zero:
            scale = max(alpha, clipped(abs(own[x]) - one)) / alpha
        rest = one - alpha * scale
        for c in range(4):
            row[x, c] = sums[c, n] * scale + rest * row[x, c]
