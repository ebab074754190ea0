"""Naive twins of multiview synthesis: layers fragment by fragment, and rays against every texel of every layer."""

import math

import numpy as np


def fragments(corners, right, up):
    """(N, H, W) depth of N triangles (N, 3, 3) in camera space through pixel centres; inf where not covered."""
    depth = np.full((len(corners), *right.shape), np.inf)
    for n, (a, b, c) in enumerate(corners):
        normal = np.cross(b - a, c - a)
        for y, x in np.ndindex(right.shape):
            ray = np.array([right[y, x], up[y, x], -1.0])
            sides = [np.dot(ray, np.cross(p, q)) for p, q in ((a, b), (b, c), (c, a))]
            if min(sides) > 0 or max(sides) < 0:
                d = np.dot(normal, a) / np.dot(normal, ray)
                if d > 0:
                    depth[n, y, x] = d
    return depth


def layers_of(depth, farthest, coc_of, bounds, overlap):
    """Both passes: {layer: (H, W) list of lists of (depth, triangle)} reduced to the nearest; missing where empty.

    depth (N, H, W) of N triangles, farthest (N,) their farthest vertices, bounds (L + 1,) in circles of confusion,
    overlap [px].
    """

    def number(coc):
        return max(k for k in range(len(bounds) - 1) if k == 0 or bounds[k] <= coc)

    found = {}
    for y, x in np.ndindex(depth.shape[1:]):
        first = {}
        for n in range(len(depth)):
            if math.isfinite(depth[n, y, x]):
                layer = number(coc_of(farthest[n]))
                first[layer] = min(first.get(layer, (math.inf, -1)), (depth[n, y, x], n))
        for fragment in first.values():
            coc = coc_of(fragment[0])
            for layer in range(len(bounds) - 1):
                near = bounds[layer + 1] + overlap > coc >= bounds[layer] - overlap
                if near or layer == number(coc):
                    key = (layer, y, x)
                    found[key] = min(found.get(key, (math.inf, -1)), fragment)
    return found


def ray_hit(coc, near, far, px, py, vx, vy, wall, discard):
    """(layer, row, column, c) of the first texel that a ray meets, out of all texels of all layers, front to back.

    Layer -1: none; -2: the ray leaves the image first. Without `discard` texels at the border are endless.
    """
    height, width = coc.shape[1:]
    row, column = np.mgrid[:height, :width].astype(np.float64)
    for k in range(len(coc)):
        a, b = float(near[k]), float(far[k])
        ends = [(px - c * vx, py + c * vy) for c in (a, b)]
        if discard and any(not (0 <= x < width and 0 <= y < height) for x, y in ends):
            return -2, -1, -1, math.inf
        # The part of the ray inside each column of texels and each row of texels.
        enter_x, leave_x = _inside(column, width, px, -vx, not discard)
        enter_y, leave_y = _inside(row, height, py, vy, not discard)
        enter, leave = np.maximum(np.maximum(enter_x, enter_y), a), np.minimum(np.minimum(leave_x, leave_y), b)
        top = coc[k].astype(np.float64)
        met = (enter <= leave) & (top <= leave) & (top >= enter - wall)
        if met.any():
            at = np.where(met, np.maximum(top, enter), np.inf)
            # Of columns that meet in one edge of the ray's path, the one that is entered first.
            order = np.lexsort([enter.ravel(), at.ravel()])
            y, x = divmod(int(order[0]), width)
            return k, y, x, at[y, x]
    return -1, -1, -1, math.inf


def _inside(index, count, start, slope, endless):
    """Range of c in which start + slope c lies in index .. index + 1; the first and last index may be endless."""
    low = np.where(endless & (index == 0), -np.inf, index)
    high = np.where(endless & (index == count - 1), np.inf, index + 1)
    if slope == 0:
        inside = (low <= start) & (start < high)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    a, b = (low - start) / slope, (high - start) / slope
    return np.minimum(a, b), np.maximum(a, b)


def mean_over_lens(coc, near, far, color, background, points, wall, discard):
    """(H, W, 3): colours (K, H, W, 3) of the hits of every pixel, points (N, 2) for all, of equal weight.

    Pixels that lose every ray are NaN.
    """
    out = np.full((*coc.shape[1:], 3), np.nan)
    for y, x in np.ndindex(coc.shape[1:]):
        seen = []
        for vx, vy in points:
            k, j, i, _ = ray_hit(coc, near, far, x + 0.5, y + 0.5, float(vx), float(vy), wall, discard)
            if k != -2:
                seen.append(background if k == -1 else color[k, j, i])
        if seen:
            out[y, x] = np.mean(seen, axis=0)
    return out
