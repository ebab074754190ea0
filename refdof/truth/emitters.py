"""Small lights: how many lens samples a pixel needs before a small bright light can be called absent.

A light that covers a share a of a pixel's lens is hit by N samples a N times. Few samples, or none of a whole
neighbourhood, then say "no light" with an error bar of zero. So where the blurred picture of a light brighter than
white falls, sampling starts with enough points to hit it several times.
"""

import math
from typing import Any

import numpy as np

from refdof._check import Float, Index
from refdof.scene.material import Material
from refdof.scene.scene import Scene
from refdof.view import View

__all__ = ["first_samples"]

_HITS = 8.0  # a share a is hit 8 times on average; missing it altogether is then a matter of e^-8 at worst


def first_samples(view: View, tolerance: float) -> Index:
    """Lens samples (H, W) that every pixel starts with, 1 where no small light needs more.

    Lights whose whole share of a pixel is below `tolerance` are left alone.
    """
    camera, lens = view.camera, view.lens
    wanted = np.ones((camera.height, camera.width), dtype=np.int64)
    faces, radiance, solid = _bright_faces(view.scene)
    if not len(faces) or lens.radius == 0.0:
        return wanted
    points = camera.project(view.scene.vertices)
    for group in _islands(view.scene.vertices, faces):
        corners = points[faces[group]]  # (n, 3, 3): x, y, depth
        if not (corners[..., 2] > 0.0).all():
            continue
        circle = lens.largest_circle_px(corners[..., 2], camera)
        a, b = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
        area = float(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) / 4.0  # half: a closed body is seen once
        area *= float(solid[group].mean())
        share = area / (math.pi * circle * circle) if circle > 0.0 else 1.0
        if circle < 0.5 or share >= 1.0 or not share > 0.0 or share * radiance[group].max() < tolerance:
            continue
        low = np.floor(corners[..., :2].min(axis=(0, 1)) - circle - 1.0)
        high = np.ceil(corners[..., :2].max(axis=(0, 1)) + circle + 1.0)
        x0, y0 = np.clip(low, 0, camera.size).astype(int)
        x1, y1 = np.clip(high, 0, camera.size).astype(int)
        np.maximum(wanted[y0:y1, x0:x1], math.ceil(_HITS / share), out=wanted[y0:y1, x0:x1])
    return wanted


def _bright_faces(scene: Scene) -> tuple[Index, Float, Float]:
    """Triangles (N, 3) that can send out more than white, the most they send (N,), and how much of them is no hole."""
    most = np.array([max(m.emission) * _brightest(m.emission_texture) for m in scene.materials])
    unlit = np.array([_albedo(m) if m.shading == "unlit" else 0.0 for m in scene.materials])
    if not len(most):
        return np.zeros((0, 3), dtype=np.int64), np.zeros(0), np.zeros(0)
    color = scene.color.max(axis=1)[scene.faces].max(axis=1)
    radiance = most[scene.face_material] + unlit[scene.face_material] * color
    bright = radiance > 1.0
    solid = np.array([_solid(m) for m in scene.materials])
    return scene.faces[bright], radiance[bright], solid[scene.face_material[bright]]


def _albedo(material: Material) -> float:
    return max(material.base_color) * _brightest(material.texture)


def _brightest(texture: Float | None) -> float:
    return 1.0 if texture is None else float(texture.max())


def _solid(material: Material) -> float:
    """Mean opacity, of a material's whole texture."""
    opacity: Any = np.float64(material.opacity)
    if material.opacity_texture is not None:
        opacity = opacity * material.opacity_texture
    return float(np.mean(opacity if material.cutoff is None else opacity >= material.cutoff))


def _islands(vertices: Float, faces: Index) -> list[Index]:
    """Groups of triangles that hang together at corners of equal position."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, place = np.unique(vertices[faces].reshape(-1, 3), axis=0, return_inverse=True)
    corner = place.reshape(-1, 3)
    edges = np.concatenate([corner[:, :2], corner[:, 1:]])
    count = int(corner.max()) + 1
    graph = coo_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    island = label[corner[:, 0]]
    order = np.argsort(island, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(island[order])) + 1)
