"""A glTF or GLB file: its header, its buffers and the numbers in its accessors.

Numbers may be sparse, of any type and stride, and packed by meshopt.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.6 (buffers, accessors), 4.4 (GLB).
"""

import base64
import json
import urllib.parse
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_index, as_integer
from refdof.scene.gltf.codecs import has_decoder, meshopt_bytes
from refdof.scene.limits import Meter

__all__ = ["GltfFile", "Numbers", "bytes_of_uri", "member", "read_gltf", "table_of"]

_MAGIC = b"glTF"  # first bytes of a .glb file
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MOST_BYTES = 1 << 40  # of any length or offset in a file
_MOST_ZEROS = 10_000_000  # items of an accessor that has no buffer view: it takes no room in the file
_MESHOPT = "EXT_meshopt_compression"


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A file's header, and the binary chunk of a GLB file (no bytes in a glTF file)."""

    header: dict[str, Any]
    binary: bytes


def read_gltf(data: bytes) -> GltfFile:
    """Take a .gltf or .glb file apart; what is no such file raises a ValueError.

    Raises
    ------
    InputError
        If it is of another version than 2.
    """
    binary = b""
    if data[:4] == _MAGIC:
        container = int.from_bytes(data[4:8], "little")
        if container != 2:
            raise InputError(f"it is a GLB file of version {container}; allowed is 2")
        if data[16:20] != b"JSON":
            raise ValueError("the first chunk is not JSON")
        end = 20 + int.from_bytes(data[12:16], "little")
        length = int.from_bytes(data[end : end + 4], "little")
        if data[end + 4 : end + 8] == b"BIN\0":
            binary = data[end + 8 : end + 8 + length]
        data = data[20:end]
    header = json.loads(data.decode("utf-8-sig"))
    if not isinstance(header, dict):
        raise ValueError("the header is not an object")
    for key in ("minVersion", "version"):
        version = str(table_of(header, "asset").get(key, "2.0"))
        if version.partition(".")[0] != "2" or (key == "minVersion" and version != "2.0"):
            raise InputError(f"asset: {key} is {version[:20]}; allowed is 2.0")
    return GltfFile(header, binary)


def table_of(holder: dict[str, Any], key: str) -> dict[str, Any]:
    """The object `key` of another; an empty one where there is none."""
    table = holder.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key}: got {type(table).__name__}; allowed is an object")
    return table


def bytes_of_uri(uri: str, fetch: Callable[[str], bytes]) -> bytes:
    """The bytes of a data URI, or of a file beside."""
    if not uri.startswith("data:"):
        return fetch(uri)
    kind, _, text = uri.partition(",")
    return base64.b64decode(text) if kind.endswith(";base64") else urllib.parse.unquote_to_bytes(text)


def member(header: dict[str, Any], kind: str, index: Any) -> dict[str, Any]:
    """The object `index` of a header's list, such as "nodes"."""
    items = header.get(kind)
    count = len(items) if isinstance(items, list) else 0
    if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < count:
        raise InputError(f"{kind}: index {str(index)[:40]} is not one of the file's {count}")
    item = items[index]  # type: ignore[index]
    if not isinstance(item, dict):
        raise InputError(f"{kind} {index}: got {type(item).__name__}; allowed is an object")
    return item


class Numbers:
    """The numbers of a file's accessors. `fetch` gives the bytes of a file that lies beside it."""

    def __init__(self, file: GltfFile, fetch: Callable[[str], bytes], meter: Meter) -> None:
        self._header, self._binary, self._fetch, self._meter = file.header, file.binary, fetch, meter
        self._buffers: dict[int, bytes] = {}
        self._unpacked: dict[int, bytes] = {}

    def floats(self, name: str, accessor: Any, kind: str, normalized: bool | None = None) -> Float:
        """(N, columns) float64, finite; integers are made fractions where the file, or `normalized`, says so."""
        stored, says = self._read(name, accessor, kind)
        return self.as_floats(name, stored, says if normalized is None else normalized)

    def as_floats(self, name: str, stored: np.ndarray, normalized: bool) -> Float:
        """Stored numbers (N, columns) as float64."""
        values = stored.astype(np.float64)
        if normalized and stored.dtype.kind in "ui":
            values = np.maximum(values / np.iinfo(stored.dtype).max, -1.0)  # [1] 3.11
        return as_float(name, values, values.shape)

    def indices(self, name: str, accessor: Any, kind: str, end: int) -> Index:
        """(N, columns) int64 in 0 .. end - 1."""
        stored, _ = self._read(name, accessor, kind)
        return as_index(name, stored, stored.shape, end=end)

    def view(self, name: str, index: Any) -> bytes:
        """The bytes of a buffer view."""
        view = member(self._header, "bufferViews", index)
        packed = table_of(table_of(view, "extensions"), _MESHOPT)
        if packed and has_decoder(_MESHOPT):
            if index not in self._unpacked:
                self._meter.clock()
                data = self._part(name, packed)
                self._unpacked[index] = meshopt_bytes(name, packed, data, self._meter.limits.bytes)
            return self._unpacked[index]
        return self._part(name, view)

    def _part(self, name: str, view: dict[str, Any]) -> bytes:
        """The bytes of a buffer from a byteOffset on, byteLength of them."""
        begin = _length(f"{name}: byteOffset", view.get("byteOffset", 0))
        return self._buffer(view.get("buffer"))[begin:][: _length(f"{name}: byteLength", view.get("byteLength"))]

    def _read(self, name: str, index: Any, kind: str) -> tuple[np.ndarray, bool]:
        accessor = member(self._header, "accessors", index)
        if accessor.get("type") != kind:
            raise InputError(f"{name}: got {str(accessor.get('type'))[:40]!r}; allowed is an accessor of {kind}")
        count = as_integer(f"{name}: count", accessor.get("count"), minimum=1)
        if "bufferView" in accessor:
            values = self._items(name, accessor, accessor.get("componentType"), count, _COLUMNS[kind])
        elif "sparse" not in accessor:
            raise InputError(f"{name}: accessor {index} has no bufferView; allowed are numbers without compression")
        else:
            count = as_integer(f"{name}: count", count, minimum=1, maximum=_MOST_ZEROS)
            values = np.zeros((count, _COLUMNS[kind]), dtype=_component(name, accessor.get("componentType")))
        sparse = accessor.get("sparse")
        if sparse is not None:
            many = as_integer(f"{name}: sparse count", sparse["count"], minimum=1, maximum=count)
            where = self._items(name, sparse["indices"], sparse["indices"]["componentType"], many, 1).ravel()
            where = as_index(f"{name}: sparse indices", where, (many,), end=count)
            values = values.copy()
            values[where] = self._items(name, sparse["values"], accessor["componentType"], many, _COLUMNS[kind])
        return values, bool(accessor.get("normalized", False))

    def _items(self, name: str, place: dict[str, Any], component: Any, count: int, columns: int) -> np.ndarray:
        """(count, columns) of a buffer view, from its start and `place`'s byteOffset, with the view's stride."""
        view = member(self._header, "bufferViews", place.get("bufferView"))
        dtype = _component(name, component)
        row = dtype.itemsize * columns
        stride = _length(f"{name}: byteStride", view.get("byteStride", row))
        offset = _length(f"{name}: byteOffset", place.get("byteOffset", 0))
        data = self.view(name, place.get("bufferView"))
        needed = offset + (count - 1) * stride + row
        if stride < row or needed > len(data):
            raise InputError(f"{name}: needs {needed} bytes, {stride} an item; its part of the file has {len(data)}")
        rows = np.lib.stride_tricks.as_strided(
            np.frombuffer(data, dtype=np.uint8, offset=offset), (count, row), (stride, 1), writeable=False
        )
        return np.ascontiguousarray(rows).view(dtype)

    def _buffer(self, index: Any) -> bytes:
        if index not in self._buffers:
            uri = member(self._header, "buffers", index).get("uri")
            if uri is None and index > 0:
                raise InputError(f"buffers {index}: has no uri; allowed is none for the first, of a GLB file")
            self._buffers[index] = self._binary if uri is None else bytes_of_uri(str(uri), self._fetch)
        return self._buffers[index]


def _component(name: str, code: Any) -> np.dtype:
    if code not in _COMPONENTS:
        raise InputError(f"{name}: componentType is {str(code)[:40]}; allowed are {', '.join(map(str, _COMPONENTS))}")
    return np.dtype(_COMPONENTS[code])


def _length(name: str, value: Any) -> int:
    return as_integer(name, value, minimum=0, maximum=_MOST_BYTES)
