"""The listing as a graphics processor runs it: texture coordinates, angles and sums in float32, all pixels at once."""

import numpy as np

ONE = np.float32(1)


def listing(color, depth, coc, divided=False, faults=(), rows=slice(None)):
    """Gustafsson's loop in float32, with depth at the nearest texel, in some rows: (R, W, 3).

    `divided`: texture coordinates are (x + 0.5) / width, not times 1 / width. Faults are pairs of a tap, counted from
    0, and "skip", "twice" or a shift (dx, dy) [px].
    """
    height, width = depth.shape
    pixel = np.array([1.0 / width, 1.0 / height], dtype=np.float32)
    size = np.array([width, height], dtype=np.float32)
    y, x = (index.astype(np.float32) + np.float32(0.5) for index in np.indices(depth.shape)[:, rows])
    place = [x / size[0], y / size[1]] if divided else [x * pixel[0], y * pixel[1]]
    largest, what = np.float32(20), dict(faults)

    def clamped(index, count):
        return np.clip(index, 0, count - 1).astype(int)

    def bilinear(u, v):
        u, v = u * size[0] - np.float32(0.5), v * size[1] - np.float32(0.5)
        i, j = np.floor(u), np.floor(v)
        right, down = (u - i)[..., None], (v - j)[..., None]
        i0, i1, j0, j1 = clamped(i, width), clamped(i + 1, width), clamped(j, height), clamped(j + 1, height)
        above = color[j0, i0] * (ONE - right) + color[j0, i1] * right
        below = color[j1, i0] * (ONE - right) + color[j1, i1] * right
        return above * (ONE - down) + below * down

    center_depth, center_size = depth[rows], np.minimum(np.abs(coc[rows]), largest)
    total_color, total = color[rows].copy(), ONE
    radius, angle, k = np.float32(0.5), np.float32(0), 0
    while radius < largest:
        fault = what.get(k)
        dx, dy = fault if isinstance(fault, tuple) else (0, 0)
        u = place[0] + np.cos(angle) * pixel[0] * radius + np.float32(dx) * pixel[0]
        v = place[1] + np.sin(angle) * pixel[1] * radius + np.float32(dy) * pixel[1]
        at = clamped(np.floor(v * size[1]), height), clamped(np.floor(u * size[0]), width)
        behind = depth[at] > center_depth
        own = np.minimum(np.abs(coc[at]), largest)
        own = np.where(behind, np.minimum(own, center_size * np.float32(2)), own)
        t = np.clip((own - (radius - np.float32(0.5))), np.float32(0), ONE)
        m = (t * t * (np.float32(3) - np.float32(2) * t))[..., None]
        for _ in range({"skip": 0, "twice": 2}.get(fault, 1)):
            total_color = total_color + total_color / total * (ONE - m) + bilinear(u, v) * m
            total = total + ONE
        angle += np.float32(2.39996323)
        radius += np.float32(0.5) / radius
        k += 1
    assert total_color.dtype == np.float32
    return total_color / total
