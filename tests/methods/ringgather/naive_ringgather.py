"""The naive twin of `ringgather`: one tap after the other in plain Python. It shares no code with the method."""

import math

import numpy as np

from tests.methods.naive_reads import read

TILE = 32


def clip(x):
    return min(max(x, 0.0), 1.0)


def table(fill):
    """{ring: [(x, y), ...]}."""
    found = {}
    for j in (1, 2, 3):
        turn = 2 * math.pi / (8 * j)
        radius = j / 3 if fill else j / 4
        start = 0.5 if j % 2 else 0.0
        found[j] = [
            (radius * math.cos((k + start) * turn), radius * math.sin((k + start) * turn)) for k in range(8 * j)
        ]
    return found


def texel(plane, x, y):
    height, width = plane.shape
    return plane[min(max(math.floor(y), 0), height - 1), min(max(math.floor(x), 0), width - 1)]


def naive_blur(color, depth, coc, params):
    height, width = coc.shape
    h, w = (height + 1) // 2, (width + 1) // 2
    depth = np.minimum(depth, 1e30)
    circle = np.minimum(abs(coc), params.largest_px) / 2
    if params.working == "tonemapped":
        working = color / (1 + color.max(axis=2))[..., None]
    else:
        working = color
    taps = table(params.fill)

    def around(x, y):
        """Nearest depth, greatest and least circle of the tile of a pixel and of those around it."""
        j, i = y // TILE, x // TILE
        part = np.s_[max(0, (j - 1) * TILE) : (j + 2) * TILE, max(0, (i - 1) * TILE) : (i + 2) * TILE]
        return depth[part].min(), circle[part].max(), circle[part].min()

    places = {
        (x, y): ((2 * x + 1) * width // (2 * w), (2 * y + 1) * height // (2 * h)) for y in range(h) for x in range(w)
    }
    c, z = np.empty((h, w)), np.empty((h, w))
    for (x, y), (i, j) in places.items():
        c[y, x], z[y, x] = circle[j, i], depth[j, i]
    light, behind = np.empty((h, w)), np.empty((h, w))
    filtered = np.empty((h, w, 3))
    for x, y in places:
        area = max(math.pi * c[y, x] ** 2, math.pi * 0.7071**2)
        t = clip((z[y, x] - around(2 * x, 2 * y)[0]) / params.foreground)
        light[y, x], behind[y, x] = 1 / area, 3 * t**2 - 2 * t**3
        scale = width / w, height / h
        centre = read(working, (x + 0.5) * scale[0], (y + 0.5) * scale[1])
        total = centre
        for p, q in taps[1]:
            u, v = (x + 0.5 + c[y, x] / 2 * p) * scale[0], (y + 0.5 + c[y, x] / 2 * q) * scale[1]
            apart = clip(2 * abs(texel(depth, u, v) - z[y, x]))
            total = total + (1 - apart) * read(working, u, v) + apart * centre
        filtered[y, x] = total / 9

    summed = np.empty((h, w, 4))
    for x, y in places:
        _, most, least = around(2 * x, 2 * y)
        if most < 1:
            summed[y, x] = *filtered[y, x], 1.0
            continue
        used = min(max(math.ceil(3 * math.sqrt(most)), 1), 3)
        reach = used / 3 * most
        spots = [(j, x + 0.5 + reach * p, y + 0.5 + reach * q) for j in range(1, used + 1) for p, q in taps[j]]
        if most - least < 1:
            mean = (filtered[y, x] + sum(read(filtered, u, v) for _, u, v in spots)) / (2 * used + 1) ** 2
            summed[y, x] = *mean, 0.0
            continue
        far, near, total = 0.0, 0.0, [0.0, 0.0]
        for j, u, v in [(0, x + 0.5, y + 0.5), *spots]:
            cover = 1.0 if j == 0 else clip(texel(c, u, v) * used / most - j + 1)
            cover = cover**2 if j == 1 else cover
            weight, share = texel(light, u, v) * cover, texel(behind, u, v)
            seen = read(filtered, u, v)
            far, near = far + weight * share * seen, near + weight * (1 - share) * seen
            total = [total[0] + weight * share, total[1] + weight * (1 - share)]
        alpha = clip(params.gain * total[1] / (2 * used + 1) ** 2 * max(math.pi * most**2, math.pi * 0.7071**2))
        mixed = (1 - alpha) * far / max(1e-5, total[0]) + alpha * near / max(1e-5, total[1])
        summed[y, x] = *mixed, alpha

    smooth = np.empty_like(summed)
    for x, y in places:
        rows, columns = ([min(max(at + k, 0), n - 1) for k in (-1, 0, 1)] for at, n in ((y, h), (x, w)))
        smooth[y, x] = np.median(summed[np.ix_(rows, columns)].reshape(9, 4), axis=0)
    if params.working == "tonemapped":
        smooth[..., :3] /= np.maximum(1 - smooth[..., :3].max(axis=2), 1e-6)[..., None]

    out = np.empty_like(color)
    for y, x in np.ndindex(height, width):
        nearest, most, _ = around(x, y)
        soft = read(smooth, (x + 0.5) * w / width, (y + 0.5) * h / height)
        own = circle[y, x]
        near = clip(1 - (depth[y, x] - nearest))
        reach = (1 - near) * most + near * own
        share = clip((1 - soft[3]) * own + soft[3] * reach)
        out[y, x] = (1 - share) * color[y, x] + share * soft[:3]
    return out
