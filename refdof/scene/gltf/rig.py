"""Rig: what moves the vertices of a glTF file. Nodes, skins and morph targets at any time, as arrays.

1. keyframes set translations, rotations, scales and morph weights   `refdof.scene.gltf.keyframes`
2. nodes stand in their parents                                      `refdof.scene.gltf.nodes`
3. morph targets are added to a mesh, by weight                      `_morphed`
4. a node moves its mesh; where it has a skin, the joints do         `_moved`
5. a file's own normals turn with the surface; others are means      `_normals`

A skin's joints move a vertex by the sum of their matrices by weight, [1] 3.7.3.3, in sets of four. Weights are divided
by their sum; where all are 0, the first joint counts. Tangents are not used.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.7 (geometry, skins, morph targets).
"""

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, InputError, as_float
from refdof.scene.animation import FRAMES_PER_SECOND, Animation, Pose
from refdof.scene.gltf.camera import gltf_camera
from refdof.scene.gltf.file import Numbers, member
from refdof.scene.gltf.keyframes import Channel, channels_of, value_at
from refdof.scene.gltf.nodes import PATHS, Tree, matrix_of
from refdof.scene.smooth_normals import mean_normals, shared_normals

__all__ = ["Limb", "Rig", "animation_of", "is_rigged", "read_rig", "turned_normals"]

_ON_FRAME = 1e-3  # of a frame: times are float32, whose last digit is less in the first 10000 frames


class Limb(NamedTuple):
    """A primitive under a node, as the scene has it: V vertices and F faces."""

    node: int
    mesh: int
    primitive: int
    source: Index  # (V,) the primitive's vertex that each copies
    vertices: Float  # (V, 3) in the node
    normal: Float  # (V, 3) in the node
    faces: Index  # (F, 3)
    states_normals: bool  # the file does


class Rig(NamedTuple):
    """What a file says of its motion."""

    header: dict[str, Any]
    numbers: Numbers
    tree: Tree
    channels: tuple[Channel, ...]


class _Skin(NamedTuple):
    joints: tuple[int, ...]  # nodes
    inverse_bind: Float  # (J, 4, 4)


class _Part(NamedTuple):
    """A limb with all that moves it: T morph targets, K joints a vertex."""

    limb: Limb
    group: Index  # (V,) of mean normals
    skin: _Skin | None
    joints: Index  # (V, K), into the skin's
    weights: Float  # (V, K)
    rest: Float  # (T,) morph weights that the file has without an animation
    shifts: Float  # (T, V, 3) of vertices
    turns: Float  # (T, V, 3) of normals


def is_rigged(header: dict[str, Any]) -> bool:
    """Whether more than its nodes' own transforms places a file's vertices."""
    if any(header.get(kind) for kind in ("animations", "skins")):
        return True
    return any("targets" in p for mesh in header.get("meshes", []) for p in mesh.get("primitives", []))


def read_rig(header: dict[str, Any], numbers: Numbers, tree: Tree) -> Rig:
    """Read a file's first animation.

    Raises
    ------
    InputError
        If the animation is not as the specification demands.
    """
    return Rig(header, numbers, tree, channels_of(header, numbers))


def animation_of(rig: Rig, limbs: Sequence[Limb]) -> Animation:
    """Poses of a scene whose vertices are those of `limbs`, one after the other.

    Raises
    ------
    InputError
        If skins, joints, weights or morph targets are not as the specification demands.
    """
    ends = [channel.times[[0, -1]] * FRAMES_PER_SECOND for channel in rig.channels] or [np.zeros(2)]
    first = int(np.floor(np.min(ends) + _ON_FRAME))
    last = max(first, int(np.ceil(np.max(ends) - _ON_FRAME)))
    return Animation(first, last, partial(_pose, rig, tuple(_part(rig, limb) for limb in limbs)))


def _pose(rig: Rig, parts: Sequence[_Part], frame: float) -> Pose:
    with np.errstate(all="ignore"):  # transforms may hold any numbers; `Scene` judges what comes out
        moved = {(channel.node, channel.path): value_at(channel, frame / FRAMES_PER_SECOND) for channel in rig.channels}
        local = [_local(node, index, moved) for index, node in enumerate(rig.header.get("nodes", []))]
        world = rig.tree.worlds(local)
        vertices: list[Float] = [np.zeros((0, 3))]
        normal: list[Float] = [np.zeros((0, 3))]
        for part in parts:
            weights = moved.get((part.limb.node, "weights"), part.rest)
            shape = _morphed(part.limb.vertices, weights, part.shifts)
            matrix = _moved(part, world)
            vertices.append(_placed(shape, matrix))
            normal.append(_normals(part, vertices[-1], weights, matrix[..., :3]))
    return Pose(np.concatenate(vertices), np.concatenate(normal), gltf_camera(rig.header, local))


def _local(node: dict[str, Any], index: int, moved: dict[tuple[int, str], Float]) -> Float:
    return matrix_of({**node, **{path: moved[index, path] for path in PATHS if (index, path) in moved}})


def _morphed(values: Float, weights: Float, shifts: Float) -> Float:
    return values + np.tensordot(weights, shifts, axes=1) if len(shifts) else values


def _moved(part: _Part, world: Sequence[Float]) -> Float:
    """World from mesh, the upper three rows: (3, 4) of a node, (V, 3, 4) of a skin, whose node does not count."""
    if part.skin is None:
        return world[part.limb.node][:3]
    joints = np.stack([world[joint] for joint in part.skin.joints]) @ part.skin.inverse_bind
    return np.einsum("vk,vkij->vij", part.weights, joints[part.joints, :3])


def _placed(vertices: Float, matrix: Float) -> Float:
    if matrix.ndim == 2:
        return vertices @ matrix[:, :3].T + matrix[:, 3]
    return np.einsum("vij,vj->vi", matrix[:, :, :3], vertices) + matrix[:, :, 3]


def _normals(part: _Part, vertices: Float, weights: Float, matrix: Float) -> Float:
    if not part.limb.states_normals:
        return mean_normals(vertices, part.limb.faces, part.group)
    normal = turned_normals(_morphed(part.limb.normal, weights, part.turns), matrix)
    lost = ~(np.isfinite(normal).all(axis=1) & normal.any(axis=1))
    normal[lost] = (0.0, 0.0, 1.0)  # a surface shrunk to nothing
    return normal


def turned_normals(normal: Float, matrix: Float) -> Float:
    """Unit normals (V, 3) of a surface moved by a matrix (3, 3), or by one each (V, 3, 3); NaN where none is left."""
    x, y, z = (matrix[..., k] for k in range(3))
    # The cofactor matrix turns normals as the matrix turns surfaces, even where it has no inverse.
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-2)
    turned = normal @ cofactors if matrix.ndim == 2 else np.einsum("vi,vij->vj", normal, cofactors)
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    with np.errstate(all="ignore"):
        return np.where((length > 0.0) & np.isfinite(length), turned / length, np.nan)


def _part(rig: Rig, limb: Limb) -> _Part:
    mesh, node = member(rig.header, "meshes", limb.mesh), member(rig.header, "nodes", limb.node)
    primitive = member(mesh, "primitives", limb.primitive)
    name, count = f"mesh {limb.mesh}, primitive {limb.primitive}", len(limb.source)

    def rows(what: str, values: Float | Index) -> Any:
        """A primitive's numbers, as the scene has its vertices."""
        whole = member(rig.header, "accessors", primitive["attributes"]["POSITION"])["count"]
        if len(values) != whole:
            raise InputError(f"{name}: {what} has {len(values)} items; allowed are as many as POSITION's {whole}")
        return values[limb.source]

    skin, joints, weights = None, np.zeros((count, 0), dtype=np.int64), np.zeros((count, 0))
    if "skin" in node:
        skin = _skin(rig, node["skin"])
        sets = sorted(key for key in primitive["attributes"] if key.startswith("JOINTS_"))
        if not sets:
            raise InputError(f"{name}: node {limb.node} has a skin; allowed is one with JOINTS_0 and WEIGHTS_0")
        for key in sets:
            other = key.replace("JOINTS", "WEIGHTS")
            which = rig.numbers.indices(f"{name}: {key}", primitive["attributes"][key], "VEC4", len(skin.joints))
            much = rig.numbers.floats(f"{name}: {other}", primitive["attributes"].get(other), "VEC4")
            joints = np.concatenate([joints, rows(key, which)], axis=1)
            weights = np.concatenate([weights, rows(other, much)], axis=1)
        whole = weights.sum(axis=1, keepdims=True)
        weights = np.where(whole > 0.0, weights / np.where(whole > 0.0, whole, 1.0), np.eye(weights.shape[1])[0])
    shifts: list[Float] = []
    turns: list[Float] = []
    for index, target in enumerate(primitive.get("targets", [])):
        for key, found in (("POSITION", shifts), ("NORMAL", turns)):
            what = f"{name}: target {index}, {key}"
            shift = rows(what, rig.numbers.floats(what, target[key], "VEC3")) if key in target else np.zeros((count, 3))
            found.append(shift)
    rest = node.get("weights", mesh.get("weights", [0.0] * len(shifts)))
    rest = as_float(f"{name}: weights", rest, (len(shifts),), dtype=np.float64)
    for channel in rig.channels:
        if channel.node == limb.node and channel.path == "weights" and channel.values.shape[-1] != len(shifts):
            raise InputError(
                f"{name}: the animation has {channel.values.shape[-1]} weights; allowed are {len(shifts)}, one a target"
            )
    group = shared_normals(limb.vertices, limb.normal)
    none = np.zeros((0, count, 3))
    stack = np.stack([shifts, turns]) if shifts else np.stack([none, none])
    return _Part(limb, group, skin, joints, weights, rest, stack[0], stack[1])


def _skin(rig: Rig, index: Any) -> _Skin:
    skin = member(rig.header, "skins", index)
    joints = tuple(skin.get("joints", ()))
    for joint in joints:
        member(rig.header, "nodes", joint)
    if not joints:
        raise InputError(f"skins {index}: has no joints; allowed is at least one")
    inverse: Float = np.tile(np.eye(4), (len(joints), 1, 1))
    if "inverseBindMatrices" in skin:
        stored = rig.numbers.floats(f"skins {index}: inverseBindMatrices", skin["inverseBindMatrices"], "MAT4")
        if len(stored) < len(joints):
            raise InputError(f"skins {index}: has {len(stored)} matrices; allowed are {len(joints)}, one a joint")
        inverse = stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    return _Skin(joints, inverse)
