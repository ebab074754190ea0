"""Polygons cut into triangles: areas by shapely and by hand."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError
from refdof.scene.formats.polygons import triangles_of

pytestmark = pytest.mark.fast
FRAME = [(0, 0), (9, 0), (9, 4), (0, 4), (0, 0)]
SHAPES = {
    # Corners, area by hand.
    "square": ([(0, 0), (2, 0), (2, 2), (0, 2)], 4.0),
    "dart": ([(0, 0), (2, 0), (0.5, 0.5), (0, 2)], 1.0),
    "dart, another first corner": ([(0.5, 0.5), (0, 2), (0, 0), (2, 0)], 1.0),
    "L": ([(1, 0), (0, 0), (0, 1), (-1, 1), (-1, -1), (1, -1)], 3.0),
    "corners on lines": ([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)], 4.0),
    # A hole, joined to the rim by two edges along one line.
    "frame": ([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], 12.0),
    # Two holes that touch each other in a corner.
    "holes that touch": (
        [*FRAME, (1, 1), (1, 3), (3, 3), (5, 1), (5, 3), (7, 3), (7, 1), (5, 1), (3, 3), (3, 1), (1, 1)],
        28.0,
    ),
    "two triangles that touch": ([(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (1, 1)], 1.0),
}
PLANES = {
    "xy": np.array([[1, 0, 0], [0, 1, 0]]),
    "zx": np.array([[0, 0, 1], [1, 0, 0]]),
    "slanted": np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]]),
}


def cut(ring):
    """Twice the signed areas, (T, 3), of a ring (N, 3)."""
    ring = np.asarray(ring, dtype=float)
    triangle, polygon = triangles_of(ring, np.array([len(ring)]), np.arange(len(ring)))
    assert (polygon == 0).all()
    assert len(triangle) == len(ring) - 2
    a, b, c = (ring[triangle[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("name", SHAPES)
def test_areas_by_hand(name, way, plane):
    corners, area = SHAPES[name]
    twice = cut(np.array(corners, dtype=float)[::way] @ PLANES[plane])
    normal = np.cross(*PLANES[plane]) * way
    signed = twice @ normal / 2
    # Each triangle turns the polygon's way, so that they cover it without overlaps. Roundings of a few units.
    assert (signed > -1e-12).all()
    assert signed.sum() == pytest.approx(area, abs=1e-12)


@settings(deadline=None, max_examples=60)
@given(st.integers(4, 24), st.integers(0, 2**32 - 1))
def test_stars_of_random_reach_by_shapely(count, seed):
    rng = np.random.default_rng(seed)
    angle = (np.arange(count) + rng.uniform(0.1, 0.9, count)) * (2 * np.pi / count)
    ring = rng.uniform(0.1, 1.0, (count, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    polygon = shapely.Polygon(ring)
    assert polygon.is_valid
    signed = cut(np.pad(ring, ((0, 0), (0, 1))))[:, 2] / 2
    assert signed.min() > -1e-15
    assert signed.sum() == pytest.approx(polygon.area, abs=1e-12)  # roundings of sums of some 20 terms below 1


def test_many_polygons_stay_in_their_order():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0.2, 0.2, 0), (0, 1, 0), (5, 5, 5)], dtype=float)
    corners = np.array([0, 1, 3, 4, 0, 1, 2, 3, 0, 1, 0, 1, 2])
    triangle, polygon = triangles_of(vertices, np.array([3, 1, 4, 2, 3]), corners)
    assert polygon.tolist() == [0, 2, 2, 4]
    assert [set(corners[t].tolist()) for t in triangle] == [{0, 1, 3}, {0, 1, 2}, {0, 2, 3}, {0, 1, 2}]


@pytest.mark.parametrize("scale", [1e-200, 1e-20, 1e20, 1e99])
def test_size_does_not_matter(scale):
    corners = np.pad(np.array(SHAPES["L"][0], dtype=float), ((0, 0), (0, 1)))
    unit, _ = triangles_of(corners, np.array([6]), np.arange(6))
    scaled, _ = triangles_of(corners * scale, np.array([6]), np.arange(6))
    np.testing.assert_array_equal(scaled, unit)


def test_polygons_that_cross_themselves_end():
    star = [(np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5), 0) for k in range(5)]
    assert len(cut(star)) == 3
    assert len(cut([(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)])) == 2
    assert len(cut(np.zeros((6, 3)))) == 4


def test_huge_polygons_are_refused_unless_convex():
    angle = np.arange(6000) * (2 * np.pi / 6000)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    assert cut(ring)[:, 2].sum() / 2 == pytest.approx(np.pi, rel=1e-6)  # 2 pi^2 / (3 n^2) less
    ring[::2] *= 0.5
    with pytest.raises(InputError, match="6000 corners; allowed are at most 5000"):
        cut(ring)
