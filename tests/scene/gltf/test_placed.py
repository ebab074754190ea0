"""Nodes and instances of glTF files, by hand."""

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.scene.formats.reading_fixtures import area_of
from tests.scene.gltf.card import FACES, PLACES, Card

pytestmark = pytest.mark.fast
HALF = np.sqrt(0.5)
EXACT = 1e-6  # float32 of the file


def instanced(card, node=0, **attributes):
    card.header["nodes"][node]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    return card.uses("EXT_mesh_gpu_instancing", required=True)


def corners(scene):
    return {tuple(np.round(place, 5).tolist()) for place in scene.vertices}


@pytest.mark.parametrize("dtype", [np.float32, np.int8, np.int16])
def test_instances_are_moved_turned_and_scaled_under_their_node(tmp_path, dtype):
    card = Card()
    # A quarter turn about z, x to y; as whole numbers it has rounded parts of one length, which is divided out.
    turns = np.array([[0, 0, 0, 1], [0, 0, HALF, HALF]])
    most = 1 if dtype == np.float32 else np.iinfo(dtype).max
    turns = card.numbers(
        turns if most == 1 else np.rint(turns * most), dtype, **({} if most == 1 else {"normalized": True})
    )
    moves = card.numbers([[0, 0, 5], [10, 0, 0]])
    scales = card.numbers([[1, 1, 1], [2, 3, 1]])
    instanced(card, TRANSLATION=moves, ROTATION=turns, SCALE=scales)
    card.header["nodes"][0]["translation"] = [0, 0, 100]
    scene = load_mesh(card.write(tmp_path))
    wanted = {(x, y, 105.0) for x, y, _ in PLACES.tolist()}
    wanted |= {(10.0 - 3 * y, 2 * x, 100.0) for x, y, _ in PLACES.tolist()}  # (2 x, 3 y) -> (-3 y, 2 x)
    assert {tuple(c + 0.0 for c in corner) for corner in corners(scene)} == {tuple(c + 0.0 for c in w) for w in wanted}
    assert area_of(scene) == pytest.approx(2.0 + 12.0, abs=1e-5)  # float32 and whole numbers


def test_normals_of_instances_turn_with_them(tmp_path):
    card = Card(NORMAL=np.array([[0.6, 0, 0.8]] * 4, dtype=np.float32))
    scene = load_mesh(instanced(card, SCALE=card.numbers([[1, 1, 1], [2, 1, 1]])).write(tmp_path))
    # By the inverse transpose: (0.3, 0, 0.8) / sqrt(0.73).
    expected = [[0.6, 0, 0.8]] * 4 + [[0.3 / np.sqrt(0.73), 0, 0.8 / np.sqrt(0.73)]] * 4
    np.testing.assert_allclose(scene.normal, expected, atol=EXACT)


def test_instances_of_a_node_that_moves(tmp_path):
    card = Card()
    instanced(card, TRANSLATION=card.numbers([[0, 0, 0], [0, 10, 0]]))
    card.move(0, "translation", [0.0, 1.0], [[0, 0, 0], [0, 0, 24]])
    scene = load_mesh(card.write(tmp_path)).at_frame(1)
    assert corners(scene) == {(x, y + shift, 1.0) for x, y, _ in PLACES.tolist() for shift in (0.0, 10.0)}


@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"TRANSLATION": [[0, 0, 0]], "SCALE": [[1, 1, 1]] * 2}, r"attributes have \[1, 2\] items"),
        ({"ROTATION": [[0, 0, 0]]}, "rotation: got 'VEC3'; allowed is an accessor of VEC4"),
    ],
)
def test_bad_instances_are_named(tmp_path, attributes, message):
    card = Card()
    instanced(card, **{key: card.numbers(rows) for key, rows in attributes.items()})
    with pytest.raises(InputError, match=message):
        load_mesh(card.write(tmp_path))


def test_instances_with_morph_targets_are_refused(tmp_path):
    card = Card()
    card.primitive["targets"] = [{"POSITION": card.numbers(np.ones((4, 3)))}]
    with pytest.raises(InputError, match="has instances with a skin or morph targets"):
        load_mesh(instanced(card, TRANSLATION=card.numbers([[0, 0, 0]])).write(tmp_path))


@pytest.mark.parametrize("below", [False, True])
def test_hidden_nodes_and_what_is_below_them(tmp_path, below):
    card = Card()
    child = card.node(mesh=0, translation=[0, 0, 7])
    card.node(root=True, children=[child], extensions={"KHR_node_visibility": {"visible": not below}})
    if not below:
        card.header["nodes"][child]["extensions"] = {"KHR_node_visibility": {"visible": False}}
    card.uses("KHR_node_visibility")
    scene = load_mesh(card.write(tmp_path))
    assert scene.vertices[:, 2].max() == 0.0


def test_only_the_scene_that_the_file_opens_with(tmp_path):
    card = Card()
    card.node(mesh=0, translation=[0, 0, 7])
    assert load_mesh(card.write(tmp_path)).vertices[:, 2].max() == 0.0
    card.header["scenes"].append({"nodes": [1]})
    card.header["scene"] = 1
    assert load_mesh(card.write(tmp_path)).vertices[:, 2].min() == 7.0
    del card.header["scenes"], card.header["scene"]
    assert area_of(load_mesh(card.write(tmp_path))) == 4.0  # all nodes


@pytest.mark.parametrize("kind", ["NORMAL", "TEXCOORD_0", "COLOR_0"])
def test_attributes_of_another_length_are_named(tmp_path, kind):
    card = Card(**{kind: np.ones((3, 2 if kind == "TEXCOORD_0" else 3), dtype=np.float32)})
    with pytest.raises(
        InputError, match=f"mesh 0, primitive 0: {kind} has 3 items; allowed are as many as POSITION's 4"
    ):
        load_mesh(card.write(tmp_path))


def test_corners_that_make_no_triangle_are_named(tmp_path):
    card = Card(faces=[*FACES, [0, 1]][-1:])
    with pytest.raises(InputError, match="has 2 corners; allowed is a multiple of 3"):
        load_mesh(card.write(tmp_path))
