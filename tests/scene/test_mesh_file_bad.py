"""Bad mesh files: whatever is wrong, one line says so, and nothing is printed."""

import os

import numpy as np
import pytest
import trimesh

from refdof._check import InputError
from refdof.scene.mesh_file import load_mesh
from tests.mesh_fixtures import PLY, gltf, write

BINARY_PLY = trimesh.creation.box().export(file_type="ply")
BOX_GLB = trimesh.creation.box().export(file_type="glb")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
BAD = {
    "empty.obj": b"",
    "blank.obj": b"\n\n",
    "points.obj": TRIANGLE,
    "degenerate.obj": f"{TRIANGLE}f 1 1 2\n",
    "range.obj": f"{TRIANGLE}f 1 2 9\n",
    "negative.obj": f"{TRIANGLE}f 1 2 -9\n",
    "words.obj": f"{TRIANGLE}f one two three\n",
    "nan.obj": f"v nan 0 0\n{TRIANGLE}f 1 2 3\n",
    "infinite.ply": PLY.replace("2 1 0 188", "inf 1 0 188"),
    "range.ply": PLY.replace("4 0 1 2 3", "4 0 1 2 7"),
    "header.ply": PLY[:60],
    "cut.ply": BINARY_PLY[: len(BINARY_PLY) // 2],
    "noise.ply": bytes(range(256)),
    "noise.stl": bytes(range(256)),
    "noise.glb": bytes(range(256)),
    "cut.glb": BOX_GLB[: len(BOX_GLB) // 2],
    "list.gltf": b"[1, 2]",
    "text.gltf": b"hello",
    "nothing.gltf": b'{"asset": {"version": "2.0"}}',
    "header.off": b"OFF\n3 1 0\n0 0 0\n",
    "points.xyz": b"0 0 0\n1 0 0\n0 1 0\n",
    "model.blend": b"BLENDER",
    "model": b"OFF",
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_in_one_line(tmp_path, name, capfd):
    with pytest.raises(InputError) as caught:
        load_mesh(write(tmp_path, name, BAD[name]))
    message = str(caught.value)
    assert message.startswith("scene: got ")
    assert name in message
    assert "allowed is a mesh file" in message
    assert "\n" not in message
    assert capfd.readouterr() == ("", "")


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"^scene: got .*nowhere.obj': there is no such file; allowed"):
        load_mesh(tmp_path / "nowhere.obj")
    with pytest.raises(InputError, match=r"^scene: got .*: it is not a file; allowed"):
        load_mesh(tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="has no pipes")
@pytest.mark.parametrize("name", ["pipe.bin", "/pipe.bin", "../pipe.bin"])
def test_a_pipe_in_place_of_a_buffer_is_refused_and_not_waited_for(tmp_path, name):
    os.mkfifo(tmp_path / "pipe.bin")
    text = gltf([{"mesh": 0}], buffers=[{"byteLength": 92, "uri": name}])
    with pytest.raises(InputError, match=r"pipe\.bin: it is (no plain file|outside)"):
        load_mesh(write(tmp_path, "model.gltf", text))


@pytest.mark.parametrize("link", [False, True])
def test_a_buffer_outside_of_the_folder_is_not_read(tmp_path, link):
    folder = tmp_path / "models"
    folder.mkdir()
    (tmp_path / "outside.bin").write_bytes(bytes(92))
    if link:
        (folder / "link.bin").symlink_to(tmp_path / "outside.bin")
    text = gltf([{"mesh": 0}], buffers=[{"byteLength": 92, "uri": "link.bin" if link else "../outside.bin"}])
    with pytest.raises(InputError, match="it is outside of the mesh file's folder"):
        load_mesh(write(folder, "model.gltf", text))


def huge_files(folder, size):
    """A box under a huge transform, and a triangle with huge corners and texture coordinates."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(), transform=np.diag([size, size, size, 1.0]))
    corners = f"v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nvt 1e25 -1e25\nvt 1 0\nvt 0 1\n"
    files = {"moved.glb": scene.export(file_type="glb"), "large.obj": f"{corners}f 1/1 2/2 3/3\n"}
    return [write(folder, name, data) for name, data in files.items()]


@pytest.mark.parametrize("size", [1e39, 1e99])
def test_huge_numbers_are_read_without_a_warning(tmp_path, size):
    for path in huge_files(tmp_path, size):
        scene = load_mesh(path)
        assert np.abs(scene.vertices).max() >= size / 2
        assert np.isfinite(
            [*scene.camera.eye, *scene.camera.target, scene.lens.radius, scene.lens.focus_distance]
        ).all()


@pytest.mark.parametrize("size", [1e150, 1e300])
def test_numbers_that_are_too_large_are_refused_without_a_warning(tmp_path, size):
    for path in huge_files(tmp_path, size):
        with pytest.raises(InputError, match=r"^scene: got .* vertices: .* allowed is a mesh file"):
            load_mesh(path)
