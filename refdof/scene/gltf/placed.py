"""Placed: the meshes of a glTF file under the nodes of its scene, and copies of them by EXT_mesh_gpu_instancing.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.5 (scenes, nodes).
.. [2] Khronos Group: EXT_mesh_gpu_instancing, KHR_node_visibility.
"""

from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, Index, InputError, as_integer
from refdof.scene.formats.reading import Reading, Surface
from refdof.scene.gltf.file import Numbers, member, table_of
from refdof.scene.gltf.materials import Materials
from refdof.scene.gltf.nodes import PATHS, Tree, local_matrix
from refdof.scene.gltf.primitives import read_primitive

__all__ = ["Placed", "copied", "copied_faces", "read_placed"]

_INSTANCES = "EXT_mesh_gpu_instancing"


class Placed(NamedTuple):
    """A primitive under a node, in the node's space, with the `copies` (N, 4, 4) that the node makes of it, or None."""

    node: int
    mesh: int
    primitive: int
    surface: Surface
    copies: Float | None


def read_placed(header: dict[str, Any], numbers: Numbers, tree: Tree, reading: Reading) -> list[Placed]:
    """All primitives of the scene that the file opens with, parents first.

    Raises
    ------
    InputError
        If something is not as the specification demands, or there is more than the limits allow.
    """
    materials = Materials(header, numbers, reading)
    made: dict[tuple[int, int], Surface | None] = {}
    found = []
    for index in _drawn(header, tree):
        node = member(header, "nodes", index)
        if "mesh" not in node:
            continue
        primitives = member(header, "meshes", node["mesh"]).get("primitives", [])
        copies = _copies(header, numbers, node, index, reading)
        count = 1 if copies is None else len(copies)
        reading.meter.instances(count * len(primitives) - 1)
        for k, primitive in enumerate(primitives):
            key = (node["mesh"], k)
            if key not in made:
                name = f"mesh {key[0]}, primitive {k}"
                made[key] = read_primitive(header, numbers, materials, reading, primitive, name)
            surface = made[key]
            if surface is not None and len(surface.faces):
                reading.meter.triangles(count * len(surface.faces))
                found.append(Placed(index, node["mesh"], k, surface, copies))
    return found


def _drawn(header: dict[str, Any], tree: Tree) -> list[int]:
    """The nodes of the scene that the file opens with, or of all trees if it has no scene; hidden ones are left out."""
    if header.get("scenes"):
        roots = set(member(header, "scenes", header.get("scene", 0)).get("nodes", []))
    else:
        roots = {node for node, parent in enumerate(tree.parent) if parent < 0}
    for root in roots:
        member(header, "nodes", root)
    state: list[bool] = [False] * len(tree.parent)
    hidden: list[bool] = [False] * len(tree.parent)
    for index in tree.order:
        parent = tree.parent[index]
        shown = table_of(table_of(member(header, "nodes", index), "extensions"), "KHR_node_visibility").get(
            "visible", True
        )
        hidden[index] = not shown or (parent >= 0 and hidden[parent])
        state[index] = index in roots or (parent >= 0 and state[parent])
    return [index for index in tree.order if state[index] and not hidden[index]]


def _copies(
    header: dict[str, Any], numbers: Numbers, node: dict[str, Any], index: int, reading: Reading
) -> Float | None:
    """(N, 4, 4) of the node's own instances; None if it has none."""
    attributes = table_of(table_of(table_of(node, "extensions"), _INSTANCES), "attributes")
    read = {path: attributes[path.upper()] for path in PATHS if path.upper() in attributes}
    if not read:
        return None
    name = f"nodes {index}, {_INSTANCES}"
    for path, accessor in read.items():
        count = as_integer(f"{name}: {path}: count", member(header, "accessors", accessor).get("count"), minimum=1)
        reading.meter.check_instances(count)
    values = {
        path: numbers.floats(f"{name}: {path}", accessor, f"VEC{len(PATHS[path])}", path == "rotation")
        for path, accessor in read.items()
    }
    counts = {len(rows) for rows in values.values()}
    if len(counts) != 1:
        raise InputError(f"{name}: attributes have {sorted(counts)} items; allowed are as many in each")
    count = counts.pop()
    rows = [values.get(path, np.tile(rest, (count, 1))) for path, rest in PATHS.items()]
    return np.stack([local_matrix(*parts) for parts in zip(*rows, strict=True)])


def copied(values: Float, copies: Float) -> Float:
    """Places (V, 3) under each of N matrices (N, 4, 4): (N V, 3)."""
    return (values @ copies[:, :3, :3].transpose(0, 2, 1) + copies[:, None, :3, 3]).reshape(-1, 3)


def copied_faces(faces: Index, vertices: int, count: int) -> Index:
    """Faces (F, 3) of `count` copies of so many vertices: (N F, 3)."""
    return (faces[None] + vertices * np.arange(count)[:, None, None]).reshape(-1, 3)
