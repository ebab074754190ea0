"""The naive twin of `NAME`: whole pictures, shifted by every offset. It shares no code with the method."""

import numpy as np


def naive_blur(color, coc, largest_px):
    """Mean of the pixels in each pixel's own circle, cut at `largest_px`."""
    height, width = coc.shape
    sums, count = np.zeros(color.shape), np.zeros((height, width, 1))
    for dy in range(-height + 1, height):
        for dx in range(-width + 1, width):
            here = np.s_[max(0, -dy) : min(height, height - dy), max(0, -dx) : min(width, width - dx)]
            there = np.s_[max(0, dy) : min(height, height + dy), max(0, dx) : min(width, width + dx)]
            inside = (np.hypot(dx, dy) <= np.minimum(np.abs(coc[here]), largest_px))[..., None]
            sums[here] += inside * color[there]
            count[here] += inside
    return sums / count
