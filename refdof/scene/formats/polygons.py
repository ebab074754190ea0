"""Polygons cut into triangles. Convex ones become fans from their first corner, all others lose ear after ear.

An ear is a corner that can be cut off: it turns the polygon's way, and the cut crosses no edge [1]. Corners may lie at
one place, as where a hole is joined to the rim by two edges along one line.

References
----------
.. [1] Meisters (1975), Polygons Have Ears, American Mathematical Monthly 82(6).
"""

import numpy as np

from refdof._check import Float, Index, InputError

__all__ = ["triangles_of"]

_STRAIGHT = 1e-9  # of a turn: what rounding makes of corners on a line
_MOST_CORNERS = 5000  # of a polygon that is not convex: its time grows with their third power at worst


def triangles_of(vertices: Float, sizes: Index, corners: Index) -> tuple[Index, Index]:
    """Cut polygons into triangles.

    Parameters
    ----------
    vertices : (V, 3) float64
    sizes : (P,) int64
        How many corners each polygon has; those with fewer than three are left out.
    corners : (sum of sizes,) int64
        Their vertices, in range, one polygon after the other.

    Returns
    -------
    triangle : (T, 3) int64, into `corners`; polygons stay in their order
    polygon : (T,) int64, which one each triangle is of

    Raises
    ------
    InputError
        If a polygon that is not convex has more than 5000 corners.
    """
    start = np.cumsum(sizes) - sizes
    found, owner = [np.zeros((0, 3), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for size in np.unique(sizes[sizes >= 3]).tolist():
        which = np.flatnonzero(sizes == size)
        fan = np.stack([np.zeros(size - 2, dtype=np.int64), np.arange(1, size - 1), np.arange(2, size)], axis=1)
        local = np.tile(fan, (len(which), 1, 1))
        if size > 3:
            for k, ring in zip(*_not_convex(vertices[corners[start[which][:, None] + np.arange(size)]]), strict=True):
                local[k] = _without_ears(ring)
        found.append((local + start[which][:, None, None]).reshape(-1, 3))
        owner.append(np.repeat(which, size - 2))
    polygon = np.concatenate(owner)
    order = np.argsort(polygon, kind="stable")
    return np.concatenate(found)[order], polygon[order]


def _not_convex(ring: Float) -> tuple[Index, list[Float]]:
    """Of polygons (P, N, 3): which are not convex, and each of these in its plane, (N, 2), turning to the left."""
    with np.errstate(all="ignore"):  # corners may be at any place; `Scene` judges them
        ring = ring - ring[:, :1]
        extent = np.abs(ring).max(axis=(1, 2))
        ring = ring / np.where((extent > 0) & np.isfinite(extent), extent, 1.0)[:, None, None]
        ahead = np.roll(ring, -1, axis=1)
        normal = np.cross(ring, ahead).sum(axis=1)  # twice the area along its direction (Newell)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        unit = normal / np.where(length > 0, length, 1.0)
        side = ahead - ring
        turn = np.einsum("pnc,pc->pn", np.cross(np.roll(side, 1, axis=1), side), unit)
        # A pentagram turns one way, too, but twice around: seen from its first corner, a fan's triangles turn back.
        fan = np.einsum("pnc,pc->pn", np.cross(ring[:, 1:-1], ring[:, 2:]), unit)
        bent = (np.minimum(turn.min(axis=1), fan.min(axis=1)) < -_STRAIGHT) & (length[:, 0] > 0)
    which = np.flatnonzero(bent)
    flat = []
    for k in which:
        axis = np.eye(3)[np.argmin(np.abs(unit[k]))]
        right = np.cross(axis, unit[k])
        right /= np.linalg.norm(right)
        flat.append(ring[k] @ np.stack([right, np.cross(unit[k], right)], axis=1))
    return which, flat


def _without_ears(ring: Float) -> Index:
    """(N - 2, 3): the triangles of a polygon (N, 2) that turns to the left."""
    if len(ring) > _MOST_CORNERS:
        raise InputError(f"a polygon that is not convex has {len(ring)} corners; allowed are at most {_MOST_CORNERS}")
    left = list(range(len(ring)))
    found: list[tuple[int, ...]] = []
    k, tried, strict = 0, 0, True
    while len(left) > 3:
        a, b, c = (left[(k + step) % len(left)] for step in (-1, 0, 1))
        if _is_ear(ring, left, (k - 1) % len(left), a, b, c, strict):
            found.append((a, b, c))
            del left[k]
            k, tried, strict = (k if k < len(left) else 0), 0, True
            k = (k - 1) % len(left)
            continue
        k, tried = (k + 1) % len(left), tried + 1
        if tried == len(left):
            if not strict:  # it crosses itself: any corner will do
                found.append(tuple(left[(k + step) % len(left)] for step in (-1, 0, 1)))
                del left[k]
                k %= len(left)
            tried, strict = 0, not strict
    found.append(tuple(left))
    return np.array(found, dtype=np.int64)


def _is_ear(ring: Float, left: list[int], at: int, a: int, b: int, c: int, strict: bool) -> bool:
    """Whether corner b between a, at place `at` of those left, and c can be cut off.

    Not strict: corners on a line are ears, too.
    """
    p, q, r = ring[a], ring[b], ring[c]
    turn = _turn(p, q, r)
    if turn < -(_STRAIGHT**2) or (strict and turn <= _STRAIGHT**2):
        return False
    if turn <= _STRAIGHT**2:
        return True
    points = ring[np.array(left)]
    same = (points == p).all(axis=1) | (points == q).all(axis=1) | (points == r).all(axis=1)
    sides = np.stack([_turn(p, q, points), _turn(q, r, points), _turn(r, p, points)])
    if ((sides >= 0).all(axis=0) & ~same).any():
        return False
    # A corner at the place of one of the three may still lead inside: its edges must not cross the cut.
    ahead = np.roll(points, -1, axis=0)
    apart = _turn(r, p, points) * _turn(r, p, ahead) < 0
    crosses = apart & (_turn_each(points, ahead, p) * _turn_each(points, ahead, r) < 0)
    return not crosses.any() and _leads_inside(ring, left, at, c)


def _leads_inside(ring: Float, left: list[int], at: int, c: int) -> bool:
    """Whether the cut from the corner at place `at` to c runs inside of the polygon where it starts."""
    before, here, after = (ring[left[(at + step) % len(left)]] for step in (-1, 0, 1))
    to = ring[c]
    first, second = _turn(before, here, to), _turn(here, after, to)
    if _turn(before, here, after) >= 0:
        return bool(first >= 0 and second >= 0)
    return not (first <= 0 and second <= 0)


def _turn(a: Float, b: Float, points: Float) -> Float:
    """Twice the area of triangles (a, b, point), > 0 where they turn to the left."""
    return (b[0] - a[0]) * (points[..., 1] - a[1]) - (b[1] - a[1]) * (points[..., 0] - a[0])


def _turn_each(a: Float, b: Float, point: Float) -> Float:
    """The same for many edges and one point."""
    return (b[:, 0] - a[:, 0]) * (point[1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (point[0] - a[:, 0])
