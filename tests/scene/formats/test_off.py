"""OFF files with all that their headers can announce."""

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import write
from tests.scene.formats.reading_fixtures import area_of, color_at, face_at, material_at

pytestmark = pytest.mark.fast
QUAD = ("0 0 0", "2 0 0", "2 1 0", "0 1 0")


def off(head="OFF", tail=("",) * 4, faces=("4 0 1 2 3",), counts=None):
    rows = [f"{place} {more}" for place, more in zip(QUAD, tail, strict=True)]
    return "\n".join([head, counts or f"4 {len(faces)} 0", *rows, *faces]) + "\n"


def loaded(folder, *args, **words):
    return load_mesh(write(folder, "a.off", off(*args, **words)))


@pytest.mark.parametrize("text", [
    off(), off("OFF # a comment"), "# first\n\n" + off(), off("OFF 4 1 0", counts=" "), off().replace("OFF\n", ""),
    off().replace("\n", "\r\n"), off("OFF", counts="4 1"),
])  # fmt: skip
def test_headers_as_programs_write_them(tmp_path, text):
    scene = load_mesh(write(tmp_path, "a.off", text))
    assert area_of(scene) == 2.0
    assert scene.materials[0].base_color == (0.5, 0.5, 0.5)


@pytest.mark.parametrize("color", ["255 0 255", "255 0 255 255", "1.0 0.0 1.0", "1 0 1 1"])
@pytest.mark.parametrize("head", ["COFF", "OFF"])
def test_colours_of_vertices(tmp_path, color, head):
    scene = loaded(tmp_path, head, (color,) * 4)
    np.testing.assert_array_equal(scene.color, np.tile([1, 0, 1], (4, 1)))
    assert (scene.materials[0].base_color, scene.opacity) == ((1, 1, 1), None)


def test_opacity_of_vertices(tmp_path):
    np.testing.assert_allclose(loaded(tmp_path, "COFF", ("255 0 0 51",) * 4).opacity, 0.2, rtol=1e-6)  # float32


def test_normals_colours_and_texture_coordinates_together(tmp_path):
    scene = loaded(tmp_path, "STCNOFF", tuple(f"0 3 4 0 255 0 255 0.{k} 0.25" for k in range(4)))
    np.testing.assert_allclose(scene.normal, np.tile([0, 0.6, 0.8], (4, 1)), atol=1e-7)  # float32
    np.testing.assert_array_equal(scene.color, np.tile([0, 1, 0], (4, 1)))
    np.testing.assert_allclose(np.sort(scene.uv[:, 0]), [0, 0.1, 0.2, 0.3], atol=1e-7)


@pytest.mark.parametrize(("red", "blue"), [("255 0 0", "0 0 255 51"), ("1.0 0 0", "0 0 1.0 0.2")])
def test_colours_of_faces(tmp_path, red, blue):
    scene = loaded(tmp_path, faces=(f"3 0 1 2 {red}", f"3 0 2 3 {blue}"))
    assert color_at(scene, (2, 0, 0)) == [[1, 0, 0]]
    assert color_at(scene, (0, 0, 0)) == [[0, 0, 1], [1, 0, 0]]
    np.testing.assert_allclose(scene.opacity[scene.faces[face_at(scene, (2 / 3, 2 / 3, 0))]], 0.2, rtol=1e-6)


def test_some_faces_have_a_colour(tmp_path):
    scene = loaded(tmp_path, faces=("3 0 1 2 255 0 0", "3 0 2 3"))
    assert material_at(scene, (4 / 3, 1 / 3, 0)).base_color == (1, 1, 1)
    assert material_at(scene, (2 / 3, 2 / 3, 0)).base_color == (0.5, 0.5, 0.5)


def test_numbers_of_another_programs_colours_are_told(tmp_path):
    with pytest.warns(UserWarning, match="left out: colours of faces"):
        loaded(tmp_path, faces=("4 0 1 2 3 7",))


def test_concave_polygons_have_their_area(tmp_path):
    rows = "1 0 0\n0 0 0\n0 1 0\n-1 1 0\n-1 -1 0\n1 -1 0\n"
    assert area_of(load_mesh(write(tmp_path, "a.off", f"OFF\n6 1 0\n{rows}6 0 1 2 3 4 5\n"))) == 3.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("OFF BINARY\n" + "x" * 60, "it is a binary OFF file"),
        (off("4OFF"), "it is a 4OFF file; allowed are three dimensions"),
        (off("nOFF"), "it is a nOFF file"),
        (off(counts="4 2 0"), "4 vertices and 2 faces of 5 lines"),
        (off(counts="99999999999 1 0"), "counts: got 99999999999"),
        (off(counts="4 one 0"), "counts: got 'one'"),
        (off(faces=("4 0 1 2 9",)), "faces: index 9 is outside 0 .. 3"),
        (off(faces=("5 0 1 2 3",)), "faces: a line has 4 numbers for 5 corners"),
        (off(faces=("4 0 1 2 x",)), "faces: got 'x'"),
        (off("COFF"), "vertices: a line has 3 numbers; allowed are 6 or more"),
        (off("NOFF", ("0 0 up",) * 4), "vertices: "),
        ("hello\n", "counts: got 'hello'"),
    ],
)
def test_bad_files_are_named(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        load_mesh(write(tmp_path, "a.off", text))
