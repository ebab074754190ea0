"""Reading mesh files: tiny files written here, with numbers known by hand."""

import json
import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from refdof._check import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import LINEAR, PLY, QUAD, TEXELS, UV_UP, gltf, png, uri, write


def texel_at(scene, corner):
    """Linear colour of the texel nearest to a vertex, by this project's convention for u and v."""
    vertex = int(np.argmin(np.abs(scene.vertices - corner).sum(axis=1)))
    texture = scene.materials[scene.face_material[0]].texture
    u, v = np.clip(scene.uv[vertex], 0.01, 0.99)
    return texture[int((1.0 - v) * len(texture)), int(u * texture.shape[1])]


def assert_quad_is_textured(scene):
    assert scene.materials[0].texture.dtype == np.float32
    # LINEAR gives 0.5029 to four digits.
    np.testing.assert_allclose(scene.materials[0].texture, LINEAR, atol=5e-5)
    for corner, expected in zip(QUAD, LINEAR[[1, 1, 0, 0], [0, 1, 1, 0]], strict=True):
        np.testing.assert_allclose(texel_at(scene, corner), expected, atol=5e-5)


BASE_TEXTURE = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}


def test_gltf_texture_is_upright_and_linear(tmp_path):
    text = gltf([{"mesh": 0}], [BASE_TEXTURE], uri("image/png", png()))
    scene = load_mesh(write(tmp_path, "quad.gltf", text))
    assert scene.name == "quad"
    assert scene.materials[0].base_color == (1.0, 1.0, 1.0)
    assert_quad_is_textured(scene)


def test_glb_written_by_trimesh(tmp_path):
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(TEXELS))
    visual = trimesh.visual.TextureVisuals(uv=UV_UP, material=material)
    quad = trimesh.Trimesh(QUAD, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
    assert_quad_is_textured(load_mesh(write(tmp_path, "quad.glb", trimesh.Scene(quad).export(file_type="glb"))))


def test_obj_with_material_library(tmp_path):
    write(tmp_path, "texels.png", png())
    write(tmp_path, "quad.mtl", "newmtl paper\nKd 0.5 0.25 1.0\nNs 80\nmap_Kd texels.png\n")
    lines = [f"v {x} {y} {z}" for x, y, z in QUAD] + [f"vt {u} {v}" for u, v in UV_UP]
    text = "\n".join(["mtllib quad.mtl", *lines, "usemtl paper", "f 1/1 2/2 3/3 4/4"])
    scene = load_mesh(write(tmp_path, "quad.obj", text))
    assert len(scene.faces) == 2
    assert (scene.materials[0].base_color, scene.materials[0].shininess) == ((0.5, 0.25, 1.0), 80.0)
    assert_quad_is_textured(scene)


def test_one_image_is_one_texture(tmp_path):
    second = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}, "baseColorFactor": [0, 1, 0, 1]}}
    nodes = [{"mesh": 0}, {"mesh": 1, "translation": [5, 0, 0]}, {"mesh": 0, "translation": [0, 5, 0]}]
    scene = load_mesh(write(tmp_path, "a.gltf", gltf(nodes, [BASE_TEXTURE, second], uri("image/png", png()))))
    assert len(scene.materials) == 2
    assert scene.materials[0].texture is scene.materials[1].texture
    assert np.bincount(scene.face_material).tolist() == [4, 2]


def test_nodes_place_meshes(tmp_path):
    # Child: times (3, 1, 1), a quarter turn about z (x to y), + (0, 0, 7). Parent: x mirrored, + (1, 0, 0).
    half = np.sqrt(0.5)
    child = {"mesh": 0, "translation": [0, 0, 7], "rotation": [0, 0, half, half], "scale": [3, 1, 1]}
    parent = {"children": [1], "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]}
    scene = load_mesh(write(tmp_path, "placed.gltf", gltf([parent, child], roots=[0])))
    # (x, y, 0) -> (3 x, y, 0) -> (-y, 3 x, 7) -> (1 + y, 3 x, 7). Single precision of the file.
    expected = [[1 + y, 3 * x, 7] for x, y, _ in QUAD.tolist()]
    np.testing.assert_allclose(scene.vertices, expected, atol=1e-6)
    np.testing.assert_allclose(np.abs(scene.normal), np.tile([0, 0, 1], (4, 1)), atol=1e-6)


def test_the_files_normals_turn_with_their_node(tmp_path):
    tilted = np.tile([0.6, 0.0, 0.8], (3, 1))
    mesh = trimesh.Trimesh(QUAD[:3], [[0, 1, 2]], vertex_normals=tilted, process=False)
    world = np.diag([2.0, 1.0, 1.0, 1.0])
    placed = trimesh.Scene()
    placed.add_geometry(mesh, transform=world)
    path = write(tmp_path, "n.glb", placed.export(file_type="glb", include_normals=True))
    # Normals turn by the inverse transpose: (0.3, 0, 0.8) / sqrt(0.73). Single precision of the file.
    np.testing.assert_allclose(load_mesh(path).normal, np.tile([0.3, 0, 0.8], (3, 1)) / np.sqrt(0.73), atol=1e-6)


def test_gltf_colours_are_linear(tmp_path):
    colors = [[0.25, 0.5, 1.0]] * 4
    grey = {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1]}, "emissiveFactor": [0.5, 0, 1]}
    scene = load_mesh(write(tmp_path, "c.gltf", gltf([{"mesh": 0}], [grey], colors=colors)))
    np.testing.assert_allclose(scene.color, colors, atol=1e-7)  # single precision
    # trimesh keeps material colours with 8 bits.
    np.testing.assert_allclose(scene.materials[0].base_color, [0.5, 0.25, 0.125], atol=0.5 / 255)
    assert scene.materials[0].emission == (0.5, 0.0, 1.0)


def test_ply_quads_with_srgb_colours(tmp_path):
    scene = load_mesh(write(tmp_path, "c.ply", PLY))
    assert len(scene.faces) == 2
    np.testing.assert_allclose(scene.color, np.tile([0.5029, 1.0, 0.0], (4, 1)), atol=5e-5)  # four digits
    assert scene.materials[0].base_color == (1.0, 1.0, 1.0)


def test_colours_of_faces(tmp_path):
    mesh = trimesh.Trimesh(QUAD, [[0, 1, 2], [0, 2, 3]], face_colors=[[255, 0, 0, 255], [0, 0, 255, 255]])
    scene = load_mesh(write(tmp_path, "f.ply", mesh.export(file_type="ply")))
    expected = np.repeat([[1, 0, 0], [0, 0, 1]], 3, axis=0).reshape(2, 3, 3)
    np.testing.assert_array_equal(scene.color[scene.faces], expected)


@pytest.mark.parametrize(
    ("suffix", "options"),
    [
        ("ply", {"encoding": "binary"}),
        ("ply", {"encoding": "ascii"}),
        ("stl", {}),
        ("off", {}),
        ("obj", {}),
        ("glb", {}),
    ],
)
def test_every_format_gives_the_same_box(tmp_path, suffix, options):
    box = trimesh.creation.box((2.0, 4.0, 6.0))
    scene = load_mesh(write(tmp_path, f"box.{suffix}", box.export(file_type=suffix, **options)))
    corner = scene.vertices[scene.faces]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2
    assert area == 88.0  # 2 (8 + 12 + 24), exact in single precision
    np.testing.assert_array_equal([scene.vertices.min(axis=0), scene.vertices.max(axis=0)], [[-1, -2, -3], [1, 2, 3]])
    assert scene.materials[0].base_color == (0.5, 0.5, 0.5) or suffix == "glb"
    if suffix not in ("glb", "obj"):  # these may carry normals of their own
        # No edge of a box is smooth: every normal lies along an axis, exactly.
        axes = np.tile([0, 0, 1], (len(scene.normal), 1))
        np.testing.assert_array_equal(np.sort(np.abs(scene.normal), axis=1), axes)


def test_shading_and_background(tmp_path):
    path = write(tmp_path, "c.ply", PLY)
    assert load_mesh(path).materials[0].shading == "lambert"
    assert load_mesh(str(path), "phong").materials[0].specular == (0.04, 0.04, 0.04)
    assert load_mesh(path, "unlit", (1, 2, 3)).background == (1.0, 2.0, 3.0)
    for bad in ({"shading": "toon"}, {"background": (0, 0, -1)}):
        with pytest.raises(InputError, match=f"^{next(iter(bad))}: "):
            load_mesh(path, **bad)


def test_roughness_makes_broad_highlights(tmp_path):
    shininess = []
    for roughness in (0.0, 0.5, 1.0):
        pbr = {"pbrMetallicRoughness": {"roughnessFactor": roughness}}
        path = write(tmp_path, "r.gltf", gltf([{"mesh": 0}], [pbr]))
        shininess.append(load_mesh(path, "phong").materials[0].shininess)
    # (2 / r^4 - 2) / 4, within 1 .. 2000: at r = 1/2 it is (32 - 2) / 4 = 7.5 exactly.
    assert shininess == [2000.0, 7.5, 1.0]


def test_missing_and_broken_textures_leave_the_colour(tmp_path):
    absent, cut, other = "nowhere.png", uri("image/png", png()[:50]), uri("image/png", b"not a picture")
    for image, told in (
        (absent, r"nowhere\.png \(there is no such file\)"),
        (cut, "texture 1 "),
        (other, r"texture 1 \(it is no picture\)$"),
    ):
        with pytest.warns(UserWarning, match=rf"quad\.gltf: left out: {told}"):
            scene = load_mesh(write(tmp_path, "quad.gltf", gltf([{"mesh": 0}], [BASE_TEXTURE], image)))
        assert scene.materials[0].texture is None
    write(tmp_path, "quad.mtl", "newmtl paper\nmap_Kd nowhere.png\n")
    triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl paper\nf 1/1 2/1 3/1\n"
    for library, lost in (("quad.mtl", "nowhere.png"), ("nowhere.mtl", "nowhere.mtl")):
        with pytest.warns(UserWarning, match=rf"quad\.obj: left out: {lost} \(there is no such file\)"):
            scene = load_mesh(write(tmp_path, "quad.obj", f"mtllib {library}\n{triangle}"))
        assert scene.materials[0].texture is None
        assert scene.materials[0].base_color == (0.5, 0.5, 0.5)


PAINTED = "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl paper\nf 1/1 2/2 3/3\n"


@pytest.mark.parametrize(
    ("written", "named"),
    [
        ("a.mtl", "a.mtl"),
        ("Sub/A.MTL", "sub/a.mtl"),
        ("sub\\\\a.mtl", "sub/a.mtl"),
        ("with%20space.mtl", "with space.mtl"),
        ("100%.mtl", "100%.mtl"),
        ("./sub/../a.mtl", "a.mtl"),
    ],
)
def test_files_beside_are_found_as_any_system_writes_them(tmp_path, written, named):
    (tmp_path / "sub").mkdir()
    write(tmp_path, named, "newmtl paper\nKd 0.25 0.5 0.75\n")
    scene = load_mesh(write(tmp_path, "a.obj", PAINTED.format(written.replace("\\\\", "\\"))))
    assert scene.materials[0].base_color == (0.25, 0.5, 0.75)


def test_only_plain_files_below_the_mesh_are_opened(tmp_path):
    """A pipe would never end; what is outside is none of a scene's."""
    inner = tmp_path / "inner"
    inner.mkdir()
    secret = write(tmp_path, "secret.mtl", "newmtl paper\nKd 1 0 0\n")
    os.mkfifo(inner / "pipe.mtl")
    (inner / "link.mtl").symlink_to(secret)
    (inner / "folder.mtl").mkdir()
    for name, reason in (
        ("../secret.mtl", "it is outside"),
        (str(secret), "it is outside"),
        ("link.mtl", "it is outside"),
        ("pipe.mtl", "it is no plain file"),
        ("folder.mtl", "it is no plain file"),
        ("/dev/zero", "it is outside"),
        ("http://127.0.0.1:9/a.mtl", "it is on another machine"),
    ):
        with pytest.warns(UserWarning, match=reason):
            scene = load_mesh(write(inner, "a.obj", PAINTED.format(name)))
        assert scene.materials[0].base_color == (0.5, 0.5, 0.5)
    whole = json.loads(gltf([{"mesh": 0}], [BASE_TEXTURE], uri("image/png", png())))
    whole["buffers"][0]["uri"] = "../secret.mtl"
    with pytest.raises(InputError, match=r"secret\.mtl: it is outside"):
        load_mesh(write(inner, "a.gltf", json.dumps(whole)))


def test_huge_textures_are_left_out_before_they_are_decoded(tmp_path):
    blank = png_of_zeros(13000, 13000)
    assert len(blank) < 1_000_000
    write(tmp_path, "huge.png", blank)
    write(tmp_path, "a.mtl", "newmtl paper\nmap_Kd huge.png\n")
    with pytest.warns(UserWarning, match="13000 x 13000 pixels; allowed are at most 67108864"):
        scene = load_mesh(write(tmp_path, "a.obj", PAINTED.format("a.mtl")))
    assert scene.materials[0].texture is None


def png_of_zeros(width, height):
    """A grey picture, by hand: it says its size first, so nobody needs to decode it."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = zlib.compress(bytes(width + 1) * height, 9)
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def test_colours_of_gltf_materials_are_what_the_file_says(tmp_path):
    """Not rounded to 8 bits, with the strength of their light, and without a light of ours where the file says so."""
    materials = [
        {"pbrMetallicRoughness": {"baseColorFactor": [0.001, 0.003, 0.0137, 1.0]}},
        {"emissiveFactor": [1.0, 0.5, 0.25]} | extension("KHR_materials_emissive_strength", emissiveStrength=20.0),
        {"name": "paper"} | extension("KHR_materials_unlit"),
    ]
    path = write(tmp_path, "a.gltf", gltf([{"mesh": k} for k in range(3)], materials))
    assert {(material.shading, material.base_color, material.emission) for material in load_mesh(path).materials} == {
        ("lambert", (0.001, 0.003, 0.0137), (0.0, 0.0, 0.0)),
        ("lambert", (1.0, 1.0, 1.0), (20.0, 10.0, 5.0)),
        ("unlit", (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
    }
    assert {material.shading for material in load_mesh(path, "phong").materials} == {"phong"}


def extension(name, **values):
    return {"extensions": {name: values}}


@pytest.mark.parametrize(
    "material",
    [
        {"pbrMetallicRoughness": {"baseColorFactor": [0.5]}},
        {"pbrMetallicRoughness": {"baseColorFactor": "red"}},
        {"pbrMetallicRoughness": 3},
        {"emissiveFactor": [1.0, -1.0, 0.0]},
        {"emissiveFactor": [1.0, 1.0, 1.0]} | extension("KHR_materials_emissive_strength", emissiveStrength=-1),
        {"extensions": []},
    ],
)
def test_bad_colours_of_gltf_materials_are_one_line(tmp_path, material):
    with pytest.raises(InputError, match="scene: got"):
        load_mesh(write(tmp_path, "a.gltf", gltf([{"mesh": 0}], [material])))


def test_extensions_are_refused_by_name_or_left_out_with_a_warning(tmp_path):
    whole = json.loads(gltf([{"mesh": 0}]))
    for name in ("KHR_materials_sheen", "KHR_texture_basisu", "ACME_teapots"):
        required = {**whole, "extensionsUsed": [name], "extensionsRequired": [name]}
        with pytest.raises(
            InputError,
            match=f"it requires the extension '{name}'; allowed are EXT_mesh",
        ):
            load_mesh(write(tmp_path, "a.gltf", json.dumps(required)))
        with pytest.warns(UserWarning, match=f"a.gltf: left out: the extension {name}$"):
            load_mesh(write(tmp_path, "a.gltf", json.dumps({**whole, "extensionsUsed": [name]})))
    read = [f"KHR_materials_{word}" for word in ("emissive_strength", "pbrSpecularGlossiness", "unlit")]
    load_mesh(write(tmp_path, "a.gltf", json.dumps({**whole, "extensionsUsed": read, "extensionsRequired": read})))
    for lists in ({"extensionsUsed": "KHR"}, {"extensionsRequired": [3]}):
        with pytest.raises(InputError, match="got no list of names"):
            load_mesh(write(tmp_path, "a.gltf", json.dumps({**whole, **lists})))


def test_comments_need_not_be_utf8(tmp_path):
    text = "# gez\u00e4hlt\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    assert len(load_mesh(write(tmp_path, "old.obj", text.encode("latin-1"))).faces) == 1


def test_triangles_without_area_are_counted(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n"
    scene = load_mesh(write(tmp_path, "d.obj", text))
    assert (len(scene.faces), scene.dropped_faces) == (1, 2)


def test_a_model_that_stands_on_z_is_seen_and_lit_from_its_front(tmp_path):
    bottle = trimesh.creation.cylinder(radius=0.3, height=2.0)
    scene = load_mesh(write(tmp_path, "bottle.stl", bottle.export(file_type="stl")))
    assert scene.camera.up == (0.0, 0.0, 1.0)
    _, y, z = scene.light.sun_direction
    assert z > 0 > y


FOLDER = os.environ.get("REFDOF_MODELS")
if FOLDER:  # real models, where somebody has some

    @pytest.mark.parametrize("path", sorted(Path(FOLDER).glob("*.[gops][lbt][bjyl]")), ids=lambda p: p.name)
    def test_real_models(path, capfd):
        scene = load_mesh(path)
        picture = scene.camera.project(scene.vertices)
        assert len(scene.faces) > 100
        assert ((picture[:, :2] >= 0) & (picture[:, :2] <= scene.camera.size)).all()
        # Rounded to single precision.
        np.testing.assert_allclose(np.linalg.norm(scene.normal, axis=1), 1.0, atol=1e-6)
        assert capfd.readouterr() == ("", "")


def test_a_byte_order_mark_costs_no_vertex(tmp_path):
    text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    plain = load_mesh(write(tmp_path, "plain.obj", text.encode()))
    marked = load_mesh(write(tmp_path, "marked.obj", b"\xef\xbb\xbf" + text.encode()))
    np.testing.assert_array_equal(marked.vertices[marked.faces[0]], [(9, 9, 9), (0, 0, 0), (1, 0, 0)])
    np.testing.assert_array_equal(marked.vertices, plain.vertices)
