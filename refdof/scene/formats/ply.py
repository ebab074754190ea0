"""PLY files: polygons and strips of triangles, with colours, normals and texture coordinates at vertices or faces.

1. numbers of each element                                               `refdof.scene.formats.ply_table`
2. polygons become triangles, strips end at -1                           `_faces`
3. what belongs to faces or to their corners splits vertices             `_corners`
4. faces of one texture are one surface; `texnumber` says which it is    `_surfaces`

Colours are sRGB. Where vertices and faces have colours, those of the vertices count.
"""

from collections.abc import Iterable

import numpy as np

from refdof._check import Float, Index, InputError, as_float, as_index
from refdof.scene.formats.pictures import Picture
from refdof.scene.formats.ply_table import Ragged, Table, read_tables
from refdof.scene.formats.polygons import triangles_of
from refdof.scene.formats.reading import GREY, SPECULAR, WHITE, Reading, Surface, decoded
from refdof.scene.material import Material

__all__ = ["read_ply"]

_PLACES = (("x", "y", "z"),)
_NORMALS = (("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z"))
_COLORS = (("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue"))
_ALPHAS = (("alpha",), ("a",), ("diffuse_alpha",))
_UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"), ("tx", "ty"))
_LISTS = ("vertex_indices", "vertex_index")
_NONE = Table({}, {}, {})


def read_ply(data: bytes, reading: Reading) -> list[Surface]:
    """The surfaces of a PLY file.

    Raises
    ------
    InputError
        If the file is not as the format demands, or an index is out of range.
    """
    tables, textures = read_tables(data)
    vertex, face = tables.get("vertex", _NONE), tables.get("face", _NONE)
    places = _columns(vertex, _PLACES)
    if places is None:
        raise InputError("it has no vertices with x, y and z")
    places = as_float("vertices", places, (None, 3))
    names = [name for name in _LISTS if name in face.lists]
    source: Index | None = None
    polygon: Index | None = None
    if "tristrips" in tables and not (names and len(face.lists[names[0]].sizes)):
        strips = next(iter(tables["tristrips"].lists.values()), Ragged(*np.zeros((2, 0))))
        faces = _strips(strips, len(places))
        face = _NONE
    elif names:
        faces, source, polygon = _faces(face.lists[names[0]], places, reading)
    else:
        raise InputError("it has no faces, only points")
    reading.meter.triangles(len(faces))
    return _surfaces(reading, textures, vertex, face, places, faces, source, polygon)


def _faces(lists: Ragged, places: Float, reading: Reading) -> tuple[Index, Index, Index]:
    """Triangles (F, 3), their corners' numbers among the polygons' (F, 3), and the polygon of each (F,)."""
    sizes = lists.sizes.astype(np.int64)
    order = as_index("faces", lists.items.astype(np.int64), (None,), end=len(places))
    reading.meter.clock()
    triangle, polygon = triangles_of(places, sizes, order)
    return order[triangle], triangle, polygon


def _strips(lists: Ragged, count: int) -> Index:
    """Triangles of strips, which -1 ends; every second one is turned."""
    ends = np.cumsum(lists.sizes.astype(np.int64))
    found: list[Index] = [np.zeros((0, 3), dtype=np.int64)]
    for begin, end in zip(np.concatenate([[0], ends[:-1]]), ends, strict=True):
        items = lists.items[begin:end].astype(np.int64)
        for piece in np.split(items, np.flatnonzero(items == -1)):
            strip = as_index("tristrips", piece[piece != -1], (None,), end=count)
            k = np.arange(max(len(strip) - 2, 0))
            odd = k % 2
            found.append(np.stack([strip[k], strip[k + 1 + odd], strip[k + 2 - odd]], axis=1))
    return np.concatenate(found)


def _surfaces(
    reading: Reading,
    textures: list[str],
    vertex: Table,
    face: Table,
    places: Float,
    faces: Index,
    source: Index | None,
    polygon: Index | None,
) -> list[Surface]:
    uv, normal = _columns(vertex, _UVS), _columns(vertex, _NORMALS)
    color, opacity = _colors(vertex)
    columns = {"uv": uv, "color": color, "opacity": opacity, "normal": normal}
    own: dict[str, Float | None] = {}  # of corners: (3 F, ...)
    if polygon is not None and source is not None and len(faces):
        of_faces = _colors(face) if color is None else (None, None)
        for name, values in zip(("color", "opacity"), of_faces, strict=True):
            if values is not None:
                own[name] = np.repeat(values[polygon], 3, axis=0)
        seams = face.lists.get("texcoord")
        if seams is not None and seams.sizes.any():
            own["uv"] = _seams(seams, next(face.lists[name] for name in _LISTS if name in face.lists), source)
    if own:  # every triangle gets corners of its own
        corner = faces.ravel()
        columns = {name: own.get(name, None if values is None else values[corner]) for name, values in columns.items()}
        places = places[corner]
        faces = np.arange(len(corner), dtype=np.int64).reshape(-1, 3)
    number = face.scalars.get("texnumber")
    which = np.zeros(len(faces)) if number is None or polygon is None or not len(textures) > 1 else number[polygon]
    which = np.where((which >= 0) & (which < max(1, len(textures))), which, -1)
    pictures = {k: _picture(textures[int(k)], reading) if 0 <= k < len(textures) else None for k in set(which.tolist())}
    found = []
    for k, picture in sorted(pictures.items()):
        material = _material(reading, picture if columns["uv"] is not None else None, columns["color"] is not None)
        used = faces[which == k]
        old, new = np.unique(used, return_inverse=True)
        rows = {name: None if values is None else values[old] for name, values in columns.items()}
        found.append(Surface(places[old], new.reshape(-1, 3), material, **rows))
    return found


def _seams(seams: Ragged, faces: Ragged, source: Index) -> Float:
    """(3 F, 2): the texture coordinates that a face states for its corners, 0 where it states none."""
    sizes = faces.sizes.astype(np.int64)
    whole = seams.sizes == 2 * sizes
    start = np.cumsum(seams.sizes.astype(np.int64)) - seams.sizes.astype(np.int64)
    first = np.cumsum(sizes) - sizes
    owner = np.repeat(np.arange(len(sizes)), sizes)
    at = (start[owner] + 2 * (np.arange(len(owner)) - first[owner]))[source.ravel()]
    stated = whole[owner][source.ravel()]
    items = np.append(seams.items, [0.0, 0.0])
    at = np.where(stated, at, len(seams.items))
    return items[at[:, None] + np.arange(2)]


def _columns(table: Table, names: Iterable[tuple[str, ...]]) -> Float | None:
    """(N, columns) of the first of the names' sets that the table has."""
    for chosen in names:
        if all(name in table.scalars for name in chosen):
            return np.stack([table.scalars[name] for name in chosen], axis=1)
    return None


def _colors(table: Table) -> tuple[Float | None, Float | None]:
    """Linear colours (N, 3) and opacity (N,)."""
    color, alpha = _columns(table, _COLORS), _columns(table, _ALPHAS)
    if color is None or not len(color):
        return None, None
    kind = next(table.kinds[names[0]] for names in _COLORS if all(name in table.scalars for name in names))
    if alpha is not None:
        color = np.concatenate([color, alpha], axis=1)
    color = as_float("colours", color, (None, None))
    return decoded(color, "u" if kind[0] != "f" else "f", 16 if kind[1] == "2" else 8)


def _picture(name: str, reading: Reading) -> Picture | None:
    try:
        return reading.pictures.get(reading.beside.find(name), name, reading.beside.get(name))
    except FileNotFoundError:
        return None  # it is told as missing


def _material(reading: Reading, picture: Picture | None, is_colored: bool) -> Material:
    if picture is None:
        return reading.plain(WHITE if is_colored else GREY)
    return Material(reading.shading(), WHITE, picture.color, specular=SPECULAR)
