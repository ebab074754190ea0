"""Smooth shading normals for meshes that bring none: edges sharper than a crease angle stay sharp.

1. corners at the same place are one point                   `smooth_normals`
2. corners on both sides of a blunt edge join one group      `_blunt_edges`
3. a group's normal is the mean of its faces' normals, weighted by the angle at the corner [1]

References
----------
.. [1] Thürmer & Wüthrich (1998), Computing Vertex Normals from Polygonal Facets, J. Graphics Tools 3(1).
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, Index

__all__ = ["mean_normals", "shared_normals", "smooth_normals"]


def smooth_normals(vertices: Float, faces: Index, crease_degrees: float = 30.0) -> tuple[Index, Index, Float]:
    """Shading normals of a triangle mesh; vertices on creases are split.

    Parameters
    ----------
    vertices : (V, 3) float64
    faces : (F, 3) int64
        In range; triangles without area are allowed and count for nothing.
    crease_degrees : float
        Two faces that share an edge and whose normals differ by more are not smoothed across it.

    Returns
    -------
    source : (W,) int64, the vertex that each new vertex copies
    faces : (F, 3) int64, into the new vertices
    normal : (W, 3) float64, unit length

    Notes
    -----
    Neighbours are found by equal positions, so that seams of texture coordinates and triangle soups are
    smooth too. Where neighbours are wound in opposite directions the edge counts as a crease.
    """
    from scipy.sparse import coo_matrix  # slow to import
    from scipy.sparse.csgraph import connected_components

    point = _same_rows(vertices)[faces]
    corner = _corners(vertices, faces)
    face_normal = _face_normals(corner)

    first, second = _blunt_edges(point, face_normal, math.cos(math.radians(crease_degrees)))
    count = faces.size
    links = coo_matrix((np.ones(len(first), dtype=np.int8), (first, second)), shape=(count, count))
    groups, group = connected_components(links, directed=False)
    normal = _means(corner, face_normal, group, groups)

    # One new vertex for every pair of group and old vertex: seams keep both of their texture coordinates.
    pair, new_faces = np.unique(group.astype(np.int64) * len(vertices) + faces.ravel(), return_inverse=True)
    return pair % max(len(vertices), 1), new_faces.reshape(-1, 3), normal[pair // max(len(vertices), 1)]


def shared_normals(vertices: Float, normal: Float) -> Index:
    """(V,) int64: one number for vertices (V, 3) at one place with one normal (V, 3), which are smooth together."""
    return _same_rows(np.concatenate([vertices, normal], axis=1))


def mean_normals(vertices: Float, faces: Index, group: Index) -> Float:
    """(V, 3) float64 unit normals where vertices moved: of each `group` (V,), as step 3 has it; no edge is split."""
    corner = _corners(vertices, faces)
    groups = int(group.max(initial=-1)) + 1
    return _means(corner, _face_normals(corner), group[faces].ravel(), groups)[group]


def _same_rows(values: Float) -> Index:
    """(N,) int64: one number for equal rows (N, C)."""
    return np.unique(values + 0.0, axis=0, return_inverse=True)[1].ravel()  # + 0.0: -0 and 0 are one


def _corners(vertices: Float, faces: Index) -> Float:
    """(F, 3, 3), scaled so that tiny meshes do not underflow."""
    extent = np.ptp(vertices, axis=0).max() if len(vertices) else 0.0
    return vertices[faces] / (extent if extent > 0 else 1.0)


def _face_normals(corner: Float) -> Float:
    """(F, 3) unit normals; zero where a triangle has no area."""
    return _unit(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))


def _means(corner: Float, face_normal: Float, group: Index, groups: int) -> Float:
    """(G, 3) unit normals of groups of corners; `group` (3 F,)."""
    weighted = (_corner_angles(corner)[:, :, None] * face_normal[:, None, :]).reshape(-1, 3)
    sums: Float = np.zeros((groups, 3))
    for k in range(3):
        sums[:, k] = np.bincount(group, weighted[:, k], minlength=groups)
    normal = _unit(sums)
    normal[(normal == 0.0).all(axis=1)] = (0.0, 0.0, 1.0)  # only triangles without area meet here
    return normal


def _blunt_edges(point: Index, face_normal: Float, cosine: float) -> tuple[Index, Index]:
    """Pairs of corners (indices into faces.ravel()) at one end of an edge blunter than the crease."""
    start, end = point.ravel(), point[:, [1, 2, 0]].ravel()
    here = np.arange(point.size)
    there = here.reshape(-1, 3)[:, [1, 2, 0]].ravel()
    flip = start > end
    low, high = np.where(flip, there, here), np.where(flip, here, there)  # corners at the edge's two ends
    key = np.minimum(start, end) * (int(point.max(initial=0)) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    a, b = order[:-1], order[1:]
    cosines = (face_normal[a // 3] * face_normal[b // 3]).sum(axis=1)
    blunt = (key[a] == key[b]) & (cosines >= cosine)
    a, b = a[blunt], b[blunt]
    return np.concatenate([low[a], high[a]]), np.concatenate([low[b], high[b]])


def _corner_angles(corner: Float) -> Float:
    """(F, 3): the angle [rad] of every triangle at its corners (F, 3, 3)."""
    ahead = corner[:, [1, 2, 0]] - corner
    behind = corner[:, [2, 0, 1]] - corner
    sine = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.arctan2(sine, (ahead * behind).sum(axis=2))


def _unit(vectors: Float) -> Float:
    """(N, 3) vectors at unit length; zero stays zero."""
    largest = np.abs(vectors).max(axis=1, keepdims=True, initial=0.0)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length: Any = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)
