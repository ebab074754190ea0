"""Projection against hand numbers and an independently built 4x4 matrix."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof._check import InputError
from refdof.optics.camera import Camera

pytestmark = pytest.mark.fast


def test_hand_numbers():
    # Height 100 and 90 degrees: 50 pixels per unit tangent. The eye is 5 in front of the origin.
    camera = Camera.look_at((0, 0, 5), (0, 0, 0), fov_y=90.0, size=(200, 100))
    picture = camera.project([[0, 0, 0], [1, 2, 0], [-1, 0, 3]])
    # x = 100 + 50 * 1 / 5, y = 50 - 50 * 2 / 5; then x = 100 - 50 * 1 / 2. tan(45 deg) rounds once.
    np.testing.assert_allclose(picture, [[100, 50, 5], [110, 30, 5], [75, 50, 2]], rtol=1e-15)


def test_pixels_per_tangent():
    assert Camera((0, 0, 0), (0, 0, -1), fov_y=90.0, size=(7, 100)).pixels_per_tangent == pytest.approx(50.0, rel=1e-15)
    # 480 / (2 * 0.36397023): the tangent of 20 degrees is written out to eight digits.
    assert Camera((0, 0, 0), (0, 0, -1)).pixels_per_tangent == pytest.approx(659.39458, rel=1e-7)


def matrix(camera):
    """World to clip space as OpenGL builds it: gluLookAt, then gluPerspective with near 1 and far 100."""
    eye, up = np.array(camera.eye), np.array(camera.up)
    forward = np.array(camera.target) - eye
    forward /= math.sqrt(forward @ forward)
    side = np.cross(forward, up / math.sqrt(up @ up))
    side /= math.sqrt(side @ side)
    above = np.cross(side, forward)
    view = np.identity(4)
    view[0, :3], view[1, :3], view[2, :3] = side, above, -forward
    move = np.identity(4)
    move[:3, 3] = -eye
    f = 1.0 / math.tan(math.radians(camera.fov_y) / 2.0)
    near, far, aspect = 1.0, 100.0, camera.width / camera.height
    clip = np.zeros((4, 4))
    clip[0, 0], clip[1, 1], clip[3, 2] = f / aspect, f, -1.0
    clip[2, 2], clip[2, 3] = (far + near) / (near - far), 2.0 * far * near / (near - far)
    return clip @ view @ move


@pytest.mark.parametrize(
    "camera",
    [
        Camera((1, 2, 3), (-1, 0.5, 0)),
        Camera((-4, 0.1, -2), (0, 0, 0), up=(0.2, 1, 0.3), fov_y=75, size=(320, 200)),
        Camera((0, 5, 0), (0, 0, 0), up=(0, 0, -7), fov_y=10, size=(101, 303)),
    ],
)
def test_agrees_with_a_graphics_library(camera):
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (50, 3))
    clip = np.concatenate([points, np.ones((50, 1))], axis=1) @ matrix(camera).T
    x = (clip[:, 0] / clip[:, 3] + 1.0) / 2.0 * camera.width
    y = (1.0 - clip[:, 1] / clip[:, 3]) / 2.0 * camera.height  # row 0 is the top
    picture = camera.project(points)
    # A dozen roundings of numbers up to 10^4 px: far below 1e-9 px, far above double's 1e-12 px.
    np.testing.assert_allclose(picture[:, 0], x, atol=1e-9)
    np.testing.assert_allclose(picture[:, 1], y, atol=1e-9)
    np.testing.assert_allclose(picture[:, 2], clip[:, 3], rtol=1e-13)


def test_behind_the_eye_there_is_no_picture():
    picture = Camera((0, 0, 0), (0, 0, -1)).project([[1, 1, 0], [0, 0, 2]])
    assert np.isnan(picture[:, :2]).all()
    np.testing.assert_array_equal(picture[:, 2], [0, -2])


coordinate = st.floats(-10, 10)


@given(eye=st.tuples(coordinate, coordinate, coordinate), target=st.tuples(coordinate, coordinate, coordinate))
@settings(max_examples=100, deadline=None)
def test_axes_are_a_rotation_and_the_target_is_in_the_middle(eye, target):
    away = np.subtract(target, eye)
    if math.hypot(away[0], away[2]) < 1e-3:  # looking along `up`: refused, see below
        return
    camera = Camera(eye, target)
    rotation = camera.rotation
    # Axes are unit to half an ulp; the smallest sine above is 1e-3 / 20, which costs 4.3 digits of 16.
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-11)
    assert np.linalg.det(rotation) == pytest.approx(1.0, abs=1e-11)
    assert rotation[1, 1] >= 0.0  # the picture stands upright
    x, y, depth = camera.project([target])[0]
    # The target's offset is 20 ulp of 10 at most, and a unit at the least depth is 660 px / 1e-3.
    np.testing.assert_allclose([x, y], [320, 240], atol=1e-6)
    assert depth == pytest.approx(math.dist(eye, target), rel=1e-9)


def test_powers_of_two_change_no_bit():
    points = np.random.default_rng(2).uniform(-1.0, 1.0, (50, 3))
    near = Camera((1, 2, 3), (0, 0.1, 0)).project(points)
    far = Camera((2.0**40, 2.0**41, 3 * 2.0**40), (0, 0.1 * 2.0**40, 0)).project(points * 2.0**40)
    np.testing.assert_array_equal(near[:, :2], far[:, :2])
    np.testing.assert_array_equal(near[:, 2] * 2.0**40, far[:, 2])


def test_other_size_same_view():
    camera = Camera((0, 0, 3), (0, 0, 0)).with_size((320, 240))
    assert (camera.width, camera.height, camera.fov_y) == (320, 240, 40.0)


BAD = [
    ("eye", (0, 0)),
    ("eye", (0, math.nan, 0)),
    ("target", (0, 0, 1)),  # the eye itself
    ("target", (math.inf, 0, 0)),
    ("up", (0, 0, 0)),
    ("up", (0, 0, 3)),  # along the view
    ("fov_y", 0.0),
    ("fov_y", -10.0),
    ("fov_y", 180.0),
    ("fov_y", math.nan),
    ("size", (0, 480)),
    ("size", (640, -1)),
    ("size", (640, 10**6)),
    ("size", (640.5, 480)),
    ("size", 640),
    ("size", (640, 480, 3)),
]


@pytest.mark.parametrize(("name", "value"), BAD)
def test_bad_arguments_are_named(name, value):
    arguments = {"eye": (0, 0, 1), "target": (0, 0, 0), name: value}
    with pytest.raises(InputError, match=f"^{name}: "):
        Camera.look_at(**arguments)
