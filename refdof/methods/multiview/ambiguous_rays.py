"""Ambiguous rays: those for which a search by samples may answer otherwise than a walk over every texel.

Along a ray, a texel is free while the ray is in front of its surface, and blocks from there on. A search that brackets
the change from free to blocked finds it if there is one change only. A ray is ambiguous if in a layer that it visits

- texels block and then are free again: the search may never see the block, or may find a later one;
- walls of any height are surface, and it stays in the texel where it is blocked for less than the search resolves:
  without bisection, the whole layer;
- a number on which the answer turns is too close to call: a wall's ends, a top at a texel's border, the image's.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Sections 4.3, 5.
"""

import numpy as np

from refdof._jit import inline
from refdof.methods.multiview.fields import extent_in
from refdof.methods.multiview.height_field import end_of, first_texel, goes_on, step

__all__ = ["ray_is_ambiguous"]

_CLOSE = 1e-3  # [px]: roundings of float32 positions up to 8192, and of heights


@inline
def ray_is_ambiguous(fields, visited, ray, search):
    """Whether a ray is ambiguous in the layers that its pixel visits, up to the one it surely hits."""
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    for place in range(visited.length):
        k = visited.layers[place]
        if k < 0:
            k = ~k
        elif visited.border:
            left, top, right, bottom = extent_in(fields, k, ray)
            inner = min(left, top, width - right, height - bottom)
            if abs(inner) < _CLOSE:
                return True
            if inner < 0:
                return False
        ambiguous, hit = _in_layer(fields, k, ray, search)
        if ambiguous or hit:
            return ambiguous
    return False


@inline
def _in_layer(fields, k, ray, search):
    """(ambiguous, hit) of one layer."""
    coc, solid = fields.coc, search.wall == np.inf
    enter, last = np.float64(fields.near[k]), np.float64(end_of(fields.far[k], search.wall))
    finest = max((last - enter) * 0.5**search.bisections, _CLOSE)
    deep = last - enter > _CLOSE
    rows, columns = coc.shape[1], coc.shape[2]
    x, y = first_texel(ray, fields.near[k], columns, rows)
    before_x, before_y, seen = -1, -1, np.inf
    blocked = hit = False
    while True:
        leave, next_x, next_y = step(ray, x, y, last, columns, rows)
        i, j = min(max(x, 0), columns - 1), min(max(y, 0), rows - 1)
        height = np.float64(coc[k, j, i])
        if abs(height - leave) < _CLOSE and leave < last:
            return True, hit
        if blocked and height > enter - _CLOSE:
            return True, hit
        if height >= enter:
            hit = hit or height <= leave
            seen = height
        elif i != before_x or j != before_y:
            top = height + search.wall
            if not solid and before_x >= 0 and _turns(fields, k, before_x, before_y, enter, top):
                return True, hit
            hit = hit or before_x < 0 or goes_on(fields, k, before_x, before_y, enter, top)
        if height <= leave:
            if solid and not blocked and leave - enter < finest and deep:
                return True, hit
            hit = hit or seen <= leave
            blocked = True
        if leave >= last:
            return False, hit
        enter, x, y, before_x, before_y = leave, next_x, next_y, i, j


@inline
def _turns(fields, k, x, y, low, high):
    """Whether layer k or a farther one has a surface at texel (x, y) too close to low or high."""
    for n in range(k, len(fields.coc)):
        height = np.float64(fields.coc[n, y, x])
        if abs(height - low) < _CLOSE or abs(height - high) < _CLOSE:
            return True
    return False
