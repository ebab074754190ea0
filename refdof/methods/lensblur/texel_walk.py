"""Texel walk: the first surface that a ray meets in packed layers, texel by texel.

A ray's place in the picture is affine in inverse depth, which is counted in pixels of parallax, u = P E / depth: two
points of the lens, one radius apart, see a point at u in places u pixels apart. A ray is then

    x(u) = ax + u wx,  y(u) = ay + u wy,

from u = near down to u = far. For a thin lens (wx, wy) is its lens point, and all rays of a pixel meet at
u = P E / focus; nothing here needs that, or that rays share a centre.

1. layers are packed four by four                               `pack_layers`
2. a ray that starts outside the picture is cut at its border   `enter_picture`
3. it goes from texel to texel [2], four layers at once         `first_hit`
4. colours are read there, or between texels                    `neighbours`

A ray meets a sample if it passes its depth inside the texel. A ray that comes into the texel from the side, already
behind the sample, meets it on the way in if it comes from above a surface that belongs to the sample's: the texel
before has a sample between the ray and `extension` below the new one. That is where peeling may have dropped a surface
(the extension is the umbra's length), and where a slanted surface crosses from texel to texel: a plane that the whole
lens sees from one side falls by less than one pixel of parallax a pixel. A farther surface is another one, and the ray
sees past the silhouette.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
.. [2] Amanatides & Woo (1987), A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float
from refdof._jit import inline

__all__ = [
    "PACK",
    "SAME_SURFACE",
    "STILL",
    "Hit",
    "Pace",
    "Ray",
    "Stay",
    "enter_picture",
    "first_hit",
    "neighbours",
    "pack_layers",
    "walk_on",
]

PACK = 4  # [1]: four depths are one RGBA texel
STILL = 1e-20  # px per px of parallax: a ray slower than this stays in its texel
SAME_SURFACE = 0.5  # px of parallax between neighbouring texels of one surface


class Ray(NamedTuple):
    """At parallax u the ray is over (ax + u wx, ay + u wy) [px]."""

    ax: float
    ay: float
    wx: float
    wy: float


class Pace(NamedTuple):
    """A ray's steps from texel to texel, -1, 0 or 1, and 1 / w, or 0 where it makes none."""

    step_x: int
    step_y: int
    inverse_x: float
    inverse_y: float


class Stay(NamedTuple):
    """A ray comes into texel (x, y) at parallax `enter`, out of the last one, after some steps."""

    x: int
    y: int
    last_x: int
    last_y: int
    enter: float
    steps: int


class Hit(NamedTuple):
    """The sample of a layer at texel (x, y) that a ray meets at parallax u."""

    layer: int
    x: int
    y: int
    u: float


def pack_layers(parallax: Float) -> Float:
    """Pack layers (N, H, W), front to back, four by four: (ceil(N / 4), H, W, 4); -inf is empty."""
    count, height, width = parallax.shape
    groups = max(-(-count // PACK), 1)
    packed = np.full((groups * PACK, height, width), -np.inf, dtype=parallax.dtype)
    packed[:count] = parallax
    return np.ascontiguousarray(packed.reshape(groups, PACK, height, width).transpose(0, 2, 3, 1))


@inline
def enter_picture(width, height, ray):
    """The parallax at which a ray comes into the picture: inf if it starts there, -inf if it never does."""
    scalar = type(ray.ax)
    near = scalar(np.inf)
    far = scalar(0.0)
    near, far = _cut(scalar(width), ray.ax, ray.wx, near, far)
    near, far = _cut(scalar(height), ray.ay, ray.wy, near, far)
    return near if near >= far else scalar(-np.inf)


@inline
def _cut(size, a, w, near, far):
    """Cut [far, near] where a + u w is inside 0 .. size."""
    if w == 0.0:
        return (near, far) if 0.0 <= a < size else (-near, far)
    low, high = -a / w, (size - a) / w
    return min(near, max(low, high)), max(far, min(low, high))


@inline
def first_hit(packs, group, ray, near, far, extension):
    """The first sample of one pack that a ray meets: slot (-1: none), x, y, u, and the texels walked.

    packs (G, H, W, 4). The ray is inside the picture at u = near. `far` may cut the walk short: what lies below is not
    looked for.
    """
    x, step_x, inverse_x = _start(ray.ax, ray.wx, near, packs.shape[2])
    y, step_y, inverse_y = _start(ray.ay, ray.wy, near, packs.shape[1])
    pace = Pace(step_x, step_y, inverse_x, inverse_y)
    return walk_on(packs, group, ray, pace, Stay(x, y, x, y, near, 0), far, extension)


@inline
def walk_on(packs, group, ray, pace, stay, far, extension):
    """`first_hit` of a ray that has come as far as a `Stay`."""
    scalar, ax, ay = type(ray.ax), ray.ax, ray.ay
    pack = packs[group]
    height, width = pack.shape[0], pack.shape[1]
    step_x, step_y, inverse_x, inverse_y = pace
    x, y, last_x, last_y, enter, steps = stay
    ahead_x, ahead_y = (
        scalar(0.5) * scalar(1 + step_x),
        scalar(0.5) * scalar(1 + step_y),
    )  # from the texel's corner to its exit
    while True:
        steps += 1
        leave_x = (scalar(x) + ahead_x - ax) * inverse_x if step_x != 0 else -scalar(np.inf)
        leave_y = (scalar(y) + ahead_y - ay) * inverse_y if step_y != 0 else -scalar(np.inf)
        exit_u = max(leave_x, leave_y)
        leave = max(exit_u, far)
        # The four layers are ordered: the first that the ray meets is the nearest.
        for k in range(PACK):
            u = pack[y, x, k]
            if u < leave:
                break
            if u <= enter:
                return k, x, y, u, steps
            if steps > 1 and _goes_on(packs, last_x, last_y, u - extension, enter):
                return k, x, y, enter, steps
        if exit_u < far:  # at far itself the ray is in the next texel, too
            break
        last_x, last_y, enter = x, y, leave
        if leave_x > leave_y:
            x += step_x
        else:
            y += step_y
        if x < 0 or y < 0 or x >= width or y >= height:
            break
    return -1, x, y, far, steps


@inline
def _goes_on(packs, x, y, low, high):
    """Whether the texel (x, y) has a sample between low and high: a surface that the ray has not passed yet."""
    for group in range(packs.shape[0]):
        for k in range(PACK):
            u = packs[group, y, x, k]
            if u < low:
                return False
            if u <= high:
                return True
    return False


@inline
def _start(a, w, near, size):
    """Texel along one axis at u = near, the step to the next one, and 1 / w.

    The texel agrees with the crossings that the walk computes, so that a walk begun later passes the same texels.
    On the border of two it is the one that the ray leaves: its samples may be at `near`, too.
    """
    scalar = type(a)
    at = math.floor(min(max(a + near * w, scalar(0.0)), scalar(size - 1)))
    if abs(w) < scalar(STILL):
        return at, 0, scalar(0.0)
    inverse = scalar(1.0) / w
    step = -1 if w > 0.0 else 1  # u falls along the ray
    entry, ahead = scalar(0.5) * scalar(1 - step), scalar(0.5) * scalar(1 + step)
    while 0 <= at - step < size and (scalar(at) + entry - a) * inverse <= near:
        at -= step
    while 0 <= at + step < size and (scalar(at) + ahead - a) * inverse > near:
        at += step
    return at, step, inverse


@inline
def neighbours(packs, hit, right, down):
    """Where to read bilinearly: for the texel across, along and both ways (layer, x, y), and the weights fx, fy.

    packs (G, H, W, 4). (right, down) is the hit's place from the texel's centre [px]. Only samples of the same surface
    count; where a texel has none, the hit one stands in.
    """
    layer, x, y, _ = hit
    scalar = type(right)
    side_x = min(max(x + (1 if right > 0.0 else -1), 0), packs.shape[2] - 1)
    side_y = min(max(y + (1 if down > 0.0 else -1), 0), packs.shape[1] - 1)
    u = packs[layer // PACK, y, x, layer % PACK]
    across = _same_surface(packs, u, layer, x, y, side_x, y)
    along = _same_surface(packs, u, layer, x, y, x, side_y)
    corner = _same_surface(packs, u, layer, x, y, side_x, side_y)
    return across, along, corner, min(abs(right), scalar(0.5)), min(abs(down), scalar(0.5))


@inline
def _same_surface(packs, u, layer, x, y, side_x, side_y):
    """(layer, x, y) of the sample at a side texel that goes on from one at u; the sample itself if there is none."""
    scalar = type(u)
    for group in range(packs.shape[0]):
        for k in range(PACK):
            other = packs[group, side_y, side_x, k]
            if other < u - scalar(SAME_SURFACE):
                return layer, x, y
            if other <= u + scalar(SAME_SURFACE):
                return group * PACK + k, side_x, side_y
    return layer, x, y
