"""Properties of the formulas behind every blur: circles, apertures, and that more samples are no worse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof import Aperture, Camera, ThinLens
from refdof.optics.lens import photographic_share

pytestmark = pytest.mark.fast

CAMERA = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=40.0, size=(9, 7))
lengths = st.floats(1e-3, 1e3)


@given(radius=lengths, focus=lengths, depth=st.one_of(lengths, st.just(math.inf)), factor=st.floats(1e-3, 1e3))
def test_circles_are_linear_in_the_aperture(radius, focus, depth, factor):
    one = ThinLens(radius, focus).coc_px(depth, CAMERA)
    other = ThinLens(factor * radius, focus).coc_px(depth, CAMERA)
    # Four roundings on either way: P E, its quotient, the ratio and their product.
    np.testing.assert_allclose(other, factor * one, rtol=8 * 2.0**-52)


@given(
    focal_length=st.floats(1e-3, 0.2),
    f_number=st.floats(0.7, 32.0),
    focus=st.floats(0.25, 1e4),
    width=st.floats(0.1, 10),
)
def test_the_background_has_the_photographers_circle(focal_length, f_number, focus, width):
    """On a sensor f s / (s - f) behind the lens the circle of infinity is A f / (s - f) across, A = f / N."""
    lens = ThinLens.from_f_number(focal_length, f_number, focus)
    sensor = focal_length * width  # height of the sensor; the picture has 7 rows
    angle = 2.0 * math.degrees(math.atan(sensor / (2.0 * focal_length)))
    shot = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=angle, size=(9, 7))
    diameter = 2.0 * float(lens.coc_px(math.inf, shot)) * sensor / 7 / photographic_share(focal_length, focus)
    across = focal_length / f_number * focal_length / (focus - focal_length)
    # The angle's tangent loses a digit or two; s - f, with s at least 0.25 and f at most 0.2, another.
    assert diameter == pytest.approx(across, rel=1e-12)


@pytest.mark.parametrize("blades", [3, 4, 5, 6, 9])
def test_polygons_have_the_second_moment_of_the_formula(blades):
    """Of a regular polygon with n corners on the unit circle: mean of x^2 + y^2 is (2 + cos(2 pi / n)) / 6."""
    points = Aperture.polygon(blades).from_square(_grid())
    expected = (2.0 + math.cos(2.0 * math.pi / blades)) / 6.0
    # The midpoint rule on cells of 1 / 128 has an error of some of their squares, 6e-5.
    assert (points**2).sum(axis=1).mean() == pytest.approx(expected, abs=5e-4)
    np.testing.assert_allclose((points**2).mean(axis=0), expected / 2.0, atol=5e-4)
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=5e-4)


def test_the_disc_has_a_quarter_on_each_axis():
    points = Aperture.disc().from_square(_grid())
    np.testing.assert_allclose((points**2).mean(axis=0), 0.25, atol=1e-4)  # as above


def _grid():
    places = (np.arange(128) + 0.5) / 128
    return np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2)
