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


class Reads:
    """Bilinear reads with the edge repeated, counted."""

    def __init__(self):
        self.count = 0

    def at(self, image, x, y):
        """x, y in texels from the corner."""
        self.count += 1
        height, width = image.shape[:2]
        i, j = math.floor(x - 0.5), math.floor(y - 0.5)
        value = 0.0
        for row, share_y in ((j, 1 - (y - 0.5 - j)), (j + 1, y - 0.5 - j)):
            for column, share_x in ((i, 1 - (x - 0.5 - i)), (i + 1, x - 0.5 - i)):
                texel = image[min(max(row, 0), height - 1), min(max(column, 0), width - 1)]
                value = value + share_x * share_y * texel
        return value


TWELVE = """-.326212 -.40581 -.840144 -.07358 -.695914 .457137 -.203345 .620716 .96234 -.194983 .473434 -.480026
.519456 .767022 .185461 -.893124 .507431 .064425 .89642 .412458 -.32194 -.932615 -.791559 -.59771"""


def poisson(color, code, max_radius=5.0):
    """Scheuermann's shader on a picture (H, W, 3) with its code (H, W): picture and number of reads."""
    reads = Reads()
    height, width = code.shape
    high = np.concatenate([color, code[..., None]], axis=-1)
    rows, columns = max(1, height // 4), max(1, width // 4)
    # A quarter of each side, halved twice; a side of 1 stays, and odd rests have no part.
    tall, broad = (4 if side >= 4 else 2 if side >= 2 else 1 for side in (height, width))
    box = np.array(
        [
            [high[tall * y : tall * y + tall, broad * x : broad * x + broad].mean(axis=(0, 1)) for x in range(columns)]
            for y in range(rows)
        ]
    )
    low = np.zeros_like(box)
    for y, x in np.ndindex(rows, columns):
        for j, i in np.ndindex(3, 3):
            low[y, x] += (0.25, 0.5, 0.25)[j] * (0.25, 0.5, 0.25)[i] * reads.at(box, x + i - 0.5, y + j - 0.5)
    taps = np.array(TWELVE.split(), dtype=float).reshape(12, 2)
    out = np.zeros((height, width, 3))
    for y, x in np.ndindex(height, width):
        radius = abs(2 * max_radius * code[y, x] - max_radius)  # |10 a - 5|
        light, total = np.zeros(3), 0.0
        for dx, dy in taps:
            sharp = reads.at(high, x + 0.5 + dx * radius, y + 0.5 + dy * radius)
            place = x + 0.5 + 4 * dx * 0.4 * radius, y + 0.5 + 4 * dy * 0.4 * radius
            soft = reads.at(low, place[0] / width * columns, place[1] / height * rows)
            blend = abs(2 * sharp[3] - 1)
            tap = (1 - blend) * sharp + blend * soft
            weight = 1.0 if tap[3] >= code[y, x] else abs(2 * tap[3] - 1)
            light, total = light + weight * tap[:3], total + weight
        out[y, x] = light / total if total > 0 else color[y, x]
    return out, reads.count


def separable(color, depth, coc, leakage=1.0):
    """The reconstructed two passes, pixel by pixel: picture and number of reads."""
    height, width = depth.shape
    reads = 0

    def passed(image, down):
        nonlocal reads
        out = np.zeros_like(image)
        for y, x in np.ndindex(height, width):
            own = abs(coc[y, x])
            light, total = np.zeros(3), 0.0
            for step in range(-math.ceil(own), math.ceil(own) + 1):
                reads += 2 if down else 1
                j, i = (y + step, x) if down else (y, x + step)
                if not (0 <= j < height and 0 <= i < width):
                    continue
                radius = abs(coc[j, i])
                overlap = 1.0 if step == 0 else min(max(radius - abs(step), 0.0), 1.0)
                weight = overlap / max(1.0, math.pi * radius**2)
                if depth[j, i] > depth[y, x]:
                    weight *= min(leakage * own, 1.0)
                light, total = light + weight * image[j, i], total + weight
            out[y, x] = light / total
        return out

    return passed(passed(color.astype(float), False), True), reads
