"""Layers and pinhole views: closed forms, a brute-force tracer in NumPy, and embreex's own class."""

import numpy as np
import pytest
import trimesh
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from refdof import Part, ThinLens, View
from tests import flat_scene

LENS = ThinLens(0.1, 2.0)
P = 24.0


def view(parts, width=24, height=18, background=(0.1, 0.2, 0.3)):
    shot = flat_scene.camera(width, height, P)
    return View(flat_scene.scene_of(parts, shot, LENS, background), shot, LENS)


def all_hits(triangles, directions):
    """Depths (N, F) at which rays (N, 3) from the origin, z = -1, meet triangles (F, 3, 3); inf where they do not.

    Volumes of the tetrahedra between the ray and the triangle's edges, not the project's formula. Also the least of
    the three, relative to their sum: rays with a small one pass near an edge.
    """
    a, b, c = (triangles[None, :, k] for k in range(3))
    ray = directions[:, None]
    volumes = np.stack([(ray * np.cross(p, q)).sum(axis=-1) for p, q in ((b, c), (c, a), (a, b))])
    total = volumes.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = volumes / total
        depth = (a * np.cross(b, c)).sum(axis=-1) / total
    margin = share.min(axis=0)
    return np.where((margin >= 0) & (depth > 0), depth, np.inf), margin


def rays(width=24, height=18):
    x, y = flat_scene.tangents(width, height, P)
    return np.stack([x, y, -np.ones_like(x)], axis=-1)


def random_triangles(seed, count):
    random = np.random.default_rng(seed)
    centre = random.uniform([-1.2, -1.0, -6.0], [1.2, 1.0, -1.0], (count, 3))
    centre[:, :2] *= -centre[:, 2:] / 2.0
    return centre[:, None] + random.normal(0.0, 0.4, (count, 3, 3))


def soup(triangles, color=(1.0, 1.0, 1.0)):
    return Part(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), flat_scene.paint(color))


def test_every_layer_of_a_soup_against_brute_force():
    triangles = random_triangles(1, 150)
    layers = view([soup(triangles)]).layers()
    depth, margin = all_hits(triangles, rays().reshape(-1, 3))
    # Embree decides in float32: leave out rays within 1e-5 of a triangle's edge, 80 of float32's roundings.
    clear = ~((np.abs(margin) < 1e-5) & (depth > 0)).any(axis=1)
    assert clear.mean() > 0.9
    order = np.argsort(depth, axis=1)
    sorted_depth = np.take_along_axis(depth, order, axis=1)
    count = np.isfinite(depth).sum(axis=1)
    assert len(layers.depth) == count.max()
    found, ids = (x.reshape(len(x), -1).T for x in (layers.depth, layers.triangle))
    deepest = found.shape[1]
    # Both are float64; a triangle seen edge-on amplifies 1e-16 by up to some 1e4.
    np.testing.assert_allclose(found[clear], sorted_depth[clear, :deepest], rtol=1e-11)
    expected = np.where(np.isfinite(sorted_depth[:, :deepest]), order[:, :deepest], -1)
    np.testing.assert_array_equal(ids[clear], expected[clear])


def test_asking_for_few_layers_gives_the_nearest_ones():
    shown = view([soup(random_triangles(2, 80))])
    every, three = shown.layers(), shown.layers(3)
    for name in three._fields:
        np.testing.assert_array_equal(getattr(three, name), getattr(every, name)[:3])
    np.testing.assert_array_equal(shown.pinhole().depth, every.depth[0])
    empty = ~np.isfinite(every.depth[0])
    np.testing.assert_array_equal(shown.pinhole().color[empty], np.float32([[0.1, 0.2, 0.3]] * empty.sum()))
    assert empty.any()
    assert (np.diff(np.where(np.isfinite(every.depth), every.depth, 1e9), axis=0) >= 0).all()
    assert ((every.triangle < 0) == np.isinf(every.depth)).all()


def test_a_sphere_has_two_sides():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.8)
    centre = np.array([0.1, -0.05, -3.0])
    layers = view([Part(ball.vertices + centre, ball.faces, flat_scene.paint((1.0,) * 3))]).layers()
    count = (layers.triangle >= 0).sum(axis=0)
    assert set(np.unique(count)) == {0, 2}

    def between(radius):
        """Whether the ray meets a sphere, and both depths: |depth ray - centre|^2 = radius^2."""
        a, b = (rays() ** 2).sum(axis=-1), rays() @ centre
        inner = b * b - a * (centre @ centre - radius**2)
        root = np.sqrt(np.maximum(inner, 0.0))
        return inner > 0, (b - root) / a, (b + root) / a

    # The mesh is convex and lies between its own sphere and the largest one that none of its faces cuts.
    corners = ball.vertices[ball.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inradius = ((normal * corners[:, 0]).sum(axis=1) / np.linalg.norm(normal, axis=1)).min()
    outside, first, last = between(0.8)
    inside, second, third = between(inradius)
    assert not (count > 0)[~outside].any()
    assert (count == 2)[inside].all()
    assert inside.sum() > 100
    near, far = layers.depth[0][inside], layers.depth[1][inside]
    assert (first[inside] - 1e-12 <= near).all()
    assert (near <= second[inside] + 1e-12).all()
    assert (third[inside] - 1e-12 <= far).all()
    assert (far <= last[inside] + 1e-12).all()
    # Normals look at the viewer, on the inner side as well, and point along the radius up to the tessellation.
    for k, sign in ((0, 1.0), (1, -1.0)):
        point = rays()[inside] * layers.depth[k][inside][:, None] - centre
        cosine = sign * (layers.normal[k][inside] * point).sum(axis=-1) / np.linalg.norm(point, axis=-1)
        assert cosine.min() >= inradius / 0.8 - 1e-6  # float32 normals


@pytest.mark.parametrize("flipped", [False, True])
def test_coplanar_duplicates_are_all_there_in_the_order_of_their_numbers(flipped):
    tilt = np.array([[-2.5, -2, -2.0], [2, -2, -3.0], [2, 2, -3.0], [-2.5, 2, -2.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    colors = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    parts = [
        Part(tilt, faces[::-1] if flipped and k == 1 else faces, flat_scene.paint(c)) for k, c in enumerate(colors)
    ]
    # No pixel centre lies on the diagonal: there both of a quad's triangles would be met.
    layers = view(parts, 8, 6).layers()
    assert len(layers.depth) == 3
    assert (layers.depth[0] == layers.depth[1]).all()
    assert (layers.depth[1] == layers.depth[2]).all()
    assert (np.diff(layers.triangle, axis=0) > 0).all()
    np.testing.assert_array_equal(layers.triangle // 2, np.broadcast_to([[[0]], [[1]], [[2]]], (3, 6, 8)))
    for k, color in enumerate(colors):
        assert (layers.color[k] == np.float32(color)).all()


def test_a_shared_edge_through_a_pixel_centre_has_no_hole():
    # Four triangles meet on the optical axis, where the only pixel's centre is.
    corners = np.array([[0, 0, -2], [-1, -1, -2], [1, -1, -2], [1, 1, -2], [-1, 1, -2]], dtype=float)
    fan = Part(corners, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]], flat_scene.paint((1.0,) * 3))
    layers = view([fan], 1, 1).layers()
    assert layers.depth[0, 0, 0] == 2.0
    hit = layers.triangle[:, 0, 0]
    assert (np.diff(hit) > 0).all()  # every triangle at most once, ties by number
    assert (view([fan], 15, 15).pinhole().depth == 2.0).all()


def test_a_slanted_plane_is_exact():
    # 1 / depth is affine in the picture: z = -(2 + x / 2 + y / 4) gives 1 / depth = (1 - tx / 2 - ty / 4) / 2.
    x, y = (np.array(v, dtype=float) for v in ([-9, 9, 9, -9], [-9, -9, 9, 9]))
    x, y = x / 6, y / 6
    plane = Part(np.stack([x, y, -(2 + x / 2 + y / 4)], axis=1), [[0, 1, 2], [0, 2, 3]], flat_scene.paint((1.0,) * 3))
    right, up = flat_scene.tangents(24, 18, P)
    depth = view([plane]).pinhole().depth
    # A dozen roundings of 1.1e-16 each, amplified by no more than the corners' spread: 1e-12 is generous.
    np.testing.assert_allclose(depth, 2.0 / (1.0 - right / 2 - up / 4), rtol=1e-12)


def test_the_nearest_triangle_is_the_one_that_embreex_finds():
    triangles = random_triangles(3, 400)
    first = view([soup(triangles)], 96, 72).layers(1)
    x, y = flat_scene.tangents(96, 72, P)
    directions = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, triangles.astype(np.float32))
    assert mesh is not None
    other = scene.run(np.zeros_like(directions, dtype=np.float32), directions.astype(np.float32))
    same = first.triangle[0].ravel() == other
    assert same.mean() >= 0.999
    assert 0.2 < (other >= 0).mean() < 0.999
    # Where they differ, the ray passes an edge, by float32's rounding of directions and corners: 1e-5 is 80 of these.
    _, margin = all_hits(triangles, directions[~same])
    assert (np.abs(margin).min(axis=1, initial=np.inf) < 1e-5).all()


def test_nothing_in_front_of_the_camera():
    for parts in ([], [flat_scene.rectangle(-1, 1, -1, 1, -2.0)]):
        shown = view(parts)
        layers = shown.layers()
        assert layers.depth.shape == (1, 18, 24)
        assert np.isinf(layers.depth).all()
        assert (layers.triangle == -1).all()
        assert (shown.pinhole().color == np.float32([0.1, 0.2, 0.3])).all()
        assert np.isinf(shown.pinhole().depth).all()


def test_a_triangle_through_the_camera_plane_is_cut_there():
    # From 1 behind the camera to 3 in front of it, one unit below the eye: a floor.
    floor = Part(
        [[-9, -1, 1], [9, -1, 1], [9, -1, -3], [-9, -1, -3.0]],
        [[0, 1, 2], [0, 2, 3]],
        flat_scene.paint((1.0,) * 3),
    )
    shot = flat_scene.camera(8, 60, 10.0)
    shown = View(flat_scene.scene_of([floor], shot, LENS), shot, LENS)
    up = flat_scene.tangents(8, 60, 10.0)[1]
    with np.errstate(divide="ignore"):
        expected = np.where((up < 0) & (-1.0 / up <= 3.0), -1.0 / up, np.inf)
    np.testing.assert_allclose(shown.pinhole().depth, expected, rtol=1e-12)  # a few roundings


def test_more_surfaces_than_the_first_guess_of_memory():
    count = 700
    walls = np.concatenate([np.array([[[-9, -9, -z], [9, -9, -z], [0, 18, -z]]]) for z in 1.0 + np.arange(count)[::-1]])
    layers = view([soup(walls)], 3, 3).layers()
    assert layers.depth.shape == (count, 3, 3)
    # Walls at z = 1, 2, ... in reverse order of their numbers; a rounding or two.
    np.testing.assert_allclose(layers.depth[:, 1, 1], 1.0 + np.arange(count), rtol=1e-15)
    np.testing.assert_array_equal(layers.triangle[:, 1, 1], np.arange(count)[::-1])


@pytest.mark.parametrize("size", [8, 9, 16])
def test_edges_and_corners_of_a_box_are_met_once_per_side(size):
    # The diagonals of the box's faces, its edges and its corners run through pixel centres.
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    part = Part(np.asarray(box.vertices) - [0.0, 0.0, 2.0], np.asarray(box.faces), flat_scene.paint((1, 1, 1)))
    shot = flat_scene.camera(size, size, 2.0 * size)
    counts = np.isfinite(View(flat_scene.scene_of([part], shot), shot, ThinLens(0.1, 1.0)).layers().depth).sum(axis=0)
    tangent = np.abs(
        np.concatenate([t.ravel() for t in flat_scene.tangents(size, size, 2.0 * size)]).reshape(2, -1)
    ).max(axis=0)
    inside = tangent.reshape(size, size) < 0.5 / 1.5 - 1e-9  # the box's front stands at depth 1.5
    assert inside.any()
    assert (counts[inside] == 2).all()
    outside = tangent.reshape(size, size) > 0.5 / 1.5 + 1e-9
    assert (counts[outside] == 0).all()


def test_coplanar_duplicates_on_a_shared_edge_both_count():
    # The common diagonal of both quads runs through pixel centres.
    cards = [flat_scene.rectangle(-1, 1, -1, 1, 2.0, color) for color in ((1, 0, 0), (0, 1, 0))]
    shot = flat_scene.camera(4, 4, 4.0)
    layers = View(flat_scene.scene_of(cards, shot), shot, ThinLens(0.1, 1.0)).layers()
    assert (np.isfinite(layers.depth).sum(axis=0) == 2).all()
    np.testing.assert_array_equal(layers.color[:, 1, 2], np.float32([[1, 0, 0], [0, 1, 0]]))
