"""The naive twin of `hexagon`: one read after the other, in plain Python. It shares no code with the method."""

import math

import numpy as np

from tests.methods.naive_reads import read

DOWN = (0.0, 1.0)
RIGHT = (math.sqrt(3) / 2, -0.5)
LEFT = (-math.sqrt(3) / 2, -0.5)


def box(image, x, y, direction, steps, equal):
    """Mean along a direction from pixel (x, y) on."""
    if not equal:
        places = [float(k) for k in range(steps + 1)]
    else:
        places = [k + 0.5 for k in range(steps)] or [0.0]
    reads = [read(image, x + 0.5 + k * direction[0], y + 0.5 + k * direction[1]) for k in places]
    return sum(reads) / len(reads)


def naive_blur(color, coc, largest_px, equal):
    """Two passes over whole pictures."""
    height, width = coc.shape
    pixels = [(x, y) for y in range(height) for x in range(width)]
    down, both, out = np.empty_like(color), np.empty_like(color), np.empty_like(color)
    steps = [round(min(abs(float(coc[y, x])), largest_px)) for x, y in pixels]  # halves to even
    for (x, y), n in zip(pixels, steps, strict=True):
        down[y, x] = box(color, x, y, DOWN, n, equal)
        up = box(color, x, y, RIGHT, n, equal)
        both[y, x] = down[y, x] + up if equal else (down[y, x] + up) / 2
    for (x, y), n in zip(pixels, steps, strict=True):
        together = box(down, x, y, RIGHT, n, equal) + box(both, x, y, LEFT, n, equal)
        out[y, x] = together / (3 if equal else 2)
    return out
