"""Texel walk: the first surface that a ray meets in packed layers, texel by texel.

A ray's place in the picture is affine in inverse depth. Inverse depth is counted in pixels of parallax, u = P E / depth:
what two points of the lens, one radius apart, see u pixels apart. A ray is then

    x(u) = ax + u wx,  y(u) = ay + u wy,

from u = near down to u = far. For a thin lens (wx, wy) is its lens point and all rays of a pixel meet at u = P E / focus;
nothing here needs that, or that rays share a centre.

1. layers are packed four by four                                  `pack_layers`
2. a ray that starts outside the picture is cut at its border      `enter_picture`
3. it goes from texel to texel [2], four layers at once            `first_hit`
4. the colour of what it meets is read                             `look_up`

A sample stands for its pixel's whole square and, below it, for the column of `thickness` [px of parallax] from which
peeling drops what the sample hides: a ray that comes into the column from the side meets the sample, too. On its way
there it passed the sample's depth outside the pixel, but not further out than `thickness` times |w| pixels: this is
the silhouette extended towards the neighbours. A ray that leaves a column above the sample never needs the extension.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
.. [2] Amanatides & Woo (1987), A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics.
"""

import math

import numpy as np

from refdof._check import Float
from refdof._jit import inline

__all__ = ["PACK", "enter_picture", "first_hit", "look_up", "pack_layers"]

PACK = 4  # [1]: four depths are one RGBA texel
_SAME_SURFACE = 0.5  # px of parallax between neighbouring texels of one surface


def pack_layers(parallax: Float) -> Float:
    """Pack layers (N, H, W), front to back, four by four: (ceil(N / 4), H, W, 4); -inf is empty."""
    count, height, width = parallax.shape
    groups = max(-(-count // PACK), 1)
    packed = np.full((groups * PACK, height, width), -np.inf, dtype=parallax.dtype)
    packed[:count] = parallax
    return np.ascontiguousarray(packed.reshape(groups, PACK, height, width).transpose(0, 2, 3, 1))


@inline
def enter_picture(width, height, ax, ay, wx, wy):
    """The parallax at which a ray comes into the picture: inf if it starts there, -inf if it never does."""
    own = type(ax)
    near = own(np.inf)
    far = own(0.0)
    near, far = _cut(own(width), ax, wx, near, far)
    near, far = _cut(own(height), ay, wy, near, far)
    return near if near >= far else own(-np.inf)


@inline
def _cut(size, a, w, near, far):
    """Cut [far, near] where a + u w is inside 0 .. size."""
    if w == 0.0:
        return (near, far) if 0.0 <= a < size else (-near, far)
    low, high = -a / w, (size - a) / w
    return min(near, max(low, high)), max(far, min(low, high))


@inline
def first_hit(pack, ax, ay, wx, wy, near, far, thickness):
    """The first sample of one pack that a ray meets: slot (-1: none), x, y, u, and the texels walked.

    pack (H, W, 4). The ray is inside the picture at u = near. `far` may cut the walk short: what lies below is not
    looked for.
    """
    own = type(ax)
    height, width = pack.shape[0], pack.shape[1]
    x, step_x, inverse_x = _start(ax, wx, near, width)
    y, step_y, inverse_y = _start(ay, wy, near, height)
    ahead_x, ahead_y = own(0.5) * own(1 + step_x), own(0.5) * own(1 + step_y)  # from the texel's corner to its exit
    enter, steps = near, 0
    while True:
        steps += 1
        leave_x = (own(x) + ahead_x - ax) * inverse_x if step_x != 0 else -own(np.inf)
        leave_y = (own(y) + ahead_y - ay) * inverse_y if step_y != 0 else -own(np.inf)
        leave = max(leave_x, leave_y, far)
        # The four layers are ordered: the first column that the ray's interval touches is the nearest.
        for k in range(PACK):
            u = pack[y, x, k]
            if u < leave:
                break
            if u - thickness < enter or u <= enter:
                return k, x, y, min(u, enter), steps
        if leave <= far:
            break
        if leave_x > leave_y:
            x += step_x
        else:
            y += step_y
        if x < 0 or y < 0 or x >= width or y >= height:
            break
        enter = leave
    return -1, x, y, far, steps


@inline
def _start(a, w, near, size):
    """Texel along one axis at u = near, the step to the next one, and 1 / w.

    The texel agrees with the crossings that the walk computes, so that a walk begun later passes the same texels.
    """
    own = type(a)
    at = min(max(int(math.floor(a + near * w)), 0), size - 1)
    if abs(w) < own(1e-20):
        return at, 0, own(0.0)
    inverse = own(1.0) / w
    step = -1 if w > 0.0 else 1  # u falls along the ray
    entry, ahead = own(0.5) * own(1 - step), own(0.5) * own(1 + step)
    while 0 <= at - step < size and (own(at) + entry - a) * inverse < near:
        at -= step
    while 0 <= at + step < size and (own(at) + ahead - a) * inverse >= near:
        at += step
    return at, step, inverse


@inline
def look_up(packs, values, group, slot, x, y, right, down, linear, out):
    """Read the sample's values into out (C,), as they are or bilinearly.

    packs (G, H, W, 4), values (N, H, W, C). (right, down) is the hit's place from the texel's centre [px]. Bilinear
    means among neighbours of the same surface; where it has none, the sample stands in.
    """
    layer = group * PACK + slot
    if not linear:
        for c in range(len(out)):
            out[c] = values[layer, y, x, c]
        return
    own = values.dtype.type
    half, one = own(0.5), own(1.0)
    fx, fy = min(abs(own(right)), half), min(abs(own(down)), half)
    side_x = min(max(x + (1 if right > 0.0 else -1), 0), values.shape[2] - 1)
    side_y = min(max(y + (1 if down > 0.0 else -1), 0), values.shape[1] - 1)
    u = packs[group, y, x, slot]
    across = _same_surface(packs, u, side_x, y)
    along = _same_surface(packs, u, x, side_y)
    corner = _same_surface(packs, u, side_x, side_y)
    ax = side_x if across >= 0 else x
    ay = side_y if along >= 0 else y
    cx, cy = (side_x, side_y) if corner >= 0 else (x, y)
    across = across if across >= 0 else layer
    along = along if along >= 0 else layer
    corner = corner if corner >= 0 else layer
    for c in range(len(out)):
        upper = values[layer, y, x, c] * (one - fx) + values[across, y, ax, c] * fx
        lower = values[along, ay, x, c] * (one - fx) + values[corner, cy, cx, c] * fx
        out[c] = upper * (one - fy) + lower * fy


@inline
def _same_surface(packs, u, x, y):
    """The layer of texel (x, y) that goes on from a sample at u; -1: none."""
    own = type(u)
    for group in range(packs.shape[0]):
        for k in range(PACK):
            other = packs[group, y, x, k]
            if other < u - own(_SAME_SURFACE):
                return -1
            if other <= u + own(_SAME_SURFACE):
                return group * PACK + k
    return -1
