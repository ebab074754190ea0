"""Nodes of a glTF file: where they stand, each in its parent and all in the world.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.5 (nodes, transformations).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_float
from refdof.scene.gltf.file import member

__all__ = ["PATHS", "Tree", "local_matrix", "matrix_of", "tree_of"]

PATHS = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}


class Tree(NamedTuple):
    """N nodes: `parent` of each, -1 for a root, and their `order`, parents first."""

    parent: tuple[int, ...]
    order: tuple[int, ...]

    def worlds(self, local: Sequence[Float]) -> list[Float]:
        """World from node, (4, 4) each, of parent from node."""
        world = list(local)
        for node in self.order:
            if self.parent[node] >= 0:
                world[node] = world[self.parent[node]] @ local[node]
        return world


def tree_of(header: dict[str, Any]) -> Tree:
    """The nodes' tree.

    Raises
    ------
    InputError
        If a node has two parents or is its own ancestor, or a child does not exist.
    """
    count = len(header.get("nodes", []))
    children = [member(header, "nodes", node).get("children", []) for node in range(count)]
    parent = [-1] * count
    for node in range(count):
        for child in children[node]:
            member(header, "nodes", child)
            if parent[child] >= 0:
                raise InputError(f"nodes: {child} is a child of {parent[child]} and of {node}; allowed is one parent")
            parent[child] = node
    order = [node for node in range(count) if parent[node] < 0]
    for node in order:  # it grows
        order.extend(children[node])
    if len(order) < count:
        lost = min(set(range(count)) - set(order))
        raise InputError(f"nodes: {lost} is below a node that is its own ancestor; allowed are trees")
    return Tree(tuple(parent), tuple(order))


def matrix_of(node: dict[str, Any]) -> Float:
    """(4, 4) parent from node as the file has it: a matrix stored by columns, or its three parts, [1] 3.5.3."""
    if "matrix" in node:
        return as_float("matrix", node["matrix"], (16,), dtype=np.float64).reshape(4, 4).T
    if not any(path in node for path in PATHS):
        return np.eye(4)
    return local_matrix(*(as_float(p, node.get(p, rest), (len(rest),), dtype=np.float64) for p, rest in PATHS.items()))


def local_matrix(translation: Float, rotation: Float, scale: Float) -> Float:
    """(4, 4) parent from node: translation * rotation * scale; the quaternion (x, y, z, w) may have any length."""
    length = float(np.linalg.norm(rotation))
    x, y, z, w = (rotation / length).tolist() if length > 0.0 else PATHS["rotation"]
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    local = np.eye(4)
    local[:3, :3] = turn * scale
    local[:3, 3] = translation
    return local
