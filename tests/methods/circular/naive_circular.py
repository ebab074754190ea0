"""The naive twin of `circular`: complex numbers in plain Python. It shares no code with the method."""

import cmath
import math

import numpy as np

from tests.methods.naive_reads import read

RADIUS = 8


def taps_of(table, transition):
    """Normalised complex taps of each component: {j: tap}."""

    def tap(a, b, j):
        x = (1 + transition) * j / RADIUS
        return math.exp(-a * x**2) * cmath.exp(1j * b * x**2)

    raw = [{j: tap(a, b, j) for j in range(-RADIUS, RADIUS + 1)} for a, b, _, _ in table]
    total = 0.0
    for (_, _, real, imaginary), f in zip(table, raw, strict=True):
        for p in f.values():
            for q in f.values():
                total += real * (p * q).real + imaginary * (p * q).imag
    return [{j: value / math.sqrt(total) for j, value in f.items()} for f in raw]


def disc(color, circles, in_reach, table, params):
    height, width = circles.shape
    taps = taps_of(table, params.transition)
    step = np.minimum(circles, params.largest_px) * (1 + params.transition) / (params.fitted_radius * RADIUS)

    def gathered(image, f, axis):
        out = np.empty((height, width, 3), complex)
        for y, x in np.ndindex(height, width):
            sums = 0
            for j, weight in f.items():
                u, v = (x + j * step[y, x], y) if axis else (x, y + j * step[y, x])
                u, v = min(max(u, 0), width - 1), min(max(v, 0), height - 1)
                touched = {(int(v), int(u)), (int(v), min(int(u) + 1, width - 1))} if axis else {
                    (int(v), int(u)), (min(int(v) + 1, height - 1), int(u))
                }  # fmt: skip
                seen = j == 0 or any(in_reach[place] for place in touched)
                sums = sums + weight * (read(image, u + 0.5, v + 0.5) if seen else image[y, x])
            out[y, x] = sums
        return out

    image = np.zeros((height, width, 3))
    for (_, _, real, imaginary), f in zip(table, taps, strict=True):
        product = gathered(gathered(color.astype(complex), f, 1), f, 0)
        image += real * product.real + imaginary * product.imag
    return image


def nearest_tiles(coc, side=8):
    """The nearest circle of tiles and of those around, read between them: (H, W)."""
    height, width = coc.shape
    h, w = math.ceil(height / side), math.ceil(width / side)
    least = np.array(
        [[coc[side * j : side * (j + 1), side * i : side * (i + 1)].min() for i in range(w)] for j in range(h)]
    )
    around = np.empty((h, w))
    for j, i in np.ndindex(h, w):
        around[j, i] = max(0.0, -least[max(0, j - 1) : j + 2, max(0, i - 1) : i + 2].min())
    out = np.empty((height, width))
    for y, x in np.ndindex(height, width):
        out[y, x] = read(around, (x + 0.5) * w / width, (y + 0.5) * h / height)
    return out


def naive_blur(color, coc, params, tables):
    table = tables[params.components]
    everywhere = np.ones(coc.shape, bool)
    if params.fields == "own":
        return disc(color, np.abs(coc), everywhere, table, params)
    behind, before = np.maximum(coc, 0), nearest_tiles(coc)
    far = disc(color, behind, behind > 0, table, params)
    near = disc(color, before, everywhere, tables[1], params)
    share = np.minimum(behind, 1)[..., None]
    out = (1 - share) * color + share * far
    share = np.minimum(before, 1)[..., None]
    return (1 - share) * out + share * near
