"""Naive twins of multiview synthesis: layers fragment by fragment, and rays against every texel of every layer."""

import itertools
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
    """(layer, row, column, c) of what a ray meets first, layer by layer, over all texels that it crosses.

    Layer -1: nothing; -2: the ray leaves the image first. Texels at the border are endless.
    """
    for k in range(len(coc)):
        a, b = float(near[k]), float(far[k])
        end = b + wall if math.isfinite(wall) else b
        leaves = any(not _in_picture(coc, px - c * vx, py + c * vy) for c in (a, b))
        if discard and leaves and _holds_something(coc[k], int(px), int(py), max(abs(a), abs(end))):
            return -2, -1, -1, math.inf
        seen = before = None
        for y, x, enter, leave in _crossed(coc, a, end, px, py, vx, vy):
            top = float(coc[k, y, x])
            if top >= enter:  # the ray is in front of the texel when it comes in
                if top <= leave:
                    return k, y, x, top
                seen = (y, x, top)
            else:
                surfaces = coc[k:, before[0], before[1]].astype(np.float64)
                if ((enter <= surfaces) & (surfaces <= top + wall)).any():
                    return k, y, x, enter
                if seen[2] <= leave:  # behind an edge, the surface seen last goes on
                    return k, *seen
            before = (y, x)
    return -1, -1, -1, math.inf


def _in_picture(coc, x, y):
    return 0 <= x < coc.shape[2] and 0 <= y < coc.shape[1]


def _holds_something(layer, x, y, widest):
    """Whether blocks of 4 x 4 px that a ray of pixel (x, y) may come near hold anything."""
    reach = min(math.ceil(widest), max(layer.shape)) + 1
    low_x, low_y = max(x - reach, 0) // 4 * 4, max(y - reach, 0) // 4 * 4
    high_x, high_y = (x + reach) // 4 * 4 + 4, (y + reach) // 4 * 4 + 4
    return np.isfinite(layer[low_y:high_y, low_x:high_x]).any()


def _crossed(coc, a, end, px, py, vx, vy):
    """(row, column, enter, leave) of the texels under a ray, cut where it crosses a line between texels."""
    height, width = coc.shape[1:]
    cuts = [(px - x) / vx for x in range(1, width) if vx] + [(y - py) / vy for y in range(1, height) if vy]
    cuts = [a, *sorted(c for c in cuts if a < c < end), end]
    for enter, leave in itertools.pairwise(cuts):
        middle = (enter + leave) / 2
        x, y = math.floor(px - middle * vx), math.floor(py + middle * vy)
        yield min(max(y, 0), height - 1), min(max(x, 0), width - 1), enter, leave


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
