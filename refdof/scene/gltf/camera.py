"""The perspective camera that a glTF file brings along.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.5.3 (transformations), 3.10 (cameras).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.optics.camera import Camera
from refdof.scene.gltf.nodes import matrix_of

__all__ = ["camera_kinds", "gltf_camera"]

_ROWS = 480  # the file states an aspect ratio, never a size in pixels


def gltf_camera(header: dict[str, Any], local: Sequence[Float] | None = None) -> Camera | None:
    """First perspective camera of the scene that the file opens with; None if there is none of use.

    `local`, (4, 4) for each node, stands for the nodes' own transforms.
    """
    try:
        roots = header["scenes"][header.get("scene", 0)].get("nodes", [])
        with np.errstate(all="ignore"):  # transforms may hold any numbers; `Camera` judges what comes out
            return _first(header, [(node, np.eye(4)) for node in roots], local)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError):
        return None


def camera_kinds(header: dict[str, Any]) -> set[str]:
    """Types of the cameras that a file has."""
    cameras = header.get("cameras")
    found = cameras if isinstance(cameras, list) else []
    return {str(camera.get("type")) for camera in found if isinstance(camera, dict)}


def _first(header: dict[str, Any], waiting: list[tuple[int, Float]], local: Sequence[Float] | None) -> Camera | None:
    """Walk the nodes depth first, in the file's order."""
    seen: set[int] = set()
    while waiting:
        index, parent = waiting.pop(0)
        if index in seen:  # not a tree: do not walk in circles
            continue
        seen.add(index)
        node = header["nodes"][index]
        world = parent @ (matrix_of(node) if local is None else local[index])
        if "camera" in node:
            perspective = header["cameras"][node["camera"]].get("perspective")
            if perspective:
                return _camera(world, perspective)
        waiting = [(child, world) for child in node.get("children", [])] + waiting
    return None


def _camera(world: Float, perspective: dict[str, Any]) -> Camera:
    """A glTF camera looks down -z of its node, with y up."""
    _, up, backward, eye = world[:3].T
    reach = max(1.0, float(np.abs(eye).max()))  # so that the target differs from the eye
    x, y, z = (eye - reach * backward / np.linalg.norm(backward)).tolist()
    size = (max(1, round(_ROWS * float(perspective.get("aspectRatio", 4 / 3)))), _ROWS)
    fov_y = math.degrees(float(perspective["yfov"]))
    return Camera((eye[0], eye[1], eye[2]), (x, y, z), (up[0], up[1], up[2]), fov_y, size)
