"""Sculpting: smooth bodies from round cones joined softly, as finely triangulated surfaces.

1. sample the body's distance on a coarse grid          `_grid`
2. put one vertex into each cell that the surface cuts  `_surface_nets`, [1]
3. split every triangle in four and pull the vertices back onto the body, twice  `_split`, `_settle`

Nothing here is exact distance; it is near enough for Newton's steps along the gradient.

References
----------
.. [1] Gibson (1998), Constrained Elastic Surface Nets.
"""

from collections.abc import Callable

import numpy as np

from refdof._check import Float, Index
from refdof.scene.kit.mesh import Mesh

__all__ = ["Body", "merged", "sculpt", "soft_union"]

Body = Callable[[Float], Float]  # (N, 3) -> (N,): below 0 inside

_FAR = 0.2  # distances are told up to here


def soft_union(cones: Float, soft: float) -> Body:
    """Body of round cones (K, 9): end a (3), end b (3), radii at a and b, flatness of z (1: round)."""

    def distance(points: Float) -> Float:
        total = np.full(len(points), _FAR)
        for ax, ay, az, bx, by, bz, ra, rb, flat in cones:
            # Only points in the cone's own box, widened by as far as distances are told.
            wide = max(ra, rb) + _FAR
            near = np.abs(points[:, 1] - 0.5 * (ay + by)) < 0.5 * abs(ay - by) + wide
            near &= np.abs(points[:, 0] - 0.5 * (ax + bx)) < 0.5 * abs(ax - bx) + wide
            k = np.flatnonzero(near)
            x, y, z = points[k].T
            px, py, pz = x - ax, y - ay, (z - az) / flat
            ex, ey, ez = bx - ax, by - ay, (bz - az) / flat
            t = np.clip((px * ex + py * ey + pz * ez) / max(ex * ex + ey * ey + ez * ez, 1e-12), 0.0, 1.0)
            px, py, pz = px - t * ex, py - t * ey, pz - t * ez
            to_cone = (np.sqrt(px * px + py * py + pz * pz) - ra - t * (rb - ra)) * min(1.0, flat)
            total[k] = merged(total[k], to_cone, soft)
        return total

    return distance


def merged(one: Float, other: Float, soft: float) -> Float:
    """Smooth minimum (quadratic): the union of two bodies, its groove filled over a width of `soft`."""
    h = np.maximum(soft - np.abs(one - other), 0.0)
    return np.minimum(one, other) - h * h / (4.0 * soft)


def sculpt(body: Body, low: tuple[float, float, float], high: tuple[float, float, float], cell: float) -> Mesh:
    """Triangulate `body` inside a box.

    Parameters
    ----------
    body : function of (N, 3) points
    low, high : corners of a box that holds the body
    cell : float
        Size of the coarse grid; the mesh's edges are about a quarter of it.
    """
    vertices, faces = _surface_nets(_grid(body, low, high, cell), np.asarray(low), cell)
    vertices = _settle(body, vertices, cell, 2)
    vertices, faces = _split(vertices, faces)
    vertices = _settle(body, vertices, cell / 2, 1)
    vertices, faces = _split(vertices, faces)
    vertices = vertices - np.clip(body(vertices), -cell / 4, cell / 4)[:, None] * _normals(vertices, faces)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    faces = faces[(np.cross(b - a, c - a) != 0.0).any(axis=1)]
    normal = _normals(vertices, faces)
    # Ambient darkening: how far the body stands back along the normal, near and far.
    open_ = [np.clip(body(vertices + r * normal) / r, 0.0, 1.0) for r in (0.045, 0.16)]
    shade = (0.35 + 0.65 * open_[0]) * (0.45 + 0.55 * open_[1])
    uv = np.column_stack([vertices[:, 0] + 0.7 * vertices[:, 2], vertices[:, 1]])
    return Mesh(vertices, faces, uv, np.repeat(shade[:, None], 3, axis=1), normal)


def _grid(body: Body, low: tuple, high: tuple, cell: float) -> Float:
    axes = [np.arange(a, b + cell, cell) for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return body(points.reshape(-1, 3)).reshape(points.shape[:3])


def _surface_nets(values: Float, low: Float, cell: float) -> tuple[Float, Index]:
    """One vertex in each cut cell at the mean of its edge crossings, one square across each cut edge."""
    shape = np.array(values.shape) - 1
    total, count = np.zeros((*shape, 3)), np.zeros(shape)
    corner = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]

    def at(c: tuple[int, ...]) -> Float:
        return values[tuple(slice(o, o + n) for o, n in zip(c, shape, strict=True))]

    for a in corner:
        for axis in range(3):
            if a[axis]:
                continue
            b = tuple(v + (i == axis) for i, v in enumerate(a))
            va, vb = at(a), at(b)
            cut = (va < 0) != (vb < 0)
            t = np.where(cut, va / np.where(cut, va - vb, 1.0), 0.0)
            for i in range(3):
                total[..., i] += np.where(cut, a[i] + (t if i == axis else 0.0), 0.0)
            count += cut
    used = count > 0
    index = np.full(shape, -1)
    index[used] = np.arange(used.sum())
    cells = np.argwhere(used)
    vertices = low + cell * (cells + total[used] / count[used][:, None])
    faces = []
    for axis in range(3):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        inside = values < 0
        first = np.take(inside, range(shape[axis]), axis=axis)
        second = np.take(inside, range(1, shape[axis] + 1), axis=axis)
        for flip, edges in ((False, first & ~second), (True, ~first & second)):
            e = np.argwhere(edges)
            step = np.zeros((2, 3), dtype=int)
            step[0, i], step[1, j] = 1, 1
            quad = [index[tuple((e - d).T)] for d in (0 * step[0], step[0], step[0] + step[1], step[1])]
            if flip:
                quad = quad[::-1]
            faces += [
                np.stack([quad[0], quad[1], quad[2]], axis=1),
                np.stack([quad[0], quad[2], quad[3]], axis=1),
            ]
    return vertices, np.concatenate(faces)


def _settle(body: Body, points: Float, reach: float, steps: int) -> Float:
    """Newton's steps onto the surface along the gradient, each shorter than `reach`."""
    for _ in range(steps):
        value = body(points)
        d = 0.02 * reach
        gradient = np.stack([(body(points + d * np.eye(3)[k]) - value) / d for k in range(3)], axis=1)
        square = np.maximum((gradient * gradient).sum(axis=1), 0.05)
        points = points - np.clip(value / square, -reach, reach)[:, None] * gradient
    return points


def _split(vertices: Float, faces: Index) -> tuple[Float, Index]:
    """Four triangles from each, with shared middles."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    key, back = np.unique(edges[:, 0] * len(vertices) + edges[:, 1], return_inverse=True)
    middle = 0.5 * (vertices[key // len(vertices)] + vertices[key % len(vertices)])
    ab, bc, ca = back.reshape(3, -1) + len(vertices)
    a, b, c = faces.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([vertices, middle]), np.concatenate([np.stack(p, axis=1) for p in parts])


def _normals(vertices: Float, faces: Index) -> Float:
    """Vertex normals weighted by area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    total = np.stack(
        [sum(np.bincount(faces[:, k], cross[:, i], len(vertices)) for k in range(3)) for i in range(3)],
        axis=1,
    )
    return total / np.maximum(np.sqrt((total * total).sum(axis=1, keepdims=True)), 1e-12)
