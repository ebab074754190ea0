"""A glTF or GLB file: its header, its buffers and the numbers in its accessors.

References
----------
.. [1] Khronos Group (2021), glTF 2.0 Specification: 3.6 (buffers, accessors), 4.4 (GLB).
"""

import base64
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_index, as_integer

__all__ = ["GltfFile", "Numbers", "member", "read_gltf"]

_MAGIC = b"glTF"  # first bytes of a .glb file
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MOST_BYTES = 1 << 40  # of any length or offset in a file
_MOST_ZEROS = 10_000_000  # items of an accessor that has no buffer view: it takes no room in the file


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A file's header, and what comes before and behind it in a GLB file (no bytes in a glTF file)."""

    header: dict[str, Any]
    start: bytes
    rest: bytes

    def with_header(self, header: dict[str, Any]) -> bytes:
        """The file's bytes with another header."""
        text = json.dumps(header).encode()
        if not self.start:
            return text
        text += b" " * (-len(text) % 4)  # chunks end at multiples of four bytes, [1] 4.4
        sizes = (20 + len(text) + len(self.rest)).to_bytes(4, "little") + len(text).to_bytes(4, "little")
        return self.start + sizes + b"JSON" + text + self.rest


def read_gltf(path: Path) -> GltfFile:
    """Read a .gltf or .glb file; what is no such file raises a ValueError."""
    data, start, rest = path.read_bytes(), b"", b""
    if data[:4] == _MAGIC:
        if data[16:20] != b"JSON":
            raise ValueError("the first chunk is not JSON")
        end = 20 + int.from_bytes(data[12:16], "little")
        start, data, rest = data[:8], data[20:end], data[end:]
    header = json.loads(data)
    if not isinstance(header, dict):
        raise ValueError("the header is not an object")
    return GltfFile(header, start, rest)


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

    def __init__(self, file: GltfFile, fetch: Callable[[str], bytes]) -> None:
        self._header, self._rest, self._fetch = file.header, file.rest, fetch
        self._buffers: dict[int, bytes] = {}

    def floats(self, name: str, accessor: Any, kind: str) -> Float:
        """(N, columns) float64, finite; integers are made fractions where the file says so."""
        stored, normalized = self._read(name, accessor, kind)
        values = stored.astype(np.float64)
        if normalized and stored.dtype.kind in "ui":
            values = np.maximum(values / np.iinfo(stored.dtype).max, -1.0)  # [1] 3.11
        return as_float(name, values, values.shape)

    def indices(self, name: str, accessor: Any, kind: str, end: int) -> Index:
        """(N, columns) int64 in 0 .. end - 1."""
        stored, _ = self._read(name, accessor, kind)
        return as_index(name, stored, stored.shape, end=end)

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
        begin = _length(f"{name}: byteOffset", view.get("byteOffset", 0))
        data = self._buffer(view.get("buffer"))[begin:][: _length(f"{name}: byteLength", view.get("byteLength"))]
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
            if uri is None:
                length = int.from_bytes(self._rest[:4], "little")
                self._buffers[index] = self._rest[8 : 8 + length] if self._rest[4:8] == b"BIN\0" else b""
            elif str(uri).startswith("data:"):
                self._buffers[index] = base64.b64decode(str(uri).partition(",")[2])
            else:
                self._buffers[index] = self._fetch(str(uri))
        return self._buffers[index]


def _component(name: str, code: Any) -> np.dtype:
    if code not in _COMPONENTS:
        raise InputError(f"{name}: componentType is {str(code)[:40]}; allowed are {', '.join(map(str, _COMPONENTS))}")
    return np.dtype(_COMPONENTS[code])


def _length(name: str, value: Any) -> int:
    return as_integer(name, value, minimum=0, maximum=_MOST_BYTES)
