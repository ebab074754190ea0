"""Downsampling: one mip level from the finer one, row by row, for pipelines that round exactly.

Rows are flat, (H, W C): texel x of a row starts at x C. The same bits as the reads of `refdof.raster.gpu.texture` at
the coarser texels' centres, which of even sizes lie midway between four finer texels. Its strict rules differ from
plain arithmetic only where that gives infinities or NaN: such texels are read again by the rules.

1. means of four texels                      `downsample_box`
2. bilinear reads midway between four        `downsample_linear`
3. nine such reads, weighted                 `downsample_gaussian`
4. least and greatest texels                 `downsample_lowest`, `downsample_highest`
"""

import numpy as np

from refdof._jit import borrow, inline, kernel, prange, tile_kernel
from refdof._jit.row_registers import blend_along, blend_squares, mean_squares
from refdof.raster.gpu.texture_sampling import Rules, lerp

__all__ = ["downsample_box", "downsample_gaussian", "downsample_highest", "downsample_linear", "downsample_lowest"]

_BAND, _STRIP = 16, 128  # coarse rows and texels of a tile: its blends stay in the nearest cache
_STRICT = Rules(strict=True, fused=False, flush=False)


@kernel
def downsample_box(fine, channels, out):
    """Means of 2 x 2 texels: fine (H, W C) -> out (h, w C). Size 1 is duplicated; an odd trailing row is dropped."""
    down = min(len(fine) - 1, 1)
    for y in prange(len(out)):
        _squares(borrow(fine)[2 * y], borrow(fine)[2 * y + down], channels, True, borrow(out)[y])


@kernel
def downsample_linear(fine, channels, out):
    """Reads midway between 2 x 2 texels: fine (H, W C) -> out (h, w C). Sizes are even, or 1."""
    down = min(len(fine) - 1, 1)
    for y in prange(len(out)):
        row = borrow(out)[y]
        _squares(borrow(fine)[2 * y], borrow(fine)[2 * y + down], channels, False, row)
        if not _all_finite(row):
            for i in range(len(row)):
                if not np.isfinite(row[i]):
                    row[i] = _read(borrow(fine), 2 * y, 2 * (i // channels), i % channels, channels)


@kernel
def downsample_gaussian(fine, channels, weights, out):
    """Nine reads midway between 2 x 2 texels, a texel apart: fine (H, W C) -> out (h, w C). Sizes are even.

    weights (9,) of the image's type, row by row, all above 0.
    """
    bands, strips = -(-len(out) // _BAND), -(-out.shape[1] // (channels * _STRIP))
    for job in prange(bands * strips):
        rows = job // strips * _BAND, min((job // strips + 1) * _BAND, len(out))
        first = job % strips * _STRIP
        count = min(_STRIP, out.shape[1] // channels - first)
        scratch = np.empty((6, (2 * count + 1) * channels), dtype=fine.dtype)
        _gaussian_tile(borrow(fine), borrow(weights), rows, first, channels, scratch, borrow(out))


@kernel
def downsample_lowest(fine, out):
    """Least of the finer texels that a coarser one covers: (H, W) -> (h, w); the last of an odd size joins the last."""
    for y in prange(len(out)):
        texels, row = borrow(fine), borrow(out)[y]
        row[:] = np.inf
        for source in range(2 * y, len(texels) if y == len(out) - 1 else 2 * y + 2):
            for x in range(len(row)):
                for column in range(2 * x, texels.shape[1] if x == len(row) - 1 else 2 * x + 2):
                    row[x] = min(row[x], texels[source, column])


@kernel
def downsample_highest(fine, out):
    """As `downsample_lowest`, for the greatest."""
    for y in prange(len(out)):
        texels, row = borrow(fine), borrow(out)[y]
        row[:] = -np.inf
        for source in range(2 * y, len(texels) if y == len(out) - 1 else 2 * y + 2):
            for x in range(len(row)):
                for column in range(2 * x, texels.shape[1] if x == len(row) - 1 else 2 * x + 2):
                    row[x] = max(row[x], texels[source, column])


@inline
def _squares(upper, lower, channels, mean, out):
    """Means of 2 x 2 texels of two rows, or blends between them by plain arithmetic; a row of one texel repeats it."""
    right = min(len(upper) // channels - 1, 1)
    # A constant number of channels lets the compiler take whole texels at once.
    if channels == 4:
        _squares_of(upper, lower, right, 4, mean, out)
    elif channels == 3:
        _squares_of(upper, lower, right, 3, mean, out)
    elif channels == 1:
        _squares_of(upper, lower, right, 1, mean, out)
    else:
        _squares_of(upper, lower, right, channels, mean, out)


@inline
def _squares_of(upper, lower, right, channels, mean, out):
    """`_squares`, the second texel of each being `right` of the first. Unsigned places spare the test for negatives."""
    half, n, count = out.dtype.type(0.5), np.uintp(channels), len(out) // channels
    done = count // 4 * 4 if channels == 4 and right == 1 else 0
    for x in range(0, done, 4):
        if mean:
            mean_squares(upper, lower, 2 * x, out, x)
        else:
            blend_squares(upper, lower, 2 * x, out, x)
    for x in range(done, count):
        for channel in range(channels):
            place = np.uintp(2 * x) * n + np.uintp(channel)
            beside = place + np.uintp(right) * n
            a, b, c, d = upper[place], upper[beside], lower[place], lower[beside]
            if mean:
                value = ((a + b) + (c + d)) * out.dtype.type(0.25)
            else:
                value = _midway(_midway(a, b, half), _midway(c, d, half), half)
            out[np.uintp(x) * n + np.uintp(channel)] = value


@inline
def _gaussian_tile(fine, weights, rows, first, channels, scratch, out):
    """Coarse texels from `first` on of some rows, by plain arithmetic; strict rules where it is not finite.

    Each fine row is blended along x once, each two of them along y once. scratch (6, (2 N + 1) C) for N texels.
    """
    scratch = borrow(scratch)
    blends, reads, spare = scratch[:2], scratch[2:5], scratch[5]
    count = (scratch.shape[1] // channels - 1) // 2
    size, start = count * channels, 2 * rows[0] - 1
    for source in range(start, 2 * rows[1] + 1):
        _along(fine[min(max(source, 0), len(fine) - 1)], first, count, channels, spare, blends[source % 2])
        if source > start:
            _down(blends[(source - 1) % 2], blends[source % 2], reads[source % 3])
        y = source // 2 - 1
        if source % 2 == 1 or y < rows[0]:
            continue
        row = out[y, first * channels : first * channels + size]
        _nine(reads[(source - 2) % 3], reads[(source - 1) % 3], reads[source % 3], channels, weights, row)
        if not _all_finite(row):
            for i in range(size):
                if not np.isfinite(row[i]):
                    row[i] = _nine_reads(fine, 2 * y, 2 * (first + i // channels), i % channels, channels, weights)


@inline
def _along(row, first, count, channels, spare, out):
    """Blend a row's neighbours: texels 2 x, 2 x + 1 for `count` coarse x, then 2 x - 1, 2 x for `count` + 1.

    At its ends the row repeats.
    """
    half, size, start = row.dtype.type(0.5), count * channels, 2 * first * channels
    pairs, between = out[:size], out[size:]
    for c in range(channels):
        between[c] = _midway(row[max(start - channels, 0) + c], row[start + c], half)
        place = start + 2 * size - channels + c
        between[size + c] = _midway(row[place], row[min(place + channels, len(row) - channels + c)], half)
    done = (count - 1) // 4 * 4 if channels == 4 else 0  # the last four would read past the border
    for x in range(0, done, 4):
        blend_along(row, 2 * (first + x), pairs, x, between, x + 1)
    start += 2 * done * channels
    blends = spare[: (2 * (count - done) - 1) * channels]
    left, right = row[start : start + len(blends)], row[start + channels : start + channels + len(blends)]
    for i in range(len(blends)):
        blends[i] = _midway(left[i], right[i], half)
    even, odd = pairs[done * channels :], between[(done + 1) * channels : size]
    # A constant number of channels lets the compiler move whole texels.
    if channels == 3:
        _apart(blends, 3, even, odd)
    elif channels == 1:
        _apart(blends, 1, even, odd)
    else:
        _apart(blends, channels, even, odd)


@inline
def _apart(row, channels, even, odd):
    """Every second texel of a row, and the others. Unsigned places spare the test for negative ones."""
    n = np.uintp(channels)
    for x in range(len(even) // channels):
        for c in range(channels):
            even[np.uintp(x) * n + np.uintp(c)] = row[np.uintp(2 * x) * n + np.uintp(c)]
    for x in range(len(odd) // channels):
        for c in range(channels):
            odd[np.uintp(x) * n + np.uintp(c)] = row[np.uintp(2 * x + 1) * n + np.uintp(c)]


@inline
def _down(upper, lower, out):
    """Blend two rows."""
    half = out.dtype.type(0.5)
    for i in range(len(out)):
        out[i] = _midway(upper[i], lower[i], half)


@inline
def _nine(above, middle, below, channels, weights, out):
    """Weighted sums of 3 x 3 reads, whose rows are laid out as `_along` has it."""
    size, zero = len(out), out.dtype.type(0)
    a, b, c = above[size:], above[:size], above[size + channels :]
    d, e, f = middle[size:], middle[:size], middle[size + channels :]
    g, h, k = below[size:], below[:size], below[size + channels :]
    wa, wb, wc = weights[0], weights[1], weights[2]
    wd, we, wf = weights[3], weights[4], weights[5]
    wg, wh, wk = weights[6], weights[7], weights[8]
    for i in range(size):
        upper = zero + wa * a[i] + wb * b[i] + wc * c[i]
        centre = upper + wd * d[i] + we * e[i] + wf * f[i]
        out[i] = centre + wg * g[i] + wh * h[i] + wk * k[i]


@inline
def _midway(a, b, half):
    return a + (b - a) * half


@inline
def _all_finite(row):
    """Whether a row has neither infinities nor NaN."""
    infinity, wrong = row.dtype.type(np.inf), False
    for i in range(len(row)):
        wrong |= not abs(row[i]) < infinity
    return not wrong


@inline
def _read(fine, y, x, c, channels):
    """Channel c midway between 2 x 2 texels from (x, y) on, by the strict rules; beyond the border the edge's."""
    half = fine.dtype.type(0.5)
    top, bottom = fine[max(y, 0)], fine[min(y + 1, len(fine) - 1)]
    a, b = max(x, 0) * channels + c, min(x + 1, fine.shape[1] // channels - 1) * channels + c
    return lerp(lerp(top[a], top[b], half, _STRICT), lerp(bottom[a], bottom[b], half, _STRICT), half, _STRICT)


@tile_kernel
def _nine_reads(fine, y, x, c, channels, weights):
    """Weighted sum of 3 x 3 reads around the one at (x, y)."""
    total = fine.dtype.type(0)
    for k in range(9):
        total += weights[k] * _read(fine, y + k // 3 - 1, x + k % 3 - 1, c, channels)
    return total
