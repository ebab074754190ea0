"""Naive twins of the single-image baselines: per output pixel, tap by tap, in float64, sharing no code with the package.

Texture reads are counted where a method has any.
"""

import math

import numpy as np
import shapely

SIDES = 4000  # of a polygon of the disc's area: a pixel's share errs by less than (2 pi / n)^2, 3e-6 of the disc


def disc_shares(radius):
    """{(i, j): share} of a disc of `radius` around the centre of pixel (0, 0), by cutting polygons."""
    if radius == 0:
        return {(0, 0): 1.0}
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    equal = radius * math.sqrt(2 * np.pi / SIDES / math.sin(2 * np.pi / SIDES))
    disc = shapely.Polygon(equal * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    reach = math.ceil(radius + 0.5)
    shares = {}
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            area = disc.intersection(shapely.box(i - 0.5, j - 0.5, i + 0.5, j + 0.5)).area
            if area > 0:
                shares[i, j] = area / disc.area
    return shares


def scatter(color, depth, coc, far_to_near=False):
    """Potmesil and Chakravarty: every output pixel asks all others for their share in it."""
    height, width = depth.shape
    shares = {key: disc_shares(abs(coc[key])) for key in np.ndindex(height, width)}
    sources = sorted(np.ndindex(height, width), key=lambda key: -depth[key]) if far_to_near else list(shares)
    out = np.zeros((height, width, 3))
    for y, x in np.ndindex(height, width):
        light, total = np.zeros(3), 0.0
        for j, i in sources:
            share = shares[j, i].get((x - i, y - j), 0.0)
            kept = 1 - share if far_to_near else 1.0
            light, total = light * kept + share * color[j, i], total * kept + share
        out[y, x] = light / total
    return out
