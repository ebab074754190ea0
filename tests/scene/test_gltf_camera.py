"""A glTF file's own camera, against hand-placed nodes."""

import struct

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import QUAD, gltf, write

CAMERA = {"type": "perspective", "perspective": {"yfov": np.pi / 2, "aspectRatio": 1.5, "znear": 0.1}}


@pytest.mark.parametrize("kind", ["gltf", "glb"])
def test_the_files_camera_stands_where_its_nodes_say(tmp_path, kind):
    # A quarter turn about y takes -z to -x: the camera, 4 along its parent's x, looks back at the origin. The
    # mesh hangs below the camera's node, 4 before it.
    half = np.sqrt(0.5)
    turned = {"translation": [4, 0, 0], "rotation": [0, half, 0, half], "camera": 0, "children": [2]}
    nodes = [{"children": [1], "scale": [10, 10, 10]}, turned, {"mesh": 0, "translation": [0, 0, -4]}]
    text = gltf(nodes, roots=[0], cameras=[CAMERA]).encode()
    if kind == "glb":
        text += b" " * (-len(text) % 4)
        text = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A) + text
    scene = load_mesh(write(tmp_path, f"cam.{kind}", text))
    camera = scene.camera
    assert camera.size == (720, 480)
    assert camera.fov_y == pytest.approx(90.0, rel=1e-12)  # roundings only, here and below
    np.testing.assert_allclose(camera.eye, (40, 0, 0), atol=1e-12)
    np.testing.assert_allclose(camera.rotation, [[0, 0, -1], [0, 1, 0], [1, 0, 0]], atol=1e-12)
    # Ten times the quad, turned with its parent: (x, y, 0) -> (0, 10 y, -10 x).
    np.testing.assert_allclose(scene.vertices, [[0, 10 * y, -10 * x] for x, y, _ in QUAD.tolist()], atol=1e-12)


@pytest.mark.parametrize("perspective", [{}, {"yfov": 0.0}, {"yfov": "wide"}, None])
def test_a_useless_camera_is_left_out(tmp_path, perspective):
    cameras = [{"type": "perspective", "perspective": perspective}]
    path = write(tmp_path, "cam.gltf", gltf([{"mesh": 0}, {"camera": 0}], cameras=cameras))
    assert load_mesh(path).camera.size == (640, 480)  # the suggested shot


ORTHOGRAPHIC = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}}


def test_an_orthographic_camera_is_refused_by_name(tmp_path):
    path = write(tmp_path, "a.gltf", gltf([{"mesh": 0}, {"camera": 0}], cameras=[ORTHOGRAPHIC]))
    with pytest.raises(InputError, match=r"its camera is orthographic; .*file_camera=False"):
        load_mesh(path)
    assert load_mesh(path, file_camera=False).camera.size == (640, 480)  # the suggested shot


def test_a_perspective_camera_beside_an_orthographic_one_is_taken(tmp_path):
    text = gltf([{"mesh": 0}, {"camera": 0}, {"camera": 1}], cameras=[ORTHOGRAPHIC, CAMERA])
    path = write(tmp_path, "a.gltf", text)
    with pytest.warns(UserWarning, match="left out: cameras but the first perspective one"):
        assert load_mesh(path).camera.fov_y == pytest.approx(90.0, rel=1e-12)
    with pytest.warns(UserWarning, match="left out: cameras but the first"):
        assert load_mesh(path, file_camera=False).camera.fov_y != pytest.approx(90.0)


def test_an_orthographic_camera_of_another_scene_does_not_count(tmp_path):
    path = write(tmp_path, "a.gltf", gltf([{"mesh": 0}, {"camera": 0}], roots=[0], cameras=[ORTHOGRAPHIC]))
    assert load_mesh(path).camera == load_mesh(path, file_camera=False).camera  # the suggested shot


@pytest.mark.parametrize(
    ("near", "far", "told"),
    [
        (0.1, 10.0, ()),
        (3.0, 3.0, ()),  # both planes through the quad, 3 before the camera
        (3.1, 10.0, ("znear",)),
        (0.1, 2.9, ("zfar",)),
        (3.5, 2.9, ("znear", "zfar")),
        (0.1, None, ()),
    ],
)
@pytest.mark.parametrize("aside", [False, True])
def test_what_lies_beyond_the_cameras_planes_is_told(tmp_path, near, far, told, aside):
    planes = {"znear": near} | ({} if far is None else {"zfar": far})
    camera = {"type": "perspective", "perspective": {"yfov": np.pi / 2, "aspectRatio": 1.0, **planes}}
    # 3 before the quad, and 40 aside of it: then nothing that is cut away is seen.
    place = {"camera": 0, "translation": [40.0 if aside else 1.0, 0.5, 3.0]}
    path = write(tmp_path, "a.gltf", gltf([{"mesh": 0}, place], cameras=[camera]))
    if told and not aside:
        with pytest.warns(
            UserWarning, match="left out: " + ", ".join(rf"its camera's {name} \(.*\)" for name in told) + "$"
        ):
            load_mesh(path)
    else:
        load_mesh(path)
