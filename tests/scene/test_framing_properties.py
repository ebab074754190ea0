"""Suggested shots of random scenes: no visible surface blurs more than stated, and the model fills the picture.

Depths are those of a naive caster of rays, one triangle after the other.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import View
from refdof.optics.camera import Camera
from refdof.scene.builtin import SCENES, built_in
from refdof.scene.framing import suggest_camera, suggest_lens, up_axis
from refdof.scene.material import Material
from refdof.scene.scene import Part, Scene

BLUR = 12.0  # [px], for 480 rows, as `suggest_lens` states
GRID = (32, 24)  # rays across the picture and down


def cast(camera, vertices, faces):
    """(rows, columns) depths of the first hit, inf for none; rays go to the edges of the picture, too."""
    half = camera.height / (2.0 * camera.pixels_per_tangent)
    x = np.linspace(-half * camera.width / camera.height, half * camera.width / camera.height, GRID[0])
    y = np.linspace(half, -half, GRID[1])
    rays = np.stack([*np.meshgrid(x, y), -np.ones((GRID[1], GRID[0]))], axis=-1)
    nearest = np.full(rays.shape[:2], np.inf)
    for a, b, c in camera.camera_from_world(vertices)[faces]:
        normal = np.cross(b - a, c - a)
        slope = rays @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (a @ normal) / slope
            place = rays * depth[..., None]
            sides = [np.cross(q - p, place - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
        hit = np.isfinite(depth) & (depth > 0) & (np.stack(sides) >= 0).all(axis=0)
        nearest = np.where(hit, np.minimum(nearest, depth), nearest)
    return nearest


def largest_circle(lens, camera, depth):
    depth = depth[np.isfinite(depth)]
    return np.abs(lens.coc_px(depth, camera)).max(initial=0.0) * 480.0 / camera.height


@st.composite
def models(draw):
    """Triangles in a box that is flat, deep or even, of any size; or a room: a box with things in it."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    extent = np.array(
        draw(st.sampled_from([(1, 1, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, 1, 1e-3), (1, 1, 40), (9, 1, 4)]))
    )
    count = draw(st.integers(1, 8))
    triangles = (rng.uniform(-1, 1, (count, 1, 3)) + rng.uniform(-1, 1, (count, 3, 3))) * extent
    if draw(st.booleans()):
        corners = (np.indices((2, 2, 2)).reshape(3, 8).T * 4.0 - 2.0) * np.maximum(extent, 0.5)
        walls = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
        quads = [corners[list(wall)] for wall in walls]
        triangles = np.concatenate([triangles, *([[q[[0, 1, 2]], q[[0, 2, 3]]] for q in quads])])
    scale = draw(st.sampled_from([1e-6, 1.0, 1e6]))
    return triangles.reshape(-1, 3) * scale, np.arange(3 * len(triangles)).reshape(-1, 3)


@settings(max_examples=150, deadline=None)
@given(models(), st.sampled_from([1, 2, None]))
def test_no_visible_surface_of_a_suggested_shot_blurs_more(model, up):
    vertices, faces = model
    camera = suggest_camera(vertices, faces, up or up_axis(vertices, faces))
    lens = suggest_lens(vertices, faces, camera)
    # 1e-6: a ray that grazes an edge meets it at a depth that differs in the last digits.
    assert largest_circle(lens, camera, cast(camera, vertices, faces)) <= BLUR * (1 + 1e-6)
    assert 0.0 < lens.radius <= 0.25 * lens.focus_distance


@settings(max_examples=150, deadline=None)
@given(models(), st.integers(0, 2**32 - 1), st.sampled_from([20.0, 60.0, 120.0]))
def test_nor_does_it_from_anywhere_inside(model, seed, fov):
    vertices, faces = model
    rng = np.random.default_rng(seed)
    reach = np.abs(vertices).max()
    eye, target = rng.uniform(-0.5, 0.5, (2, 3)) * reach
    camera = Camera(tuple(eye), tuple(target), tuple(rng.normal(size=3)), fov, (200, 150))
    lens = suggest_lens(vertices, faces, camera)
    assert largest_circle(lens, camera, cast(camera, vertices, faces)) <= BLUR * (1 + 1e-6)


@settings(max_examples=150, deadline=None)
@given(models(), st.sampled_from([1, 2, None]))
def test_the_model_fills_the_picture_and_none_of_it_is_cut_off(model, up):
    """0.86 of the width or the height, or the eye is a tenth of its size away, as `suggest_camera` states."""
    vertices, faces = model
    camera = suggest_camera(vertices, faces, up or up_axis(vertices, faces))
    x, y, depth = camera.project(vertices).T
    assert (depth > 0).all()
    assert 0 <= x.min() <= x.max() <= 640
    assert 0 <= y.min() <= y.max() <= 480
    # Corners of what is seen are corners of triangles. 1e-9: roundings.
    share = max(np.ptp(x) / 640, np.ptp(y) / 480)
    if depth.min() > 0.1 * np.ptp(vertices, axis=0).max() * (1 + 1e-9):  # else it is as near as it may be
        assert share == pytest.approx(0.86, rel=1e-9)
    assert share <= 0.86 * (1 + 1e-9)


def test_a_room_seen_from_outside_is_bounded_at_both_ends():
    """A box of 2 x 2 x 2 without its back: its near edge blurred by 171 px, and its far one by 6."""
    corners = np.indices((2, 2, 2)).reshape(3, 8).T * 2.0 - 1.0
    walls = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
    faces = np.array([triangle for a, b, c, d in walls for triangle in ((a, b, c), (a, c, d))])
    camera = suggest_camera(corners, faces)
    lens = suggest_lens(corners, faces, camera)
    near, far = (lens.coc_px(end(camera.project(corners)[:, 2]), camera) for end in (np.min, np.max))
    assert near == pytest.approx(-12.0, rel=1e-12)  # all corners are in the picture
    assert 0.0 < far < 12.0


@pytest.mark.parametrize("name", ["fence", "lights", "branches"])
def test_built_in_scenes_seen_as_files_are_bounded_and_filled(name):
    """What Embree sees, of the scene's own camera and of the suggested one."""
    assert name in SCENES
    scene = built_in(name)
    for camera in (scene.camera, suggest_camera(scene.vertices, scene.faces)):
        lens = suggest_lens(scene.vertices, scene.faces, camera)
        small = camera.with_size((64, 48))
        depth = View(scene, small, lens).pinhole().depth
        assert largest_circle(lens, small, depth) <= BLUR * (1 + 1e-6)


@pytest.mark.parametrize("axis", [None, 0, 1, 2])
def test_visible_pixels_fill_the_picture(axis):
    """Counted in pixels: rows or columns with something in them, and none at the picture's edge."""
    rng = np.random.default_rng(3)
    triangles = rng.uniform(-1, 1, (40, 3, 3))
    if axis is not None:
        triangles[:, :, axis] = 0.25
    vertices, faces = triangles.reshape(-1, 3), np.arange(120).reshape(-1, 3)
    camera = suggest_camera(vertices, faces, up_axis(vertices, faces))
    lens = suggest_lens(vertices, faces, camera)
    scene = Scene.from_parts("triangles", [Part(vertices, faces, Material())], camera, lens)
    seen = np.isfinite(View(scene, camera.with_size((96, 72)), lens).pinhole().depth)
    columns, rows = np.flatnonzero(seen.any(axis=0)), np.flatnonzero(seen.any(axis=1))
    assert 0 < columns.min() < columns.max() < 95
    assert 0 < rows.min() < rows.max() < 71
    # 0.86 but for the thin tips of two triangles, which slip between pixel centres: a pixel is 0.010 or 0.014.
    assert 0.80 <= max(np.ptp(columns) / 96, np.ptp(rows) / 72) <= 0.86
