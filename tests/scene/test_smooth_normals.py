"""Smooth normals: creases, seams and weights, against shapes whose normals are known."""

import math

import numpy as np
import pytest
import trimesh

from refdof.scene.smooth_normals import smooth_normals


def ridge(degrees):
    """Two unit squares that share an edge along y and bend downwards by `degrees` there; four triangles."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    vertices = np.array([[-1, 0, 0], [0, 0, 0], [0, 1, 0], [-1, 1, 0], [c, 0, -s], [c, 1, -s]], dtype=float)
    return vertices, np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])


def test_a_blunt_edge_is_rounded_and_a_sharp_one_is_not():
    vertices, faces = ridge(29.0)
    source, new, normal = smooth_normals(vertices, faces)
    assert len(source) == 6
    half = math.radians(14.5)
    # Both sides meet the edge's ends with 90 degrees in all, so that the mean is half way. Roundings only.
    for vertex in (1, 2):
        np.testing.assert_allclose(normal[source == vertex], [[math.sin(half), 0, math.cos(half)]], atol=1e-15)
    vertices, faces = ridge(31.0)
    source, new, normal = smooth_normals(vertices, faces)
    assert sorted(source) == [0, 1, 1, 2, 2, 3, 4, 5]
    np.testing.assert_allclose(normal[new[:2].ravel()], [[0, 0, 1]] * 6, atol=1e-15)
    sharp = [math.sin(math.radians(31)), 0, math.cos(math.radians(31))]
    np.testing.assert_allclose(normal[new[2:].ravel()], [sharp] * 6, atol=1e-15)


def test_a_cube_keeps_its_faces_flat():
    cube = trimesh.creation.box()
    source, faces, normal = smooth_normals(cube.vertices.view(np.ndarray), cube.faces.view(np.ndarray))
    assert len(source) == 24  # eight corners, three faces each
    np.testing.assert_array_equal(source[faces], cube.faces)
    corner = cube.vertices[cube.faces]
    flat = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    np.testing.assert_allclose(normal[faces], np.repeat(flat[:, None], 3, axis=1), atol=1e-15)  # area 1 exactly


@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
def test_a_sphere_has_radial_normals(scale):
    sphere = trimesh.creation.icosphere(subdivisions=3)
    vertices = np.array(sphere.vertices)
    source, _, normal = smooth_normals(vertices * scale, np.array(sphere.faces))
    assert len(source) == len(vertices)
    # A face's normal points to its circumcentre, at most 0.1 rad from its corners, and so do means.
    assert (normal * vertices[source]).sum(axis=1).min() > math.cos(0.1)
    # trimesh weighs by angles too; its arccos may lose half of a double's 16 digits.
    np.testing.assert_allclose(normal, sphere.vertex_normals[source], atol=1e-8)


def test_a_soup_of_triangles_gets_the_normals_of_the_joined_mesh():
    sphere = trimesh.creation.icosphere(subdivisions=2)
    vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
    _, joined, expected = smooth_normals(vertices, faces)
    soup = vertices[faces.ravel()]
    _, new, normal = smooth_normals(soup, np.arange(len(soup)).reshape(-1, 3))
    np.testing.assert_allclose(normal[new], expected[joined], atol=1e-14)  # sums in another order


def test_seams_keep_both_vertices():
    vertices, faces = ridge(10.0)
    vertices = np.concatenate([vertices, vertices[[1, 2]]])  # the second square gets corners of its own
    faces[2:] = [[6, 4, 5], [6, 5, 7]]
    source, new, normal = smooth_normals(vertices, faces)
    assert sorted(source) == list(range(8))
    np.testing.assert_array_equal(source[new], faces)
    np.testing.assert_array_equal(normal[source == 1], normal[source == 6])


def test_faces_count_by_their_angle_and_not_by_their_number():
    vertices, faces = ridge(20.0)
    split = np.array([[1, 4, 6], [1, 6, 5], [1, 5, 2]])  # the second square in three triangles
    middle = (vertices[4] + vertices[5]) / 2.0
    _, new, normal = smooth_normals(np.concatenate([vertices, [middle]]), np.concatenate([faces[:2], split]))
    half = math.radians(10.0)
    # At vertex 1 both squares still have 90 degrees in all.
    np.testing.assert_allclose(normal[new[0, 1]], [math.sin(half), 0, math.cos(half)], atol=1e-15)


def test_triangles_without_area_do_no_harm():
    vertices, faces = ridge(10.0)
    flat = np.array([[0, 1, 1], [0, 0, 0], [0, 1, 6]])
    vertices = np.concatenate([vertices, [[1.0, 0.0, 0.0]]])
    _, new, normal = smooth_normals(vertices, np.concatenate([faces, flat]))
    _, plain, expected = smooth_normals(vertices, faces)
    np.testing.assert_array_equal(normal[new[:4]], expected[plain])
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-15)


def test_nothing_comes_from_nothing():
    source, faces, normal = smooth_normals(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    assert (source.shape, faces.shape, normal.shape) == ((0,), (0, 3), (0, 3))
