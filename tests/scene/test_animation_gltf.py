"""Animated glTF files: keyframes, nodes, skins and morph targets, by hand and against a twin in plain Python."""

import math

import numpy as np
import pytest

from refdof import InputError
from refdof.scene.mesh_file import load_mesh
from tests.animated_gltf import Builder
from tests.scene.naive_animation import corners

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
STRIP = np.array([[x, y, 0.0] for y in range(4) for x in range(2)], dtype=np.float32)
STRIP_FACES = [[2 * k + a, 2 * k + b, 2 * k + c] for k in range(3) for a, b, c in ((0, 1, 3), (0, 3, 2))]
HALF = math.sqrt(0.5)
EXACT = 1e-12  # roundings of a few products of numbers near 1


def places(scene, frame=0):
    """(3 F, 3): the triangles' corners at a frame."""
    posed = scene.at_frame(frame)
    return posed.vertices[posed.faces.ravel()]


def one_triangle(**node):
    """A triangle under one node."""
    made = Builder()
    made.node(root=True, mesh=made.mesh((TRIANGLE, [[0, 1, 2]], {}, {})), **node)
    return made


def test_a_node_moves_along_straight_lines(tmp_path):
    made = one_triangle()
    made.move(0, "translation", [0.0, 1.0, 3.0], [[0, 0, 0], [2, 0, 0], [2, 4, 0]])
    scene = load_mesh(made.write(tmp_path))
    assert scene.frames == (0, 72)
    for frame, shift in (
        (0, (0, 0, 0)),
        (12, (1, 0, 0)),
        (24, (2, 0, 0)),
        (36, (2, 1, 0)),
        (99, (2, 4, 0)),
        (-5, (0, 0, 0)),
    ):
        np.testing.assert_allclose(places(scene, frame), TRIANGLE + np.array(shift), atol=EXACT)
    assert scene.at_frame(0) is scene
    assert scene.at_frame(30).at_frame(0).vertices.tobytes() == scene.vertices.tobytes()
    np.testing.assert_array_equal(scene.at_frame(30).faces, scene.faces)


def test_steps_change_on_their_frame(tmp_path):
    made = one_triangle()
    # Keys of frames 1 and 7, whose float32 times lie above and below f / 24 by up to 3e-8 s.
    made.move(0, "translation", [0.0, 1 / 24, 7 / 24], [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "STEP")
    scene = load_mesh(made.write(tmp_path))
    assert scene.frames == (0, 7)
    assert [places(scene, f)[0, 0] for f in (0, 0.9, 1, 6, 6.9, 7)] == [0, 0, 1, 1, 1, 2]


def test_rotations_take_the_shorter_arc(tmp_path):
    made = one_triangle()
    # A quarter turn about z, its quaternion with the other sign: the same turn, not three quarters the other way.
    made.move(0, "rotation", [0.0, 1.0], [[0, 0, 0, 1], [0, 0, -HALF, -HALF]])
    scene = load_mesh(made.write(tmp_path))
    for frame, angle in ((6, 22.5), (8, 30.0), (18, 67.5), (24, 90.0)):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        # float32 quaternions: 6e-8 of a digit.
        np.testing.assert_allclose(places(scene, frame), [[0, 0, 0], [c, s, 0], [-s, c, 0]], atol=2e-7)


def test_cubic_splines_by_hand(tmp_path):
    made = one_triangle()
    # From 0 to 1 in 2 s, leaving at 3 / s and arriving at -1 / s: at t = 1/4,
    # (3/16 - 2/64) + 2 (1/64 - 2/16 + 1/4) 3 + 2 (1/64 - 1/16) (-1) = 0.15625 + 0.84375 + 0.09375 = 1.09375.
    rows = [[9, 9, 9], [0, 0, 0], [3, 0, 0], [-1, 0, 0], [1, 0, 0], [9, 9, 9]]
    made.move(0, "translation", [0.0, 2.0], rows, "CUBICSPLINE")
    scene = load_mesh(made.write(tmp_path))
    for frame, x in ((0, 0.0), (12, 1.09375), (48, 1.0), (60, 1.0)):
        np.testing.assert_allclose(places(scene, frame)[0], (x, 0, 0), atol=EXACT)


def test_nodes_stand_in_their_parents(tmp_path):
    made = Builder()
    mesh = made.mesh((TRIANGLE, [[0, 1, 2]], {}, {}))
    child = made.node(mesh=mesh, translation=[1, 0, 0])
    made.node(root=True, children=[child], scale=[2, 2, 2])
    made.move(1, "rotation", [0.0, 1.0], [[0, 0, 0, 1], [0, 0, HALF, HALF]])
    scene = load_mesh(made.write(tmp_path, "moving.gltf"))
    # Turned by 90 degrees and twice as large: (x + 1, y) -> 2 (-y, x + 1).
    expected = [[-2 * y, 2 * (x + 1), 0] for x, y, _ in TRIANGLE.tolist()]
    np.testing.assert_allclose(places(scene, 24), expected, atol=1e-6)  # float32 quaternions


def two_bones(**more):
    """A strip 3 high: the lower joint at its foot, the upper one at half height, which bends; a node of its own."""
    made = Builder()
    share = np.clip(STRIP[:, 1] - 1.0, 0.0, 1.0)  # of the upper joint: rows 0, 0, 1, 1
    weights = np.stack([1.0 - share, share, 0 * share, 0 * share], axis=1)
    joints = made.numbers(np.tile([0, 1, 0, 0], (8, 1)), np.uint8)
    mesh = made.mesh((STRIP, STRIP_FACES, {"JOINTS_0": joints, "WEIGHTS_0": weights, **more}, {}))
    made.node(root=True, mesh=mesh, skin=0, translation=[100, 0, 0])  # which does not apply
    upper = made.node(translation=[0, 1.5, 0])
    lower = made.node(root=True, children=[upper], translation=[0, 0, 5])
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[1, 1, 3] = -1.5
    made.header["skins"] = [{"joints": [lower, upper], "inverseBindMatrices": made.numbers(inverse)}]
    return made, upper


def test_two_bones_by_hand(tmp_path):
    made, upper = two_bones()
    rest = load_mesh(made.write(tmp_path))
    assert rest.frames is None  # nothing moves, and it stands where its joints are
    np.testing.assert_allclose(places(rest), (STRIP + np.array([0, 0, 5]))[np.ravel(STRIP_FACES)], atol=EXACT)
    made.move(upper, "rotation", [0.0, 1.0], [[0, 0, 0, 1], [HALF, 0, 0, HALF]])  # forwards: y -> z
    scene = load_mesh(made.write(tmp_path))
    # The upper rows, 0.5 and 1.5 above the joint, lie so far before it at its height, on a foot at z = 5.
    bent = np.array([[x, y, 5] if y < 1.5 else [x, 1.5, 5 + y - 1.5] for x, y, _ in STRIP.tolist()])
    np.testing.assert_allclose(places(scene, 24), bent[np.ravel(STRIP_FACES)], atol=1e-6)  # float32 quaternions


def test_morph_targets_by_hand(tmp_path):
    made = Builder()
    targets = [{"POSITION": made.numbers(np.tile(shift, (3, 1)))} for shift in ([0, 0, 2], [4, 0, 0])]
    mesh = made.mesh((TRIANGLE, [[0, 1, 2]], {}, {"targets": targets}), weights=[0.5, 0.25])
    made.node(root=True, mesh=mesh)
    scene = load_mesh(made.write(tmp_path))
    assert scene.frames is None
    np.testing.assert_allclose(places(scene), TRIANGLE + np.array([1, 0, 1]), atol=EXACT)
    made.header["nodes"][0]["weights"] = [0.0, 1.0]  # instead of the mesh's
    np.testing.assert_allclose(places(load_mesh(made.write(tmp_path))), TRIANGLE + np.array([4, 0, 0]), atol=EXACT)
    made.move(0, "weights", [0.0, 2.0], [1.0, 0.0, 0.0, 0.5])
    scene = load_mesh(made.write(tmp_path))
    np.testing.assert_allclose(places(scene), TRIANGLE + np.array([0, 0, 2]), atol=EXACT)
    np.testing.assert_allclose(places(scene, 24), TRIANGLE + np.array([1, 0, 1]), atol=EXACT)


def grove(seed):
    """Everything at once, at random: six nodes that move in all ways, a skin, and morph targets of a shared mesh."""
    random = np.random.default_rng(seed)
    made, _ = two_bones()
    target = {"POSITION": made.numbers(random.normal(size=(3, 3)))}
    # Two primitives, without normals, one with doubled corners; and the mesh of the skin.
    mesh = made.mesh(
        (random.normal(size=(3, 3)), [[0, 2, 1]], {}, {"targets": [target]}),
        (STRIP[:4], [[0, 1, 3], [0, 3, 2]], {}, {"targets": [{"POSITION": made.numbers(random.normal(size=(4, 3)))}]}),
        weights=[0.3],
    )
    matrix = random.normal(size=(4, 4))
    matrix[3] = (0, 0, 0, 1)
    below = made.node(mesh=mesh, rotation=random.normal(size=4).tolist(), name="7")  # names like other nodes' numbers
    middle = made.node(children=[below], matrix=matrix.T.ravel().tolist(), mesh=0, name="world")
    top = made.node(root=True, children=[middle], scale=random.uniform(0.5, 2, 3).tolist(), mesh=mesh)
    ways = [(node, "translation", 3) for node in (below, top, 2)] + [(node, "rotation", 4) for node in (top, 1)]
    for node, path, columns in (*ways, (below, "scale", 3), (below, "weights", 1)):
        kind = ("STEP", "LINEAR", "CUBICSPLINE")[int(random.integers(3))]
        times = np.sort(random.choice(48, 5, replace=False)) / 24
        values = random.normal(size=(5 * (3 if kind == "CUBICSPLINE" else 1), columns))
        if path == "rotation":
            values /= np.linalg.norm(values, axis=1, keepdims=True)
        made.move(node, path, times.astype(np.float32), values[:, 0] if path == "weights" else values, kind)
    return made


@pytest.mark.parametrize("seed", range(4))
def test_all_at_once_beside_the_twin(tmp_path, seed):
    made = grove(seed)
    scene = load_mesh(made.write(tmp_path))
    meshes = [k for k, node in enumerate(made.header["nodes"]) if "mesh" in node]
    for frame in (0, 5.25, 17, 31.5, 47):
        time = float(np.float32(frame / 24))
        found = places(scene, frame)
        expected = [corners(made, node, time) for node in meshes]
        # Which node comes first is the reader's choice; the corners of each follow one another, and stay in place.
        for part in expected:
            apart = [np.abs(found[k : k + len(part)] - part).max() for k in range(0, len(found) - len(part) + 1, 3)]
            assert min(apart) < 1e-10 * max(1.0, np.abs(part).max())  # roundings, in numbers of another order
        assert sum(map(len, expected)) == len(found)


def order_of(made, scene, frame, meshes):
    """Where each node's corners begin."""
    found, starts = places(scene, frame), []
    for node in meshes:
        part = corners(made, node, float(np.float32(frame / 24)))
        apart = [np.abs(found[k : k + len(part)] - part).max() for k in range(0, len(found) - len(part) + 1, 3)]
        starts.append(3 * int(np.argmin(apart)))
    return starts


def test_triangles_keep_their_numbers(tmp_path):
    made = grove(9)
    scene = load_mesh(made.write(tmp_path))
    meshes = [k for k, node in enumerate(made.header["nodes"]) if "mesh" in node]
    assert order_of(made, scene, 3, meshes) == order_of(made, scene, 29, meshes)


def test_normals_turn_with_their_surface(tmp_path):
    """Normals that the file states, under a turn and an uneven scale; and those of a bent strip that states none."""
    slanted = np.tile([0.6, 0.0, 0.8], (3, 1))
    made = Builder()
    made.node(root=True, mesh=made.mesh((TRIANGLE, [[0, 1, 2]], {"NORMAL": slanted}, {})))
    made.move(0, "scale", [0.0, 1.0], [[1, 1, 1], [2, 1, 1]])
    scene = load_mesh(made.write(tmp_path))
    np.testing.assert_allclose(scene.normal, slanted, atol=1e-7)  # float32
    # The inverse transpose of diag(2, 1, 1) takes (0.6, 0, 0.8) to (0.3, 0, 0.8) / 0.8544.
    expected = np.array([0.3, 0.0, 0.8]) / math.hypot(0.3, 0.8)
    np.testing.assert_allclose(scene.at_frame(24).normal, np.tile(expected, (3, 1)), atol=2e-7)
    made, upper = two_bones()
    made.move(upper, "rotation", [0.0, 1.0], [[0, 0, 0, 1], [HALF, 0, 0, HALF]])
    posed = load_mesh(made.write(tmp_path)).at_frame(24)
    at = {tuple(np.round(v, 6).tolist()): n for v, n in zip(posed.vertices, posed.normal, strict=True)}
    np.testing.assert_allclose(at[0.0, 0.0, 5.0], (0, 0, 1), atol=1e-6)  # the foot stands upright
    np.testing.assert_allclose(at[0.0, 1.5, 6.5], (0, -1, 0), atol=1e-6)  # the top lies, and looks down


def test_what_grows_from_nothing_is_framed_as_it_will_be(tmp_path):
    made = one_triangle()
    made.move(0, "scale", [0.0, 1.0], [[0, 0, 0], [1, 1, 1]])
    scene = load_mesh(made.write(tmp_path))
    np.testing.assert_allclose(places(scene, 24), TRIANGLE, atol=EXACT)
    x, y, _ = scene.camera.project(places(scene, 24)).T
    assert 0 < x.min() < x.max() < 640
    assert 0 < y.min() < y.max() < 480
    made.header["animations"][0]["samplers"][0]["output"] = made.numbers(np.zeros((2, 3)))
    with pytest.raises(InputError, match="its triangles have no extent at its first and last frame"):
        load_mesh(made.write(tmp_path))


def test_a_camera_moves(tmp_path):
    made = one_triangle()
    camera = {"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1}}
    made.header["cameras"] = [camera]
    node = made.node(root=True, camera=0, translation=[0, 0, 5])
    made.move(node, "translation", [0.0, 1.0], [[0, 0, 5], [2, 0, 5]])
    scene = load_mesh(made.write(tmp_path))
    assert scene.camera.eye == (0.0, 0.0, 5.0)
    assert scene.at_frame(12).camera.eye == pytest.approx((1.0, 0.0, 5.0))
    assert scene.scaled(10.0).at_frame(12).camera.eye == pytest.approx((10.0, 0.0, 50.0))
    np.testing.assert_allclose(scene.scaled(10.0).at_frame(12).vertices, scene.at_frame(12).vertices * 10.0)
