"""OFF files, with normals, texture coordinates and colours of vertices or faces.

The header is OFF, with N for normals, C for colours and ST for texture coordinates before it. Colours are sRGB: whole
numbers of 0 .. 255, or parts of 1. Files without a C have colours, too, where their lines have the numbers.

References
----------
.. [1] Geomview 1.9 manual: OFF files.
"""

import re

import numpy as np

from refdof._check import Float, InputError, as_float, as_index
from refdof.scene.formats.polygons import triangles_of
from refdof.scene.formats.reading import GREY, WHITE, Reading, Surface, decoded
from refdof.scene.formats.text import lines_of

__all__ = ["read_off"]

_HEADER = re.compile(r"(ST)?(C)?(N)?(4)?(n)?OFF", re.ASCII)
_MOST = 1 << 31


def read_off(data: bytes, reading: Reading) -> list[Surface]:
    """The surface of an OFF file.

    Raises
    ------
    InputError
        If a line is not as the format demands, an index is out of range, or the file is binary or of four dimensions.
    """
    if re.match(rb"\s*\S*OFF\s+BINARY", data[:40]):
        raise InputError("it is a binary OFF file; allowed is text")
    lines = lines_of(data)
    header = _HEADER.match(lines[0]) if lines else None
    first = lines[0][header.end() :].split() if header else lines[0].split() if lines else []
    rest = lines[1:]
    st, c, n, four, dimension = (bool(part) for part in header.groups()) if header else (False,) * 5
    if four or dimension:
        raise InputError(f"it is a {lines[0].split()[0]} file; allowed are three dimensions")
    if not first and rest:
        first, rest = rest[0].split(), rest[1:]
    count, faces = (_whole("counts", word) for word in [*first, "0", "0"][:2])
    if not 0 < count <= len(rest) or not 0 <= faces <= len(rest) - count:
        raise InputError(
            f"counts: {count} vertices and {faces} faces of {len(rest)} lines; allowed is what the file has"
        )
    reading.meter.triangles(faces)
    rows = [line.split() for line in rest[:count]]
    width = min(map(len, rows))
    table = _numbers("vertices", [word for row in rows for word in row[:width]]).reshape(count, width)
    at = 3 + 3 * n
    colors = width - at - 2 * st
    if width < at + 2 * st or (c and colors < 3):
        raise InputError(f"vertices: a line has {width} numbers; allowed are {at + 3 * c + 2 * st} or more")
    color, opacity = None, None
    if colors in (3, 4):
        kind = "u" if _are_whole([row[at : at + colors] for row in rows], table[:, at : at + colors]) else "f"
        color, opacity = decoded(table[:, at : at + colors], kind)
    uv = table[:, width - 2 :] if st else None
    sizes, corners, hues = [], [], []
    for line in rest[count : count + faces]:
        words = line.split()
        size = _whole("faces", words[0])
        if not 0 <= size < len(words):
            raise InputError(f"faces: a line has {len(words) - 1} numbers for {size} corners; allowed is one for each")
        sizes.append(size)
        corners += words[1 : 1 + size]
        hues.append(words[1 + size :])
    order = as_index("faces", np.array([_whole("faces", word) for word in corners], dtype=np.int64), (None,), end=count)
    triangle, polygon = triangles_of(table[:, :3], np.array(sizes, dtype=np.int64), order)
    reading.meter.triangles(len(triangle) - faces)
    whole = table[:, :3], order[triangle], uv, table[:, 3:6] if n else None
    if color is None and any(len(hue) >= 3 for hue in hues):
        return _of_faces(whole, hues, triangle, polygon, order, reading)
    if color is None and any(len(hue) in (1, 2) for hue in hues):
        reading.leave_out("colours of faces", "they are numbers in a table of another program")
    return [Surface(whole[0], whole[1], reading.plain(GREY if color is None else WHITE), uv, color, opacity, whole[3])]


def _of_faces(
    whole: tuple, hues: list[list[str]], triangle: np.ndarray, polygon: np.ndarray, order: np.ndarray, reading: Reading
) -> list[Surface]:
    """Faces with colours of their own, and those without."""
    vertices, faces, uv, normal = whole
    has = np.array([len(hue) >= 3 for hue in hues], dtype=bool)
    words = [(hue[:4] if len(hue) > 3 else [*hue[:3], ""]) for hue in hues if len(hue) >= 3]
    values = _numbers("colours", [word for row in words for word in row[:3]]).reshape(-1, 3)
    kind = "u" if _are_whole([row[:3] for row in words], values) else "f"
    scale = 255.0 if kind == "u" else 1.0
    alpha = np.array([scale if row[3] == "" else _numbers("colours", [row[3]])[0] for row in words])
    color, opacity = decoded(np.concatenate([values, alpha[:, None]], axis=1), kind)
    found = []
    number = np.cumsum(has) - 1  # of each polygon's colour
    for colored in (True, False):
        which = has[polygon] == colored
        if not which.any():
            continue
        corner = faces[which].ravel()
        one = np.repeat(number[polygon[which]], 3)
        found.append(
            Surface(
                vertices[corner],
                np.arange(len(corner)).reshape(-1, 3),
                reading.plain(WHITE if colored else GREY),
                None if uv is None else uv[corner],
                color[one] if colored else None,
                opacity[one] if colored and opacity is not None else None,
                None if normal is None else normal[corner],
            )
        )
    return found


def _are_whole(words: list[list[str]], values: Float) -> bool:
    """Whether colours are of 0 .. 255: no number has a point, and one is larger than 1."""
    return bool(values.max(initial=0.0) > 1.0) and not any("." in word or "e" in word for row in words for word in row)


def _numbers(name: str, words: list[str]) -> Float:
    try:
        return as_float(name, np.array(words, dtype=np.float64), (None,))
    except ValueError as error:
        raise InputError(f"{name}: {' '.join(str(error).split())[:80]}; allowed are numbers") from None


def _whole(name: str, word: str) -> int:
    try:
        value = int(word)
    except ValueError:
        raise InputError(f"{name}: got {word[:40]!r}; allowed are whole numbers") from None
    if abs(value) > _MOST:
        raise InputError(f"{name}: got {value}; allowed is at most {_MOST}")
    return value
