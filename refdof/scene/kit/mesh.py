"""Triangle meshes of the built-in scenes: one record of arrays, and how to move, repeat and join it.

World space is y up. Every function returns a new mesh; arrays are never changed in place.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from refdof._check import Float, Index
from refdof.scene.material import Material
from refdof.scene.scene import Part

__all__ = ["Mesh", "join", "rotation", "scatter"]

_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, eq=False)
class Mesh:
    """V vertices with attributes and F triangles.

    Attributes
    ----------
    vertices : (V, 3) float64
    faces : (F, 3) int64
    uv : (V, 2) float64
    color : (V, 3) float64, linear; multiplies the material's
    normal : (V, 3) float64, unit
    """

    vertices: Float
    faces: Index
    uv: Float
    color: Float
    normal: Float

    def moved(self, x: float, y: float, z: float) -> "Mesh":
        """Shifted by (x, y, z)."""
        return replace(self, vertices=self.vertices + np.array([x, y, z]))

    def turned(self, axis: str, degrees: float) -> "Mesh":
        """Turned counter-clockwise about an axis through the origin."""
        matrix = rotation(axis, degrees)
        return replace(self, vertices=_apply(matrix, self.vertices), normal=_apply(matrix, self.normal))

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> "Mesh":
        """Scaled about the origin; one number scales all three axes."""
        factor = np.array([x, x if y is None else y, x if z is None else z])
        normal = self.normal / factor
        return replace(self, vertices=self.vertices * factor, normal=_unit(normal))

    def tinted(self, color: Float | tuple[float, float, float] | float) -> "Mesh":
        """With its colours multiplied by a grey, a colour (3,), or one per vertex: (V, 3), or grey (V, 1)."""
        return replace(self, color=self.color * np.asarray(color))

    def tiled(self, u: float, v: float) -> "Mesh":
        """With texture coordinates multiplied by (u, v)."""
        return replace(self, uv=self.uv * np.array([u, v]))

    def part(self, material: Material) -> Part:
        """As a part of a scene."""
        return Part(self.vertices, self.faces, material, self.uv, self.color, self.normal)


def join(meshes: Iterable[Mesh]) -> Mesh:
    """All meshes as one."""
    meshes = list(meshes)
    first = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + k for m, k in zip(meshes, first, strict=False)]),
        np.concatenate([m.uv for m in meshes]),
        np.concatenate([m.color for m in meshes]),
        np.concatenate([m.normal for m in meshes]),
    )


def scatter(mesh: Mesh, place: Float, turn: Float, size: Float, color: Float | None = None) -> Mesh:
    """N copies of a mesh.

    Parameters
    ----------
    place : (N, 3)
        Where the copy's origin goes.
    turn : (N, 3, 3)
        Rotations; columns are the copy's axes in the world.
    size : (N,)
    color : (N, 3), or None
        Multiplies the mesh's colours.
    """
    count, each = len(place), len(mesh.vertices)
    turn = np.asarray(turn)[:, None]
    vertices = _apply(turn, mesh.vertices[None]) * np.asarray(size)[:, None, None] + np.asarray(place)[:, None]
    normal = _apply(turn, mesh.normal[None])
    tint = np.ones((count, 3)) if color is None else np.asarray(color)
    return Mesh(
        vertices.reshape(-1, 3),
        (mesh.faces[None] + each * np.arange(count)[:, None, None]).reshape(-1, 3),
        np.tile(mesh.uv, (count, 1)),
        (mesh.color[None] * tint[:, None]).reshape(-1, 3),
        normal.reshape(-1, 3),
    )


def rotation(axis: str, degrees: float | Float) -> Float:
    """Rotation matrices (..., 3, 3) about "x", "y" or "z"."""
    angle = np.radians(np.asarray(degrees, dtype=np.float64))
    matrix = np.zeros((*angle.shape, 3, 3))
    k = _AXES[axis]
    i, j = (k + 1) % 3, (k + 2) % 3
    matrix[..., k, k] = 1.0
    matrix[..., i, i] = matrix[..., j, j] = np.cos(angle)
    matrix[..., j, i] = np.sin(angle)
    matrix[..., i, j] = -np.sin(angle)
    return matrix


def _apply(matrix: Float, vectors: Float) -> Float:
    """Rows of `vectors` (..., 3) times `matrix` (..., 3, 3), in one fixed order of operations."""
    x, y, z = vectors[..., 0:1], vectors[..., 1:2], vectors[..., 2:3]
    return x * matrix[..., :, 0] + y * matrix[..., :, 1] + z * matrix[..., :, 2]


def _unit(vectors: Float) -> Float:
    return vectors / np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
