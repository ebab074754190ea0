"""Naive twin of mipmap interpolation: the equations of Lee, Kim and Choi (2009), pixel by pixel, tap by tap.

It shares no code with the package. Reads are counted as they happen.
"""

import math

import numpy as np

G = {0: 1.0, 1: math.exp(-0.5), 2: math.exp(-1.0)}  # by squared distance


class Reads:
    """How many texture reads were made."""

    def __init__(self):
        self.count = 0

    def read(self, image, x, y):
        """Bilinear, along x first; texel (i, j) is centred on (i + 1/2, j + 1/2); the edge repeats."""
        self.count += 1
        return self._at(image, x, y)

    def read_between(self, levels, lod, x, y, geometric=False):
        """Trilinear: x, y in [0, 1] of the picture."""
        self.count += 1
        fine = math.floor(lod)
        share = lod - fine
        first = self._at(levels[fine], x * levels[fine].shape[1], y * levels[fine].shape[0])
        if share == 0:
            return first
        coarse = levels[fine + 1]
        second = self._at(coarse, x * coarse.shape[1], y * coarse.shape[0])
        return first ** (1 - share) * second**share if geometric else (1 - share) * first + share * second

    def _at(self, image, x, y):
        height, width = image.shape[:2]
        i, j = math.floor(x - 0.5), math.floor(y - 0.5)
        a, b = x - 0.5 - i, y - 0.5 - j

        def texel(column, row):
            return image[min(max(row, 0), height - 1), min(max(column, 0), width - 1)]

        above = (1 - a) * texel(i, j) + a * texel(i + 1, j)
        return (1 - b) * above + b * ((1 - a) * texel(i, j + 1) + a * texel(i + 1, j + 1))


def level_of(sigma):
    """Equation (6)."""
    return 0.0 if 2 / 3 * sigma < 0.5 else 1 + math.log2(2 / 3 * sigma)


def mipmap(color, coc, delta=0.5, foreground_points=5, geometric=False, store=lambda circles: circles):
    """The picture, and the stages: neighbours, smoothed, level, colour levels, reads."""
    reads = Reads()
    height, width = coc.shape
    color, sigma = color.astype(float), np.abs(coc).astype(float)
    whole = math.floor(math.log2(max(width, height)))
    largest = 0 if 2 / 3 * sigma.max() <= 0.5 else min(math.ceil(level_of(sigma.max())), whole)
    colors, circles = [color], [store(np.stack([coc.astype(float), sigma], axis=-1))]
    nearer = np.zeros((1, 1))
    for level in range(1, largest + 1):
        above, fine_color = circles[-1], colors[-1]
        rows, columns = max(1, height >> level), max(1, width >> level)
        next_circles, next_color = np.zeros((rows, columns, 2)), np.zeros((rows, columns, 3))
        nearer = np.zeros((rows, columns))
        for y, x in np.ndindex(rows, columns):
            px, py = (x + 0.5) / columns * above.shape[1], (y + 0.5) / rows * above.shape[0]
            taps = {}
            for i in (1, 0, -1):
                for j in (1, 0, -1):
                    taps[i, j] = reads.read(above, px + i, py + j), reads.read(fine_color, px + i, py + j)
            z_p, sigma_p = taps[0, 0][0]
            weight = {key: G[key[0] ** 2 + key[1] ** 2] for key in taps}
            next_circles[y, x] = sum(weight[k] * taps[k][0] for k in taps) / sum(weight.values())
            for key, ((z_q, sigma_q), _) in taps.items():
                if sigma_p > sigma_q + delta and z_p > 0:
                    weight[key] = 0.0
                if z_q < 0 and z_q < z_p:
                    nearer[y, x] = max(nearer[y, x], sigma_q)
            next_color[y, x] = sum(weight[k] * taps[k][1] for k in taps) / sum(weight.values())
        circles.append(store(next_circles))
        colors.append(next_color)
    if largest == 0:
        foreground_points = 0
    nearer = store(nearer)
    stages = {"neighbours": np.zeros((height, width)), "smoothed": sigma.copy(), "level": np.zeros((height, width))}
    out = np.zeros((height, width, 3))
    five = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]
    nine = [*five, (1, 1), (-1, 1), (1, -1), (-1, -1)]
    for y, x in np.ndindex(height, width):
        u, v = (x + 0.5) / width, (y + 0.5) / height
        degree = circles[0][y, x, 1]
        if foreground_points:
            points = five if foreground_points == 5 else nine
            rho = total = 0.0
            for i, j in points:
                inward = math.sqrt(0.5) if i and j else 1.0
                step = 2.0**largest * inward
                place = (x + 0.5 + i * step) / width * nearer.shape[1], (y + 0.5 + j * step) / height * nearer.shape[0]
                rho += G[i * i + j * j] * reads.read(nearer, *place)
                total += G[i * i + j * j]
            rho /= total
            stages["neighbours"][y, x] = rho
            n = min(level_of(rho), largest)
            degree = reads.read_between([c[..., 1] for c in circles], n, u, v)
        m = level_of(degree)
        stages["smoothed"][y, x], stages["level"][y, x] = degree, m
        lod = min(max(m - 1, 0.0), largest)
        radius = 2.0**lod * min(m, 1.0)
        total = 0.0
        for i, j in nine:
            inward = math.sqrt(0.5) if i and j else 1.0
            place = (x + 0.5 + i * radius * inward) / width, (y + 0.5 + j * radius * inward) / height
            weight = G[i * i + j * j]
            out[y, x] += weight * reads.read_between(colors, lod, *place, geometric)
            total += weight
        out[y, x] /= total
    stages["colors"], stages["reads"] = colors[1:], reads.count
    return out, stages
