"""The naive twin of `filament`: one tap after the other in plain Python. It shares no code with the method."""

import math

import numpy as np

from tests.methods.naive_reads import read


def clip(x):
    return min(max(x, 0.0), 1.0)


def gradient_noise(x, y):
    inner = math.modf(0.06711056 * x + 0.00583715 * y)[0]
    return math.modf(52.9829189 * inner)[0]


def filled(image, side=16):
    height, width = image.shape[:2]
    rows = [min(j, height - 1) for j in range(math.ceil(height / side) * side)]
    columns = [min(i, width - 1) for i in range(math.ceil(width / side) * side)]
    return image[np.ix_(rows, columns)]


def levels_of(color, coc, largest):
    """[(colour, circle), ...] from half the size on."""
    color, coc = filled(color), filled(coc)
    height, width = coc.shape[0] // 2, coc.shape[1] // 2
    half, circle = np.empty((height, width, 3)), np.empty((height, width))
    for y, x in np.ndindex(height, width):
        part = np.s_[2 * y : 2 * y + 2, 2 * x : 2 * x + 2]
        four = color[part].reshape(4, 3)
        weights = [1 / (1 + max(texel)) for texel in four]
        half[y, x] = sum(w * texel for w, texel in zip(weights, four, strict=True)) / sum(weights)
        nearest = min(max(coc[part].min(), -largest), largest)
        circle[y, x] = nearest if abs(nearest) >= 1 else 0.0
    found = [(half, circle)]
    for _ in range(3):
        half, circle = found[-1]
        size = half.shape[0] // 2, half.shape[1] // 2
        coarse, least = np.empty((*size, 3)), np.empty(size)
        for y, x in np.ndindex(size):
            part = np.s_[2 * y : 2 * y + 2, 2 * x : 2 * x + 2]
            coarse[y, x], least[y, x] = half[part].mean(axis=(0, 1)), circle[part].min()
        found.append((coarse, least))
    return found


class Kernel:
    """Taps of one pixel: rings of places, distances and the level that they are read from."""

    def __init__(self, levels, x, y, circle, rings):
        self.n, self.circle = rings, circle
        self.step = circle / (rings - 0.5)
        self.level = max(0, math.floor(math.log2(self.step / 2) + 0.5)) if self.step > 0 else 0
        assert self.level <= 3
        self.image, self.circles = levels[self.level]
        angle = 2 * math.pi * gradient_noise(x + 0.5, y + 0.5)
        far = 0.5 * math.sqrt(gradient_noise(5099 * (x + 0.5), 3499 * (y + 0.5)))
        self.noise = complex(math.cos(angle), math.sin(angle)) * self.step * far
        self.middle = complex(x + 0.5, y + 0.5) + self.noise / 2

    def ring(self, i):
        """Offsets in pixels of the picture."""
        if i == 0:
            return [0j]
        start = 0.5 if i % 2 else 0.0
        turns = [(k + start) / (8 * i) for k in range(8 * i)]
        return [i * self.step * complex(math.cos(2 * math.pi * t), math.sin(2 * math.pi * t)) for t in turns]

    def distance(self, i):
        return abs(self.ring(i)[0] + self.noise)

    def at(self, offset):
        """Colour and circle at the nearest texel."""
        place = (self.middle + offset / 2) / 2**self.level
        height, width = self.circles.shape
        texel = min(max(math.floor(place.imag), 0), height - 1), min(max(math.floor(place.real), 0), width - 1)
        return self.image[texel], self.circles[texel]

    def blended(self, offset):
        place = (self.middle + offset / 2) / 2**self.level
        return read(self.image, place.real, place.imag)

    def weight(self, c):
        return 32.0**2 / max(c * c, 2 * 2**self.level)

    def within(self, distance, c):
        return clip((c - distance) / 2**self.level + 0.5)

    def full(self):
        return self.weight(self.circle * (self.n + 0.5) / self.n)


def rings_of(circle, most):
    return min(most, math.ceil(circle / 2 + 0.5))


def background(levels, x, y, high, most):
    own = abs(levels[0][1][y, x])
    if own <= 1:
        return np.zeros(3), 0.0
    kernel = Kernel(levels, x, y, own, rings_of(high, most))
    past = np.zeros(5)
    for i in reversed(range(kernel.n)):
        border, outermost = kernel.step * (i + 0.5), i == kernel.n - 1
        current, miss, ring = np.zeros(5), 0.0, kernel.ring(i)
        for offset in ring:
            color, c = kernel.at(offset)
            if c > 0:
                w = kernel.within(kernel.distance(i), c) * kernel.weight(c)
                q = 1.0 if outermost else clip(c - border + 0.5)
                tap = np.array([*color, c, 1.0])
                past, current, miss = past + w * q * tap, current + w * (1 - q) * tap, miss + q
        if current[4] > 0:
            if past[4] > 0:
                past = past * (1 - (1 - miss / len(ring)) * clip(past[3] / past[4] - current[3] / current[4]))
            past = past + current
    t = clip(own - 1)
    alpha = clip(past[4] / kernel.full()) * t * t * (3 - 2 * t)
    return (alpha * past[:3] / past[4], alpha) if past[4] > 0 else (np.zeros(3), 0.0)


def foreground(levels, x, y, low, most, behind):
    kernel = Kernel(levels, x, y, -low, rings_of(-low, most))
    back, front = np.zeros(4), np.zeros(4)
    for i in range(kernel.n):
        ring = kernel.ring(i)
        pairs = [(offset, -offset) for offset in ring[: 4 * i]] if i else [(0j, None)]
        for pair in pairs:
            taps = [kernel.at(offset) for offset in pair if offset is not None]
            c = min(circle for _, circle in taps)
            if c < 0:
                w = clip(-c) * kernel.within(kernel.distance(i), -c) * kernel.weight(c)
                t = clip((c - low - 2) / 2)
                for color, _ in taps:
                    back, front = back + w * t * np.array([*color, 1]), front + w * (1 - t) * np.array([*color, 1])
    count = (2 * kernel.n - 1) ** 2
    back_alpha, front_alpha = (clip(layer[3] / (kernel.full() * count)) for layer in (back, front))
    alpha = 1 - (1 - front_alpha) * (1 - back_alpha)
    color = np.zeros(3)
    if front[3] > 0:
        color = color + front_alpha * front[:3] / front[3]
    if back[3] > 0:
        color = color + back_alpha * (1 - front_alpha) * back[:3] / back[3]
    if 0 < alpha < 1 and behind[1] == 0:
        more = max(alpha, clip(abs(levels[0][1][y, x]) - 1))
        color, alpha = color * more / alpha, more
    return color + (1 - alpha) * behind[0], alpha + (1 - alpha) * behind[1]


def naive_blur(color, coc, params):
    levels = levels_of(color, coc, params.largest_px)
    circle = levels[0][1]
    height, width = circle.shape
    tiles = {}
    for j, i in np.ndindex(height // 8, width // 8):
        part = circle[max(0, 8 * (j - 2)) : 8 * (j + 3), max(0, 8 * (i - 2)) : 8 * (i + 3)]
        tiles[j, i] = part.min(), part.max()
    gathered = np.zeros((height, width, 4))
    for y, x in np.ndindex(height, width):
        low, high = tiles[y // 8, x // 8]
        if max(abs(low), abs(high)) < 1:
            continue
        if high - low <= 0.05 * abs(high):
            kernel = Kernel(
                levels, x, y, (abs(low) + abs(high)) / 2, rings_of((abs(low) + abs(high)) / 2, params.rings)
            )
            taps = [kernel.blended(offset) for i in range(kernel.n) for offset in kernel.ring(i)]
            alpha = clip(kernel.circle - 1)
            gathered[y, x] = *(alpha * sum(taps) / len(taps)), alpha
            continue
        layer = background(levels, x, y, high, params.rings) if high > 0 else (np.zeros(3), 0.0)
        if low < 0:
            layer = foreground(levels, x, y, low, params.rings, layer)
        gathered[y, x] = *layer[0], layer[1]
    smooth = gathered.copy()
    for y, x in np.ndindex(height, width):
        if max(map(abs, tiles[y // 8, x // 8])) >= 1:
            rows, columns = ([min(max(at + k, 0), n - 1) for k in (-1, 0, 1)] for at, n in ((y, height), (x, width)))
            smooth[y, x] = np.median(gathered[np.ix_(rows, columns)].reshape(9, 4), axis=0)
    out = np.empty(color.shape)
    for y, x in np.ndindex(coc.shape):
        low, high = tiles[y // 16, x // 16]
        soft = read(smooth, (x + 0.5) / 2, (y + 0.5) / 2)
        if max(abs(low), abs(high)) < 1:
            out[y, x] = color[y, x]
        elif high - low <= 0.05 * abs(high) and abs(low) >= 2:
            out[y, x] = soft[:3]
        else:
            out[y, x] = soft[:3] + (1 - soft[3]) * color[y, x]
    return out
