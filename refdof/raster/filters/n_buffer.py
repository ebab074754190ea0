"""N-buffers: the least and the greatest depth inside any rectangle of pixels, in a few look-ups.

Level i holds, at every pixel, the extreme value of the 2^i x 2^i square whose top left corner is that pixel, cut off
at the border of the image. All levels have the size of the image.

1. find every pixel's (or block's) extremes          `bottom_lowest`, `bottom_highest`
2. double the squares, level by level                `double_lowest`, `double_highest`
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

from refdof._check import Float, Index, InputError, as_bool, as_choice, as_index, as_integer, as_map, shape_of
from refdof._jit import borrow, inline, kernel, prange
from refdof.raster.filters.n_buffer_levels import (
    bottom_highest,
    bottom_lowest,
    double_highest,
    double_lowest,
    extremes_of_four,
)

__all__ = ["Extremes", "NBuffer", "highest_in", "lowest_in", "n_buffer", "query"]

_CHUNK = 1024  # rectangles that one iteration answers


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


class Rectangles(NamedTuple):
    """First and last column and row of K rectangles, both inclusive [px], (K,) each."""

    x0: Index
    y0: Index
    x1: Index
    y1: Index


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
    depth = as_map("depth", depth, (None,) * (3 if len(shape_of("depth", depth)) == 3 else 2))
    as_choice("extremes", extremes, ("both", "min", "max"))
    block = as_integer("block", block, minimum=1, maximum=2**20)
    height, width = depth.shape[-2:]
    rows, columns = -(-height // block), -(-width // block)
    levels = _level_count(max(rows, columns), largest, block)

    stack = depth.reshape(-1, height, width)
    lowest = np.empty((levels if extremes != "max" else 0, rows, columns), dtype=depth.dtype)
    highest = np.empty((levels if extremes != "min" else 0, rows, columns), dtype=depth.dtype)
    infinity = depth.dtype.type(np.inf)
    if len(lowest):
        bottom_lowest(stack, block, infinity, lowest[0])
        for level in range(1, levels):
            double_lowest(lowest[level - 1], 2 ** (level - 1), lowest[level])
    if len(highest):
        bottom_highest(stack, block, infinity, highest[0])
        for level in range(1, levels):
            double_highest(highest[level - 1], 2 ** (level - 1), highest[level])
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
        If a rectangle is inverted or leaves the image, an exact answer is asked of a buffer of blocks, or the levels
        do not fit the image or each other.
    """
    if not isinstance(nbuffer, NBuffer):
        raise InputError(f"nbuffer: got {type(nbuffer).__name__}; allowed is what n_buffer returns")
    made = [side.shape for side in nbuffer[:2] if len(side)]
    plane = -(-nbuffer.height // nbuffer.block), -(-nbuffer.width // nbuffer.block)
    if not made or any(shape != (len(nbuffer.lowest) or len(nbuffer.highest), *plane) for shape in made):
        shapes = f"{nbuffer.lowest.shape} and {nbuffer.highest.shape}"
        raise InputError(
            f"nbuffer: got levels of shape {shapes}; each side must have the same number of shape {plane}, or none"
        )
    nbuffer = nbuffer._replace(
        lowest=np.ascontiguousarray(nbuffer.lowest), highest=np.ascontiguousarray(nbuffer.highest)
    )
    if as_bool("exact", exact) and nbuffer.block > 1:
        raise InputError(f"exact: got True for blocks of {nbuffer.block} px; allowed is a buffer with block 1")
    rectangles = x0, y0, x1, y1
    ready = all(isinstance(side, np.ndarray) and side.dtype == np.int64 and side.ndim == 1 for side in rectangles)
    if not ready or len({len(side) for side in rectangles}) > 1:
        rectangles = _as_rectangles(nbuffer, *rectangles)
    count = len(rectangles[0])
    lowest = np.empty(count if len(nbuffer.lowest) else 0, dtype=nbuffer.lowest.dtype)
    highest = np.empty(count if len(nbuffer.highest) else 0, dtype=nbuffer.highest.dtype)
    inside = np.empty(-(-count // _CHUNK), dtype=np.bool_)
    _query(nbuffer, Rectangles(*rectangles), bool(exact), Extremes(lowest, highest), inside)
    if not inside.all():
        _as_rectangles(nbuffer, *rectangles)
    return Extremes(lowest, highest)


def _as_rectangles(nbuffer: NBuffer, x0: Any, y0: Any, x1: Any, y1: Any) -> tuple[Index, Index, Index, Index]:
    """Validation of rectangles: four int64 arrays (K,), inside the image and not inverted."""
    x0 = as_index("x0", x0, (None,), end=nbuffer.width)
    y0 = as_index("y0", y0, x0.shape, end=nbuffer.height)
    x1 = as_index("x1", x1, x0.shape, end=nbuffer.width)
    y1 = as_index("y1", y1, x0.shape, end=nbuffer.height)
    for first_name, first, last_name, last in (("x0", x0, "x1", x1), ("y0", y0, "y1", y1)):
        if (first > last).any():
            k = int(np.argmax(first > last))
            got = f"got {last[k]} with {first_name} {first[k]}"
            raise InputError(f"{last_name}: {got}; allowed is {first_name} or more")
    return x0, y0, x1, y1


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
    if block > 1:
        x0, y0, x1, y1 = x0 // block, y0 // block, x1 // block, y1 // block
    width, height = x1 - x0 + 1, y1 - y0 + 1
    level = _level_of(width, height, len(levels), exact)
    side = 1 << level
    found = levels[level, y0, x0]
    if max(width, height) <= 2 * side:  # two by two squares
        right, below = max(x1 + 1 - side, x0), max(y1 + 1 - side, y0)
        value = levels[level, y0, right]
        found = value if value < found else found
        value = levels[level, below, x0]
        found = value if value < found else found
        value = levels[level, below, right]
        return value if value < found else found
    for y in range(y0, y1 + 1, side):
        for x in range(x0, x1 + 1, side):
            value = levels[level, max(min(y, y1 + 1 - side), y0), max(min(x, x1 + 1 - side), x0)]
            found = value if value < found else found
    return found


@inline
def highest_in(levels, block, x0, y0, x1, y1, exact):
    """The greatest value in a rectangle, for kernels: `NBuffer.highest`, else as `lowest_in`."""
    if block > 1:
        x0, y0, x1, y1 = x0 // block, y0 // block, x1 // block, y1 // block
    width, height = x1 - x0 + 1, y1 - y0 + 1
    level = _level_of(width, height, len(levels), exact)
    side = 1 << level
    found = levels[level, y0, x0]
    if max(width, height) <= 2 * side:  # two by two squares
        right, below = max(x1 + 1 - side, x0), max(y1 + 1 - side, y0)
        value = levels[level, y0, right]
        found = value if value > found else found
        value = levels[level, below, x0]
        found = value if value > found else found
        value = levels[level, below, right]
        return value if value > found else found
    for y in range(y0, y1 + 1, side):
        for x in range(x0, x1 + 1, side):
            value = levels[level, max(min(y, y1 + 1 - side), y0), max(min(x, x1 + 1 - side), x0)]
            found = value if value > found else found
    return found


@inline
def _level_of(width, height, count, exact):
    """The squares to take: the largest that fit inside, or the smallest that cover two by two; < count."""
    pixels = min(width, height) if exact else max(width - 1, height - 1, 1)
    exponent = (np.float64(pixels).view(np.int64) >> 52) - 1023  # floor(log2(pixels))
    return min(exponent, count - 1)


@kernel
def _query(nbuffer, rectangles, exact, found, inside):
    """Fill the extremes found (K,), or a length of 0 for a side not made, and whether all of a chunk are valid.

    That part of the validation is here: reading all corners once more would take longer than the answers.
    """
    lowest, highest, block, low, high = nbuffer.lowest, nbuffer.highest, nbuffer.block, found.lowest, found.highest
    shape = max(len(lowest), len(highest)), nbuffer.height, nbuffer.width  # of flat levels without blocks
    x0, y0, x1, y1 = rectangles
    flat_near, flat_far = lowest.reshape(-1), highest.reshape(-1)
    for chunk in prange(len(inside)):
        part = slice(chunk * _CHUNK, (chunk + 1) * _CHUNK)
        left, top, right, bottom = borrow(x0)[part], borrow(y0)[part], borrow(x1)[part], borrow(y1)[part]
        places = np.empty((3, len(left)), dtype=np.int64)
        valid, covered = _four_squares(Rectangles(left, top, right, bottom), shape, exact, places)
        inside[chunk] = valid
        if not valid:
            continue
        near, far, least, greatest = borrow(lowest), borrow(highest), borrow(low)[part], borrow(high)[part]
        if block == 1:
            extremes_of_four(borrow(flat_near), borrow(flat_far), places, least, greatest)
            if covered:
                continue
        for k in range(len(left)):
            width_k, height_k = right[k] - left[k] + 1, bottom[k] - top[k] + 1
            if block == 1 and max(width_k, height_k) <= 2 << _level_of(width_k, height_k, shape[0], exact):
                continue
            if len(near):
                least[k] = lowest_in(near, block, left[k], top[k], right[k], bottom[k], exact)
            if len(far):
                greatest[k] = highest_in(far, block, left[k], top[k], right[k], bottom[k], exact)


@inline
def _four_squares(rectangles, shape, exact, places):
    """Whether all rectangles are valid, and two by two squares cover each: then the squares' places.

    places (3, K): that of the first square in the flattened levels, and the steps to its right and its lower neighbour.
    Without branches, so that the compiler takes many at once.
    """
    left, top, right, bottom = rectangles
    count, height, width = shape
    plane, corner, across, down = height * width, places[0], places[1], places[2]
    wrong, uncovered = 0, 0
    for k in range(len(left)):
        # Cut off: far outside, differences could leave the type.
        x, y = min(max(left[k], -1), width), min(max(top[k], -1), height)
        last_x, last_y = max(min(right[k], width), -1), max(min(bottom[k], height), -1)
        wrong |= (x < 0) | (y < 0) | (last_x < x) | (last_y < y) | (last_x >= width) | (last_y >= height)
        w, h = max(last_x - x + 1, 1), max(last_y - y + 1, 1)
        level = _level_of(w, h, count, exact)
        side = 1 << level
        uncovered |= max(w, h) > 2 * side
        corner[k] = level * plane + y * width + x
        across[k], down[k] = max(w - side, 0), max(h - side, 0) * width
    return wrong == 0, uncovered == 0
