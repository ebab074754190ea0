"""Primitives of a glTF file: triangles, texture coordinates and colours, whatever numbers they are stored as.

1. accessors, or a Draco buffer, become floats       `_attributes`
2. strips and fans become triangles                  `_triangles`
3. a material's transform moves its coordinates      `_transformed`

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.7.2 (meshes).
.. [2] Khronos Group: KHR_mesh_quantization, KHR_texture_transform, KHR_draco_mesh_compression.
"""

from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_index, as_number
from refdof.scene.formats.reading import Reading, Surface
from refdof.scene.gltf.codecs import draco_numbers
from refdof.scene.gltf.file import Numbers, member, table_of
from refdof.scene.gltf.materials import Materials

__all__ = ["read_primitive"]

_TRIANGLES, _STRIP, _FAN = 4, 5, 6  # modes
_DRACO = "KHR_draco_mesh_compression"


def read_primitive(
    header: dict[str, Any],
    numbers: Numbers,
    materials: Materials,
    reading: Reading,
    primitive: dict[str, Any],
    name: str,
) -> Surface | None:
    """A primitive's surface in its mesh's space; None for points, lines, and what has no places.

    Raises
    ------
    InputError
        If an accessor, or how many items it has, is not as the specification demands.
    """
    mode = primitive.get("mode", _TRIANGLES)
    attributes = table_of(primitive, "attributes")
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        if mode not in (0, 1, 2, 3):
            raise InputError(f"{name}: mode {str(mode)[:40]}; allowed are 0 to 6")
        reading.leave_out("points and lines")
        return None
    if "POSITION" not in attributes:
        reading.leave_out(name, "it has no POSITION")
        return None
    if "COLOR_1" in attributes:
        reading.leave_out("sets of colours but the first")
    for target in primitive.get("targets", ()):
        for key in set(target) - {"POSITION", "NORMAL", "TANGENT"}:
            reading.leave_out(f"morph targets of {key[:40]}")
    values, order = _attributes(header, numbers, primitive, attributes, name)
    places = values["POSITION"]
    if order is None:
        order = np.arange(len(places))
    if mode == _TRIANGLES and len(order) % 3:
        raise InputError(f"{name}: has {len(order)} corners; allowed is a multiple of 3")
    faces = order.reshape(-1, 3) if mode == _TRIANGLES else _triangles(mode, order)
    sets = frozenset(int(key[9:]) for key in values if key.startswith("TEXCOORD_"))
    dress = materials.of(primitive.get("material"), sets)
    uv = None if dress.texcoord is None else values[f"TEXCOORD_{dress.texcoord}"]
    color = values.get("COLOR_0")
    has_alpha = color is not None and color.shape[1] == 4 and not dress.is_opaque and (color[:, 3] < 1.0).any()
    return Surface(
        places,
        faces,
        dress.material,
        None if uv is None else _transformed(uv, dress.transform) * (1.0, -1.0) + (0.0, 1.0),
        None if color is None else np.maximum(color[:, :3], 0.0),
        np.clip(color[:, 3], 0.0, 1.0) if has_alpha else None,  # type: ignore[index]
        values.get("NORMAL"),
    )


def _attributes(
    header: dict[str, Any], numbers: Numbers, primitive: dict[str, Any], attributes: dict[str, Any], name: str
) -> tuple[dict[str, Float], Index | None]:
    """What is read of a primitive, (V, columns) each, and the order of its vertices."""
    packed = table_of(table_of(primitive, "extensions"), _DRACO)
    unpacked, order = draco_numbers(numbers, packed, name) if packed else ({}, None)
    found: dict[str, Float] = {}
    for key, index in attributes.items():
        kinds = _kinds(key)
        if not kinds:
            continue
        accessor = member(header, "accessors", index)
        normalized = True if key == "COLOR_0" else None  # whole numbers have no other meaning there
        if key in unpacked:
            found[key] = numbers.as_floats(
                f"{name}: {key}", unpacked[key], normalized or accessor.get("normalized", False)
            )
            if found[key].shape[1] not in [int(kind[3]) for kind in kinds]:
                raise InputError(f"{name}: {key} has {found[key].shape[1]} columns; allowed are {' or '.join(kinds)}")
        else:
            kind = accessor.get("type") if accessor.get("type") in kinds else kinds[0]
            found[key] = numbers.floats(f"{name}: {key}", index, str(kind), normalized)
    for key, values in found.items():
        if len(values) != len(found["POSITION"]):
            whole = len(found["POSITION"])
            raise InputError(f"{name}: {key} has {len(values)} items; allowed are as many as POSITION's {whole}")
    count = len(found["POSITION"])
    if order is not None:
        return found, as_index(f"{name}: indices", order, (None,), end=count)
    if primitive.get("indices") is not None:
        return found, numbers.indices(f"{name}: indices", primitive["indices"], "SCALAR", count).ravel()
    return found, None


def _kinds(key: str) -> tuple[str, ...]:
    """Types that an attribute may have; none if it is not read."""
    if key in ("POSITION", "NORMAL"):
        return ("VEC3",)
    if key == "COLOR_0":
        return ("VEC4", "VEC3")
    return ("VEC2",) if key.startswith("TEXCOORD_") and key[9:].isdecimal() else ()


def _triangles(mode: int, order: Index) -> Index:
    """(N - 2, 3): corners of the triangles of a strip or a fan, [1] 3.7.2.1."""
    k = np.arange(max(len(order) - 2, 0))
    odd = k % 2
    corners = (k, k + 1 + odd, k + 2 - odd) if mode == _STRIP else (k + 1, k + 2, 0 * k)
    return order[np.stack(corners, axis=1)]


def _transformed(uv: Float, transform: dict[str, Any]) -> Float:
    """Scaled, turned against the clock as one sees the picture, and moved, [2]; v runs downwards."""
    offset, scale = (
        as_float(name, transform.get(name, default), (2,), dtype=np.float64)
        for name, default in (("offset", [0.0, 0.0]), ("scale", [1.0, 1.0]))
    )
    angle = as_number("rotation", transform.get("rotation", 0.0))
    c, s = np.cos(angle), np.sin(angle)
    return (uv * scale) @ np.array([[c, -s], [s, c]]) + offset
