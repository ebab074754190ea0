"""Scenes that move, made in Python: frames, normals, what stays, and what is refused."""

import math

import numpy as np
import pytest

from refdof import Camera, InputError, Part, ThinLens, View, load_scene, render
from tests.flat_scene import paint, rectangle, scene_of

CAMERA = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=40.0, size=(24, 16))
FRAMES = np.array([[[0, 0, -4], [1, 0, -4], [0, 1, -4]], [[1, 0, -4], [2, 0, -4], [1, 1, -6]]], dtype=float)


def triangle():
    return scene_of([Part(FRAMES[0], [[0, 1, 2]], paint((1, 1, 1)))], CAMERA, ThinLens(0.1, 4.0))


def test_vertices_move_along_lines_and_hold_beyond():
    scene = triangle().with_frames(FRAMES)
    assert scene.frames == (0, 1)
    for frame, t in ((-3.0, 0.0), (0, 0.0), (0.25, 0.25), (1, 1.0), (1e9, 1.0)):
        posed = scene.at_frame(frame)
        expected = [[a + t * (b - a) for a, b in zip(p, q, strict=True)] for p, q in zip(*FRAMES.tolist(), strict=True)]
        np.testing.assert_allclose(posed.vertices, expected, atol=1e-15)
        assert posed.frame == t
        assert posed.at_frame(frame) is posed
    np.testing.assert_array_equal(scene.at_frame(1).at_frame(0).vertices, FRAMES[0])
    assert triangle().frames is None
    still = triangle()
    assert still.at_frame(7) is still
    # The plane through (1, 0, -4), (2, 0, -4) and (1, 1, -6) has the normal (0, 2, 1) / sqrt 5; float32.
    np.testing.assert_allclose(scene.at_frame(1).normal, np.tile([0, 2, 1], (3, 1)) / math.sqrt(5), atol=1e-7)


def test_what_is_smooth_stays_smooth():
    """Two triangles of a flat square, each with corners of its own, bend about their diagonal by 90 degrees."""
    square = scene_of([rectangle(0.0, 1.0, 0.0, 1.0, 4.0)], CAMERA)
    assert len(square.vertices) == 6
    bent = square.vertices.copy()
    middle, up = np.array([0.5, 0.5, -4.0]), np.array([0.0, 0.0, math.sqrt(0.5)])
    for corner in ((1.0, 0.0, -4.0), (0.0, 1.0, -4.0)):  # rise by 45 degrees each
        at = (square.vertices == corner).all(axis=1)
        bent[at] = middle + (np.array(corner) - middle) * math.sqrt(0.5) + up * math.sqrt(0.5)
    normal = square.with_frames(np.stack([square.vertices, bent])).at_frame(1).normal
    on_fold = square.vertices[:, 0] == square.vertices[:, 1]
    np.testing.assert_allclose(np.abs(normal[on_fold]), np.tile([0, 0, 1], (4, 1)), atol=1e-7)
    np.testing.assert_allclose(np.abs(normal[~on_fold, 2]), math.sqrt(0.5), atol=1e-7)


def test_what_has_a_crease_keeps_it():
    """A roof of two squares at a right angle, each of one normal, which moves as it is."""
    floor = Part([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], paint((1, 1, 1)))
    wall = Part([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]], paint((1, 1, 1)))
    roof = scene_of([floor, wall], CAMERA)
    moved = roof.with_frames(np.stack([roof.vertices, roof.vertices + 3.0])).at_frame(1)
    np.testing.assert_allclose(moved.normal, roof.normal, atol=1e-7)  # float32


def test_poses_are_their_own():
    """Writing to a pose's arrays, or to what was given, changes no other pose."""
    given = FRAMES.copy()
    scene = triangle().with_frames(given)
    given[:] = 0.0
    scene.at_frame(1).vertices[:] = 0.0
    np.testing.assert_array_equal(scene.at_frame(1).vertices, FRAMES[1])


def test_other_sizes_and_looks_move_too():
    scene = triangle().with_frames(FRAMES)
    large = scene.scaled(8.0)
    np.testing.assert_array_equal(large.at_frame(0.5).vertices, scene.at_frame(0.5).vertices * 8.0)
    assert large.at_frame(0.5).camera is large.camera
    assert scene.with_shading("lambert").at_frame(1).materials[0].shading == "lambert"


def test_a_view_moves_and_renders():
    scene = triangle().with_frames(FRAMES)
    view = View(scene, CAMERA, scene.lens)
    assert view.at_frame(0) is view
    later = view.at_frame(1)
    np.testing.assert_array_equal(later.scene.vertices, FRAMES[1])
    assert later.camera == CAMERA
    still = scene_of([Part(FRAMES[1], [[0, 1, 2]], paint((1, 1, 1)))], CAMERA, scene.lens)
    np.testing.assert_array_equal(render("scatter", scene.at_frame(1)).image, render("scatter", still).image)


def test_triangles_may_shrink_to_nothing():
    """A frame in which all corners meet: its pictures are the background's."""
    parts = [rectangle(-1.0, 1.0, -1.0, 1.0, 4.0)]
    scene = scene_of(parts, CAMERA, ThinLens(0.1, 4.0), (0.25, 0.5, 1.0))
    scene = scene.with_frames(np.stack([scene.vertices, scene.vertices * 0.0 + [0.0, 0.0, -4.0]]))
    for method in ("scatter", "lensblur", "multiview", "cascaded", "accumulation"):
        image = render(method, scene.at_frame(1)).image
        np.testing.assert_allclose(image, np.broadcast_to([0.25, 0.5, 1.0], image.shape), atol=1e-6)  # float32


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        (FRAMES[:, :2], "vertices: got shape (2, 2, 3); allowed is (any, 3, 3)"),
        (FRAMES[:0], "vertices: got no frame; allowed is at least one"),
        (FRAMES * np.nan, "vertices: has 18 NaN values"),
        (FRAMES * 1e150, "vertices: smallest value is"),
        ("frames", "vertices: got 'frames'"),
    ],
)  # fmt: skip
def test_bad_frames_are_named(vertices, message):
    with pytest.raises(InputError) as told:
        triangle().with_frames(vertices)
    assert str(told.value).startswith(message)
    with pytest.raises(InputError, match="frame: got nan"):
        triangle().at_frame(float("nan"))


def test_built_in_scenes_stand_still():
    assert load_scene("cans").frames is None
