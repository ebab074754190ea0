"""Naive twins of mip chains: loops over the full picture's pixels that a coarse texel stands for."""

import math


def pixels_of(x, y, level, shape):
    """Pixels (x, y) under texel (x, y) of a level, where the last texel of an odd size joins the last coarser one."""
    height, width = shape

    def range_of(place, size):
        first, count = place << level, max(1, size >> level)
        return range(first if place < count else size, size if place == count - 1 else first + (1 << level))

    return [(i, j) for i in range_of(x, width) for j in range_of(y, height)]


def extremes(depth, x, y, level):
    """(least, greatest) finite depth under a texel; (inf, -inf): none."""
    found = [depth[j][i] for i, j in pixels_of(x, y, level, depth.shape) if not math.isinf(depth[j][i])]
    return min(found, default=math.inf), max(found, default=-math.inf)


def covered_mean(color, covered, x, y, level):
    """(part of the pixels under a texel that are covered, their mean colour as a list); sizes are powers of two."""
    pixels = pixels_of(x, y, level, covered.shape)
    there = [color[j, i] for i, j in pixels if covered[j, i]]
    channels = color.shape[2]
    return len(there) / len(pixels), [math.fsum(c[k] for c in there) / max(len(there), 1) for k in range(channels)]
