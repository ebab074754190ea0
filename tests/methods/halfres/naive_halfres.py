"""The naive twin of `halfres`: one read after the other, in plain Python. It shares no code with the method."""

import math

import numpy as np

from tests.methods.naive_reads import read


def table():
    found = []
    for i in range(80):
        radius, angle = math.sqrt(i / 80), i * 2.39996323
        found.append((radius * math.cos(angle), radius * math.sin(angle)))
    return [p for i, p in enumerate(found) if i % 5], found[::5]


def blurs(depth, coc, params):
    """Blur of one pixel, in front and behind."""
    if params.circles == "smoothstep":
        side = depth - params.focus_plane
        t = min(abs(side) / params.focus_range, 1.0)
        c = 3 * t**2 - 2 * t**3
    else:
        side, c = coc, min(abs(coc) / params.largest_px, 1.0) if params.largest_px else 0.0
    return (c if side <= 0 else 0.0), (c if side >= 0 else 0.0)


def coarse(value):
    return math.floor(value * 255 + 0.5 + 2**-10) / 255


def each(size, what):
    """An image of `what` (x, y) says, at texel centres."""
    return np.array([[what(x + 0.5, y + 0.5) for x in range(size[1])] for y in range(size[0])])


def disc(color, circle, spots, reach):
    """Mean over a disc, at half the size: (h, w, 3)."""
    (rows, columns), (height, width) = color.shape[:2], circle.shape

    def mean(x, y):
        u, v, r = x * columns / width, y * rows / height, circle[int(y), int(x)] * reach
        return sum(read(color, u + p * r, v + q * r) for p, q in spots) / len(spots)

    return each((height, width), mean)


def most(blurred, circle, spots, reach, size):
    height, width = circle.shape

    def largest(x, y):
        r = circle[int(y), int(x)] * reach
        places = [(x + p * r * width / size[1], y + q * r * height / size[0]) for p, q in spots]
        return np.max([read(blurred, x, y), *(read(blurred, u, v) for u, v in places)], axis=0)

    return each((height, width), largest)


def naive_blur(color, depth, coc, params):
    size = coc.shape
    half = tuple(max(1, math.floor(n / 2 + 0.5)) for n in size)
    pairs = [[blurs(depth[y, x], coc[y, x], params) for x in range(size[1])] for y in range(size[0])]
    near, far = np.moveaxis(np.array(pairs), 2, 0)
    other = params.variant == "pmndrs"
    if other:
        near, far = np.vectorize(coarse)(near), np.vectorize(coarse)(far)
        spread = near
        for k in (0, 1, 1, 2):
            right, down = spread.shape[1] / half[1], spread.shape[0] / half[0]
            corners = [(u, v) for u in (-k - 0.5, k + 0.5) for v in (-k - 0.5, k + 0.5)]
            spread = each(
                half,
                lambda x, y, s=spread, c=corners, r=right, d=down: coarse(
                    sum(read(s, (x + u) * r, (y + v) * d) for u, v in c) / 4
                ),
            )
    else:
        weights = [math.exp(-(i**2) / (2 * (7 / 3) ** 2)) for i in range(-6, 7)]
        across = each(
            size, lambda x, y: sum(w * read(near, x + i - 6, y) for i, w in enumerate(weights)) / sum(weights)
        )
        spread = each(
            size, lambda x, y: sum(w * read(across, x, y + i - 6) for i, w in enumerate(weights)) / sum(weights)
        )
        spread = each(half, lambda x, y: read(spread, x * size[1] / half[1], y * size[0] / half[0]))
    far_half = each(half, lambda x, y: read(far, x * size[1] / half[1], y * size[0] / half[0]))
    near_circle, source, reach = spread, color, params.largest_px
    if other:
        near_circle = np.where(spread > 0, np.maximum(spread, far_half), 0.0)
        source = color * np.minimum(far * reach, 1.0)[..., None]
    mean_of, most_of = table()
    near_rgb = most(disc(color, near_circle, mean_of, reach), near_circle, most_of, reach, size)
    far_rgb = most(disc(source, far_half, mean_of, reach), far_half, most_of, reach, size)

    def laid(x, y):
        u, v = x * half[1] / size[1], y * half[0] / size[0]
        here, behind, before = color[int(y), int(x)], read(far_rgb, u, v), read(near_rgb, u, v)
        if other:
            f, n = min(far[int(y), int(x)] * reach, 1.0), min(read(spread, u, v) * reach, 1.0)
            return ((1 - f) * here + behind) * (1 - n) + n * before
        f, n = 2 * min(read(far_half, u, v), 0.5), 2 * min(read(near_circle, u, v), 0.5)
        return ((1 - f) * here + f * behind) * (1 - n) + n * before

    return each(size, laid)
