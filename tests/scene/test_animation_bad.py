"""Broken and hostile animated files: one line says what is wrong; what is unknown is left out with a warning."""

import base64

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.animated_gltf import Builder
from tests.scene.test_animation_gltf import TRIANGLE, one_triangle, two_bones


def moving(times=(0.0, 1.0), values=((0, 0, 0), (1, 0, 0)), path="translation", kind=None):
    made = one_triangle()
    made.move(0, path, list(times), np.asarray(values, dtype=np.float32), kind)
    return made


def skinned():
    made, _ = two_bones()
    return made


def morphed():
    """One target, and an animation of two weights."""
    made = Builder()
    target = {"POSITION": made.numbers(np.ones((3, 3)))}
    made.node(root=True, mesh=made.mesh((TRIANGLE, [[0, 1, 2]], {}, {"targets": [target]})))
    made.move(0, "weights", [0.0, 1.0], [0.0, 1.0, 2.0, 3.0])
    return made


def edited(made, *path, **values):
    """The file with other values at a place in its header; None: without the key."""
    place = made.header
    for key in path:
        place = place[key]
    for key, value in values.items():
        place.update({key: value})
        if value is None:
            del place[key]
    return made


def twice():
    made = moving()
    made.move(0, "translation", [0.0], [[0, 0, 0]])
    return made


def parents():
    made = moving()
    made.header["nodes"].extend([{"children": [0]}, {"children": [0]}])
    return made


# Accessors of `moving`: indices, places, times, values; of `skinned`: joints, weights, indices, places, matrices.
TIMES, VALUES, MATRICES = ("accessors", 2), ("accessors", 3), ("accessors", 4)
CHANNEL = ("animations", 0, "channels", 0)
IDENTITY = np.eye(4).ravel().tolist()
ATTRIBUTES = ("meshes", 0, "primitives", 0, "attributes")
BAD = [
    (lambda: edited(moving(), *TIMES, count=10**9), "channel 0: input: needs 4000000000 bytes"),
    (lambda: edited(moving(), *TIMES, count=10**9, bufferView=None, sparse={}), "input: count: got 1000000000"),
    (lambda: edited(moving(), *TIMES, count=0), "input: count: got 0"),
    (lambda: edited(moving(), *VALUES, bufferView=None), "output: accessor 3 has no bufferView"),
    (lambda: edited(moving(), *VALUES, byteOffset=-4), "output: byteOffset: got -4"),
    (lambda: edited(moving(), *VALUES, componentType=5124), "output: componentType is 5124"),
    (lambda: edited(moving(), "bufferViews", 3, byteStride=0), "output: needs 12 bytes, 0 an item"),
    (lambda: edited(moving(), "bufferViews", 3, buffer=3), "buffers: index 3 is not one of the file's 1"),
    (lambda: moving(values=((0, 0, 0), (np.nan, 0, 0))), "animation 0, channel 0: output: has 1 NaN"),
    (lambda: moving(times=(1.0, 0.0)), "channel 0: input: times do not grow"),
    (lambda: moving(times=(-1.0, 0.0)), "channel 0: input: times do not grow"),
    (lambda: moving(times=(0.0,)), "channel 0: output: has 2 items for 1 keys"),
    (lambda: moving(kind="CUBICSPLINE"), "channel 0: output: has 2 items for 2 keys"),
    (lambda: moving(kind="CUBIC"), "channel 0: interpolation: got 'CUBIC'; did you mean 'CUBICSPLINE'"),
    (lambda: moving(values=((0, 0, 0, 0), (0, 0, 0, 1)), path="rotation"), "output: a quaternion is 0"),
    (lambda: moving(path="rotation"), "channel 0: output: got 'VEC3'; allowed is an accessor of VEC4"),
    (lambda: edited(moving(), *CHANNEL, "target", node=7), "nodes: index 7 is not one of the file's 1"),
    (lambda: edited(moving(), *CHANNEL, sampler=5), "samplers: index 5"),
    (lambda: edited(moving(), "animations", 0, "samplers", 0, input=55), "accessors: index 55"),
    (lambda: edited(moving(), "nodes", 0, matrix=IDENTITY), "channel 0: moves node 0, which has a matrix"),
    (lambda: edited(moving(), "nodes", 0, children=[0]), "nodes: 0 is below a node that is its own ancestor"),
    (lambda: edited(moving(), "nodes", 0, children=[9]), "nodes: index 9"),
    (lambda: edited(moving(), "nodes", 0, scale="large"), "scale: got 'large'"),
    (lambda: edited(moving(), "nodes", 0, scale=[1e200] * 3), "vertices: largest value"),
    (twice, "channel 1: moves the translation of node 0 again"),
    (parents, "nodes: 0 is a child of 1 and of 2"),
    (lambda: edited(skinned(), "skins", 0, joints=[1]), "JOINTS_0: index 1 is outside 0 .. 0"),
    (lambda: edited(skinned(), "skins", 0, joints=[1, 99]), "nodes: index 99"),
    (lambda: edited(skinned(), "skins", 0, joints=[]), "skins 0: has no joints"),
    (lambda: edited(skinned(), *MATRICES, count=1), "skins 0: has 1 matrices; allowed are 2"),
    (lambda: edited(skinned(), *ATTRIBUTES, WEIGHTS_0=None), "accessors: index None"),
    (lambda: edited(skinned(), *ATTRIBUTES, WEIGHTS_0=None, JOINTS_0=None), "node 0 has a skin"),
    (lambda: edited(skinned(), "accessors", 1, count=7), "WEIGHTS_0 has 7 items; allowed are as many as POSITION's 8"),
    (morphed, "the animation has 2 weights; allowed are 1"),
    (lambda: edited(morphed(), "meshes", 0, weights=[0, 0]), "weights: got shape (2,); allowed is (1)"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_what_is_wrong_is_said_in_one_line(tmp_path, make, message, capfd):
    with pytest.raises(InputError) as told:
        load_mesh(make().write(tmp_path))
    assert str(told.value).startswith("scene: got ")
    assert message in str(told.value)
    assert "\n" not in str(told.value)
    assert capfd.readouterr() == ("", "")


def test_what_is_unknown_is_left_out_with_a_warning(tmp_path):
    made = moving()
    made.header["animations"][0]["channels"].append({"sampler": 0, "target": {"path": "pointer"}})
    with pytest.warns(UserWarning, match="animation 0, channel 1: moves 'pointer', which is left out"):
        scene = load_mesh(made.write(tmp_path))
    assert scene.frames == (0, 24)


def test_buffers_beside_the_file_and_sparse_numbers(tmp_path):
    made = moving()
    plain = load_mesh(made.write(tmp_path)).at_frame(12).vertices
    text = made.text()
    start = text.index("data:application")
    address = text[start : text.index('"', start)]
    (tmp_path / "moving.bin").write_bytes(base64.b64decode(address.partition(",")[2]))
    (tmp_path / "beside.gltf").write_text(text.replace(address, "moving.bin"))
    np.testing.assert_array_equal(load_mesh(tmp_path / "beside.gltf").at_frame(12).vertices, plain)
    # The same values as zeros, of which one row is another.
    where = made.view(np.array([1], dtype=np.uint16).tobytes())
    rows = made.view(np.array([[1, 0, 0]], dtype=np.float32).tobytes())
    sparse = {"indices": {"bufferView": where, "componentType": 5123}, "values": {"bufferView": rows}}
    edited(made, *VALUES, bufferView=None, sparse={"count": 1, **sparse})
    np.testing.assert_array_equal(load_mesh(made.write(tmp_path)).at_frame(12).vertices, plain)


def test_integers_that_stand_for_fractions(tmp_path):
    """A weight of 0.2 as a byte, and a quarter turn whose sine is 23170 / 32767."""
    made = one_triangle()
    turn = np.array([[0, 0, 0, 32767], [0, 0, 23170, 23170]])
    made.move(0, "rotation", [0.0, 1.0], [[0, 0, 0, 1]] * 2)
    made.header["animations"][0]["samplers"][0]["output"] = made.numbers(turn, np.int16, normalized=True)
    found = load_mesh(made.write(tmp_path)).at_frame(24).vertices
    np.testing.assert_allclose(found, [[0, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-12)  # equal sines: 90 degrees
    made, _ = two_bones()
    attributes = made.header["meshes"][0]["primitives"][0]["attributes"]
    shares = np.tile([204, 51, 0, 0], (8, 1))
    attributes["WEIGHTS_0"] = made.numbers(shares, np.uint8, normalized=True)
    made.header["nodes"][1]["translation"] = [0, 6.5, 0]  # 5 above its bind pose
    found = load_mesh(made.write(tmp_path)).vertices
    assert found[:, 1].min() == pytest.approx(1.0, abs=1e-12)  # a fifth of 5
    made = morphed()
    # Two keys of one weight, 0 and 51 / 255 = 0.2, of a target that lies 1 off.
    made.header["animations"][0]["samplers"][0]["output"] = made.numbers([0, 51], np.uint8, normalized=True)
    np.testing.assert_allclose(load_mesh(made.write(tmp_path)).at_frame(24).vertices, TRIANGLE + 0.2, atol=1e-12)
