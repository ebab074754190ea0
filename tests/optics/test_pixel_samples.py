"""Lens points per pixel: inside the aperture, spread evenly, and moved as the paper says."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from refdof import Aperture, InputError, lens_samples
from refdof.optics.pixel_samples import JITTERS, lens_point_sets, mean_nearest_distance

pytestmark = pytest.mark.fast


@given(st.integers(3, 9), st.floats(0, 360), st.floats(0, 1), st.floats(0.3, 3.0), st.sampled_from(JITTERS))
def test_points_stay_in_the_aperture(blades, rotation, curvature, ratio, jitter):
    aperture = Aperture.polygon(blades, rotation, curvature, ratio)
    points = lens_point_sets(5, aperture, jitter, "vogel").points.reshape(-1, 2)[:2000]
    aperture_sampler = shapely.Polygon(aperture.boundary * np.asarray(aperture.scale))
    # Roundings of a few float64 operations.
    assert shapely.dwithin(aperture_sampler, shapely.points(points), 1e-12).all()


@pytest.mark.parametrize("jitter", JITTERS)
def test_points_spread_evenly_over_the_disc(jitter):
    points = lens_point_sets(64, Aperture.disc(), jitter, "vogel", seed=3).points
    # A uniform disc's second moments are 1/4. So few points miss them by 1 / 64 at most, and so do their moved copies.
    np.testing.assert_allclose((points**2).mean(axis=(0, 1)), 0.25, atol=1 / 64)
    np.testing.assert_allclose(points.mean(axis=(0, 1)), 0.0, atol=1 / 64)


def test_noise_moves_points_by_half_their_distance_along_each_axis():
    points, _ = lens_samples(32, "poisson", 5)
    amplitude = 0.5 * mean_nearest_distance(points)
    pattern = lens_point_sets(32, Aperture.disc(), "noise", "poisson", 5)
    inner = np.hypot(*points.T) < 1.0 - 1.5 * amplitude  # never mirrored
    shift = (pattern.points - points)[:, inner]
    assert inner.sum() > 5
    # 4096 uniform numbers come within 0.1 % of both ends.
    np.testing.assert_allclose(shift.max(axis=0), amplitude, rtol=0.01)
    np.testing.assert_allclose(shift.min(axis=0), -amplitude, rtol=0.01)
    # The paper's pairs include those of a number with itself: points 0 and 1 of 32 move along the diagonal.
    first = (pattern.points - points)[:, 0]
    unmirrored = np.hypot(*pattern.points[:, 0].T) < 1.0 - 3.0 * amplitude
    np.testing.assert_allclose(first[unmirrored, 0], first[unmirrored, 1], atol=1e-14)


def test_mean_nearest_distance_of_poisson_discs():
    # The paper prints 0.137 for 32 samples, which is half the mean distance of darts; sets differ by 0.0033.
    halves = [0.5 * mean_nearest_distance(lens_samples(32, "poisson", seed)[0]) for seed in range(20)]
    assert np.mean(halves) == pytest.approx(0.137, abs=0.005)


def test_halton_windows_overlap():
    points = lens_point_sets(8, Aperture.disc(), "halton", seed=1).points
    assert points.shape == (16, 8, 2)
    np.testing.assert_array_equal(points[3, 1:], points[4, :-1])
    np.testing.assert_array_equal(points[15, 1], points[0, 0])


@pytest.mark.parametrize("jitter", JITTERS)
@pytest.mark.parametrize("count", [1, 64])
def test_points_stay_on_an_image_and_are_as_dense_as_its_light(jitter, count):
    image = np.zeros((5, 5))
    image[1:4, 1:3] = 1.0
    image[1:4, 3] = 0.5
    aperture = Aperture.image(image)
    for pattern in ("vogel", "poisson"):
        made = lens_point_sets(count, aperture, jitter, pattern)
        assert (made.weights == 1.0).all()
        points = made.points.reshape(-1, 2)
        assert (aperture.transmission(points) > 0.0).all()
        if count == 64:
            # A fifth of the light is right of x = 1/5; so few points miss it by 4 of 64 at most.
            assert (points[:, 0] > 0.2).mean() == pytest.approx(0.2, abs=4 / 64)
        if jitter == "noise":
            assert len(np.unique(made.points, axis=0)) > 1000  # most pixels have a set of their own


def test_without_jitter_all_pixels_share_the_lens_samples():
    pattern = lens_point_sets(7, Aperture.disc(), "none", "sobol", 2)
    np.testing.assert_array_equal(pattern.points[0], lens_samples(7, "sobol", 2)[0])
    assert pattern.set.tolist() == [[0]]


@pytest.mark.parametrize("words", [{"count": 0}, {"count": 5000}, {"jitter": "nose"}, {"pattern": "x"}, {"seed": -1}])
def test_bad_input(words):
    with pytest.raises(InputError, match=next(iter(words))):
        lens_point_sets(**{"count": 4, "aperture": Aperture.disc(), **words})
