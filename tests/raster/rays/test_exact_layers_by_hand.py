"""Peeled surfaces by hand: the list of hits along a ray, surfaces met twice, and the very end of an umbra."""

import numpy as np
import pytest

from refdof import Part, ThinLens, View
from refdof._jit import tile_kernel
from refdof.raster.rays.exact_layers import _insert
from refdof.raster.rays.umbra import umbra_step
from tests import flat_scene

pytestmark = pytest.mark.fast


@tile_kernel
def insert_all(depths, faces, out_depth, out_face):
    count = 0
    for k in range(len(depths)):
        count = _insert(out_depth, out_face, count, depths[k], faces[k])
    return count


def inserted(*hits):
    depth, face = np.zeros(len(hits) + 1), np.zeros(len(hits) + 1, dtype=np.int32)
    depths, faces = (np.array(column) for column in zip(*hits, strict=True))
    count = insert_all(depths.astype(np.float64), faces.astype(np.int32), depth, face)
    return list(zip(depth[:count].tolist(), face[:count].tolist(), strict=True))


def test_hits_are_kept_by_depth_and_then_by_triangle():
    assert inserted((3, 1), (1, 7), (2, 4)) == [(1, 7), (2, 4), (3, 1)]
    assert inserted((2, 5), (2, 3), (2, 9), (1, 6)) == [(1, 6), (2, 3), (2, 5), (2, 9)]


def test_a_hit_reported_twice_counts_once():
    assert inserted((2, 5), (2, 5)) == [(2, 5)]
    assert inserted((2, 3), (2, 5), (2, 4), (2, 3), (2, 5), (2, 4)) == [(2, 3), (2, 4), (2, 5)]
    assert inserted((1, 5), (2, 5), (1, 5)) == [(1, 5), (2, 5)]


def view_of(parts, lens, size=(3, 3), pixels_per_tangent=4.0):
    shot = flat_scene.camera(*size, pixels_per_tangent)
    return View(flat_scene.scene_of(parts, shot, lens), shot, lens)


def depths(view, *arguments):
    """Depths along the ray of the picture's middle."""
    layers = view.umbra_layers(*arguments) if arguments else view.layers()
    found = layers.depth[:, 1, 1]
    return found[np.isfinite(found)].tolist()


def card(depth):
    """A triangle around the axis, with corners that are no corners of other cards."""
    return Part([[-8, -8, -depth], [8, -8, -depth], [0, 16, -depth]], [[0, 1, 2]], flat_scene.paint((1, 1, 1)))


def test_the_very_end_of_an_umbra_is_hidden():
    # A step of 1 / (P E) = 1/2 of inverse depth: 1 hides all up to 2, that included.
    lens = ThinLens(0.5, 2.0)
    assert umbra_step(flat_scene.camera(2, 2, 4.0), lens) == 0.5
    assert depths(view_of([card(d) for d in (1.0, 2.0, 4.0)], lens, (2, 2))) == [1.0, 2.0, 4.0]
    assert depths(view_of([card(d) for d in (1.0, 2.0, 4.0)], lens, (2, 2)), None, 2) == [1.0, 4.0]
    # A wide lens, 1 / 64: what hides little still hides that.
    wide = ThinLens(16.0, 2.0)
    assert depths(view_of([card(d) for d in (1.0, 1.0078125, 2.0)], wide, (2, 2)), None, 2) == [1.0, 2.0]
    assert depths(view_of([card(d) for d in (1.0, 2.125, 4.0)], lens), None, 2) == [1.0, 2.125]
    # Half the extent, half the umbra: 1 hides up to 4/3, 2 hides up to 4.
    assert depths(view_of([card(d) for d in (1.0, 1.25, 2.0, 4.0, 8.0)], lens), None, 1) == [1.0, 2.0, 8.0]


def test_depths_come_in_the_units_of_the_scene():
    for unit in (0.01, 1.0, 300.0):
        np.testing.assert_allclose(depths(view_of([card(2.5 * unit)], ThinLens(unit, unit))), [2.5 * unit], rtol=1e-14)


def test_what_lies_behind_the_eye_is_not_met():
    behind = Part([[-8, -8, 2], [8, -8, 2], [0, 16, 2]], [[0, 1, 2]], flat_scene.paint((1, 1, 1)))
    assert depths(view_of([behind, card(3.0)], ThinLens(1.0, 2.0))) == [3.0]


def test_two_surfaces_near_each_other_both_count():
    assert depths(view_of([card(2.0), card(2.0 * (1 + 2.0**-30))], ThinLens(1.0, 2.0))) == [2.0, 2.0 * (1 + 2.0**-30)]


def fan(depth, count, turn=1):
    """A disc of triangles around a corner on the axis; turned inside out with turn = -1."""
    angle = 2.0 * np.pi * np.arange(count) / count
    rim = np.stack([8 * np.cos(angle), 8 * np.sin(angle), np.full(count, -depth)], axis=1)
    faces = [[0, 1 + k, 1 + (k + 1) % count][::turn] for k in range(count)]
    return Part(np.concatenate([[[0.0, 0.0, -depth]], rim]), faces, flat_scene.paint((1, 1, 1)))


@pytest.mark.parametrize("count", [3, 4, 5, 8])
def test_a_corner_of_many_triangles_is_met_once(count):
    # The ray of the middle pixel runs through the corner that all of them share; opposite ones share nothing else.
    np.testing.assert_allclose(depths(view_of([fan(2.0, count)], ThinLens(1.0, 2.0))), [2.0], rtol=1e-14)


def test_a_corner_of_two_sides_is_met_once_a_side():
    # Two fans at one depth, of which one shows its back: two surfaces, that share their corners.
    both = depths(view_of([fan(2.0, 4), fan(2.0, 4, -1)], ThinLens(1.0, 2.0)))
    assert both == [2.0, 2.0]


def test_an_edge_of_two_triangles_is_met_once():
    assert depths(view_of([flat_scene.rectangle(-8, 8, -8, 8, 2.0)], ThinLens(1.0, 2.0))) == [2.0]


def test_sides_that_alternate_in_number_are_told_apart():
    # Four triangles around the axis, each of them there twice: as it is, and turned inside out right after it.
    front, back = fan(2.0, 4), fan(2.0, 4, -1)
    faces = np.stack([front.faces, back.faces], axis=1).reshape(-1, 3)
    part = Part(front.vertices, faces, flat_scene.paint((1, 1, 1)))
    assert depths(view_of([part], ThinLens(1.0, 2.0))) == [2.0, 2.0]


def test_more_surfaces_than_room_was_made_for():
    # The list of hits starts with 256 places.
    found = depths(view_of([card(1.0 + k / 64.0) for k in range(300)], ThinLens(1.0, 2.0)))
    assert found == [1.0 + k / 64.0 for k in range(300)]


def test_of_many_layers_one_more_than_needed_is_made():
    layers = view_of([card(1.0), card(2.0)], ThinLens(1.0, 2.0)).layers(20)
    assert layers.depth[:, 1, 1].tolist() == [1.0, 2.0, np.inf]


def test_edges_that_share_a_corner_are_apart_where_the_ray_meets_them():
    # Two triangles that fold apart from a corner at the left: on the axis their lower edges are at 2 and at 2.0002.
    corners = [[-1, 0, -2], [1, 0, -2], [0, 2, -2], [1, 0, -2.0004], [0, 2, -2.0004]]
    part = Part(corners, [[0, 1, 2], [0, 3, 4]], flat_scene.paint((1, 1, 1)))
    np.testing.assert_allclose(depths(view_of([part], ThinLens(1.0, 2.0))), [2.0, 2.0002], rtol=1e-7)


def test_what_only_float32_puts_in_front_of_the_eye_is_not_met():
    # A slanted plane that passes the axis 8.5e-8 behind the eye, and 2.4e-7 before it once its corners are float32,
    # as they are in the tree that finds it.
    left, far = -7.9999997, 8.0 + 4.7e-7

    def behind(left, far):
        return -8.0 + (far + 8.0) * left / (left - 8.0)

    assert behind(left, far) > 8e-8
    assert behind(float(np.float32(left)), float(np.float32(far))) < -2e-7
    corners = [[left, -8, -8], [left, 8, -8], [8, -8, far], [8, 8, far]]
    plane = Part(corners, [[0, 2, 1], [1, 2, 3]], flat_scene.paint((1, 1, 1)))
    assert depths(view_of([plane, card(3.0)], ThinLens(1.0, 2.0))) == [3.0]
