"""Passes: along rows with complex taps, then along columns, where their products become colours.

Each pixel's taps are as far apart as its own circle says. A tap outside repeats the edge.

Strips of columns pass one after the other through both, so that what is between them stays in the nearer caches. There
a texel has eight numbers of every component, which one vector holds: three real colours and a zero, three imaginary
ones and a zero. Where a tap of a run of pixels lies is found for all of them at once, and then it is added to their
sums.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import borrow, inline, kernel, prange
from refdof._jit.texel_sums import WIDE, add_pairs, add_pairs_of_four
from refdof.methods.circular.coefficients import Kernels

__all__ = ["disc"]

_STRIP = 64  # px


class _Line(NamedTuple):
    """Where the pixels of a run read from.

    Pixel x is texel `start` + x `step` of a line of `size` texels, whose texel i is `base` + i `along` + x `aside`.
    """

    size: int
    start: int
    step: int
    base: int
    along: int
    aside: int


def disc(color: Float, spacing: Float, taps: Kernels, reach: Float | None, parts: Float) -> Float:
    """Both passes: color (H, W, 3), spacing (H, W) px, taps of the type of `color` -> (H, W, 3).

    reach (H, W): a tap between two texels where it is 0 counts as the pixel itself. None: all are taken.
    parts (H, W, n, 2, 3): set to real and imaginary colours after the first pass, unless it is empty.
    """
    out, first, second = np.empty_like(color), _of_pairs(taps.first), _of_pairs(taps.second)
    # Of NumPy, whose large arrays are on large pages; with one more to be loaded after the last.
    texels = np.empty((spacing.size + 1, 4), dtype=color.dtype)
    texels[-1] = 0.0
    _disc(color, texels, spacing, first, second, reach, parts, out)
    return out


def _of_pairs(taps: Float) -> Float:
    """Taps (R + 1, n, 2), number for number: (R + 1, n, 8). Half of the central one, which both sides add."""
    wide = np.repeat(taps, WIDE // 2, axis=2)
    wide[0] *= 0.5
    return wide


@kernel
def _disc(color, texels, spacing, across, down, reach, parts, out):
    """`disc`, with texels (H W + 1, 4) to be filled."""
    (height, width), count, zero = spacing.shape, across.shape[1], color.dtype.type(0)
    for y in prange(height):
        row, source = borrow(texels)[y * width : (y + 1) * width], borrow(color)[y]
        for x in range(width):
            row[x, 0], row[x, 1], row[x, 2], row[x, 3] = source[x, 0], source[x, 1], source[x, 2], zero
    for job in prange(-(-width // _STRIP)):
        start, end = job * _STRIP, min((job + 1) * _STRIP, width)
        pitch = _STRIP + 1  # or all rows would meet in a few places of a cache
        between = np.zeros(((height + 1) * pitch, count, WIDE), dtype=color.dtype)
        flat, colors, picture = between.reshape(-1, WIDE), borrow(texels), borrow(out)
        firsts, shares = np.empty((2, _STRIP), dtype=np.int32), np.empty((2, _STRIP), dtype=color.dtype)
        for y in range(height):
            line = _Line(width, start, 1, y * width, 1, 0)
            sums = flat[y * pitch * count :]
            for j in range(len(across)):
                _find(spacing[y, start:end], j, line, firsts, shares)
                if reach is not None:
                    _stay(reach.reshape(-1), end - start, line, firsts, shares)
                _add_to_parts(colors, line, firsts, shares, across[j], sums[: (end - start) * count])
            if len(parts) > 0:
                _keep(between[y * pitch :], parts[y, start:end])
        sums = np.empty((end - start, WIDE), dtype=color.dtype)
        for y in range(height):
            line, near = _Line(height, y, 0, 0, pitch, 1), _Line(height, y, 0, start, width, 1)
            sums[:] = zero
            for j in range(len(down)):
                _find(spacing[y, start:end], j, line, firsts, shares)
                if reach is not None:
                    _stay(reach.reshape(-1), end - start, near, firsts, shares)
                _add_parts(flat, line, firsts, shares, down[j], sums)
            for x in range(len(sums)):
                for c in range(3):
                    picture[y, start + x, c] = sums[x, c] + sums[x, c + 4]


@inline
def _find(spacing, j, line, firsts, shares):
    """The first of the two texels around the taps `j` spacings to both sides, and the second's weight."""
    scalar = spacing.dtype.type
    last = scalar(np.int32(line.size - 1))
    for side in range(2):
        first, share, away = firsts[side], shares[side], scalar(j if side else -j)
        for x in range(len(spacing)):
            place = min(max(scalar(np.int32(line.start + line.step * x)) + away * spacing[x], scalar(0)), last)
            first[x] = np.int32(place)
            share[x] = place - scalar(first[x])


@inline
def _stay(reach, count, line, firsts, shares):
    """Let taps between two texels of no reach read the pixel itself."""
    scalar = shares.dtype.type
    for side in range(2):
        for x in range(count):
            a = np.int64(firsts[side, x])
            start = line.base + x * line.aside
            b = min(a + 1, line.size - 1)
            if not (reach[start + a * line.along] > scalar(0) or reach[start + b * line.along] > scalar(0)):
                firsts[side, x], shares[side, x] = np.int32(line.start + line.step * x), scalar(0)


@inline
def _add_to_parts(texels, line, firsts, shares, weights, sums):
    """Add a tap to both sides to the sums of each component (X n, 8). After a line's last texel the share is 0."""
    count = len(weights)
    for x in range(len(sums) // count):
        a, c = line.base + np.int64(firsts[0, x]), line.base + np.int64(firsts[1, x])
        for n in range(count):
            add_pairs_of_four(sums, x * count + n, weights, n, texels, a, a + 1, c, c + 1, shares[0, x], shares[1, x])


@inline
def _add_parts(parts, line, firsts, shares, weights, sums):
    """Add a tap of all components to both sides to the sums (X, 8)."""
    count = len(weights)
    below = line.along * count
    for x in range(len(sums)):
        a = (np.int64(firsts[0, x]) * line.along + x) * count
        c = (np.int64(firsts[1, x]) * line.along + x) * count
        for n in range(count):
            add_pairs(
                sums, x, weights, n, parts, a + n, a + n + below, c + n, c + n + below, shares[0, x], shares[1, x]
            )


@inline
def _keep(texels, parts):
    for x in range(len(parts)):
        for n in range(parts.shape[1]):
            for c in range(3):
                parts[x, n, 0, c], parts[x, n, 1, c] = texels[x, n, c], texels[x, n, c + 4]
