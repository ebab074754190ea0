"""The perspective camera that a glTF file brings along; an orthographic one is refused.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.5.3 (transformations), 3.10 (cameras).
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError
from refdof.optics.camera import Camera
from refdof.scene.gltf.nodes import matrix_of

__all__ = ["beyond_clipping", "gltf_camera", "refuse_other_cameras"]

_SLACK = 1e-6  # of a distance: files round to float32
_ROWS = 480  # the file states an aspect ratio, never a size in pixels


def gltf_camera(header: dict[str, Any], local: Sequence[Float] | None = None) -> Camera | None:
    """First perspective camera of the scene that the file opens with; None if there is none of use.

    `local`, (4, 4) for each node, stands for the nodes' own transforms.
    """
    found = _found(header, "perspective", local)
    return None if found is None else _camera(*found)


def refuse_other_cameras(header: dict[str, Any]) -> None:
    """Raise if the scene has a camera, and no perspective one.

    Raises
    ------
    InputError
        It says how to choose another camera.
    """
    if _found(header, "perspective") is None and _found(header, "orthographic") is not None:
        raise InputError(
            "its camera is orthographic; allowed are perspective ones, or another in its place: "
            "--no-file-camera, load_scene(..., file_camera=False)"
        )


def beyond_clipping(header: dict[str, Any], camera: Camera, vertices: Float, faces: Index) -> list[str]:
    """Which of the camera's znear and zfar would cut triangles away that it sees."""
    found = _found(header, "perspective")
    if found is None:
        return []
    near, far = (found[1].get(key) for key in ("znear", "zfar"))
    with np.errstate(all="ignore"):
        place = (vertices - np.asarray(camera.eye)) @ np.asarray(camera.rotation).T
        depth = -place[:, 2]
        # Triangles beyond one side of the view are not seen; corners may lie behind the camera.
        y = math.tan(math.radians(camera.fov_y) / 2)
        x = y * camera.size[0] / camera.size[1]
        sides = [s * place[:, k] <= extent * depth for k, extent in ((0, x), (1, y)) for s in (1.0, -1.0)]
        seen = np.logical_and.reduce([side[faces].any(axis=1) for side in (*sides, depth > 0)])
        least, most = (edge(depth[faces], axis=1)[seen] for edge in (np.min, np.max))
    cut = []
    if isinstance(near, int | float) and (least < near * (1 - _SLACK)).any():
        cut.append("its camera's znear")
    if isinstance(far, int | float) and (most > far * (1 + _SLACK)).any():
        cut.append("its camera's zfar")
    return cut


def _found(
    header: dict[str, Any], kind: str, local: Sequence[Float] | None = None
) -> tuple[Float, dict[str, Any]] | None:
    """World from camera (4, 4), and what the file says of its first camera of a kind."""
    if not header.get("cameras"):
        return None
    try:
        roots = header["scenes"][header.get("scene", 0)].get("nodes", [])
        with np.errstate(all="ignore"):  # transforms may hold any numbers; `Camera` judges what comes out
            return _first(header, [(node, np.eye(4)) for node in roots], local, kind)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError):
        return None


def _first(
    header: dict[str, Any], waiting: list[tuple[int, Float]], local: Sequence[Float] | None, kind: str
) -> tuple[Float, dict[str, Any]] | None:
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
            camera = header["cameras"][node["camera"]]
            if camera.get(kind):
                return world, camera[kind]
        waiting = [(child, world) for child in node.get("children", [])] + waiting
    return None


def _camera(world: Float, perspective: dict[str, Any]) -> Camera | None:
    """A glTF camera looks down -z of its node, with y up; None if its numbers are of no use."""
    try:
        with np.errstate(all="ignore"):
            return _made(world, perspective)
    except (LookupError, TypeError, ValueError, ArithmeticError):
        return None


def _made(world: Float, perspective: dict[str, Any]) -> Camera:
    _, up, backward, eye = world[:3].T
    reach = max(1.0, float(np.abs(eye).max()))  # so that the target differs from the eye
    x, y, z = (eye - reach * backward / np.linalg.norm(backward)).tolist()
    size = (max(1, round(_ROWS * float(perspective.get("aspectRatio", 4 / 3)))), _ROWS)
    fov_y = math.degrees(float(perspective["yfov"]))
    return Camera((eye[0], eye[1], eye[2]), (x, y, z), (up[0], up[1], up[2]), fov_y, size)
