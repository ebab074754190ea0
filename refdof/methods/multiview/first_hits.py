"""First hits: the layers that rays of a pixel pass at first, and what most of them meet there, for all rays at once.

False position, layer by layer, in steps without decisions: processors wait for those. Rays that it does not settle so
are left to `refdof.methods.multiview.height_field.next_hit`, which looks at the same places.

1. Look where the layer begins                                                    `_begin`
2. Look at its end and where false position looks first: most rays are on a top   `_look_on`
3. Where both ends are empty it looks at places that do not depend on the ray     `_keep_empty`
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof.methods.multiview.fields import Ray
from refdof.methods.multiview.height_field import between, end_of, texel_under

__all__ = ["FirstHits", "borrow_first_hits", "first_hits", "first_hits_of"]

_LANES = 16  # rays of a vector; what is done for more rays than there are does no harm


class FirstHits(NamedTuple):
    """Of the N rays of a pixel. begin (N,): place in `Visit.layers` before which they meet nothing;
    texel (N,): row * W + column of what they meet there, -1: not known; looks (K, steps + 2): where false position
    looks in each layer while it meets nothing, (K, 0): another search. Memory for N rays, rounded up to whole vectors:
    rays (2, n) and slopes (2, 2, n) of those over an empty texel and of the others; of these, numbers (4, n): place,
    and heights there, where the layer begins, and at its end; texels (4, n): column, row and number, and the answer.
    """

    begin: Index
    texel: Index
    looks: Float
    rays: Index
    slopes: Float
    numbers: Float
    texels: Index


@inline
def first_hits_of(fields, search, count):
    """Memory for `count` rays."""
    kind = fields.coc.dtype
    looks = np.empty((len(fields.coc), 0 if search.march or search.middle else search.steps + 2), kind)
    for k in range(len(looks) if looks.shape[1] > 0 else 0):
        a, b = fields.near[k], end_of(fields.far[k], search.wall)
        above, below = b - a, a - b
        looks[k, 0], looks[k, 1] = a, b
        for n in range(2, looks.shape[1]):
            c = between(a, b, above, below)
            a, above = c, b - c
            looks[k, n] = c
    begin, texel, room = np.zeros(count, np.int64), np.full(count, -1, np.int64), count + _LANES
    rays, slopes = np.zeros((2, room), np.int64), np.zeros((2, 2, room), kind)
    return FirstHits(begin, texel, looks, rays, slopes, np.zeros((4, room), kind), np.zeros((4, room), np.int32))


@inline
def borrow_first_hits(hits):
    """`FirstHits` whose arrays are borrowed."""
    return FirstHits(
        borrow(hits.begin),
        borrow(hits.texel),
        borrow(hits.looks),
        borrow(hits.rays),
        borrow(hits.slopes),
        borrow(hits.numbers),
        borrow(hits.texels),
    )


@inline
def first_hits(fields, visited, px, py, points, hits):
    """Fill `begin` and `texel` for the rays of the pixel with centre (px, py) through points (N, 2)."""
    begin, texel, rays, slopes = hits.begin, hits.texel, hits.rays[0], hits.slopes[0]
    count = len(points)
    for n in range(count):
        begin[n], texel[n], rays[n], slopes[0, n], slopes[1, n] = 0, -1, n, points[n, 0], points[n, 1]
    if hits.looks.shape[1] == 0 or visited.border:  # another search; or rays that leave the image are to be dropped
        return
    for place in range(visited.length):
        k = visited.layers[place]
        k = k if k >= 0 else ~k
        full, count = _begin(fields.coc, k, px, py, count, hits)
        _look_on(fields.coc, k, px, py, full, hits)
        for n in range(1, hits.looks.shape[1]):
            count = _keep_empty(fields.coc, k, px, py, hits.looks[k, n], count, hits)
        if count == 0:
            return
        for m in range(count):
            begin[rays[m]] = place + 1


@inline
def _begin(coc, k, px, py, count, hits):
    """Part the rays where layer k begins: how many are over a texel with a surface, how many over an empty one."""
    full, empty = np.int64(0), np.int64(0)
    rays, slopes = hits.rays, hits.slopes
    for m in range(count):
        ray, vx, vy = rays[0, m], slopes[0, 0, m], slopes[0, 1, m]
        _, _, height = texel_under(coc, k, Ray(px, py, vx, vy), hits.looks[k, 0])
        rays[0, empty], slopes[0, 0, empty], slopes[0, 1, empty] = ray, vx, vy
        rays[1, full], slopes[1, 0, full], slopes[1, 1, full] = ray, vx, vy
        full += np.int64(height < np.inf)
        empty += np.int64(height == np.inf)
    return full, empty


@inline
def _look_on(coc, k, px, py, count, hits):
    """Set `texel` of rays that are on a top where layer k begins, or where false position looks first."""
    whole, width = (count + _LANES - 1) // _LANES * _LANES, np.int32(coc.shape[2])
    zero, right, bottom = coc.dtype.type(0.0), coc.dtype.type(coc.shape[2] - 1), coc.dtype.type(coc.shape[1] - 1)
    flat, a, b = coc[k].reshape(-1), hits.looks[k, 0], hits.looks[k, 1]
    (vx, vy), (columns, rows, numbers, answer) = hits.slopes[1], hits.texels
    places, heights, firsts, ends = hits.numbers
    for m in range(whole):
        answer[m] = -1
    for look in range(min(hits.looks.shape[1], 3)):  # its end, its begin, and the first place between, if any
        for m in range(whole):
            above, below = (firsts[m] if firsts[m] < np.inf else b) - a, (ends[m] if ends[m] < np.inf else a) - b
            c = between(a, b, above, below)
            places[m] = b if look == 0 else a if look == 1 else c
        for m in range(whole):
            columns[m] = np.int32(min(max(px - places[m] * vx[m], zero), right))
            rows[m] = np.int32(min(max(py + places[m] * vy[m], zero), bottom))
            numbers[m] = np.int32(np.int32(rows[m] * width) + columns[m])
        kept = ends if look == 0 else firsts if look == 1 else heights
        for m in range(whole):
            kept[m] = flat[np.uint64(numbers[m])]
        if look > 0:
            _answer(kept, px, py, (vx, vy), (columns, rows, numbers), (right, bottom), answer, whole)
    for m in range(count):
        hits.texel[hits.rays[1, m]] = answer[m]


@inline
def _answer(heights, px, py, slopes, texels, last, answer, count):
    """Numbers of texels where `refdof.methods.multiview.height_field._on_top` holds, if there is no answer yet.

    The same comparisons, so written that they vectorise: one function for both takes a third more time.
    """
    (vx, vy), (columns, rows, numbers), zero = slopes, texels, type(px)(0.0)
    for m in range(count):
        filled, x, y = heights[m] < np.inf, type(px)(columns[m]), type(px)(rows[m])
        height = heights[m] if filled else zero
        u, v = px - height * vx[m], py + height * vy[m]
        inside_x = ((x <= u) | (x == zero)) & ((u < x + type(px)(1.0)) | (x == last[0]))
        inside_y = ((y <= v) | (y == zero)) & ((v < y + type(px)(1.0)) | (y == last[1]))
        answer[m] = numbers[m] if (answer[m] < 0) & filled & inside_x & inside_y else answer[m]


@inline
def _keep_empty(coc, k, px, py, c, count, hits):
    """Keep the rays over an empty texel of layer k at c, of the first `count`: how many they are."""
    kept, rays, slopes = np.int64(0), hits.rays, hits.slopes
    for m in range(count):
        ray, vx, vy = rays[0, m], slopes[0, 0, m], slopes[0, 1, m]
        _, _, height = texel_under(coc, k, Ray(px, py, vx, vy), c)
        rays[0, kept], slopes[0, 0, kept], slopes[0, 1, kept] = ray, vx, vy
        kept += np.int64(height == np.inf)
    return kept
