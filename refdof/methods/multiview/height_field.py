"""Height fields: where a lens ray first meets a stack of layers whose heights are circles of confusion.

At circle of confusion c the ray of a pixel through lens point v passes the image at (x - c v_x, y + c v_y), y down: a
straight line in (x, y, c). Each texel is a column as high as its surface, read at the nearest texel. In each layer,
front to back, a ray meets

- a top, where the texel's own height lies on the part of the ray inside the texel; or
- a wall, where it comes into a texel below that height, out of a texel with a surface that goes on there: of this or a
  farther layer, not in front of the ray, and at most `wall` [px] above the texel's. A plane that the whole lens sees
  from one side changes by less than 1 px per px: with 1 px it has no cracks.

Else the ray passes behind an object's edge. What the layer held there it has lost to the nearer object: the surface of
the texel that the ray came from goes on behind it, at its height, until the ray comes out again.

The part of a ray in a layer lies between the layer's least and greatest height; walls are looked for `wall` farther, as
they may lead to the next layer. With `wall` infinite all walls are surface, and objects as thick as their layer [1].

1. `next_hit`    the layers that a pixel can meet, front to back (`refdof.methods.multiview.fields`)
2. `_walk`       within one: every texel under the ray, in order; exact for these columns
3. `_search`     or false position, then bisection [1], and a walk over what they leave

References
----------
.. [1] Lee, Eisemann & Seidel (2009), Depth-of-Field Rendering with Multiview Synthesis, Section 4.3.
"""

import math

import numpy as np

from refdof._jit import inline
from refdof.methods.multiview.fields import extent_in

__all__ = ["between", "end_of", "first_texel", "goes_on", "next_hit", "step", "texel_under"]


@inline
def next_hit(fields, visited, first, ray, search):
    """The first hit of a ray in visited.layers[first : visited.length].

    Returns (place in `layers`, column, row, c); place -1: none, -2: the ray leaves the image. Behind an edge the ray is
    not over the texel that it meets. With `search.holes` the texel may be an empty one.
    """
    height, width = fields.coc.shape[1], fields.coc.shape[2]
    for place in range(first, visited.length):
        k = visited.layers[place]
        if k < 0:
            k = ~k
        elif visited.border:
            left, top, right, bottom = extent_in(fields, k, ray)
            if left < 0 or top < 0 or right >= width or bottom >= height:
                return -2, 0, 0, fields.near[k]
        if search.march:
            x, y, c = _walk(fields, k, fields.near[k], ray, search)
        else:
            x, y, c = _search(fields, k, ray, search)
        if x < 0 and search.holes:
            x, y, top = texel_under(fields.coc, k, ray, fields.far[k])
            c, x = fields.far[k], x if top == np.inf else -1
        if x >= 0:
            return place, x, y, c
    return -1, 0, 0, ray.px


@inline
def _walk(fields, k, begin, ray, search):
    """Every texel under the ray in layer k from `begin` on, in order: (column, row, c) of the first hit.

    Column -1: none. At `begin` the ray is in front of the layer.
    """
    coc = fields.coc
    enter, last = np.float64(begin), np.float64(end_of(fields.far[k], search.wall))
    rows, columns = coc.shape[1], coc.shape[2]
    x, y = first_texel(ray, begin, columns, rows)
    before_x, before_y = -1, -1  # where the ray comes from
    seen_x, seen_y, seen = -1, -1, np.inf  # the texel that it was in front of last, and its height
    while True:
        leave, next_x, next_y = step(ray, x, y, last, columns, rows)
        i, j = min(max(x, 0), columns - 1), min(max(y, 0), rows - 1)
        height = np.float64(coc[k, j, i])
        if height >= enter:
            if height <= leave:
                return i, j, coc.dtype.type(height)
            seen_x, seen_y, seen = i, j, height
        elif before_x < 0 or (
            (i != before_x or j != before_y) and goes_on(fields, k, before_x, before_y, enter, height + search.wall)
        ):
            return i, j, coc.dtype.type(enter)
        elif seen <= leave:
            return seen_x, seen_y, coc.dtype.type(seen)
        if leave >= last:
            return -1, 0, coc.dtype.type(last)
        enter, x, y, before_x, before_y = leave, next_x, next_y, i, j


@inline
def end_of(far, wall):
    """Where the part of a ray ends that can meet a layer up to `far`."""
    return far + (type(far)(wall) if wall < np.inf else type(far)(0.0))


@inline
def goes_on(fields, k, x, y, low, high):
    """Whether layer k or a farther one has a surface between low and high at texel (x, y)."""
    for n in range(k, len(fields.coc)):
        if fields.near[n] > high:
            return False
        if low <= fields.coc[n, y, x] <= high:
            return True
    return False


@inline
def _search(fields, k, ray, search):
    """False position and bisection in layer k: (column, row, c); column -1: no hit."""
    coc, half = fields.coc, fields.coc.dtype.type(0.5)
    near, far = fields.near[k], end_of(fields.far[k], search.wall)
    # Empty ends count as the bound at the other end, which puts the first guess in the middle.
    a, b, above, below = near, far, far - near, near - far
    blocked = crossed = False
    bx, by, top = 0, 0, near
    if search.middle:
        c = half * (a + b)
        x, y, height = texel_under(coc, k, ray, c)
        if _on_top(coc, ray, x, y, height):
            return x, y, height
        if height < c:
            blocked = crossed = True
            b, bx, by, top = c, x, y, height
        elif height < np.inf:
            a, above = c, height - c
    # Look up both ends, unless the middle showed a surface.
    if a == near and not crossed:
        x, y, height = texel_under(coc, k, ray, a)
        if _on_top(coc, ray, x, y, height):
            return x, y, height
        if height < np.inf:
            above = height - a
        bx, by, top = texel_under(coc, k, ray, b)
        blocked = top < np.inf
        if blocked:
            below = top - b
    # Follow the straight line between the ends, as long as it stays in front of the surface.
    for _ in range(0 if crossed else search.steps):
        c = between(a, b, above, below)
        x, y, height = texel_under(coc, k, ray, c)
        if _on_top(coc, ray, x, y, height):
            return x, y, height
        if height < c:
            blocked, b, bx, by, top = True, c, x, y, height
            break
        a, above = c, (height if height < np.inf else far) - c
    if not blocked:
        bx, by, top = texel_under(coc, k, ray, b)
        if top == np.inf:
            return -1, 0, near
    # Halve the part in which the surface comes before the ray.
    for _ in range(search.bisections):
        c = half * (a + b)
        x, y, height = texel_under(coc, k, ray, c)
        if _on_top(coc, ray, x, y, height):
            return x, y, height
        if height < c:
            b, bx, by, top = c, x, y, height
        else:
            a = c
    if search.wall < np.inf:
        return _walk(fields, k, a, ray, search)
    if _on_top(coc, ray, bx, by, top):
        return bx, by, top
    return bx, by, b


@inline
def first_texel(ray, c, width, height):
    """Column and row of the ray at c. All columns left of the image are -1, all right of it `width`; rows likewise."""
    x, y = min(max(ray.px - c * ray.vx, -1), width), min(max(ray.py + c * ray.vy, -1), height)
    return math.floor(x), math.floor(y)


@inline
def step(ray, x, y, last, width, height):
    """Where the ray leaves texel (x, y), at most `last`, and the texel after it: (c, column, row)."""
    stays_x = ray.vx == 0 or (ray.vx > 0 and x < 0) or (ray.vx < 0 and x >= width)
    stays_y = ray.vy == 0 or (ray.vy > 0 and y >= height) or (ray.vy < 0 and y < 0)
    leave_x = np.inf if stays_x else (ray.px - (x if ray.vx > 0 else x + 1)) / np.float64(ray.vx)
    leave_y = np.inf if stays_y else ((y + 1 if ray.vy > 0 else y) - ray.py) / np.float64(ray.vy)
    leave = min(leave_x, leave_y, last)
    if leave_x <= leave_y:
        return leave, (x - 1 if ray.vx > 0 else x + 1), y
    return leave, x, (y + 1 if ray.vy > 0 else y - 1)


@inline
def texel_under(coc, k, ray, c):
    """Column, row and height of the texel under the ray at c; the border goes on for ever."""
    scalar = coc.dtype.type
    right, bottom = scalar(coc.shape[2] - 1), scalar(coc.shape[1] - 1)
    # In the image truncation is the floor, and takes half the time.
    x = int(min(max(ray.px - c * ray.vx, scalar(0.0)), right))
    y = int(min(max(ray.py + c * ray.vy, scalar(0.0)), bottom))
    return x, y, coc[k, np.uint64(y), np.uint64(x)]  # unsigned: no index counts from the end


@inline
def _on_top(coc, ray, x, y, height):
    """Whether the ray is inside texel (x, y), or past the border next to it, where it has the texel's height."""
    if height == np.inf:
        return False
    scalar = coc.dtype.type
    u, v = ray.px - height * ray.vx, ray.py + height * ray.vy
    # Without decisions, on which processors wait.
    inside_x = ((scalar(x) <= u) | (x == 0)) & ((u < scalar(x + 1)) | (x + 1 == coc.shape[2]))
    return inside_x & ((scalar(y) <= v) | (y == 0)) & ((v < scalar(y + 1)) | (y + 1 == coc.shape[1]))


@inline
def between(a, b, above, below):
    """Where false position looks: where a surface that is `above` the ray at a, and `below` at b, would meet it.

    Midway, if it is not so.
    """
    return a + (b - a) * (above / (above - below)) if above > below else type(a)(0.5) * (a + b)
