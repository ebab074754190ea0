"""Doubt: rays for which a search by samples may answer otherwise than a walk over every texel.

Along a ray, a texel is free while the ray is in front of its surface, and blocks from there on. A search that brackets
the change from free to blocked finds it if there is one change only. A ray is in doubt if in a layer that it visits

- texels block and then are free again: the search may never see the block, or may find a later one;
- it stays in the texel where it is blocked for less than the search resolves: without bisection, the whole layer;
- a number on which the answer turns is too close to call: a wall's height, a top at a texel's border, the image's.

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Sections 4.3, 5.
"""

import numpy as np

from refdof._jit import inline
from refdof.raster.height_field import first_texel, step

__all__ = ["in_doubt"]

_CLOSE = 1e-3  # [px]: roundings of float32 positions up to 8192, and of heights


@inline
def in_doubt(fields, layers, count, border, px, py, vx, vy, search):
    """Whether the ray at (px - c vx, py + c vy) is in doubt in layers[:count], up to the one it surely hits."""
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    for place in range(count):
        k = layers[place]
        near, far = fields.near[~k if k < 0 else k], fields.far[~k if k < 0 else k]
        if border:
            x0, x1, y0, y1 = px - near * vx, px - far * vx, py + near * vy, py + far * vy
            inner = min(min(x0, x1), min(y0, y1), width - max(x0, x1), height - max(y0, y1))
            if abs(inner) < _CLOSE:
                return True
            if inner < 0:
                return False
        if k >= 0:
            doubt, hit = _in_layer(fields.coc, k, near, far, px, py, vx, vy, search)
            if doubt or hit:
                return doubt
    return False


@inline
def _in_layer(coc, k, near, far, px, py, vx, vy, search):
    """(doubt, hit) of one layer."""
    finest = max((np.float64(far) - near) * 0.5**search.bisections, _CLOSE)
    enter, last = np.float64(near), np.float64(far)
    rows, columns = coc.shape[1], coc.shape[2]
    x, y = first_texel(px, py, vx, vy, near, columns, rows)
    blocked = hit = False
    while True:
        leave, next_x, next_y = step(px, py, vx, vy, x, y, last, columns, rows)
        i, j = min(max(x, 0), columns - 1), min(max(y, 0), rows - 1)
        height = coc[k, j, i]
        if abs(height - leave) < _CLOSE and leave < last:
            return True, hit
        if blocked and height > enter - _CLOSE:
            return True, hit
        if height <= leave and not hit:
            wall = max(enter - height, 0.0)
            if abs(wall - search.thickness) < finest or (blocked and wall < search.thickness):
                return True, hit
            if not blocked and leave - enter < finest and far - near > _CLOSE:
                return True, hit
            hit, blocked = wall <= search.thickness, True
        if leave >= last:
            return False, hit
        enter, x, y = leave, next_x, next_y
