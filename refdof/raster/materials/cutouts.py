"""Cut-outs: how opaque a surface is at a point, for kernels. What it means: `refdof.scene.material`.

An opaque scene has an empty record, and pays nothing.
"""

from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import borrow, inline
from refdof.image.bilinear import bilinear
from refdof.raster.materials.texel import TEXTURE_COLUMNS, texel_weights
from refdof.scene.material import WRAPS, Material
from refdof.scene.scene import Scene

__all__ = ["OPAQUE", "Cutouts", "borrow_cutouts", "cutouts_of", "may_blend", "opacity_at", "pack_textures", "some_of"]

_OPACITY, _CUTOFF = TEXTURE_COLUMNS, TEXTURE_COLUMNS + 1
_BLENDED = -1.0  # in the place of a cutoff


class Cutouts(NamedTuple):
    """F triangles, K materials that are not opaque, T texels; F = 0 if the whole scene is opaque.

    material (F,) int32: row of `table`, -1: opaque; corner (F, 9) float32: (u, v, opacity) of the three corners;
    table (K, 7) float64: texture of opacities (`refdof.raster.materials.texel`), opacity, cutoff (-1: blended);
    texels (T,) float32; blends: whether some material is blended.
    """

    material: Index
    corner: Float
    table: Float
    texels: Float
    blends: bool


OPAQUE = Cutouts(
    np.zeros(0, dtype=np.int32),
    np.zeros((0, 9), dtype=np.float32),
    np.zeros((0, TEXTURE_COLUMNS + 2)),
    np.zeros(0, dtype=np.float32),
    False,
)


def cutouts_of(scene: Scene) -> Cutouts:
    """The record of a scene."""
    faded: Index = np.zeros(len(scene.materials), dtype=np.bool_)
    if scene.opacity is not None:
        fades = (scene.opacity[scene.faces] < 1.0).any(axis=1)
        faded[np.unique(scene.face_material[fades])] = True
    chosen = [k for k, m in enumerate(scene.materials) if faded[k] or m.opacity < 1.0 or m.opacity_texture is not None]
    materials = [scene.materials[k] for k in chosen]
    textures, texels = pack_textures([m.opacity_texture for m in materials], materials)
    cutoffs = [_BLENDED if m.cutoff is None else m.cutoff for m in materials]
    table = np.column_stack([textures, [m.opacity for m in materials], cutoffs]).reshape(-1, TEXTURE_COLUMNS + 2)
    row = np.full(len(scene.materials), -1, dtype=np.int32)
    row[chosen] = np.arange(len(chosen))
    faces = scene.faces if chosen else scene.faces[:0]
    opacity = np.ones(len(scene.vertices), dtype=np.float32) if scene.opacity is None else scene.opacity
    corner = np.concatenate([scene.uv[faces], opacity[faces][..., None]], axis=2)
    return Cutouts(
        row[scene.face_material[: len(faces)]],
        np.ascontiguousarray(corner.reshape(-1, 9), dtype=np.float32),
        table.astype(np.float64),
        texels.reshape(-1),
        _BLENDED in cutoffs,
    )


def some_of(cutouts: Cutouts, chosen: Index) -> Cutouts:
    """The record of some triangles."""
    if not len(cutouts.material):
        return cutouts
    return cutouts._replace(material=cutouts.material[chosen], corner=cutouts.corner[chosen])


def pack_textures(textures: list[Float | None], materials: list[Material]) -> tuple[Index, Float]:
    """A table (K, 5) of textures for kernels, and one flat list of texels; a shared texture is stored once."""
    first: dict[int, int] = {}
    blocks, total = [], 0
    table = np.zeros((len(materials), TEXTURE_COLUMNS), dtype=np.int64)
    for k, (texture, material) in enumerate(zip(textures, materials, strict=True)):
        if texture is None:
            continue
        height, width = texture.shape[:2]
        if id(texture) not in first:
            first[id(texture)] = total
            blocks.append(np.asarray(texture, dtype=np.float32).reshape(height * width, -1))
            total += height * width
        table[k] = first[id(texture)], width, height, *(WRAPS.index(wrap) for wrap in material.wrap)
    return table, np.concatenate(blocks) if blocks else np.zeros((0, 3), dtype=np.float32)


@inline
def borrow_cutouts(c):
    """`Cutouts` whose arrays are borrowed, for a tile kernel's inner loops."""
    return Cutouts(borrow(c.material), borrow(c.corner), borrow(c.table), borrow(c.texels), c.blends)


@inline
def opacity_at(cutouts, face, u, v):
    """Opacity of a triangle at barycentrics (u, v): 0 or 1 where a material has a cutoff."""
    if len(cutouts.material) == 0 or cutouts.material[face] < 0:
        return 1.0
    row, c, w = cutouts.table[cutouts.material[face]], cutouts.corner[face], 1.0 - u - v
    # Differences, so that three equal numbers give just that number: an opacity may be the cutoff itself.
    opacity = row[_OPACITY] * (c[2] + u * (np.float64(c[5]) - c[2]) + v * (np.float64(c[8]) - c[2]))
    if row[1] > 0.0:
        s, t = w * c[0] + u * c[3] + v * c[6], w * c[1] + u * c[4] + v * c[7]
        k, n, m, o, a, b = texel_weights(row, s, t)
        texels = cutouts.texels
        opacity *= bilinear(texels[k], texels[n], texels[m], texels[o], a, b)
    if row[_CUTOFF] == _BLENDED:
        return min(max(opacity, 0.0), 1.0)
    return 1.0 if np.float32(opacity) >= np.float32(row[_CUTOFF]) else 0.0  # as files state both


@inline
def may_blend(cutouts, face):
    """Whether a triangle's material is blended."""
    return cutouts.blends and cutouts.material[face] >= 0 and cutouts.table[cutouts.material[face], _CUTOFF] == _BLENDED
