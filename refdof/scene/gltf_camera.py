"""The perspective camera that a glTF file brings along, and the file without it for readers it trips up.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.5.3 (transformations), 3.10 (cameras), 4.4 (GLB).
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.optics.camera import Camera

__all__ = ["gltf_camera", "without_cameras"]

_MAGIC = b"glTF"  # first bytes of a .glb file
_ROWS = 480  # the file states an aspect ratio, never a size in pixels


def gltf_camera(path: Path) -> Camera | None:
    """First perspective camera of the scene that the file opens with; None if there is none of use."""
    try:
        header, _ = _split(path.read_bytes())
        roots = header["scenes"][header.get("scene", 0)].get("nodes", [])
        with np.errstate(all="ignore"):  # transforms may hold any numbers; `Camera` judges what comes out
            return _first(header, [(node, np.eye(4)) for node in roots])
    except (OSError, LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError):
        return None


def without_cameras(path: Path) -> bytes | None:
    """The same file with its camera nodes turned into plain nodes; None if it has no cameras."""
    data = path.read_bytes()
    header, rest = _split(data)
    if not header.pop("cameras", None):
        return None
    for node in header.get("nodes", []):
        node.pop("camera", None)
    text = json.dumps(header).encode()
    if data[:4] != _MAGIC:
        return text
    text += b" " * (-len(text) % 4)  # chunks end at multiples of four bytes, [1] 4.4
    sizes = [(20 + len(text) + len(rest)).to_bytes(4, "little"), len(text).to_bytes(4, "little")]
    return data[:8] + sizes[0] + sizes[1] + b"JSON" + text + rest


def _split(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON part of a .gltf or .glb file, and the chunks behind it."""
    rest = b""
    if data[:4] == _MAGIC:
        if data[16:20] != b"JSON":
            raise ValueError("the first chunk is not JSON")
        end = 20 + int.from_bytes(data[12:16], "little")
        data, rest = data[20:end], data[end:]
    header = json.loads(data)
    if not isinstance(header, dict):
        raise ValueError("the header is not an object")
    return header, rest


def _first(header: dict[str, Any], waiting: list[tuple[int, Float]]) -> Camera | None:
    """Walk the nodes depth first, in the file's order."""
    seen: set[int] = set()
    while waiting:
        index, parent = waiting.pop(0)
        if index in seen:  # not a tree: do not walk in circles
            continue
        seen.add(index)
        node = header["nodes"][index]
        world = parent @ _local(node)
        if "camera" in node:
            perspective = header["cameras"][node["camera"]].get("perspective")
            if perspective:
                return _camera(world, perspective)
        waiting = [(child, world) for child in node.get("children", [])] + waiting
    return None


def _local(node: dict[str, Any]) -> Float:
    """(4, 4) parent from node: a matrix stored by columns, or translation * rotation * scale, [1] 3.5.3."""
    if "matrix" in node:
        return np.reshape(np.asarray(node["matrix"], dtype=np.float64), (4, 4)).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    local = np.eye(4)
    local[:3, :3] = rotation * np.asarray(node.get("scale", (1.0, 1.0, 1.0)), dtype=np.float64)
    local[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return local


def _camera(world: Float, perspective: dict[str, Any]) -> Camera:
    """A glTF camera looks down -z of its node, with y up."""
    _, up, backward, eye = world[:3].T
    reach = max(1.0, float(np.abs(eye).max()))  # so that the target differs from the eye
    x, y, z = (eye - reach * backward / np.linalg.norm(backward)).tolist()
    size = (max(1, round(_ROWS * float(perspective.get("aspectRatio", 4 / 3)))), _ROWS)
    fov_y = math.degrees(float(perspective["yfov"]))
    return Camera((eye[0], eye[1], eye[2]), (x, y, z), (up[0], up[1], up[2]), fov_y, size)
