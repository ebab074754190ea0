"""Numbers of a glTF file as a reader of triangles takes them: floats, in the first set of texture coordinates.

1. sparse accessors, and whole numbers of places, normals and texture coordinates, become floats     `_floats`
2. strips and fans become triangles                                                                  `_triangles`
3. the texture coordinates of a material's base colour become the first set, with their transform    `_texture_places`

What is as it should be already stays in the file; all else is put into one more buffer.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.6.2.3 (sparse accessors), 3.9.2 (texture coordinates).
.. [2] Khronos Group, KHR_mesh_quantization and KHR_texture_transform.
"""

import base64
from typing import Any

import numpy as np

from refdof._check import Float, as_float, as_integer, as_number
from refdof.scene.gltf.file import Numbers, member

__all__ = ["with_plain_numbers"]

_KINDS = {"POSITION": "VEC3", "NORMAL": "VEC3", "TEXCOORD_0": "VEC2"}
_FLOAT, _WHOLE = 5126, 5125
_TRIANGLES, _STRIP, _FAN = 4, 5, 6  # modes of a primitive
_MOST_VERTICES = 1 << 31
_TRANSFORM = "KHR_texture_transform"
_MOST_SETS = 64  # of texture coordinates


def with_plain_numbers(header: dict[str, Any], numbers: Numbers) -> dict[str, Any]:
    """The same header, or one whose accessors are plain, with a buffer of its own for what changed.

    Raises
    ------
    InputError
        If an accessor or a texture's transform is not as the specification demands.
    """
    writer = _Writer(header)
    meshes = []
    for mesh in header.get("meshes", []):
        primitives = [_plain_primitive(header, numbers, writer, primitive) for primitive in mesh.get("primitives", [])]
        meshes.append({**mesh, "primitives": primitives})
    return {**header, "meshes": meshes, **writer.lists()} if writer.changed else header


class _Writer:
    """New accessors, and the bytes behind them."""

    def __init__(self, header: dict[str, Any]) -> None:
        self._lists = {kind: list(header.get(kind, [])) for kind in ("accessors", "bufferViews", "buffers")}
        self._parts: list[bytes] = []
        self._made: dict[tuple[int, str], int] = {}

    @property
    def changed(self) -> bool:
        return bool(self._parts)

    def once(self, index: int, kind: str, make: Any) -> int:
        """The number of the accessor that stands for `index`; made when it is first asked for."""
        if (index, kind) not in self._made:
            self._made[index, kind] = self.accessor(make(), kind)
        return self._made[index, kind]

    def accessor(self, values: np.ndarray, kind: str) -> int:
        """The number of a new accessor with these values: floats, or whole numbers of 32 bits."""
        whole = values.dtype.kind in "ui"
        data = np.ascontiguousarray(values, dtype=np.uint32 if whole else np.float32).tobytes()
        start = sum(map(len, self._parts))
        self._parts.append(data)
        view = {"buffer": len(self._lists["buffers"]), "byteOffset": start, "byteLength": len(data)}
        self._lists["bufferViews"].append(view)
        component = _WHOLE if whole else _FLOAT
        entry = {"bufferView": len(self._lists["bufferViews"]) - 1, "componentType": component, "type": kind}
        self._lists["accessors"].append({**entry, "count": len(values)})
        return len(self._lists["accessors"]) - 1

    def lists(self) -> dict[str, Any]:
        """The header's lists with what is new."""
        data = b"".join(self._parts)
        uri = f"data:application/octet-stream;base64,{base64.b64encode(data).decode()}"
        return {**self._lists, "buffers": [*self._lists["buffers"], {"byteLength": len(data), "uri": uri}]}


def _plain_primitive(
    header: dict[str, Any], numbers: Numbers, writer: _Writer, primitive: dict[str, Any]
) -> dict[str, Any]:
    attributes = dict(primitive.get("attributes", {}))
    if "extensions" in primitive and "KHR_draco_mesh_compression" in primitive["extensions"]:
        return primitive  # its numbers are elsewhere
    places = _texture_places(header, numbers, writer, primitive, attributes)
    if places is not None:
        attributes["TEXCOORD_0"] = places
    for name, index in list(attributes.items()):
        accessor = member(header, "accessors", index) if index != places else {"componentType": _FLOAT}
        kind = _KINDS.get(name, str(accessor.get("type")) if name == "COLOR_0" else None)
        if kind is not None and ("sparse" in accessor or (name in _KINDS and accessor.get("componentType") != _FLOAT)):
            attributes[name] = writer.once(index, kind, lambda i=index, n=name, k=kind: numbers.floats(n, i, k))
    plain = {**primitive, "attributes": attributes}
    order, mode = primitive.get("indices"), primitive.get("mode", _TRIANGLES)
    if mode in (_STRIP, _FAN):
        plain |= {
            "mode": _TRIANGLES,
            "indices": writer.accessor(_triangles(mode, _order(header, numbers, primitive)), "SCALAR"),
        }
    elif order is not None and "sparse" in member(header, "accessors", order):
        plain["indices"] = writer.once(order, "SCALAR", lambda: _order(header, numbers, primitive))
    return plain


def _order(header: dict[str, Any], numbers: Numbers, primitive: dict[str, Any]) -> np.ndarray:
    """(N,) uint32: the vertices in the order in which the primitive has them."""
    places = member(header, "accessors", primitive.get("attributes", {}).get("POSITION"))
    count = as_integer("POSITION: count", places.get("count"), minimum=1, maximum=_MOST_VERTICES)
    if primitive.get("indices") is None:
        return np.arange(count, dtype=np.uint32)
    return numbers.indices("indices", primitive["indices"], "SCALAR", count).ravel().astype(np.uint32)


def _triangles(mode: int, order: np.ndarray) -> np.ndarray:
    """(3 (N - 2),) uint32: corners of the triangles of a strip or a fan, [1] 3.7.2.1."""
    k = np.arange(max(len(order) - 2, 0))
    odd = k % 2
    corners = (k, k + 1 + odd, k + 2 - odd) if mode == _STRIP else (k + 1, k + 2, 0 * k)
    return order[np.stack(corners, axis=1).ravel()].astype(np.uint32)


def _texture_places(
    header: dict[str, Any], numbers: Numbers, writer: _Writer, primitive: dict[str, Any], attributes: dict[str, Any]
) -> int | None:
    """Accessor of the texture coordinates of the base colour where they are not the first set as it is."""
    if "material" not in primitive:
        return None
    texture = member(header, "materials", primitive["material"]).get("pbrMetallicRoughness", {})
    texture = texture.get("baseColorTexture") if isinstance(texture, dict) else None
    if not isinstance(texture, dict):
        return None
    extensions = texture.get("extensions")
    transform = extensions.get(_TRANSFORM) if isinstance(extensions, dict) else None
    chosen = (transform or {}).get("texCoord", texture.get("texCoord", 0))
    chosen = as_integer("texCoord", chosen, minimum=0, maximum=_MOST_SETS)
    if (chosen == 0 and not transform) or f"TEXCOORD_{chosen}" not in attributes:
        return None
    uv = numbers.floats(f"TEXCOORD_{chosen}", attributes[f"TEXCOORD_{chosen}"], "VEC2")
    return writer.accessor(_transformed(uv, transform or {}), "VEC2")


def _transformed(uv: Float, transform: dict[str, Any]) -> Float:
    """Scaled, turned against the clock as one sees the picture, and moved, [2]; v runs downwards."""
    offset, scale = (
        as_float(name, transform.get(name, default), (2,), dtype=np.float64)
        for name, default in (("offset", [0.0, 0.0]), ("scale", [1.0, 1.0]))
    )
    angle = as_number("rotation", transform.get("rotation", 0.0))
    c, s = np.cos(angle), np.sin(angle)
    return (uv * scale) @ np.array([[c, -s], [s, c]]) + offset
