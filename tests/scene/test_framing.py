"""The suggested shot: everything fits, focus lies on the model, the far end blurs as stated."""

import math

import numpy as np
import pytest
import trimesh

from refdof.optics.camera import Camera
from refdof.scene.framing import suggest_camera, suggest_lens, up_axis


def arrays(mesh):
    return np.array(mesh.vertices), np.array(mesh.faces)


SHAPES = {
    "sphere": trimesh.creation.icosphere(subdivisions=3),
    "wide": trimesh.creation.box((10.0, 0.1, 0.5)),
    "tall": trimesh.creation.box((0.1, 7.0, 0.2)),
    "deep": trimesh.creation.box((0.1, 0.2, 30.0)),
    "flat": trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 0, 1]], [[0, 1, 2]], process=False),
}


@pytest.mark.parametrize("up", [1, 2])
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (1e-6, 0.0), (1e6, 5e6)])
def test_the_whole_model_fits_and_fills_the_picture(name, up, scale, shift):
    vertices, faces = arrays(SHAPES[name])
    vertices = vertices * scale + shift
    camera = suggest_camera(vertices, faces, up)
    x, y, depth = camera.project(vertices).T
    assert (depth > 0).all()
    across, along = np.abs(x / 320 - 1), np.abs(y / 240 - 1)
    # 0.86 of the picture is the stated margin; 1e-9 for roundings at a distance of five model sizes.
    assert max(across.max(), along.max()) <= 0.86 + 1e-9
    # The nearest such eye: the model touches the margin on both sides of one axis.
    assert max(x.max() - x.min(), y.max() - y.min()) > 0
    touching = [
        (x / 320 - 1).min() < -0.859 < 0.859 < (x / 320 - 1).max(),
        (y / 240 - 1).min() < -0.859 < 0.859 < (y / 240 - 1).max(),
    ]
    assert any(touching)


def test_the_view_is_from_the_front_right_and_above():
    vertices, faces = arrays(SHAPES["sphere"])
    x, y, z = np.subtract(*(getattr(suggest_camera(vertices, faces, 1), k) for k in ("eye", "target")))
    # Elevation 15 and azimuth 30 degrees, as the module states; roundings only.
    assert math.degrees(math.atan2(y, math.hypot(x, z))) == pytest.approx(15.0, rel=1e-9)
    assert math.degrees(math.atan2(x, z)) == pytest.approx(30.0, rel=1e-9)
    x, y, z = np.subtract(*(getattr(suggest_camera(vertices, faces, 2), k) for k in ("eye", "target")))
    assert math.degrees(math.atan2(z, math.hypot(x, y))) == pytest.approx(15.0, rel=1e-9)
    assert math.degrees(math.atan2(x, -y)) == pytest.approx(30.0, rel=1e-9)


def test_focus_is_where_the_axis_meets_the_model():
    vertices, faces = arrays(trimesh.creation.icosphere(subdivisions=4))
    camera = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0))
    lens = suggest_lens(vertices, faces, camera)
    # The sphere's front is 4 away; its faces lie at most 1 - cos(0.04) = 8e-4 inside.
    assert 4.0 <= lens.focus_distance < 4.0 + 8e-4


def test_focus_is_on_the_nearest_of_several_surfaces():
    near, far = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((9, 9, 1))
    far.apply_translation((0, 0, -10))
    vertices, faces = arrays(trimesh.util.concatenate([far, near]))
    assert suggest_lens(vertices, faces, Camera((0.1, 0.1, 5.0), (0.1, 0.1, 0.0))).focus_distance == 4.5


def test_focus_beside_the_axis_is_at_a_third_of_the_depths():
    vertices = np.array([[1, 0, -2], [2, 0, -2], [1, 1, -5]], dtype=float)
    lens = suggest_lens(vertices, np.array([[0, 1, 2]]), Camera((0, 0, 0), (0, 0, -1), fov_y=90.0))
    assert lens.focus_distance == pytest.approx(3.0, rel=1e-15)  # 2 + (5 - 2) / 3


def test_a_floor_is_cut_at_the_picture_s_edge():
    """The near end is no corner of the floor: it lies under the lower edge of the picture, at the depth 1."""
    corners = np.array([[-9, -1, 9], [9, -1, 9], [-900, -1, -100], [900, -1, -100]], dtype=float)
    lens = suggest_lens(corners, np.array([[0, 1, 2], [1, 3, 2]]), Camera((0, 0, 0), (0, 0, -1), fov_y=90.0))
    # No surface on the axis: focus at 1 + 99 / 3. P = 240 px; 240 radius (1 / 1 - 1 / 34) = 12.
    assert lens.focus_distance == pytest.approx(34.0, rel=1e-12)
    assert lens.radius == pytest.approx(12.0 / 240.0 * 34.0 / 33.0, rel=1e-12)


@pytest.mark.parametrize(("x", "y"), [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_a_wall_is_nearest_at_a_corner_of_the_picture(x, y):
    """A slanting plane over the whole picture, none of whose corners is in it: depth = 4 - 0.45 x - 0.7 y."""
    span = np.array([[-99, -99], [99, -99], [0, 150]], dtype=float)
    depth = 4.0 - span @ [0.45 * x, 0.7 * y]
    corners = np.column_stack([span, -depth])
    lens = suggest_lens(corners, np.array([[0, 1, 2]]), Camera((0, 0, 0), (0, 0, -1), fov_y=90.0))
    # Toward the picture's corner (4/3, 1, -1): depth (1 + 0.45 4/3 + 0.7) = 4, so 1 / depth = 2.3 / 4.
    assert lens.focus_distance == pytest.approx(4.0, rel=1e-12)
    assert 240.0 * lens.radius * (2.3 / 4.0 - 1.0 / 4.0) == pytest.approx(12.0, rel=1e-9)


def test_the_far_end_blurs_by_twelve_pixels_at_480_rows():
    near, far = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))
    far.apply_translation((0.5, 0, -10))
    vertices, faces = arrays(trimesh.util.concatenate([far, near]))
    for size in ((640, 480), (1280, 960)):
        camera = Camera((0, 0, 5), (0, 0, 0), size=size)
        lens = suggest_lens(vertices, faces, camera)
        depth = camera.project(vertices)[:, 2].max()
        # Radius 12 px for 480 rows, in proportion for others. Roundings only.
        assert lens.coc_px(np.array([depth]), camera)[0] == pytest.approx(12.0 * size[1] / 480, rel=1e-12)


def test_a_flat_model_asks_for_no_giant_lens():
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], dtype=float)
    lens = suggest_lens(vertices, np.array([[0, 1, 2]]), Camera((0, 0, 4), (0, 0, 0)))
    assert (lens.focus_distance, lens.radius) == (4.0, 1.0)  # a quarter of the focus distance


def test_a_camera_that_looks_away_still_gets_a_lens():
    vertices = np.array([[-1, -1, 5], [1, -1, 5], [0, 1, 5]], dtype=float)
    lens = suggest_lens(vertices, np.array([[0, 1, 2]]), Camera((0, 0, 0), (0, 0, -3)))
    assert lens.focus_distance == 3.0
    assert lens.radius > 0


def test_a_model_that_stands_on_z_is_z_up():
    bottle = trimesh.creation.cylinder(radius=0.3, height=2.0)  # along z, with flat ends
    vertices, faces = arrays(bottle)
    assert up_axis(vertices, faces) == 2
    assert up_axis(vertices[:, [1, 2, 0]], faces) == 1  # its axis along y


# Two triangles over corners of a box (x slowest, z fastest), in a plane across each axis.
SHEETS = [np.array([[0, 1, 3], [0, 3, 2]]), np.array([[0, 1, 5], [0, 5, 4]]), np.array([[0, 2, 6], [0, 6, 4]])]
BOX = np.concatenate([sheet + step for sheet, step in zip(SHEETS, (4, 2, 1), strict=True)] + SHEETS)


@pytest.mark.parametrize("thickness", [0.0, 0.04])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_flat_models_show_their_side(axis, thickness):
    """With the axis that is guessed, and a box of 3 x 2 that is next to flat: the side takes most of what is seen."""
    extents = np.insert([3.0, 2.0], axis, thickness)
    vertices = (np.indices((2, 2, 2)).reshape(3, 8).T - 0.5) * extents
    faces = BOX if thickness else SHEETS[axis]
    up = up_axis(vertices, faces)
    if axis == 2:
        assert up == 1
    camera = suggest_camera(vertices, faces, up)
    backward = np.subtract(camera.eye, camera.target)
    backward /= np.linalg.norm(backward)
    # From the front, cos 30 cos 15 = 0.837 of the side is seen; from above, sin 60 = 0.866. Never from behind or below.
    assert backward[axis] >= 0.83


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_model_that_is_not_flat_is_seen_as_before(axis):
    vertices, faces = arrays(trimesh.creation.box(np.insert([3.0, 2.0], axis, 0.11)))  # above a share of 0.05
    x, y, z = np.subtract(*(getattr(suggest_camera(vertices, faces, 1), k) for k in ("eye", "target")))
    assert math.degrees(math.atan2(y, math.hypot(x, z))) == pytest.approx(15.0, rel=1e-9)
    assert math.degrees(math.atan2(x, z)) == pytest.approx(30.0, rel=1e-9)


@pytest.mark.parametrize("name", ["sphere", "wide", "tall", "deep", "flat"])
def test_without_a_clear_base_y_is_up(name):
    assert up_axis(*arrays(SHAPES[name])) == 1
