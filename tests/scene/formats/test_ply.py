"""PLY files of all three kinds of numbers, written here by struct, with what they say known by hand."""

import struct

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import png, write
from tests.scene.formats.reading_fixtures import area_of, color_at, face_at, material_at, triangles, uv_of

pytestmark = pytest.mark.fast
FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")
CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}
NEW_NAMES = {"char": "int8", "uchar": "uint8", "short": "int16", "ushort": "uint16", "int": "int32", "uint": "uint32",
             "float": "float32", "double": "float64"}  # fmt: skip
XYZ = "float x,float y,float z"
QUAD = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
INDICES = "list uchar int vertex_indices"


def ply(order, *elements, comments=(), new_names=False):
    """A file of elements (name, "type name,list type type name", rows); a list is a tuple in its row."""
    head = [f"ply\nformat {order} 1.0"] + [f"comment {text}" for text in comments]
    body = b""
    for name, properties, rows in elements:
        head.append(f"element {name} {len(rows)}")
        kinds = [text.split() for text in properties.split(",")]
        for words in kinds:
            head.append("property " + " ".join([NEW_NAMES.get(word, word) if new_names else word for word in words]))
        for row in rows:
            cells = []
            for value, words in zip(row, kinds, strict=True):
                if words[0] == "list":
                    cells += [(CODES[words[1]], len(value)), *((CODES[words[2]], item) for item in value)]
                else:
                    cells.append((CODES[words[0]], value))
            if order == "ascii":
                body += " ".join(str(value) for _, value in cells).encode() + b"\n"
            else:
                mark = "<" if "little" in order else ">"
                body += b"".join(struct.pack(mark + code, value) for code, value in cells)
    return "\n".join([*head, "end_header\n"]).encode() + body


def loaded(folder, order, *elements, **words):
    return load_mesh(write(folder, "a.ply", ply(order, *elements, **words)))


@pytest.mark.parametrize("order", FORMATS)
@pytest.mark.parametrize("new_names", [False, True])
def test_triangles_and_polygons_in_one_file(tmp_path, order, new_names):
    places = [*QUAD, (0.5, 0.5, 0)]
    faces = [((0, 1, 2),), ((0, 2, 4, 3),), ((0, 1, 4),)]  # the second is a dart
    scene = loaded(
        tmp_path,
        order,
        ("vertex", "double x,short y,float z", [(x, int(y), z) for x, y, z in QUAD] + [(0.5, 0, 0.25)]),
        ("face", "list uchar uint vertex_index", [((0, 1, 2),), ((0, 1, 2, 3),), ((4, 1, 2),)]),
        new_names=new_names,
    )
    assert len(scene.faces) == 4
    scene = loaded(tmp_path, order, ("vertex", XYZ, places), ("face", INDICES, faces), new_names=new_names)
    assert area_of(scene) == 1.0 + 0.5 + 0.5  # by hand; all numbers are exact


@pytest.mark.parametrize("order", FORMATS)
def test_a_byte_order_mark_does_no_harm(tmp_path, order):
    data = ply(order, ("vertex", XYZ, QUAD), ("face", INDICES, [((0, 1, 2, 3),)]))
    assert area_of(load_mesh(write(tmp_path, "a.ply", b"\xef\xbb\xbf" + data))) == 2.0


@pytest.mark.parametrize("order", FORMATS)
def test_concave_polygons_have_their_area(tmp_path, order):
    places = [(1, 0, 0), (0, 0, 0), (0, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)]
    scene = loaded(tmp_path, order, ("vertex", XYZ, places), ("face", INDICES, [(tuple(range(6)),)]))
    assert area_of(scene) == 3.0


@pytest.mark.parametrize("order", FORMATS)
@pytest.mark.parametrize("names", ["red green blue", "r g b", "diffuse_red diffuse_green diffuse_blue"])
@pytest.mark.parametrize(("kind", "most"), [("uchar", 255), ("ushort", 65535), ("float", 1.0), ("float", 255.0)])
def test_colours_of_vertices(tmp_path, order, names, kind, most):
    colors = ",".join(f"{kind} {name}" for name in names.split())
    rows = [(*place, most, 0, most) for place in QUAD]
    scene = loaded(tmp_path, order, ("vertex", f"{XYZ},{colors}", rows), ("face", INDICES, [((0, 1, 2, 3),)]))
    np.testing.assert_array_equal(scene.color, np.tile([1, 0, 1], (len(scene.vertices), 1)))
    assert scene.materials[0].base_color == (1, 1, 1)


@pytest.mark.parametrize("order", FORMATS)
def test_colours_and_opacity_of_faces_of_any_size(tmp_path, order):
    faces = [((0, 1, 2, 3), 255, 0, 0, 255), ((0, 1, 4), 0, 0, 255, 51)]
    properties = f"{INDICES},uchar red,uchar green,uchar blue,uchar alpha"
    scene = loaded(tmp_path, order, ("vertex", XYZ, [*QUAD, (1, -1, 0)]), ("face", properties, faces))
    assert color_at(scene, (2, 1, 0)) == [[1, 0, 0]]
    assert color_at(scene, (0, 0, 0)) == [[0, 0, 1], [1, 0, 0]]
    blue = scene.faces[face_at(scene, (1, -1 / 3, 0))]
    np.testing.assert_allclose(scene.opacity[blue], 0.2, rtol=1e-6)  # float32


def test_colours_of_vertices_come_before_those_of_faces(tmp_path):
    rgb = "uchar red,uchar green,uchar blue"
    vertices = [(*place, 0, 255, 0) for place in QUAD]
    scene = loaded(
        tmp_path,
        "ascii",
        ("vertex", f"{XYZ},{rgb}", vertices),
        ("face", f"{INDICES},{rgb}", [((0, 1, 2, 3), 255, 0, 0)]),
    )
    assert np.unique(scene.color, axis=0).tolist() == [[0, 1, 0]]


@pytest.mark.parametrize("order", FORMATS)
def test_seams_keep_both_of_their_texture_coordinates(tmp_path, order):
    faces = [((0, 1, 2), (0, 0, 1, 0, 1, 1)), ((0, 2, 3), (0.25, 0, 1, 0.5, 0, 1))]
    properties = f"{INDICES},list uchar float texcoord"
    write(tmp_path, "p.png", png())
    scene = loaded(tmp_path, order, ("vertex", XYZ, QUAD), ("face", properties, faces), comments=["TextureFile p.png"])
    assert uv_of(scene, face_at(scene, (4 / 3, 1 / 3, 0))) == {(0, 0, 0): (0, 0), (2, 0, 0): (1, 0), (2, 1, 0): (1, 1)}
    assert uv_of(scene, face_at(scene, (2 / 3, 2 / 3, 0))) == {
        (0, 0, 0): (0.25, 0),
        (2, 1, 0): (1, 0.5),
        (0, 1, 0): (0, 1),
    }
    assert scene.materials[0].texture.shape == (2, 2, 3)


@pytest.mark.parametrize("order", FORMATS)
def test_seams_of_faces_of_several_sizes_and_pictures(tmp_path, order):
    faces = [((0, 1, 2, 3), (0, 0, 1, 0, 1, 1, 0, 1), 0), ((0, 1, 4), (), 1), ((1, 2, 4), (0.5, 0, 0, 0.5, 1, 1), 1)]
    properties = f"{INDICES},list uchar float texcoord,int texnumber"
    write(tmp_path, "a b.png", png())
    with pytest.warns(UserWarning, match=r"left out: nowhere\.png \(there is no such file\)$"):
        scene = loaded(
            tmp_path,
            order,
            ("vertex", XYZ, [*QUAD, (9, 0, 9)]),
            ("face", properties, faces),
            comments=["TextureFile a b.png", "TextureFile nowhere.png"],
        )
    assert material_at(scene, (4 / 3, 1 / 3, 0)).texture is not None
    third = face_at(scene, (13 / 3, 1 / 3, 3))
    assert material_at(scene, (13 / 3, 1 / 3, 3)).texture is None
    assert uv_of(scene, third) == {(2, 0, 0): (0.5, 0), (2, 1, 0): (0, 0.5), (9, 0, 9): (1, 1)}


@pytest.mark.parametrize("names", ["s t", "u v", "texture_u texture_v"])
def test_texture_coordinates_of_vertices(tmp_path, names):
    write(tmp_path, "p.png", png())
    rows = [(x, y, z, x / 2, y) for x, y, z in QUAD]
    uv = ",".join(f"float {name}" for name in names.split())
    scene = loaded(
        tmp_path, "ascii", ("vertex", f"{XYZ},{uv}", rows), ("face", INDICES, [((0, 1, 2, 3),)]),
        comments=["TextureFile p.png"],
    )  # fmt: skip
    np.testing.assert_array_equal(scene.uv, scene.vertices[:, :2] / (2, 1))
    assert scene.materials[0].texture is not None


@pytest.mark.parametrize("order", FORMATS)
def test_strips_of_triangles(tmp_path, order):
    strips = [((0, 1, 3, 2, -1, 0, 1, 4),)]
    scene = loaded(
        tmp_path, order, ("vertex", XYZ, [*QUAD, (1, -1, 0)]), ("tristrips", "list int int vertex_indices", strips)
    )
    # The second triangle of a strip is turned.
    wanted = [[QUAD[0], QUAD[1], QUAD[3]], [QUAD[1], QUAD[2], QUAD[3]], [QUAD[0], QUAD[1], (1, -1, 0)]]
    found = [[tuple(corner) for corner in triangle] for triangle in triangles(scene)]
    assert sorted(found) == sorted(t[t.index(min(t)) :] + t[: t.index(min(t))] for t in wanted)


def test_the_files_normals_and_elements_of_other_programs(tmp_path):
    rows = [(*place, 0, 3, 4) for place in QUAD]
    scene = loaded(
        tmp_path,
        "binary_little_endian",
        ("camera", "float fov,list uchar float lens", [(1.0, (2, 3)), (2.0, ())]),
        ("vertex", f"{XYZ},float nx,float ny,float nz", rows),
        ("face", INDICES, [((0, 1, 2, 3),)]),
        ("edge", "int vertex1,int vertex2", [(0, 1)]),
        comments=["TextureFile", "made by hand"],
    )
    np.testing.assert_allclose(scene.normal, np.tile([0, 0.6, 0.8], (4, 1)), atol=1e-7)  # float32


@pytest.mark.parametrize("order", FORMATS)
@pytest.mark.parametrize("count", [5, 10**9])
def test_files_shorter_than_they_say_are_refused_at_once(tmp_path, order, count):
    data = ply(order, ("vertex", XYZ, QUAD), ("face", INDICES, [((0, 1, 2, 3),)]))
    for element, rows in (("vertex", 4), ("face", 1)):
        cut = data.replace(f"element {element} {rows}".encode(), f"element {element} {count}".encode())
        with pytest.raises(
            InputError, match=r"vertex: the file ends|face: the file ends|a list has the length|outside|no triangle"
        ):
            load_mesh(write(tmp_path, "a.ply", cut))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"format ascii 1.0\n", b"", "header: has no format"),
        (b"format ascii", b"format pdp11", "header: got 'format pdp11 1.0'"),
        (b"float x", b"half x", "property 'half x'"),
        (b"element vertex 4", b"element vertex -4", "element vertex -4"),
        (b"property float z", b"property float w", "no vertices with x, y and z"),
        (b"2 1 0", b"2 one 0", "numbers: "),
        (b"4 0 1 2 3", b"4 0 1 2 4", "faces: index 4 is outside 0 .. 3"),
        (b"4 0 1 2 3", b"-4 0 1 2 3", "a list has the length -4"),
        (b"end_header", b"end", "it has no header"),
        (b"list uchar int vertex_indices", b"list uchar int corners", "it has no faces, only points"),
    ],
)
def test_bad_files_are_named(tmp_path, old, new, message):
    data = ply("ascii", ("vertex", XYZ, QUAD), ("face", INDICES, [((0, 1, 2, 3),)]))
    assert old in data
    with pytest.raises(InputError, match=message):
        load_mesh(write(tmp_path, "a.ply", data.replace(old, new)))
