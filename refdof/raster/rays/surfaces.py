"""Surfaces: a scene as flat arrays in camera space, one record per triangle, so that a hit touches few cache lines.

References
----------
.. [1] Moeller & Trumbore (1997), Fast, Minimum Storage Ray/Triangle Intersection, Journal of Graphics Tools 2(1).
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof.optics.camera import Camera
from refdof.raster.materials.cutouts import Cutouts, cutouts_of, pack_textures
from refdof.scene.material import SHADINGS
from refdof.scene.scene import Scene

__all__ = ["Surfaces", "borrow_surfaces", "cutouts_in", "intersect", "surfaces_of"]


class Surfaces(NamedTuple):
    """A scene for kernels: F triangles, K materials, T texels.

    `attribute` holds, for the three corners, color (9), uv (6) and normal (9). Lengths are in units of
    2^exponent scene units, so that Embree's float32 sees moderate numbers; a power of two changes no bit.
    """

    corner: Float  # (F, 9) float64, camera space
    attribute: Float  # (F, 24) float32, normals in camera space
    face_material: Index  # (F,) int32
    shading: Index  # (K,) index into SHADINGS
    base_color: Float  # (K, 3)
    emission: Float  # (K, 3)
    specular: Float  # (K, 3)
    shininess: Float  # (K,)
    texture: Index  # (K, 5): `refdof.raster.materials.texel`
    emission_texture: Index  # (K, 5)
    texels: Float  # (T, 3) float32, linear RGB
    light: Float  # (6, 3): sun direction (camera space), sun, sky, ground, up (camera space), background
    environment: Float  # (n, n, 3) float32, octahedral; n = 0: the dome
    world_from_camera: Float  # (3, 3)
    cut_material: Index  # the fields of `Cutouts`, which parallel kernels do not take as a tuple within a tuple
    cut_corner: Float
    cut_table: Float
    cut_texels: Float
    blends: bool
    exponent: int

    @property
    def cutouts(self) -> Cutouts:
        """How opaque the triangles are; `cutouts_in` for kernels."""
        return Cutouts(self.cut_material, self.cut_corner, self.cut_table, self.cut_texels, self.blends)


def surfaces_of(scene: Scene, camera: Camera) -> Surfaces:
    """Flatten `scene` as seen from `camera`."""
    scene = replace(scene)  # checks it again: its arrays may have been written to
    points = camera.camera_from_world(scene.vertices)
    extent = np.abs(points).max(initial=0.0)
    exponent = int(math.frexp(extent)[1]) if extent > 0 else 0
    points = np.ldexp(points, -exponent)
    rotation = camera.rotation
    faces = scene.faces
    attribute = np.concatenate(
        [
            scene.color[faces].reshape(-1, 9),
            scene.uv[faces].reshape(-1, 6),
            (scene.normal.astype(np.float64) @ rotation.T)[faces].reshape(-1, 9),
        ],
        axis=1,
    )
    materials, light = scene.materials, scene.light
    textures, texels = pack_textures(
        [*(m.texture for m in materials), *(m.emission_texture for m in materials)], [*materials, *materials]
    )
    environment = light.environment
    return Surfaces(
        np.ascontiguousarray(points[faces].reshape(-1, 9)),
        np.ascontiguousarray(attribute, dtype=np.float32),
        scene.face_material.astype(np.int32),
        np.array([SHADINGS.index(m.shading) for m in materials], dtype=np.int32),
        np.array([m.base_color for m in materials]).reshape(-1, 3),
        np.array([m.emission for m in materials]).reshape(-1, 3),
        np.array([m.specular for m in materials]).reshape(-1, 3),
        np.array([m.shininess for m in materials]),
        textures[: len(materials)],
        textures[len(materials) :],
        texels,
        np.array(
            [
                rotation @ np.asarray(light.sun_direction),
                light.sun,
                light.sky,
                light.ground,
                rotation @ np.array([0.0, 1.0, 0.0]),
                scene.background,
            ]
        ),
        np.zeros((0, 0, 3), dtype=np.float32) if environment is None else environment,
        np.ascontiguousarray(rotation.T),
        *cutouts_of(scene),
        exponent,
    )


@inline
def borrow_surfaces(s):
    """`Surfaces` whose arrays are borrowed, for a tile kernel's inner loops."""
    return Surfaces(
        borrow(s.corner),
        borrow(s.attribute),
        borrow(s.face_material),
        borrow(s.shading),
        borrow(s.base_color),
        borrow(s.emission),
        borrow(s.specular),
        borrow(s.shininess),
        borrow(s.texture),
        borrow(s.emission_texture),
        borrow(s.texels),
        borrow(s.light),
        borrow(s.environment),
        borrow(s.world_from_camera),
        borrow(s.cut_material),
        borrow(s.cut_corner),
        borrow(s.cut_table),
        borrow(s.cut_texels),
        s.blends,
        s.exponent,
    )


@inline
def cutouts_in(s):
    """The `Cutouts` of `Surfaces`, for kernels."""
    return Cutouts(s.cut_material, s.cut_corner, s.cut_table, s.cut_texels, s.blends)


@inline
def intersect(corner, face, ox, oy, oz, dx, dy, dz):
    """Where the ray meets the plane of a triangle, [1]: (t, u, v); t is inf if it runs within the plane.

    With dz = -1 and oz = 0, t is the planar depth.
    """
    ax, ay, az = corner[face, 0], corner[face, 1], corner[face, 2]
    ex, ey, ez = corner[face, 3] - ax, corner[face, 4] - ay, corner[face, 5] - az
    fx, fy, fz = corner[face, 6] - ax, corner[face, 7] - ay, corner[face, 8] - az
    px, py, pz = dy * fz - dz * fy, dz * fx - dx * fz, dx * fy - dy * fx
    determinant = ex * px + ey * py + ez * pz
    sx, sy, sz = ox - ax, oy - ay, oz - az
    qx, qy, qz = sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex
    if determinant == 0.0:
        return np.inf, 0.0, 0.0
    scale = 1.0 / determinant
    u = (sx * px + sy * py + sz * pz) * scale
    v = (dx * qx + dy * qy + dz * qz) * scale
    t = (fx * qx + fy * qy + fz * qz) * scale
    return t, u, v
