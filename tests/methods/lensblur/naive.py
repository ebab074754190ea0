"""Lens blur without any short cut: every ray against every texel of every layer, from the paper's definitions.

Written in float64 from the geometry: a texel is the column over a pixel's square, and a ray's stay in it is the overlap
of its stays between two vertical and two horizontal lines. No walk, no packs, no bounds.
"""

import numpy as np


def trace(parallax, color, background, pinhole, focus, lens, weights, extension=0.0, complete=True, shift=(0, 0, 0)):
    """The nearest hit of every ray.

    parallax (N, H, W), -inf where empty; color (N, H, W, 3); lens (H, W, R, 2), x right, y up; weights (H, W, R). shift
    moves all rays by (x, y) px and all samples by u, to find decisions on a knife's edge.

    Returns
    -------
    image (H, W, 3), missed rays left out; hit (H, W, R): texel index, -1 for the background, -2 for a miss.
    """
    _, height, width = parallax.shape
    image = np.zeros((height, width, 3))
    hit = np.zeros(lens.shape[:3], dtype=np.int64)
    palette = np.concatenate([color.reshape(-1, 3), np.zeros((1, 3)), [background]])  # [-2]: misses, [-1]: background
    for y in range(height):
        for x in range(width):
            for r, (right, up) in enumerate(lens[y, x]):
                hit[y, x, r] = _ray(
                    parallax + shift[2],
                    x + 0.5 + shift[0] - focus * right,
                    y + 0.5 + shift[1] + focus * up,
                    right,
                    -up,
                    extension,
                    complete,
                )
            w = weights[y, x] * (hit[y, x] != -2)
            image[y, x] = pinhole[y, x] if w.sum() == 0.0 else w @ palette[hit[y, x]] / w.sum()
    return image, hit


def _ray(parallax, ax, ay, wx, wy, extension, complete):
    """What the ray (ax + u wx, ay + u wy) meets, from u = inf down to 0."""
    _, height, width = parallax.shape
    low_x, high_x = stay(ax, wx, np.arange(width), np.arange(width) + 1.0)
    low_y, high_y = stay(ay, wy, np.arange(height), np.arange(height) + 1.0)
    low = np.maximum(np.maximum(low_y[:, None], low_x[None, :]), 0.0)
    high = np.minimum(high_y[:, None], high_x[None, :])

    # Does it come into the picture from outside, below the surface at the border?
    enter = min(high_x.max(), high_y.max())
    leave = max(low_x.min(), low_y.min(), 0.0)
    if enter < leave:
        return -2
    if np.isfinite(enter):
        at = (high >= enter) & (low <= enter)
        if (parallax[0][at] > enter).all():
            return -2

    # A sample is met where its depth lies in the ray's stay in its texel.
    met = np.where((low <= high) & (parallax >= low) & (parallax <= high), parallax, -1.0)
    # Or at the side, if the texel that the ray comes from has a sample at most `extension` below it, not yet passed.
    sideways = high_x[None, :] < high_y[:, None]
    for k, y, x in zip(*np.nonzero((low <= high) & (parallax > high)), strict=True):
        before = (y, x + int(np.sign(wx))) if sideways[y, x] else (y + int(np.sign(wy)), x)
        if 0 <= before[0] < height and 0 <= before[1] < width:
            column = parallax[:, before[0], before[1]]
            if ((column <= high[y, x]) & (column >= parallax[k, y, x] - extension)).any():
                met[k, y, x] = high[y, x]
    if met.max(initial=-1.0) >= 0.0:
        return int(np.argmax(met))
    if not (0.0 <= ax < width and 0.0 <= ay < height):
        return -2
    full = parallax[-1, int(ay), int(ax)] > 0.0
    return -2 if full and not complete else -1


def stay(a, w, first, last):
    """The u between which a + u w lies in first .. last, elementwise; empty as (inf, -inf)."""
    if w == 0.0:
        inside = (a >= first) & (a < last)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    one, other = (first - a) / w, (last - a) / w
    return np.minimum(one, other), np.maximum(one, other)
