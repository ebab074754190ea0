"""Naive twins of the N-buffers: loops over the pixels of a window, as the definition reads."""

import math


def extremes_in(depth, x0, y0, x1, y1):
    """(least, greatest) finite value of depth (H, W) in an inclusive rectangle cut at the image; (inf, -inf): none."""
    height, width = depth.shape
    least, greatest = math.inf, -math.inf
    for x in range(max(x0, 0), min(x1, width - 1) + 1):
        for y in range(max(y0, 0), min(y1, height - 1) + 1):
            if not math.isinf(depth[y, x]):
                least, greatest = min(least, depth[y, x]), max(greatest, depth[y, x])
    return least, greatest


def four_squares(x0, y0, x1, y1):
    """The paper's cover of a rectangle: (side, corners) of squares that hang from their top left corner."""
    longer = max(x1 - x0 + 1, y1 - y0 + 1)
    side = 2 ** max(math.ceil(math.log2(longer)) - 1, 0)
    return side, [(x, y) for x in (x0, max(x1 - side + 1, x0)) for y in (y0, max(y1 - side + 1, y0))]
