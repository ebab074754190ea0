"""N-buffers: the least and the greatest depth inside any rectangle of pixels, in a few look-ups.

Level i holds, at every pixel, the extreme value of the 2^i x 2^i square whose top left corner is that pixel, cut off
at the border of the image. All levels have the size of the image.

1. find every pixel's (or block's) extremes          `_bottom_lowest`, `_bottom_highest`
2. double the squares, level by level                `_double_lowest`, `_double_highest`
3. cover a rectangle with four equal squares         `lowest_in`, `highest_in`, `query`

An infinite depth is empty: it counts as +inf in a minimum and as -inf in a maximum. A rectangle that holds nothing
answers (inf, -inf), the only case in which the minimum is above the maximum.

Departures from the paper
-------------------------
Written after the abstract of [1] and its use in [2]; where they leave details open:

- Squares hang from their corner pixel and are not centred around it: a shift, no loss.
- The squares are the smallest that cover the rectangle two by two. Where that side is larger than the rectangle's
  shorter side they reach past it, and the answer is conservative: never too high a minimum, never too low a maximum.
  `exact` takes smaller squares and more of them.
- Blocks of pixels (the downsampled buffer of [2]) are always conservative. [2] looks small regions up in the original
  image, which the caller has at hand.
- [2] marks empty pixels with depth 0; here they are infinite.

References
----------
.. [1] Decoret (2005), N-Buffers for Efficient Depth Map Query, Computer Graphics Forum 24(3).
.. [2] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_choice, as_float, as_index, as_integer
from refdof._jit import inline, kernel, prange

__all__ = ["Extremes", "NBuffer", "highest_in", "lowest_in", "n_buffer", "query"]


class NBuffer(NamedTuple):
    """lowest, highest: (L, ceil(H / block), ceil(W / block)), levels of squares of side 2^i; L = 0 for a side not made.

    `block` [px] is the side of the pixel blocks that the levels count in; `height` and `width` are the image's [px].
    """

    lowest: Float
    highest: Float
    block: int
    height: int
    width: int


class Extremes(NamedTuple):
    """lowest, highest: (K,), the extremes inside K rectangles; lowest > highest where there is nothing."""

    lowest: Float
    highest: Float


def n_buffer(depth: Any, *, extremes: str = "both", largest: int | None = None, block: int = 1) -> NBuffer:
    """Build the N-buffer of a depth map, or the shared one of several layers.

    Parameters
    ----------
    depth : (H, W) or (N, H, W) float32 or float64
        Any values; infinite ones are empty. N layers share one buffer of their extremes per pixel.
    extremes : "both", "min" or "max"
        Which side to make.
    largest : int, optional
        Longest side of the rectangles that will be asked for [px]: levels that only larger ones need are left out.
        A larger rectangle is still answered, with more look-ups. None: 1 + ceil(log2(max(H, W))) levels, the last of
        which holds the whole image's extreme in its first pixel.
    block : int
        Side of the blocks of pixels that are reduced to one value each [px]; blocks at the border may be partial.

    Returns
    -------
    NBuffer
        Of the type of `depth`. Only comparisons are made, no arithmetic: values are exact.

    Raises
    ------
    InputError
        If depth has another shape, no pixels or NaN, or another argument is out of range.

    Notes
    -----
    Time and memory are O(H W L / block^2) for L levels and each side.
    """
    depth = as_float("depth", depth, (None,) * (3 if np.ndim(depth) == 3 else 2), finite=False)
    if depth.size == 0:
        raise InputError(f"depth: got shape {depth.shape}; allowed are images of at least one pixel")
    as_choice("extremes", extremes, ("both", "min", "max"))
    block = as_integer("block", block, minimum=1)
    height, width = depth.shape[-2:]
    rows, columns = -(-height // block), -(-width // block)
    levels = _level_count(max(rows, columns), largest, block)

    stack = depth.reshape(-1, height, width)
    lowest = np.empty((levels if extremes != "max" else 0, rows, columns), dtype=depth.dtype)
    highest = np.empty((levels if extremes != "min" else 0, rows, columns), dtype=depth.dtype)
    infinity = depth.dtype.type(np.inf)
    if len(lowest):
        _bottom_lowest(stack, block, infinity, lowest[0])
        for level in range(1, levels):
            _double_lowest(lowest[level - 1], 2 ** (level - 1), lowest[level])
    if len(highest):
        _bottom_highest(stack, block, infinity, highest[0])
        for level in range(1, levels):
            _double_highest(highest[level - 1], 2 ** (level - 1), highest[level])
    return NBuffer(lowest, highest, block, height, width)


def query(nbuffer: NBuffer, x0: Any, y0: Any, x1: Any, y1: Any, *, exact: bool = False) -> Extremes:
    """The extremes inside K rectangles of pixels.

    Parameters
    ----------
    nbuffer : NBuffer
    x0, y0, x1, y1 : (K,) integers
        First and last column and row, both **inclusive** [px].
    exact : bool
        False: at most four squares; exact if those stay inside the rectangle or outside the image, else conservative.
        They do whenever the rectangle's shorter side is at least as long as a square's: 2^i for the least i with
        2^(i + 1) >= longer side. True: as many squares as it takes, about longer / shorter side times as many.

    Returns
    -------
    Extremes
        A side that was not made has length 0.

    Raises
    ------
    InputError
        If a rectangle is inverted or leaves the image, or an exact answer is asked of a buffer of blocks.
    """
    if not isinstance(nbuffer, NBuffer):
        raise InputError(f"nbuffer: got {type(nbuffer).__name__}; allowed is what n_buffer returns")
    if exact and nbuffer.block > 1:
        raise InputError(f"exact: got True for blocks of {nbuffer.block} px; allowed is a buffer with block 1")
    x0 = as_index("x0", x0, (None,), end=nbuffer.width)
    y0 = as_index("y0", y0, x0.shape, end=nbuffer.height)
    x1 = as_index("x1", x1, x0.shape, end=nbuffer.width)
    y1 = as_index("y1", y1, x0.shape, end=nbuffer.height)
    for first_name, first, last_name, last in (("x0", x0, "x1", x1), ("y0", y0, "y1", y1)):
        if (first > last).any():
            k = int(np.argmax(first > last))
            raise InputError(
                f"{last_name}: got {last[k]} with {first_name} {first[k]}; allowed is {first_name} or more"
            )

    lowest = np.empty(len(x0) if len(nbuffer.lowest) else 0, dtype=nbuffer.lowest.dtype)
    highest = np.empty(len(x0) if len(nbuffer.highest) else 0, dtype=nbuffer.highest.dtype)
    if len(lowest):
        _query_lowest(nbuffer.lowest, nbuffer.block, x0, y0, x1, y1, bool(exact), lowest)
    if len(highest):
        _query_highest(nbuffer.highest, nbuffer.block, x0, y0, x1, y1, bool(exact), highest)
    return Extremes(lowest, highest)


def _level_count(side: int, largest: int | None, block: int) -> int:
    """Levels for an image of `side` blocks: the last square covers it, or two by two cover `largest` pixels."""
    if largest is None:
        return 1 + (side - 1).bit_length()
    largest = as_integer("largest", largest, minimum=1)
    spanned = min((largest + block - 2) // block + 1, side)  # blocks that `largest` pixels touch at most
    return max((spanned - 1).bit_length(), 1)


@inline
def lowest_in(levels, block, x0, y0, x1, y1, exact):
    """The least value in a rectangle, for kernels: `NBuffer.lowest`, `NBuffer.block`, inclusive pixels in the image."""
    x0, y0, x1, y1 = x0 // block, y0 // block, x1 // block, y1 // block
    level = _level_of(x1 - x0 + 1, y1 - y0 + 1, len(levels), exact)
    side = 1 << level
    found = levels[level, y0, x0]
    for y in range(y0, y1 + 1, side):
        for x in range(x0, x1 + 1, side):
            value = levels[level, max(min(y, y1 + 1 - side), y0), max(min(x, x1 + 1 - side), x0)]
            found = value if value < found else found
    return found


@inline
def highest_in(levels, block, x0, y0, x1, y1, exact):
    """The greatest value in a rectangle, for kernels: `NBuffer.highest`, else as `lowest_in`."""
    x0, y0, x1, y1 = x0 // block, y0 // block, x1 // block, y1 // block
    level = _level_of(x1 - x0 + 1, y1 - y0 + 1, len(levels), exact)
    side = 1 << level
    found = levels[level, y0, x0]
    for y in range(y0, y1 + 1, side):
        for x in range(x0, x1 + 1, side):
            value = levels[level, max(min(y, y1 + 1 - side), y0), max(min(x, x1 + 1 - side), x0)]
            found = value if value > found else found
    return found


@inline
def _level_of(width, height, count, exact):
    """The squares to take: the largest that fit inside, or the smallest that cover two by two; < count."""
    level = 0
    if exact:
        while level + 1 < count and 2 << level <= min(width, height):
            level += 1
    else:
        while level + 1 < count and 2 << level < max(width, height):
            level += 1
    return level


@kernel
def _query_lowest(levels, block, x0, y0, x1, y1, exact, out):
    """Fill out (K,)."""
    for k in prange(len(out)):
        out[k] = lowest_in(levels, block, x0[k], y0[k], x1[k], y1[k], exact)


@kernel
def _query_highest(levels, block, x0, y0, x1, y1, exact, out):
    """Fill out (K,)."""
    for k in prange(len(out)):
        out[k] = highest_in(levels, block, x0[k], y0[k], x1[k], y1[k], exact)


@kernel
def _bottom_lowest(stack, block, infinity, out):
    """Least value of every block over all layers: stack (N, H, W) -> out (ceil(H / block), ceil(W / block))."""
    for y in prange(len(out)):
        row = out[y]
        row[:] = infinity
        for layer in range(len(stack)):
            for source in range(y * block, min((y + 1) * block, stack.shape[1])):
                for dx in range(min(block, stack.shape[2])):
                    taps = stack[layer, source, dx::block]
                    for x in range(len(taps)):
                        value = taps[x] if abs(taps[x]) < infinity else infinity
                        row[x] = value if value < row[x] else row[x]


@kernel
def _bottom_highest(stack, block, infinity, out):
    """Greatest value of every block over all layers, as `_bottom_lowest`."""
    for y in prange(len(out)):
        row = out[y]
        row[:] = -infinity
        for layer in range(len(stack)):
            for source in range(y * block, min((y + 1) * block, stack.shape[1])):
                for dx in range(min(block, stack.shape[2])):
                    taps = stack[layer, source, dx::block]
                    for x in range(len(taps)):
                        value = taps[x] if abs(taps[x]) < infinity else -infinity
                        row[x] = value if value > row[x] else row[x]


@kernel
def _double_lowest(level, side, out):
    """Squares of 2 `side` from squares of `side`: (H, W) -> (H, W).

    A square that reaches the border has no right or lower neighbour that could add to it.
    """
    height, width = level.shape
    for y in prange(height):
        upper, lower, row = level[y], level[min(y + side, height - 1)], out[y]
        for x in range(width):
            row[x] = upper[x] if upper[x] < lower[x] else lower[x]
        upper_right, lower_right = upper[side:], lower[side:]
        for x in range(len(upper_right)):
            right = upper_right[x] if upper_right[x] < lower_right[x] else lower_right[x]
            row[x] = right if right < row[x] else row[x]


@kernel
def _double_highest(level, side, out):
    """As `_double_lowest`, for the greatest values."""
    height, width = level.shape
    for y in prange(height):
        upper, lower, row = level[y], level[min(y + side, height - 1)], out[y]
        for x in range(width):
            row[x] = upper[x] if upper[x] > lower[x] else lower[x]
        upper_right, lower_right = upper[side:], lower[side:]
        for x in range(len(upper_right)):
            right = upper_right[x] if upper_right[x] > lower_right[x] else lower_right[x]
            row[x] = right if right > row[x] else row[x]
