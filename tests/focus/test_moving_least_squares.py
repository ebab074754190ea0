"""Moving least squares: exact at points, planes, order, limits, and a solution of the weighted system by itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof.focus.moving_least_squares import moving_least_squares

pytestmark = pytest.mark.fast

PLACES = np.stack(np.meshgrid(np.linspace(0.05, 1.25, 7), np.linspace(0.03, 0.97, 6)), axis=-1).reshape(-1, 2)


def points_of(count, seed=0):
    random = np.random.default_rng(seed)
    points = random.uniform(0.0, 1.0, (count, 2)) * [1.3, 1.0]
    return points, random.uniform(0.1, 1.0, (count, 1)), random.uniform(0.5, 2.0, count), random.uniform(2, 4, count)


@given(count=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_the_surface_has_the_values_of_its_points(count, seed):
    points, values, weight, falloff = points_of(count, seed)
    found = moving_least_squares(points, values, weight, falloff, points)
    np.testing.assert_allclose(found, values, rtol=1e-12)


@given(seed=st.integers(0, 10**6))
def test_the_order_of_points_changes_no_bit(seed):
    points, values, weight, falloff = points_of(7, seed)
    order = np.random.default_rng(seed).permutation(7)
    first = moving_least_squares(points, values, weight, falloff, PLACES)
    second = moving_least_squares(points[order], values[order], weight[order], falloff[order], PLACES)
    np.testing.assert_array_equal(first, second)


@given(seed=st.integers(0, 10**6), count=st.integers(4, 9))
def test_planes_are_reproduced(seed, count):
    points, _, weight, falloff = points_of(count, seed)
    plane = 0.4 + points @ [[0.3], [-0.2]]
    found = moving_least_squares(points, plane, weight, falloff, PLACES)
    # The spread across the line of the nearest points may be 1e-8 of that along it; then 1e-16 becomes 1e-8.
    np.testing.assert_allclose(found, 0.4 + PLACES @ [[0.3], [-0.2]], atol=1e-6)


def test_it_is_the_weighted_least_squares_plane_at_every_place():
    points, values, weight, falloff = points_of(6)
    found = moving_least_squares(points, values, weight, falloff, PLACES)
    for place, height in zip(PLACES, found, strict=True):
        root = np.sqrt(weight / np.hypot(*(points - place).T) ** falloff)
        system = np.column_stack([np.ones(6), points - place]) * root[:, None]
        wanted, *_ = np.linalg.lstsq(system, values * root[:, None], rcond=None)
        np.testing.assert_allclose(height, wanted[0], rtol=1e-8)


def test_one_point_is_level_and_two_are_level_across_their_line():
    one = moving_least_squares(np.array([[0.3, 0.4]]), np.array([[0.7]]), np.ones(1), np.full(1, 3.0), PLACES)
    np.testing.assert_array_equal(one, 0.7)
    points, values = np.array([[0.2, 0.5], [0.8, 0.5]]), np.array([[1.0], [2.0]])
    two = moving_least_squares(points, values, np.ones(2), np.full(2, 3.0), PLACES)
    np.testing.assert_allclose(two[:, 0], 1.0 + (PLACES[:, 0] - 0.2) / 0.6, rtol=1e-6)


def test_points_at_one_place_have_the_mean_by_weight():
    points = np.array([[0.2, 0.5], [0.2, 0.5], [0.9, 0.1]])
    values, weight = np.array([[1.0], [4.0], [2.0]]), np.array([2.0, 1.0, 1.0])
    at = moving_least_squares(points, values, weight, np.full(3, 2.0), points[:1])
    assert at[0, 0] == pytest.approx(2.0, rel=1e-15)
    beside = moving_least_squares(points, values, weight, np.full(3, 2.0), points[:1] + 1e-5)
    assert beside[0, 0] == pytest.approx(2.0, abs=1e-4)  # the surface comes up to it


def test_with_a_steep_falloff_the_nearest_point_counts():
    points, values = np.array([[0.2, 0.2], [0.8, 0.3], [0.4, 0.9]]), np.array([[1.0], [2.0], [3.0]])
    found = moving_least_squares(points, values, np.ones(3), np.full(3, 60.0), np.array([[0.21, 0.2], [0.79, 0.3]]))
    # The plane still runs through the two others; what is near the nearest point has nearly its value.
    np.testing.assert_allclose(found[:, 0], [1.0, 2.0], atol=0.05)
