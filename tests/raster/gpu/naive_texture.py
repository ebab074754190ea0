"""Naive twins of texture reads: sums of four weighted texels in exact fractions, texel by texel."""

import math
from fractions import Fraction

import numpy as np


def bilinear(image, u, v, border=None):
    """The four texels around (u, v) times the areas opposite to them: list of C fractions."""
    height, width, channels = image.shape
    x, y = Fraction(u) * width - Fraction(1, 2), Fraction(v) * height - Fraction(1, 2)
    i, j = math.floor(x), math.floor(y)
    right, below = x - i, y - j

    def texel(column, row, c):
        if border is not None and not (0 <= column < width and 0 <= row < height):
            return Fraction(border[c])
        return Fraction(float(image[min(max(row, 0), height - 1), min(max(column, 0), width - 1), c]))

    return [
        (1 - right) * (1 - below) * texel(i, j, c)
        + right * (1 - below) * texel(i + 1, j, c)
        + (1 - right) * below * texel(i, j + 1, c)
        + right * below * texel(i + 1, j + 1, c)
        for c in range(channels)
    ]


def trilinear(levels, u, v, lod, border=None):
    """Bilinear reads of the two levels around `lod`, weighted: list of C fractions."""
    lod = min(max(Fraction(lod), Fraction(0)), Fraction(len(levels) - 1))
    fine = math.floor(lod)
    coarse = min(fine + 1, len(levels) - 1)
    pair = zip(bilinear(levels[fine], u, v, border), bilinear(levels[coarse], u, v, border), strict=True)
    return [a * (1 - (lod - fine)) + b * (lod - fine) for a, b in pair]


def nearest_float32(value):
    """The float32 nearest to a fraction, ties to even."""
    guess = np.float32(float(value))
    around = [np.nextafter(guess, np.float32(-np.inf)), guess, np.nextafter(guess, np.float32(np.inf))]
    return min(around, key=lambda f: (abs(Fraction(float(f)) - value), int(f.view(np.uint32)) & 1))
