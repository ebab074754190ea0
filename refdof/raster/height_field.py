"""Height fields: where a lens ray first meets a stack of layers whose heights are circles of confusion.

At circle of confusion c the ray of a pixel through lens point v passes the image at (x - c v_x, y + c v_y), y down: a
straight line in (x, y, c). Each texel is a column as high as its surface, read at the nearest texel. A ray meets

- a top, where the texel's own height lies on the part of the ray inside the texel, or
- a wall, where it enters a texel below that height. A wall up to `thickness` [px] is surface; a higher one is the edge
  of an object that the ray passes behind.

1. `visit`       which layers a pixel's rays can meet at all: culling with N-buffers
2. `next_hit`    layers front to back
3. `_search`     within one: false position, then bisection [1]
4. `_march`      or every texel under the ray, in order: exact for these columns

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.3.
"""

import math
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof.raster.nbuffer import lowest_in, n_buffer

__all__ = ["Fields", "Search", "borrow_fields", "fields_of", "first_texel", "next_hit", "step", "visit"]

_BLOCK = 4  # [px] of the N-buffers: windows grow by up to 3 px, memory shrinks sixteenfold


class Fields(NamedTuple):
    """K height fields for kernels.

    coc (K, H, W) [px], inf: empty; near, far (K,) [px]; reach (K,) int64: how far a ray strays from its pixel [px];
    lowest (K, levels, h, w): N-buffers of the heights.
    """

    coc: Float
    near: Float
    far: Float
    reach: Index
    lowest: Float


class Search(NamedTuple):
    """How to search: whether to begin in the middle of a layer; steps of false position and of bisection; highest wall
    that is surface [px]; whether to march instead; whether to cull; whether rays that leave the image are dropped
    (else the image's border goes on); whether a layer that the ray leaves over an empty texel counts as met, where the
    search ended.
    """

    middle: bool
    steps: int
    bisections: int
    thickness: float
    march: bool
    culling: bool
    discard: bool
    holes: bool = False


def fields_of(coc: Float, near: Float, far: Float, largest: float, widening: float = 0.0) -> Fields:
    """Prepare heights (K, H, W) for lens points up to `largest` from the middle of the unit lens disc.

    Rays read up to `widening` times the circle of confusion beside them.
    """
    extent = np.ceil(np.maximum(np.abs(near), np.abs(far)).astype(np.float64) * (largest + widening))
    reach = np.minimum(extent, max(coc.shape[1:])).astype(np.int64) + 1
    window = 2 * int(reach.max(initial=0)) + 1
    levels = [n_buffer(layer, extremes="min", largest=window, block=_BLOCK).lowest for layer in coc]
    lowest = np.stack(levels) if levels else np.zeros((0, 1, 1, 1), dtype=coc.dtype)
    return Fields(coc, near.astype(coc.dtype), far.astype(coc.dtype), reach, lowest)


@inline
def borrow_fields(fields):
    """`Fields` whose arrays are borrowed."""
    return Fields(
        borrow(fields.coc), borrow(fields.near), borrow(fields.far), borrow(fields.reach), borrow(fields.lowest)
    )


@inline
def visit(fields, x, y, search, layers):
    """Write the layers that rays of pixel (x, y) can meet into layers (K,); returns (their count, border).

    `border` tells that a ray may leave the image. Layers that are culled there are written as ~k, since leaving the
    image within them counts.
    """
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    count, border = 0, False
    for k in range(len(fields.coc)):
        r = fields.reach[k]
        border = border or x < r or y < r or x + r >= width or y + r >= height
    for k in range(len(fields.coc)):
        r = fields.reach[k]
        x0, x1, y0, y1 = max(x - r, 0), min(x + r, width - 1), max(y - r, 0), min(y + r, height - 1)
        if not search.culling or lowest_in(fields.lowest[k], _BLOCK, x0, y0, x1, y1, False) < np.inf:
            layers[count] = k
            count += 1
        elif border and search.discard:
            layers[count] = ~k
            count += 1
    return count, border and search.discard


@inline
def next_hit(fields, layers, first, count, border, px, py, vx, vy, search):
    """The first hit in layers[first:count] of the ray at (px - c vx, py + c vy).

    Returns (place in `layers`, column, row, c); place -1: none, -2: the ray leaves the image. With `search.holes` the
    texel may be an empty one.
    """
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    for place in range(first, count):
        k = layers[place]
        if border:
            seen = ~k if k < 0 else k
            near, far = fields.near[seen], fields.far[seen]
            x0, x1, y0, y1 = px - near * vx, px - far * vx, py + near * vy, py + far * vy
            if min(x0, x1) < 0 or min(y0, y1) < 0 or max(x0, x1) >= width or max(y0, y1) >= height:
                return -2, 0, 0, near
            if k < 0:
                continue
        if search.march:
            x, y, c = _march(fields.coc, k, fields.near[k], fields.far[k], px, py, vx, vy, search)
        else:
            x, y, c = _search(fields.coc, k, fields.near[k], fields.far[k], px, py, vx, vy, search)
        if x >= 0:
            return place, x, y, c
    return -1, 0, 0, px


@inline
def _search(coc, k, near, far, px, py, vx, vy, search):
    """False position and bisection in layer k: (column, row, c); column -1: no hit."""
    half, thickness = coc.dtype.type(0.5), coc.dtype.type(search.thickness)
    # Empty ends count as the bound at the other end, which puts the first guess in the middle.
    a, b, above, below = near, far, far - near, near - far
    blocked = crossed = False
    bx, by, top = 0, 0, near
    if search.middle:
        c = half * (a + b)
        x, y, height = _texel(coc, k, px, py, vx, vy, c)
        if _on_top(coc, px, py, vx, vy, x, y, height):
            return x, y, height
        if height < c:
            blocked = crossed = True
            b, bx, by, top = c, x, y, height
        elif height < np.inf:
            a, above = c, height - c
    # Look up both ends, unless the middle showed a surface.
    if a == near and not crossed:
        x, y, height = _texel(coc, k, px, py, vx, vy, a)
        if _on_top(coc, px, py, vx, vy, x, y, height):
            return x, y, height
        if height < np.inf:
            above = height - a
        bx, by, top = _texel(coc, k, px, py, vx, vy, b)
        blocked = top < np.inf
        if blocked:
            below = top - b
    # Follow the straight line between the ends, as long as it stays in front of the surface.
    for _ in range(0 if crossed else search.steps):
        c = a + (b - a) * (above / (above - below)) if above > below else half * (a + b)
        x, y, height = _texel(coc, k, px, py, vx, vy, c)
        if _on_top(coc, px, py, vx, vy, x, y, height):
            return x, y, height
        if height < c:
            blocked, b, bx, by, top = True, c, x, y, height
            break
        a, above = c, (height if height < np.inf else far) - c
    if not blocked:
        bx, by, top = _texel(coc, k, px, py, vx, vy, b)
        if top == np.inf:
            return (bx, by, a) if search.holes else (-1, 0, near)
    # Halve the part in which the surface comes before the ray.
    for _ in range(search.bisections):
        c = half * (a + b)
        x, y, height = _texel(coc, k, px, py, vx, vy, c)
        if _on_top(coc, px, py, vx, vy, x, y, height):
            return x, y, height
        if height < c:
            b, bx, by, top = c, x, y, height
        else:
            a = c
    if _on_top(coc, px, py, vx, vy, bx, by, top):
        return bx, by, top
    return (bx, by, b) if b - top <= thickness else (-1, 0, near)


@inline
def _march(coc, k, near, far, px, py, vx, vy, search):
    """Every texel under the ray in layer k, in order: (column, row, c) of the first top or wall; column -1: none."""
    enter, last = np.float64(near), np.float64(far)
    rows, columns = coc.shape[1], coc.shape[2]
    x, y = first_texel(px, py, vx, vy, near, columns, rows)
    while True:
        leave, next_x, next_y = step(px, py, vx, vy, x, y, last, columns, rows)
        i, j = min(max(x, 0), columns - 1), min(max(y, 0), rows - 1)
        height = coc[k, j, i]
        if height <= leave and height >= enter - search.thickness:
            return i, j, coc.dtype.type(max(np.float64(height), enter))
        if leave >= last:
            return (i, j, far) if search.holes and height == np.inf else (-1, 0, near)
        enter, x, y = leave, next_x, next_y


@inline
def first_texel(px, py, vx, vy, c, width, height):
    """Column and row of the ray at c. All columns left of the image are -1, all right of it `width`; rows likewise."""
    x, y = min(max(px - c * vx, -1), width), min(max(py + c * vy, -1), height)
    return math.floor(x), math.floor(y)


@inline
def step(px, py, vx, vy, x, y, last, width, height):
    """Where the ray leaves texel (x, y), at most `last`, and the texel after it: (c, column, row)."""
    stays_x = vx == 0 or (vx > 0 and x < 0) or (vx < 0 and x >= width)
    stays_y = vy == 0 or (vy > 0 and y >= height) or (vy < 0 and y < 0)
    leave_x = np.inf if stays_x else (px - (x if vx > 0 else x + 1)) / np.float64(vx)
    leave_y = np.inf if stays_y else ((y + 1 if vy > 0 else y) - py) / np.float64(vy)
    leave = min(leave_x, leave_y, last)
    if leave_x <= leave_y:
        return leave, (x - 1 if vx > 0 else x + 1), y
    return leave, x, (y + 1 if vy > 0 else y - 1)


@inline
def _texel(coc, k, px, py, vx, vy, c):
    """Column, row and height of the texel under the ray at c; the border goes on for ever."""
    u, v = min(max(px - c * vx, 0), coc.shape[2] - 1), min(max(py + c * vy, 0), coc.shape[1] - 1)
    x, y = math.floor(u), math.floor(v)
    return x, y, coc[k, y, x]


@inline
def _on_top(coc, px, py, vx, vy, x, y, height):
    """Whether the ray is inside texel (x, y), or past the border next to it, where it has the texel's height."""
    if height == np.inf:
        return False
    u, v = px - height * vx, py + height * vy
    inside_x = (x <= u or x == 0) and (u < x + 1 or x + 1 == coc.shape[2])
    return inside_x and (y <= v or y == 0) and (v < y + 1 or y + 1 == coc.shape[1])
