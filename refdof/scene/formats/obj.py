"""OBJ files: vertices with colours, polygons of any shape, materials of any number of libraries.

1. lines: places, texture coordinates and normals; a corner is a triple of their numbers     `_Lines`
2. polygons become triangles                                                                 `triangles_of`
3. triangles of one material, that have the same of three things, are one surface            `_surfaces`

A face has texture coordinates, normals or colours if all of its corners do. Colours are sRGB.

References
----------
.. [1] Wavefront Technologies (1992), Advanced Visualizer Manual, appendix B1: object files.
"""

from collections.abc import Sequence

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_index
from refdof.scene.formats.mtl import Library, Paint
from refdof.scene.formats.polygons import triangles_of
from refdof.scene.formats.reading import Reading, Surface, decoded
from refdof.scene.formats.text import lines_of

__all__ = ["read_obj"]

_CURVED = ("curv", "curv2", "surf", "bzp", "bsp")  # free forms, [1]: they have no triangles


def read_obj(data: bytes, reading: Reading) -> list[Surface]:
    """The surfaces of an OBJ file.

    Raises
    ------
    InputError
        If a line is not as the format demands, or a number is out of range.
    """
    lines = _Lines(data)
    for what in lines.curved:
        reading.leave_out(f"free-form geometry ({what})")
    corner = lines.corners()  # (C, 3): place, texture coordinates, normal; -1 is none
    used = np.array(lines.polygons, dtype=np.int64)
    sizes = np.array(lines.sizes, dtype=np.int64)
    reading.meter.triangles(int(np.maximum(sizes - 2, 0).sum()))
    places = as_float("v", lines.rows("v", 3), (None, 3), dtype=np.float64)
    if not len(sizes):
        return []
    if corner[:, 0].max() >= len(places):  # in the file's own numbers, which start at 1
        raise InputError(f"f: got vertex {corner[:, 0].max() + 1}; allowed are 1 .. {len(places)}, those of the file")
    as_index("f", corner[:, 0], (None,), end=len(places))
    for column, kind in ((1, "vt"), (2, "vn")):
        if (corner[:, column] >= 0).any() and not lines.table[kind]:
            reading.leave_out(kind, "faces name some, and the file has none")
            corner[:, column] = -1
        as_index(f"f, {kind}", np.maximum(corner[:, column], 0), (None,), end=max(1, len(lines.table[kind])))
    triangle, polygon = triangles_of(places, sizes, corner[used, 0])
    material = np.array(lines.material, dtype=np.int64)[polygon]
    library = Library(lines.libraries, reading)
    return _surfaces(lines, library, reading, corner, places, used[triangle], material)


def _surfaces(
    lines: "_Lines",
    library: Library,
    reading: Reading,
    corner: Index,
    places: Float,
    faces: Index,
    material: Index,
) -> list[Surface]:
    """Faces (F, 3) into `corner` (C, 3), and the material (F,) of each, by what they have."""
    uv, normal = lines.rows("vt", 2), lines.rows("vn", 3)
    has_color, color = lines.colors()
    colored = has_color[corner[:, 0]]
    kind = (
        4 * (corner[faces, 1] >= 0).all(axis=1)
        + 2 * (corner[faces, 2] >= 0).all(axis=1)
        + 1 * colored[faces].all(axis=1)
    )
    found = []
    groups, group, counts = np.unique(material * 8 + kind, return_inverse=True, return_counts=True)
    reading.meter.instances(len(groups))
    pieces = np.split(faces[np.argsort(group, kind="stable")], np.cumsum(counts)[:-1])
    names = lines.names
    for piece, number in zip(pieces, groups.tolist(), strict=True):
        reading.meter.clock()
        has_uv, has_normal, is_colored = bool(number & 4), bool(number & 2), bool(number & 1)
        old, new = np.unique(piece, return_inverse=True)
        wanted = corner[old] * (1, has_uv, has_normal)  # of what only some corners have, nothing counts
        rows, again = np.unique(wanted, axis=0, return_inverse=True)
        paint = library.paint(names[number // 8], has_uv, is_colored)
        found.append(
            Surface(
                places[rows[:, 0]],
                again.ravel()[new].reshape(-1, 3),
                paint.material,
                _transformed(uv[rows[:, 1]], paint) if has_uv else None,
                color[rows[:, 0]] if is_colored else None,
                normal=normal[rows[:, 2]] if has_normal else None,
            )
        )
    return found


def _transformed(uv: Float, paint: Paint) -> Float:
    return uv * paint.scale + paint.offset


class _Lines:
    """What the lines of a file say, as lists."""

    def __init__(self, data: bytes) -> None:
        self.table: dict[str, list[list[str]]] = {"v": [], "vt": [], "vn": []}
        self.sizes: list[int] = []
        self.polygons: list[int] = []  # corners, one polygon after the other
        self.material: list[int] = []  # of each polygon, into `names`
        self._numbers: dict[str | None, int] = {None: 0}  # of materials, by their names
        self.libraries: list[str] = []
        self.curved: dict[str, None] = {}
        self._corners: dict[str, int] = {}  # by their text
        current = 0
        for line in lines_of(data):
            key, _, rest = line.partition(" ")
            key = key.lower()
            if key in self.table:
                self.table[key].append(rest.split())
            elif key in ("f", "fo"):
                self._polygon(rest.split(), current)
            elif key == "usemtl":
                name = rest.strip().strip('"')
                current = self._numbers.setdefault(name, len(self._numbers))
            elif key == "mtllib":
                self.libraries.append(rest.strip())
            elif key in _CURVED:
                self.curved[key] = None

    @property
    def names(self) -> list[str | None]:
        """The materials' names; None is none."""
        return list(self._numbers)

    def _polygon(self, words: Sequence[str], material: int) -> None:
        for word in words:
            if "-" in word:
                word = self._counted(word)
            self.polygons.append(self._corners.setdefault(word, len(self._corners)))
        self.sizes.append(len(words))
        self.material.append(material)

    def _counted(self, word: str) -> str:
        """Numbers below 0 count from the last item so far: -1."""
        parts = word.split("/")
        for k, (part, kind) in enumerate(zip(parts, ("v", "vt", "vn"), strict=False)):
            if part.startswith("-"):
                number = len(self.table[kind]) + 1 + _whole(part)
                if number < 1:
                    raise InputError(
                        f"f: got {word[:40]!r} after {len(self.table[kind])} {kind}; allowed are those so far"
                    )
                parts[k] = str(number)
        return "/".join(parts)

    def corners(self) -> Index:
        """(C, 3) int64 of place, texture coordinates and normal, from 0; -1 where there is none."""
        found = np.full((len(self._corners), 3), -1, dtype=np.int64)
        for k, word in enumerate(self._corners):
            for column, part in enumerate(word.split("/")[:3]):
                if part:
                    number = _whole(part)
                    if number < 1:
                        raise InputError(f"f: got {word[:40]!r}; allowed are numbers from 1 on, or below 0")
                    found[k, column] = number - 1
        if (found[:, 0] < 0).any():
            raise InputError("f: a corner has no place; allowed are v, v/vt, v//vn and v/vt/vn")
        return found

    def rows(self, kind: str, columns: int) -> Float:
        """(N, columns) float64; texture coordinates of one number have 0 as their second."""
        table = self.table[kind]
        if kind == "vt":
            table = [[*row, "0"] if len(row) == 1 else row for row in table]
        try:
            flat = [word for row in table for word in row[:columns]]
            return np.array(flat, dtype=np.float64).reshape(len(table), columns)
        except ValueError as error:
            raise InputError(
                f"{kind}: {' '.join(str(error).split())[:80]}; allowed are {columns} numbers a line"
            ) from None

    def colors(self) -> tuple[np.ndarray, Float]:
        """Which places have a colour (V,), and linear colours (V, 3)."""
        table = self.table["v"]
        has = np.array([len(row) >= 6 for row in table], dtype=bool)
        color = np.ones((len(table), 3))
        if has.any():
            try:
                stored = np.array([row[3:6] for row in table if len(row) >= 6], dtype=np.float64)
            except ValueError:
                raise InputError("v: a colour is no number; allowed are x y z r g b") from None
            color[has], _ = decoded(as_float("v, colours", stored, (None, 3)))
        return has, color


def _whole(part: str) -> int:
    try:
        return int(part)
    except ValueError:
        raise InputError(f"f: got {part[:40]!r}; allowed are whole numbers") from None
