"""Tile walk: one lens ray of each of some neighbouring pixels, all walked at once.

Neighbours' rays are nearly alike, and loops over pixels without branches become vector code. Most rays pass above the
first layer's samples until they meet the top of one: that is all that these loops know. A ray that passes below a
sample is walked on by itself. All answers are those of `refdof.methods.lensblur.texel_walk`.

1. begin all rays in their texels                           `_begin`
2. take steps until no ray goes on                          `_step`
3. note the hits, and walk single rays that need more care  `_settle`

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, Section 3.
.. [2] Amanatides & Woo (1987), A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import inline
from refdof.methods.lensblur.texel_walk import PACK, STILL, Pace, Ray, Stay, first_hit, walk_on

__all__ = ["LANES", "PLACES", "TILE", "Lanes", "new_lanes", "part", "walk_tile"]

TILE = 64  # pixels
LANES, PLACES = 29, 5  # numbers and places of a tile, in parts of TILE
_WALKS, _MEETS, _ENDS, _CARE, _UNSURE = range(5)


class Lanes(NamedTuple):
    """The rays of a tile: numbers (TILE,) of one type, so that all vectors have as many lanes.

    center (TILE,): the pixel's centre along x; walked: texels so far, of all its rays.
    ax, ay, wx, wy as in `Ray`; border: the parallax at which it comes into the picture, -inf if it is missed. best,
    layer, hit_x, hit_y: the nearest hit so far, layer -1: none. inverse_x, inverse_y as in `Pace`; far, where the walk
    ends; x, y, last_x, last_y, enter as in `Stay`; steps; state; top: the first sample of texel (x, y).
    at (TILE,) uint32: the texel's number.
    """

    center: Float
    walked: Float
    ax: Float
    ay: Float
    wx: Float
    wy: Float
    border: Float
    best: Float
    layer: Float
    hit_x: Float
    hit_y: Float
    inverse_x: Float
    inverse_y: Float
    far: Float
    enter: Float
    x: Float
    y: Float
    last_x: Float
    last_y: Float
    steps: Float
    state: Float
    top: Float
    at: Index


@inline
def new_lanes(numbers, places):
    """`Lanes` in numbers (LANES * TILE,) and places (PLACES * TILE,).

    They are parts of one array: so compilers see that they do not overlap.
    """
    return Lanes(
        part(numbers, 0),
        part(numbers, 1),
        part(numbers, 2),
        part(numbers, 3),
        part(numbers, 4),
        part(numbers, 5),
        part(numbers, 6),
        part(numbers, 7),
        part(numbers, 8),
        part(numbers, 9),
        part(numbers, 10),
        part(numbers, 11),
        part(numbers, 12),
        part(numbers, 13),
        part(numbers, 14),
        part(numbers, 15),
        part(numbers, 16),
        part(numbers, 17),
        part(numbers, 18),
        part(numbers, 19),
        part(numbers, 20),
        part(numbers, 21),
        part(places, 0),
    )


@inline
def part(memory, k):
    """The k-th part of TILE numbers."""
    return memory[k * TILE : (k + 1) * TILE]


@inline
def walk_tile(packs, group, tops, lanes, near, far, extension):
    """Walk rays through one pack from `near` down to `far` (count,), and note what is nearer than their best hits.

    tops (H, W) is the pack's first layer.
    """
    count, width, height = len(near), tops.shape[1], tops.shape[0]
    flat = tops.reshape(-1)
    _begin(lanes, near, far, width, height)
    while _find_texels(lanes, count, width):
        for k in range(count):  # by itself: nothing tells the compiler that this memory is not written to
            lanes.top[k] = flat[lanes.at[k]]
        _step(lanes, count, width, height)
    _settle(packs, group, lanes, count, extension)


@inline
def _find_texels(lanes, count, width):
    """Number the texels in which rays are, and tell whether any ray goes on."""
    walking, zero = np.int32(0), lanes.x.dtype.type(0.0)
    for k in range(count):
        lanes.at[k] = np.uint32(np.int32(lanes.y[k]) * np.int32(width) + np.int32(lanes.x[k]))
        walking = max(walking, np.int32(1) if lanes.state[k] == zero else np.int32(0))
    return walking > 0


@inline
def _begin(lanes, near, far, width, height):
    """Texels at the walks' beginnings, as `refdof.methods.lensblur.texel_walk` finds them."""
    scalar = lanes.x.dtype.type
    zero, walking, unsure, ended = scalar(0.0), scalar(_WALKS), scalar(_UNSURE), scalar(_ENDS)
    for k in range(len(near)):
        lanes.enter[k], lanes.far[k] = near[k], far[k]
    for k in range(len(near)):
        begin, end = min(lanes.enter[k], lanes.border[k]), max(lanes.far[k], lanes.best[k])
        ax, ay, wx, wy = lanes.ax[k], lanes.ay[k], lanes.wx[k], lanes.wy[k]
        walks = begin >= end
        enter = begin if walks else zero
        x, inverse_x, sure_x = _start(ax, wx, enter, width)
        y, inverse_y, sure_y = _start(ay, wy, enter, height)
        state = walking if sure_x & sure_y else unsure
        state = state if walks else ended
        lanes.inverse_x[k], lanes.inverse_y[k] = inverse_x, inverse_y
        lanes.x[k], lanes.y[k], lanes.last_x[k], lanes.last_y[k] = x, y, x, y
        lanes.enter[k], lanes.far[k], lanes.steps[k], lanes.state[k] = enter, end, zero, state


@inline
def _start(a, w, near, size):
    """Texel along one axis at u = near, 1 / w, and whether the texel is sure: at most one step from the first guess."""
    scalar = type(a)
    zero, one = scalar(0.0), scalar(1.0)
    moves = abs(w) >= scalar(STILL)
    inverse = one / w if moves else zero
    step = -one if w > zero else one
    entry = one if w > zero else zero
    ahead = one - entry
    at = scalar(np.int32(min(max(a + near * w, zero), scalar(size - 1))))
    back = at - step
    inside = (back >= zero) & (back < scalar(size))
    late = moves & inside & ((at + entry - a) * inverse <= near)
    at = back if late else at
    back = at - step
    inside = (back >= zero) & (back < scalar(size))
    unsure = late & inside & ((at + entry - a) * inverse <= near)
    onward = at + step
    inside = (onward >= zero) & (onward < scalar(size))
    early = moves & inside & ((at + ahead - a) * inverse > near)
    at = onward if early else at
    onward = at + step
    inside = (onward >= zero) & (onward < scalar(size))
    unsure = unsure | (early & inside & ((at + ahead - a) * inverse > near))
    return at, inverse, not unsure


@inline
def _step(lanes, count, width, height):
    """One step of all rays that walk."""
    scalar = lanes.x.dtype.type
    zero, one, nowhere = scalar(0.0), scalar(1.0), scalar(-np.inf)
    right, bottom = scalar(width), scalar(height)
    meets, care, ends = scalar(_MEETS), scalar(_CARE), scalar(_ENDS)
    for k in range(count):
        x, y, enter, state, top = lanes.x[k], lanes.y[k], lanes.enter[k], lanes.state[k], lanes.top[k]
        ax, ay, inverse_x, inverse_y = lanes.ax[k], lanes.ay[k], lanes.inverse_x[k], lanes.inverse_y[k]
        last_x, last_y, steps, far = lanes.last_x[k], lanes.last_y[k], lanes.steps[k], lanes.far[k]
        walks = state == zero
        ahead_x = zero if inverse_x > zero else one
        ahead_y = zero if inverse_y > zero else one
        step_x, step_y = ahead_x + ahead_x - one, ahead_y + ahead_y - one
        leave_x, leave_y = (x + ahead_x - ax) * inverse_x, (y + ahead_y - ay) * inverse_y
        leave_x = leave_x if inverse_x != zero else nowhere
        leave_y = leave_y if inverse_y != zero else nowhere
        exit_u = max(leave_x, leave_y)
        leave = max(exit_u, far)
        across = leave_x > leave_y
        next_x = x + step_x if across else x
        next_y = y if across else y + step_y
        over = (exit_u < far) | (next_x < zero) | (next_y < zero) | (next_x >= right) | (next_y >= bottom)
        above = ends if over else zero
        below = meets if top <= enter else care
        new = above if top < leave else below
        new = new if walks else state + zero
        goes = new == zero
        lanes.state[k] = new
        # A choice between a new number and the old one would be a masked store, which is slow on some processors.
        lanes.x[k] = next_x if goes else x + zero
        lanes.y[k] = next_y if goes else y + zero
        lanes.enter[k] = leave if goes else enter + zero
        lanes.last_x[k] = x if goes else last_x + zero
        lanes.last_y[k] = y if goes else last_y + zero
        lanes.steps[k] = steps + (one if walks else zero)


@inline
def _settle(packs, group, lanes, count, extension):
    """Note what rays met in a pack; those that need care are walked to their end."""
    scalar = packs.dtype.type
    meets, first, zero = scalar(_MEETS), scalar(group * PACK), scalar(0.0)
    for k in range(count):
        best, layer, hit_x, hit_y = lanes.best[k], lanes.layer[k], lanes.hit_x[k], lanes.hit_y[k]
        top, x, y = lanes.top[k], lanes.x[k], lanes.y[k]
        nearer = (lanes.state[k] == meets) & (top > best)
        lanes.best[k] = top if nearer else best + zero
        lanes.layer[k] = first if nearer else layer + zero
        lanes.hit_x[k] = x if nearer else hit_x + zero
        lanes.hit_y[k] = y if nearer else hit_y + zero
        lanes.walked[k] += lanes.steps[k]
    for k in range(count):
        if lanes.state[k] >= _CARE:
            ray = Ray(lanes.ax[k], lanes.ay[k], lanes.wx[k], lanes.wy[k])
            x, y, steps = int(lanes.x[k]), int(lanes.y[k]), int(lanes.steps[k])
            if lanes.state[k] == _UNSURE:
                slot, x, y, u, walked = first_hit(packs, group, ray, lanes.enter[k], lanes.far[k], extension)
            else:
                inverse_x, inverse_y = lanes.inverse_x[k], lanes.inverse_y[k]
                pace = Pace(_step_of(inverse_x), _step_of(inverse_y), inverse_x, inverse_y)
                stay = Stay(x, y, int(lanes.last_x[k]), int(lanes.last_y[k]), lanes.enter[k], steps - 1)
                slot, x, y, u, walked = walk_on(packs, group, ray, pace, stay, lanes.far[k], extension)
            lanes.walked[k] += scalar(walked - steps)
            if slot >= 0 and u > lanes.best[k]:
                lanes.layer[k], lanes.best[k] = scalar(group * PACK + slot), u
                lanes.hit_x[k], lanes.hit_y[k] = scalar(x), scalar(y)


@inline
def _step_of(inverse):
    """The step of a ray with 1 / w along one axis."""
    return 0 if inverse == 0.0 else (-1 if inverse > 0.0 else 1)
