"""OBJ and MTL files: small ones written here, with what they say known by hand."""

import io

import numpy as np
import pytest
from PIL import Image

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import png, write
from tests.scene.formats.reading_fixtures import area_of, color_at, face_at, material_at, triangles, uv_of

pytestmark = pytest.mark.fast
QUAD = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
UVS = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
FACE = "f 1/1 2/2 3/3 4/4\n"
PAINTED = f"{QUAD}{UVS}mtllib a.mtl\nusemtl paper\n{FACE}"
HALF = 0.21404  # of sRGB 0.5, five digits


def loaded(folder, text, **others):
    for name, content in others.items():
        write(folder, name.replace("_", "."), content)
    return load_mesh(write(folder, "a.obj", text))


def test_concave_polygons_have_their_area(tmp_path):
    """With and without texture coordinates, as one of several, and with a hole."""
    L = "v 1 0 0\nv 0 0 0\nv 0 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\n"
    assert area_of(loaded(tmp_path, f"{L}f 1 2 3 4 5 6\n")) == 3.0
    assert area_of(loaded(tmp_path, f"{L}vt 0 0\nf 1/1 2/1 3/1 4/1 5/1 6/1\nf 1 2 6\n")) == 3.5
    rim = "".join(f"v {x} {y} 0\n" for x, y in ((0, 0), (4, 0), (4, 4), (0, 4), (1, 1), (1, 3), (3, 3), (3, 1)))
    assert area_of(loaded(tmp_path, f"{rim}f 1 2 3 4 1 5 6 7 8 5\n")) == 12.0


def test_numbers_below_0_count_back_from_where_they_stand(tmp_path):
    text = f"{QUAD}vt 9 9\nvt 0 0\nvt 1 0\nvt 1 1\nf -4/-3 -3/-2 -2/-1\nv 7 7 7\nf 1 2 -1\n"
    scene = loaded(tmp_path, text)
    assert triangles(scene) == [[[0, 0, 0], [2, 0, 0], [2, 1, 0]], [[0, 0, 0], [2, 0, 0], [7, 7, 7]]]
    face = face_at(scene, (4 / 3, 1 / 3, 0))
    assert uv_of(scene, face) == {(0, 0, 0): (0, 0), (2, 0, 0): (1, 0), (2, 1, 0): (1, 1)}


def test_one_object_coloured_and_another_not(tmp_path):
    text = "o a\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 0.5 0.5 0.5\nf 1 2 3\no b\nv 5 5 5\nv 6 5 5\nv 6 6 5\nf 4 5 6\n"
    scene = loaded(tmp_path, text)
    assert color_at(scene, (0, 0, 0)) == [[1, 0, 0]]
    np.testing.assert_allclose(color_at(scene, (1, 1, 0)), [[HALF] * 3], atol=5e-6)  # five digits
    assert material_at(scene, (0.7, 0.3, 0)).base_color == (1.0, 1.0, 1.0)
    assert material_at(scene, (5.7, 5.3, 5)).base_color == (0.5, 0.5, 0.5)
    assert color_at(scene, (5, 5, 5)) == [[1, 1, 1]]


@pytest.mark.parametrize("row", ["255 0 128", "1 0 0.5019607843137255", "1 0 0.5019607843137255 1"])
def test_colours_of_vertices_in_bytes_or_parts(tmp_path, row):
    scene = loaded(tmp_path, "".join(f"v {x} {y} 0 {row}\n" for x, y in ((0, 0), (1, 0), (0, 1))) + "f 1 2 3\n")
    # sRGB 128 is 0.2158605 linear, IEC 61966-2-1.
    np.testing.assert_allclose(scene.color, np.tile([1, 0, 0.2158605], (3, 1)), atol=1e-7)


def test_several_libraries_in_lines_and_in_one(tmp_path):
    write(tmp_path, "c d.mtl", "newmtl third\nKd 0 0 1\n")
    text = f"{QUAD}v 9 0 0\nv 9 1 0\nv 9 1 1\nmtllib a.mtl b.mtl\nmtllib c d.mtl\n"
    faces = "usemtl paper\nf 1 2 3\nusemtl Second\nf 1 3 4\nusemtl third\nf 5 6 7\n"
    scene = loaded(tmp_path, text + faces,
                   a_mtl="newmtl paper\nKd 1 0 0\n", b_mtl="newmtl second\nKd 0 1 0\n")  # fmt: skip
    assert material_at(scene, (1.3, 0.3, 0)).base_color == (1, 0, 0)
    assert material_at(scene, (0.6, 0.7, 0)).base_color == (0, 1, 0)  # its name in another letter case
    assert material_at(scene, (9, 0.7, 0.3)).base_color == (0, 0, 1)


def test_quoted_names_with_blanks(tmp_path):
    write(tmp_path, "my paints.mtl", 'newmtl my paper\nmap_Kd "my picture.png"\n')
    write(tmp_path, "my picture.png", png())
    scene = loaded(tmp_path, f'{QUAD}{UVS}mtllib "my paints.mtl"\nusemtl my paper\n{FACE}')
    assert scene.materials[0].texture.shape == (2, 2, 3)


def test_pictures_are_looked_for_beside_their_library_first(tmp_path):
    (tmp_path / "paints").mkdir()
    write(tmp_path / "paints", "a.mtl", "newmtl paper\nmap_Kd p.png\n")
    write(tmp_path, "p.png", picture((0, 255, 0)))
    text = PAINTED.replace("a.mtl", r"Paints\A.MTL")
    np.testing.assert_array_equal(loaded(tmp_path, text).materials[0].texture[0, 0], (0, 1, 0))
    write(tmp_path / "paints", "p.png", picture((255, 0, 0)))
    np.testing.assert_array_equal(loaded(tmp_path, text).materials[0].texture[0, 0], (1, 0, 0))


def picture(color, mode="RGB"):
    out = io.BytesIO()
    Image.new(mode, (1, 1), color).save(out, "png")
    return out.getvalue()


@pytest.mark.parametrize(
    ("options", "scale", "offset", "wrap"),
    [
        ("", (1, 1), (0, 0), "repeat"),
        ("-s 2 3 1", (2, 3), (0, 0), "repeat"),
        ("-s 2 3", (2, 3), (0, 0), "repeat"),
        ("-s 2", (2, 1), (0, 0), "repeat"),
        ("-o 0.5 -0.25 0", (1, 1), (0.5, -0.25), "repeat"),
        ("-clamp on", (1, 1), (0, 0), "clamp"),
        ("-clamp off -blendu off -cc off -texres 4 -bm 1", (1, 1), (0, 0), "repeat"),
        ("-S 4 2 1 -o 1 2 3 -clamp on", (4, 2), (1, 2), "clamp"),
    ],
)
def test_options_of_a_picture(tmp_path, options, scale, offset, wrap):
    scene = loaded(tmp_path, PAINTED, a_mtl=f"newmtl paper\nmap_Kd {options} 1 p.png\n")if False else loaded(
        tmp_path, PAINTED, a_mtl=f"newmtl paper\nmap_Kd {options} p.png\n", p_png=png()
    )  # fmt: skip
    assert scene.materials[0].texture.shape == (2, 2, 3)
    assert scene.materials[0].wrap == (wrap, wrap)
    found = {tuple(v.tolist()): tuple(uv.tolist()) for v, uv in zip(scene.vertices, scene.uv, strict=True)}
    for x, u in ((0, 0), (2, 1)):
        for y in (0, 1):
            assert found[(x, y, 0)] == (u * scale[0] + offset[0], y * scale[1] + offset[1])


def test_brightness_and_contrast_of_a_picture(tmp_path):
    scene = loaded(tmp_path, PAINTED, a_mtl="newmtl paper\nmap_Kd -mm 0.25 0.5 p.png\n", p_png=picture((255, 0, 0)))
    np.testing.assert_array_equal(scene.materials[0].texture[0, 0], (0.75, 0.25, 0.25))


@pytest.mark.parametrize(
    ("text", "opacity"),
    [("d 0.25", 0.25), ("Tr 0.25", 0.75), ("Tr 0.25\nd 0.5", 0.5), ("d -halo 0.5", 0.5), ("d 7", 1.0), ("", 1.0)],
)
def test_opacity(tmp_path, text, opacity):
    material = loaded(tmp_path, PAINTED, a_mtl=f"newmtl paper\n{text}\n").materials[0]
    assert (material.opacity, material.cutoff, material.opacity_texture) == (opacity, None, None)


@pytest.mark.parametrize(
    ("color", "mode", "opacity"),
    [(51, "L", 0.2), ((51, 0, 0), "RGB", 0.2), ((0, 0, 0, 102), "RGBA", 0.4)],
)
def test_a_picture_for_opacity(tmp_path, color, mode, opacity):
    material = loaded(tmp_path, PAINTED, a_mtl="newmtl paper\nmap_d p.png\n", p_png=picture(color, mode)).materials[0]
    np.testing.assert_allclose(material.opacity_texture, [[opacity]], rtol=1e-6)  # float32
    assert material.texture is None


def test_emission_and_its_picture(tmp_path):
    material = loaded(tmp_path, PAINTED, a_mtl="newmtl paper\nKe 5 6 7\n").materials[0]
    assert (material.emission, material.emission_texture) == ((5, 6, 7), None)
    material = loaded(tmp_path, PAINTED, a_mtl="newmtl paper\nmap_Ke p.png\n", p_png=picture((255, 0, 0))).materials[0]
    assert material.emission == (1, 1, 1)
    np.testing.assert_array_equal(material.emission_texture, [[(1, 0, 0)]])
    with pytest.warns(UserWarning, match="nowhere.png"):
        material = loaded(tmp_path, PAINTED, a_mtl="newmtl paper\nKe 5 6 7\nmap_Ke nowhere.png\n").materials[0]
    assert material.emission == (0, 0, 0)


@pytest.mark.parametrize(
    ("library", "told"),
    [
        ("newmtl other\n", r"the material 'paper' \(no material library has it\)"),
        ("newmtl paper\nmap_Kd\n", r"the picture of map_kd \(it has no name\)"),
        ("newmtl paper\nmap_Kd nowhere.png\n", r"nowhere\.png \(there is no such file\)"),
        ("newmtl paper\nmap_Kd a.mtl\n", r"a\.mtl \(it is no picture\)"),
        ("newmtl paper\nmap_bump p.png\n", r"pictures for map_bump \(they are not read\)"),
        ("newmtl paper\nmap_Kd -t 1 1 1 p.png\n", "the option -t of map_kd"),
        ("newmtl paper\nmap_Kd p.png\nmap_d -s 2 2 2 p.png\n", "the options of map_d"),
    ],
)
def test_what_is_left_out_is_one_warning(tmp_path, library, told):
    with pytest.warns(UserWarning, match=f"a.obj: left out: .*{told}") as caught:
        loaded(tmp_path, PAINTED, a_mtl=library, p_png=png())
    assert len(caught) == 1


def test_a_material_without_a_library_is_told(tmp_path):
    with pytest.warns(UserWarning, match="left out: the material 'paper'"):
        scene = loaded(tmp_path, PAINTED.replace("mtllib a.mtl\n", ""))
    assert scene.materials[0].base_color == (0.5, 0.5, 0.5)


def test_faces_of_one_material_with_and_without_texture_coordinates(tmp_path):
    text = f"{PAINTED}v 5 5 5\nv 6 5 5\nv 6 6 5\nf 5 6 7\n"
    scene = loaded(tmp_path, text, a_mtl="newmtl paper\nKd 0.5 0 0\nmap_Kd p.png\n", p_png=png())
    assert material_at(scene, (1.3, 0.3, 0)).texture is not None
    assert material_at(scene, (5.7, 5.3, 5)).texture is None
    assert {m.base_color for m in scene.materials} == {(0.5, 0.0, 0.0)}


def test_faces_that_name_what_the_file_has_not(tmp_path):
    with pytest.warns(UserWarning, match=r"vt \(faces name some, and the file has none\), vn \("):
        assert len(loaded(tmp_path, f"{QUAD}f 1/1/1 2/2/1 3/3/1\n").faces) == 1


def test_the_files_normals(tmp_path):
    scene = loaded(tmp_path, f"{QUAD}vn 0 3 4\nf 1//1 2//1 3//1\n")
    np.testing.assert_allclose(scene.normal, np.tile([0, 0.6, 0.8], (3, 1)), atol=1e-7)  # float32


def test_lines_that_go_on_comments_and_letter_case(tmp_path):
    text = "# a\nV 0 0 0 # first\r\nv 1 0 \\\r\n0\nv\t0 1 0\nF 1 2 \\\n3\n"
    assert triangles(loaded(tmp_path, text)) == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


def test_free_forms_points_and_lines(tmp_path):
    with pytest.warns(UserWarning, match=r"free-form geometry \(surf\)"):
        scene = loaded(tmp_path, f"{QUAD}p 1\nl 1 2\nf 1 2\nf 1 2 3\ncstype bezier\nsurf 0 1 0 1 1 2 3\n")
    assert len(scene.faces) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{QUAD}f 0 1 2\n", "f: got '0'"),
        (f"{QUAD}f -5 1 2\n", "f: got '-5' after 4 v"),
        (f"{QUAD}vt 0 0\nf 1/2 2/1 3/1\n", "f, vt: index 1 is outside 0 .. 0"),
        (f"{QUAD}vn 0 0 1\nf 1//2 2//1 3//1\n", "f, vn: index 1 is outside 0 .. 0"),
        (f"{QUAD}f /1 /1 /1\n", "f: a corner has no place"),
        (f"{QUAD}f 1.5 2 3\n", "f: got '1.5'"),
        ("v 0 0\nf 1 1 1\n", "v: .*allowed are 3 numbers a line"),
        ("v 0 0 0 red green blue\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "v: a colour is no number"),
    ],
)
def test_bad_lines_are_named(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        loaded(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n", "it has no triangle"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "f: got vertex 9; allowed are 1 .. 3, those of the file"),
    ],
)
def test_faces_that_are_not_there_are_said_in_the_files_own_numbers(tmp_path, text, said):
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(InputError, match=said):
        load_mesh(tmp_path / "a.obj")
