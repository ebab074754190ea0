"""Triangles, their clipping and peeling by hand: borders of pixels, tiles, the guard band and the far plane."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import ThinLens, View
from refdof._jit.compile import tile_kernel
from refdof.raster.gpu.ambiguity import ambiguous_pixels, near_edges, tied_depths
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.rasterize import rasterize
from refdof.raster.rays.layer_color import pinhole_hit
from tests import flat_scene

pytestmark = pytest.mark.fast
TRIANGLE = np.array([[0, 1, 2]])


def placed(corners, size=(8, 6)):
    """Vertices (N, 3) of corners (N, 3): x, y [px, y down], depth; one px is one unit of length at depth 8."""
    x, y, depth = np.asarray(corners, float).T
    return np.stack([(x - size[0] / 2) * depth / 8.0, (size[1] / 2 - y) * depth / 8.0, -depth], axis=1)


def draw(corners, size=(8, 6), faces=TRIANGLE, **words):
    return rasterize(placed(corners, size), np.asarray(faces), flat_scene.camera(*size, 8.0), **words)


def wall(depth):
    return [(-900.0, -900.0, depth), (900.0, -900.0, depth), (0.0, 900.0, depth)]


def covered(found):
    return [tuple(place) for place in np.argwhere(found.triangle >= 0).tolist()]


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [3, 2, 1, 0], [1, 2, 3, 0]])
def test_centres_on_left_and_top_borders_are_inside(order):
    # A rectangle between pixel centres: columns 2 .. 5 and rows 1 .. 3, of which the last are on the other borders.
    corners = np.array([(2.5, 1.5, 8.0), (5.5, 1.5, 8.0), (5.5, 3.5, 8.0), (2.5, 3.5, 8.0)])[order]
    found = draw(corners, faces=[[0, 1, 2], [0, 2, 3]])
    assert covered(found) == [(y, x) for y in (1, 2) for x in (2, 3, 4)]


def test_of_equal_depths_the_first_triangle_stays():
    found = draw(wall(8.0) * 2, faces=[[0, 1, 2], [3, 4, 5]])
    assert (found.triangle == 0).all()


@pytest.mark.parametrize(("far", "drawn"), [(4.0, True), (3.999, False)])
def test_what_is_at_the_far_plane_is_drawn(far, drawn):
    assert (draw(wall(4.0), far=far).triangle == (0 if drawn else -1)).all()


def test_a_wall_covers_all_tiles():
    # Tiles of 32 px: two columns and two rows, the second ones cut.
    assert (draw(wall(8.0), size=(40, 35)).triangle == 0).all()


def test_a_sliver_in_one_column():
    found = draw([(3.4, 0.0, 8.0), (3.6, 0.0, 8.0), (3.5, 6.0, 8.0)])
    assert covered(found) == [(y, 3) for y in range(6)]


@pytest.mark.parametrize("up", [1.0, -1.0])
@pytest.mark.parametrize("turned", [False, True])
def test_a_triangle_far_beyond_the_picture_keeps_its_sides(up, turned):
    # From two corners at y = 100 px to a tip at (30000, -1e6) px: the sides cross the picture, slightly slanted.
    sides, tall = np.array([(-1.3, 100.0), (2.6, 100.0), (30000.0, -1e6)]), np.arange(8) + 0.5
    left, right = (x + (30000.0 - x) * (100.0 - tall) / 1000100.0 for x in (-1.3, 2.6))
    wanted = (left[:, None] < tall) & (tall < right[:, None])
    if up < 0:
        sides[:, 1], wanted = 8.0 - sides[:, 1], wanted[::-1]
    if turned:
        sides, wanted = sides[:, ::-1], wanted.T
    found = draw(np.column_stack([sides, np.full(3, 8.0)]), size=(8, 8))
    assert_array_equal(found.triangle >= 0, wanted)
    assert (wanted.sum(axis=1 if not turned else 0) >= 3).all()


@pytest.mark.parametrize("winding", [[0, 1, 2], [2, 1, 0]])
def test_both_sides_of_a_triangle_are_drawn(winding):
    found = draw([(1.0, 1.0, 8.0), (7.0, 1.0, 8.0), (1.0, 5.0, 8.0)], faces=[winding])
    # The slanted side runs from (7, 1) to (1, 5): x + 3/2 y < 8.5.
    assert covered(found) == [(y, x) for y in range(1, 5) for x in range(1, 7) if x + 0.5 + 1.5 * (y + 0.5) < 8.5]


@pytest.mark.parametrize(("moved", "inside"), [(1 / 512, True), (3 / 512, False), (-1 / 512, True)])
def test_ties_of_the_grid_go_to_even(moved, inside):
    # 256 steps per px. A left border half a step beyond a pixel's centre moves to the centre, an even place; one and a
    # half steps beyond it moves to the second step.
    corners = [(2.5 + moved, -1.0, 8.0), (20.0, -1.0, 8.0), (2.5 + moved, 40.0, 8.0)]
    found = draw(corners, model=GpuModel(subpixel_bits=8))
    assert (found.triangle[:, 2] >= 0).all() == inside
    assert (found.triangle[:, 3] >= 0).all()


@pytest.mark.parametrize(
    "corners",
    [
        [(6.56, 4.399, 8.0), (9.605, 4.774, 9.0), (7.88, 4.564, 30.0)],
        [(2.926, 6.057, 9.0), (2.303, 1.269, 30.0), (2.535, 2.848, 8.0)],
        [(3.398, 4.509, 9.0), (-0.185, 4.693, 30.0), (2.178, 4.527, 8.0)],
        [(1.776, 5.574, 9.0), (6.357, 5.461, 8.0), (4.806, 5.564, 30.0)],
    ],
)
def test_depths_stay_within_the_triangle(corners):
    # Slivers that a coarse grid moves over a centre at which their planes are nearer than any of their corners.
    found = draw(corners, model=GpuModel(subpixel_bits=4))
    depth = found.depth[found.triangle >= 0]
    assert len(depth) > 0
    assert (depth >= 8.0 * (1 - 1e-6)).all()  # float32
    assert (depth <= 30.0 * (1 + 1e-6)).all()


def test_a_triangle_without_a_plane_has_its_nearest_depth():
    # A second triangle is 2^60 units away: in their common unit the first one's determinant is below float32.
    corners = np.array([(1.0, 1.0, 1.0), (7.0, 1.0, 2.0), (1.0, 5.0, 2.0), *([(4.0, 3.0, 2.0**60)] * 3)])
    found = draw(corners, faces=[[0, 1, 2], [3, 4, 5]], near=0.5, precision="float32")
    assert_array_equal(found.depth[found.triangle == 0], 1.0)
    assert (found.triangle == 0).sum() == 5 + 4 + 2 + 1  # as in the test above


@pytest.mark.parametrize(
    ("umbra", "depths"),
    [
        (0.0, [2.0, 2.1, 10.0]),
        (0.1, [2.0, 10.0]),  # 1 / (1 / 2 - 0.1) = 2.5
        (0.405, [2.0]),  # 10.53
        (0.6, [2.0]),  # an umbra without end
        (np.inf, [2.0]),
    ],
)
def test_peeling_leaves_out_umbrae(umbra, depths):
    corners = np.array(wall(2.0) + wall(2.1) + wall(10.0))
    x, y, depth = corners.T
    vertices = np.stack([x * depth, y * depth, -depth], axis=1)
    found = peel_raster(vertices, np.arange(9).reshape(3, 3), flat_scene.camera(5, 4, 8.0), 4, umbra=umbra)
    assert_allclose(found.depth, np.broadcast_to(np.reshape(depths, (-1, 1, 1)), (len(depths), 4, 5)), rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3, 9])
def test_peeling_stops_at_its_count(count):
    corners = np.array(wall(2.0) + wall(2.1) + wall(10.0))
    x, y, depth = corners.T
    vertices = np.stack([x * depth, y * depth, -depth], axis=1)
    found = peel_raster(vertices, np.arange(9).reshape(3, 3), flat_scene.camera(5, 4, 8.0), count)
    assert len(found.depth) == min(count, 3)


@tile_kernel
def hit(surfaces, projection, x, y):
    return pinhole_hit(surfaces, projection, 0, x, y)


def test_pixels_beside_a_triangle_see_its_border():
    # The triangle (1, 1), (5, 1), (1, 5) px of a picture of 8 x 6 px, at depth 8.
    corners = np.array([(-3.0, 2.0, -8.0), (1.0, 2.0, -8.0), (-3.0, -2.0, -8.0)])
    projection = flat_scene.camera(8, 6, 8.0)
    view = View(flat_scene.scene_of([flat_scene.Part(corners, TRIANGLE)], projection), projection, ThinLens(0.1, 1.0))
    for x, y, u, v in ((1, 1, 1 / 8, 1 / 8), (2, 3, 3 / 8, 5 / 8), (3, 1, 5 / 8, 1 / 8), (0, 2, 0, 3 / 8)):
        assert_allclose(hit(view.surfaces(), view.projection(), x, y), (u, v, (x - 3.5) / 8, (2.5 - y) / 8), atol=1e-12)
    # Beyond the slanted side weights are divided by their sum, beyond an upright one they are cut: 7/8 of 12/8.
    assert_allclose(hit(view.surfaces(), view.projection(), 4, 3)[:2], (7 / 12, 5 / 12), rtol=1e-12)
    assert_allclose(hit(view.surfaces(), view.projection(), 4, 0)[:2], (7 / 8, 0.0), atol=1e-12)


def to_segment(point, a, b):
    """Distance of a point from the segment a b, by the nearest of many points on it."""
    share = np.linspace(0.0, 1.0, 4001)[:, None]
    return np.hypot(*(a + share * (b - a) - point).T).min()


@pytest.mark.parametrize("reach", [0.3, 1.0, 1.7])
def test_pixels_near_an_edge_by_distance(reach):
    random = np.random.default_rng(6)
    for _ in range(10):
        corners = np.column_stack([random.uniform(-2.0, 10.0, (3, 2)), random.uniform(4.0, 12.0, 3)])
        mask = near_edges(placed(corners), TRIANGLE, flat_scene.camera(8, 6, 8.0), reach)
        sides = [(corners[k, :2], corners[(k + 1) % 3, :2]) for k in range(3)]
        for y, x in np.ndindex(6, 8):
            distance = min(to_segment(np.array([x + 0.5, y + 0.5]), a, b) for a, b in sides)
            # Steps of 17 / 4000 px along a side make distances too long by less than 1e-4 px at these reaches.
            assert mask[y, x] == (distance <= reach) or abs(distance - reach) < 1e-4


@pytest.mark.parametrize(
    ("model", "away", "marked"),
    [
        (EXACT, 2.0**-13, True),  # the finest grid has steps of 2^-12 px
        (EXACT, 2.0**-11, False),
        (GpuModel(subpixel_bits=4), 2.0**-5, True),
        (GpuModel(subpixel_bits=4), 2.0**-3, False),
    ],
)
def test_a_step_of_the_grid_is_in_doubt(model, away, marked):
    corners = placed([(2.5 + away, -9.0, 8.0), (90.0, -9.0, 8.0), (2.5 + away, 99.0, 8.0)])
    mask = ambiguous_pixels(corners, TRIANGLE, flat_scene.camera(8, 6, 8.0), np.full((1, 6, 8), np.inf), model)
    assert (mask[:, 2] == marked).all()
    assert not mask[:, [0, 1, 3, 4, 5, 6, 7]].any()


def test_edges_before_the_near_plane_are_not_seen():
    # The near plane is a millionth of the largest coordinate away; the second triangle lies between it and the eye.
    corners = placed([(-99.0, -99.0, 1.0), (-99.0, -98.0, 1.0), (-98.0, -99.0, 1.0)])
    largest = np.abs(corners).max()
    closer = placed([(2.0, 2.0, 2e-7), (6.0, 2.0, 3e-7), (2.0, 5.0, 4e-7)]) * largest
    for second, seen in ((closer, False), (closer * 100.0, True)):
        vertices = np.concatenate([corners, second])
        mask = near_edges(vertices, [[0, 1, 2], [3, 4, 5]], flat_scene.camera(8, 6, 8.0), 0.6)
        assert mask.any() == seen


def test_tied_depths_by_hand():
    depth = np.array([1.0, 2.0, 2.0, np.inf, np.inf]), np.array([1.0, 2.0, 2.0 + 1e-3, 3.0, np.inf])
    assert_array_equal(tied_depths(np.array(depth).T[:, None]), [[True, False]])
