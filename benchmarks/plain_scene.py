"""A scene reduced to what every renderer here can show with the same work: triangles with vertex colours.

Textures are replaced by their value at the vertices, shading by the unlit colour; shapes and lens stay.
"""

from dataclasses import replace

import numpy as np

import refdof

__all__ = ["plain"]


def plain(scene: refdof.Scene) -> refdof.Scene:
    """`scene` unlit, with one white material and everything else in its vertex colours."""
    color = scene.color.astype(np.float64)
    for k, material in enumerate(scene.materials):
        mine = np.unique(scene.faces[scene.face_material == k])
        color[mine] *= material.base_color
        if material.texture is not None:
            color[mine] *= _texels(material.texture, scene.uv[mine])
        color[mine] += material.emission
    return replace(
        scene,
        color=color.astype(np.float32),
        materials=(refdof.Material("unlit"),),
        face_material=np.zeros_like(scene.face_material),
    )


def _texels(texture: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Nearest texels (N, 3); (0, 0) is the lower left corner, row 0 the top row, repeated."""
    height, width, _ = texture.shape
    column = np.floor(uv[:, 0] * width).astype(np.int64) % width
    row = np.floor((1.0 - uv[:, 1]) * height).astype(np.int64) % height
    return texture[row, column]
