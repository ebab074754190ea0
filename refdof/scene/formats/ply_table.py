"""The numbers of a PLY file: its header, and one table for each element, from text or bytes of either order.

References
----------
.. [1] Turk (1994), The PLY Polygon File Format.
"""

from abc import ABC, abstractmethod
from codecs import BOM_UTF8
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from refdof._check import InputError

__all__ = ["Element", "Ragged", "Table", "read_tables"]

_TYPES = {
    "i1": ("char", "int8"),
    "u1": ("uchar", "uint8"),
    "i2": ("short", "int16"),
    "u2": ("ushort", "uint16"),
    "i4": ("int", "int32"),
    "u4": ("uint", "uint32"),
    "f4": ("float", "float32"),
    "f8": ("double", "float64"),
}
_BY_NAME = {name: code for code, names in _TYPES.items() for name in names}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_HEADER = 1 << 20
_MOST_ITEMS = 1 << 31


class _Property(NamedTuple):
    name: str
    length: str  # the type of a list's length, or ""
    kind: str


@dataclass
class Element:
    """One `element` of a header."""

    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


class Ragged(NamedTuple):
    """Lists of a property: their lengths (N,), and all their items."""

    sizes: np.ndarray
    items: np.ndarray


class Table(NamedTuple):
    """The numbers of an element, by property, float64; `kinds` has each one's type, such as "u1"."""

    scalars: dict[str, np.ndarray]
    lists: dict[str, Ragged]
    kinds: dict[str, str]


def read_tables(data: bytes) -> tuple[dict[str, Table], list[str]]:
    """The tables of a PLY file by element, and the names that its comments give to textures.

    Raises
    ------
    InputError
        If the header is not as the format demands, or the file is shorter than it says.
    """
    data = data.removeprefix(BOM_UTF8)
    end = data.find(b"end_header", 0, _LONGEST_HEADER)
    if not data.lstrip().startswith(b"ply") or end < 0:
        raise InputError("it has no header of a PLY file")
    order, elements, textures = _header(data[:end].decode("latin-1"))
    start = end + len(b"end_header")
    start += 2 if data[start : start + 2] == b"\r\n" else 1
    source: _Text | _Bytes
    if order == "":
        try:
            source = _Text(np.array(data[start:].split(), dtype=np.float64))
        except ValueError as error:
            raise InputError(f"numbers: {' '.join(str(error).split())[:80]}; allowed are numbers") from None
    else:
        source = _Bytes(data[start:], order)
    return {element.name: source.table(element) for element in elements}, textures


def _header(text: str) -> tuple[str, list[Element], list[str]]:
    order, elements, textures = None, [], []
    for line in text.splitlines()[1:]:
        words = line.split()
        if not words:
            continue
        if words[0] == "format" and len(words) > 1 and words[1] in _ORDERS:
            order = _ORDERS[words[1]]
        elif words[0] == "comment" and len(words) > 2 and words[1].lower() == "texturefile":
            textures.append(line.split(None, 2)[2].strip().strip('"'))
        elif words[0] == "element" and len(words) == 3 and words[2].isdecimal() and int(words[2]) < _MOST_ITEMS:
            elements.append(Element(words[1], int(words[2])))
        elif words[0] == "property" and elements:
            elements[-1].properties.append(_property(words[1:]))
        elif words[0] not in ("comment", "obj_info"):
            raise InputError(f"header: got {line.strip()[:60]!r}; allowed are format, element, property and comment")
    if order is None:
        raise InputError(f"header: has no format; allowed are {', '.join(_ORDERS)}")
    return order, elements, textures


def _property(words: list[str]) -> _Property:
    kinds = words[1:3] if words[:1] == ["list"] else words[:1]
    if len(words) != len(kinds) + 1 + (words[:1] == ["list"]) or any(kind not in _BY_NAME for kind in kinds):
        raise InputError(f"header: got property {' '.join(words)[:60]!r}; allowed are types {', '.join(_BY_NAME)}")
    codes = [_BY_NAME[kind] for kind in kinds]
    return _Property(words[-1], codes[0] if len(codes) == 2 else "", codes[-1])


class _Stream(ABC):
    """Numbers one after the other. A row is read at once where all rows have lists of the same lengths."""

    def _short(self, element: Element) -> InputError:
        return InputError(f"{element.name}: the file ends before its {element.count} rows do")

    def table(self, element: Element) -> Table:
        """The next element."""
        kinds = {item.name: item.kind for item in element.properties}
        if not element.count:
            return Table(
                {}, {item.name: Ragged(*np.zeros((2, 0))) for item in element.properties if item.length}, kinds
            )
        if not element.properties:
            return Table({}, {}, kinds)
        lengths = self._first_lengths(element)
        columns = self._even(element, lengths)
        if columns is None:
            columns = self._uneven(element)
        scalars = {p.name: c for p, c in zip(element.properties, columns, strict=True) if not p.length}
        lists = {p.name: c for p, c in zip(element.properties, columns, strict=True) if p.length}
        return Table(scalars, lists, kinds)

    def _uneven(self, element: Element) -> list:
        """Columns of an element whose lists differ in length, row by row."""
        columns: list[list] = [[] for _ in element.properties]
        sizes: list[list[int]] = [[] for _ in element.properties]
        for _ in range(element.count):
            for k, item in enumerate(element.properties):
                values = self._next(element, item)
                columns[k].append(values)
                sizes[k].append(len(values))
        return _joined(element, columns, sizes)

    @abstractmethod
    def _first_lengths(self, element: Element) -> list[int]:
        """How many numbers each property of the next row has."""

    @abstractmethod
    def _even(self, element: Element, lengths: list[int]) -> list | None:
        """Columns of an element whose rows all have these lengths; None: they have not."""

    @abstractmethod
    def _next(self, element: Element, item: _Property) -> np.ndarray:
        """The next numbers, of one property of one row."""


class _Text(_Stream):
    def __init__(self, numbers: np.ndarray) -> None:
        self._numbers, self._at = numbers, 0

    def _first_lengths(self, element: Element) -> list[int]:
        at, found = self._at, []
        for item in element.properties:
            length = self._length(element, at) if item.length else 1
            found.append(length)
            at += length + (1 if item.length else 0)
        return found

    def _length(self, element: Element, at: int) -> int:
        if at >= len(self._numbers):
            raise self._short(element)
        length = self._numbers[at]
        if not 0 <= length <= len(self._numbers):
            raise InputError(f"{element.name}: a list has the length {length:g}; allowed is what the file has")
        return int(length)

    def _even(self, element: Element, lengths: list[int]) -> list | None:
        width = sum(lengths) + sum(1 for item in element.properties if item.length)
        end = self._at + width * element.count
        if end > len(self._numbers):
            return None
        rows = self._numbers[self._at : end].reshape(element.count, width)
        found: list = []
        at = 0
        for item, length in zip(element.properties, lengths, strict=True):
            if item.length:
                if (rows[:, at] != length).any():
                    return None
                sizes = np.full(element.count, length, dtype=np.int64)
                found.append(Ragged(sizes, rows[:, at + 1 : at + 1 + length].ravel()))
            else:
                found.append(rows[:, at])
            at += length + (1 if item.length else 0)
        self._at = end
        return found

    def _next(self, element: Element, item: _Property) -> np.ndarray:
        length = self._length(element, self._at) if item.length else 1
        self._at += 1 if item.length else 0
        if self._at + length > len(self._numbers):
            raise self._short(element)
        self._at += length
        return self._numbers[self._at - length : self._at]


class _Bytes(_Stream):
    def __init__(self, data: bytes, order: str) -> None:
        self._data, self._order, self._at = data, order, 0

    def _one(self, element: Element, kind: str, at: int, count: int = 1) -> np.ndarray:
        dtype = np.dtype(self._order + kind)
        if count < 0 or at + count * dtype.itemsize > len(self._data):
            raise self._short(element)
        return np.frombuffer(self._data, dtype, count, at)

    def _first_lengths(self, element: Element) -> list[int]:
        at, found = self._at, []
        for item in element.properties:
            length = int(self._one(element, item.length, at)[0]) if item.length else 1
            self._one(element, item.kind, at, length)
            at += (int(item.length[1]) if item.length else 0) + length * int(item.kind[1])
            found.append(length)
        return found

    def _even(self, element: Element, lengths: list[int]) -> list | None:
        fields: list = []
        for k, (item, length) in enumerate(zip(element.properties, lengths, strict=True)):
            if item.length:
                fields.append((f"n{k}", self._order + item.length))
            fields.append((f"v{k}", self._order + item.kind, (length,) if item.length else ()))
        dtype = np.dtype(fields)
        if self._at + dtype.itemsize * element.count > len(self._data):
            return None
        rows = np.frombuffer(self._data, dtype, element.count, self._at)
        found: list = []
        for k, (item, length) in enumerate(zip(element.properties, lengths, strict=True)):
            values: Any = rows[f"v{k}"].astype(np.float64)
            if item.length:
                if (rows[f"n{k}"] != length).any():
                    return None
                values = Ragged(np.full(element.count, length, dtype=np.int64), values.ravel())
            found.append(values)
        self._at += dtype.itemsize * element.count
        return found

    def _next(self, element: Element, item: _Property) -> np.ndarray:
        length = 1
        if item.length:
            length = int(self._one(element, item.length, self._at)[0])
            self._at += int(item.length[1])
        values = self._one(element, item.kind, self._at, length)
        self._at += length * int(item.kind[1])
        return values


def _joined(element: Element, columns: list[list], sizes: list[list[int]]) -> list:
    found: list = []
    for item, column, size in zip(element.properties, columns, sizes, strict=True):
        values = np.concatenate(column).astype(np.float64)
        found.append(Ragged(np.array(size, dtype=np.int64), values) if item.length else values)
    return found
