"""Naive twins of the single-image baselines: pixel by pixel, in float64. They share no code with the package.

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


def pyramidal(color, coc, largest_side=8):
    """The reconstructed sub-images: picture and number of reads.

    Borders between sub-images lie at 0.85 px and at 1.5 times 1.7 2^(i - 1) px, on either side.
    """
    reads = 0
    height, width = coc.shape
    borders = [0.85] + [1.5 * 1.7 * 2.0 ** (i - 1) for i in range(1, 20)]  # borders[i]: between i and i + 1
    signed = {i: borders[i] for i in range(19)} | {-i - 1: -borders[i] for i in range(19)}

    def needed(largest):
        return next((i for i in range(largest_side) if largest <= borders[i]), largest_side)

    def synthesized(coarse, y, x):
        rows, columns = coarse.shape[:2]
        total = 0.0
        for j, share_y in ((y // 2, 0.75), (y // 2 + (1 if y % 2 else -1), 0.25)):
            for i, share_x in ((x // 2, 0.75), (x // 2 + (1 if x % 2 else -1), 0.25)):
                total = total + share_y * share_x * coarse[min(max(j, 0), rows - 1), min(max(i, 0), columns - 1)]
        return total

    def fill(image, known):
        nonlocal reads
        if known.size == 1:
            return np.where(known[..., None], image, 0.0)
        rows, columns = known.shape
        coarse = np.zeros((math.ceil(rows / 2), math.ceil(columns / 2), image.shape[2]))
        mask = np.zeros(coarse.shape[:2], dtype=bool)
        for y, x in np.ndindex(mask.shape):
            reads += 4
            block = np.s_[2 * y : 2 * y + 2, 2 * x : 2 * x + 2]
            mask[y, x] = known[block].any()
            if mask[y, x]:
                coarse[y, x] = image[block][known[block]].mean(axis=0)
        coarse = fill(coarse, mask)
        out = image.copy()
        for y, x in np.ndindex(rows, columns):
            reads += 5
            if not known[y, x]:
                out[y, x] = synthesized(coarse, y, x)
        return out

    def soften(image, levels):
        nonlocal reads
        if levels == 0:
            return image
        rows, columns = image.shape[:2]
        coarse = np.zeros((math.ceil(rows / 2), math.ceil(columns / 2), image.shape[2]))
        for y, x in np.ndindex(coarse.shape[:2]):
            for j, i in np.ndindex(4, 4):
                reads += 1
                row, column = 2 * y - 1 + j, 2 * x - 1 + i
                coarse[y, x] += image[min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)] / 16
        coarse = soften(coarse, levels - 1)
        out = np.zeros_like(image)
        for y, x in np.ndindex(rows, columns):
            reads += 4
            out[y, x] = synthesized(coarse, y, x)
        return out

    front, back = needed(-coc.min()), needed(coc.max())
    result = np.zeros((height, width, 4))
    for i in range(back, -front - 1, -1):
        lower, upper = (0.0 if i == 1 else signed[i - 2]), (0.0 if i == -1 else signed[i + 1])
        known = coc >= lower if i > -front else np.ones(coc.shape, dtype=bool)
        filled = fill(np.concatenate([color, coc[..., None]], axis=-1), known)
        layer = np.zeros((height, width, 4))
        for y, x in np.ndindex(height, width):
            reads += 3
            c = filled[y, x, 3]
            opacity = 1.0
            if i > -front and c < signed[i - 1]:
                opacity = max((c - lower) / (signed[i - 1] - lower), 0.0)
            if i < back and c > signed[i]:
                opacity = max((upper - c) / (upper - signed[i]), 0.0)
            layer[y, x] = [*(opacity * filled[y, x, :3]), opacity]
        layer = soften(layer, abs(i))
        result = layer + (1 - layer[..., 3:]) * result
    return result[..., :3] / result[..., 3:], reads
