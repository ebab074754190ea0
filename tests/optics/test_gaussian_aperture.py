"""The Gaussian aperture: moments, light inside a radius, and the blur of an edge, against closed forms."""

import math

import numpy as np
import pytest
from scipy import integrate
from scipy.stats import chisquare

import refdof
from refdof import Aperture, InputError, ThinLens
from refdof.optics.aperture_sampling import aperture_sampler_of, is_plain_disc, lens_point
from refdof.optics.lens_samples import PATTERNS, lens_samples
from tests import flat_scene


def light_inside(radius, deviation):
    """Share of the light inside a radius: the integral of r exp(-r^2 / (2 s^2)) by hand."""
    return -np.expm1(-(np.asarray(radius) ** 2) / (2 * deviation**2)) / -math.expm1(-1 / (2 * deviation**2))


def edge_profile(t, deviation):
    """Share of the light with x < t, by quadrature of the strips' Gaussian integrals."""

    def strip(x):
        half = math.sqrt(max(1.0 - x * x, 0.0))
        return math.exp(-x * x / (2 * deviation**2)) * math.erf(half / (deviation * math.sqrt(2.0)))

    whole = integrate.quad(strip, -1.0, 1.0)[0]
    return integrate.quad(strip, -1.0, min(max(t, -1.0), 1.0))[0] / whole


@pytest.mark.parametrize("deviation", [0.01, 0.2, 0.5, 1.0, 100.0])
def test_variance_is_that_of_a_cut_gaussian(deviation):
    v = (np.arange(512) + 0.5) / 512
    square = np.stack(np.meshgrid(v, v), axis=-1).reshape(-1, 2)
    x, y = Aperture.gaussian(deviation).from_square(square).T
    # Mean r^2 = 2 s^2 - q / (1 - q) with q = exp(-1 / (2 s^2)); half of it along each axis.
    q = math.exp(-1 / (2 * deviation**2))
    if q < 0.99:
        closed = (2 * deviation**2 - q / (1 - q)) / 2
    else:
        closed = 0.25  # an even disc, to 1 / (48 s^2)
    # The outermost of 256 square rings holds 1 / 128 of the light; a logarithm's midpoint is 1 - ln 2 off its mean
    # there, and in the other rings by 0.04 in all.
    assert np.mean(x * x) == pytest.approx(closed, rel=0.36 / 128)
    assert np.mean(y * y) == pytest.approx(closed, rel=0.36 / 128)
    np.testing.assert_allclose([x.mean(), y.mean(), np.mean(x * y)], 0.0, atol=1e-13)  # mirrored pairs cancel
    assert np.hypot(x, y).max() <= 1.0 + 1e-15


def test_light_inside_a_radius():
    count = 40_000
    points = Aperture.gaussian(0.5).from_square(np.random.default_rng(3).random((count, 2)))
    edges = np.linspace(0.0, 1.0, 13)
    found, _ = np.histogram(np.hypot(*points.T), edges)
    assert chisquare(found, np.diff(light_inside(edges, 0.5)) * count).pvalue > 1e-3  # false alarm rate


def test_a_wide_gaussian_is_the_even_disc():
    square = np.random.default_rng(4).random((500, 2))
    # r^2 is off by r^2 (1 - r^2) / (4 s^2) = 6e-6.
    difference = Aperture.gaussian(100.0).from_square(square) - Aperture.disc().from_square(square)
    assert np.abs(difference).max() < 1e-5


def test_kernels_draw_the_same_points():
    aperture = Aperture.gaussian(0.4, ratio=0.5)
    square = np.concatenate([np.random.default_rng(5).random((200, 2)), [[0.5, 0.5]]])
    aperture_sampler = aperture_sampler_of(aperture)
    assert not is_plain_disc(aperture_sampler)
    drawn = [lens_point(aperture_sampler, u, v) for u, v in square]
    np.testing.assert_allclose(drawn, aperture.from_square(square), rtol=0, atol=1e-15)
    assert drawn[-1] == (0.0, 0.0)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_every_pattern_has_equal_weights(pattern):
    points, weights = lens_samples(256, pattern, 1, Aperture.gaussian())
    assert (weights == 1.0).all()
    # Half the light of a Gaussian of 0.5 lies inside 0.5328: (1 - exp(-2 r^2)) / (1 - exp(-2)) = 1 / 2.
    inside = (np.hypot(*points.T) < 0.5328).mean()
    assert inside == pytest.approx(0.5, abs=4 * 0.5 / 16)  # at worst independent points: deviation 1 / 32, four times


@pytest.mark.parametrize("deviation", [0.5, 0.25])
def test_an_edge_blurs_as_the_cut_gaussian_does(deviation):
    p, width, focus, depth = 24.0, 24, 4.0, 1.0
    shot = flat_scene.camera(width, 1, p)
    card = flat_scene.rectangle(-9, 0, -9, 9, depth, (1.0, 1.0, 1.0))
    lens = ThinLens(8.0 / (p * 0.75), focus, Aperture.gaussian(deviation))  # circles of -8 px on the card
    truth = refdof.reference(flat_scene.scene_of([card], shot), shot, lens, samples=4096)
    # A pixel at x sees the card through lens points with x + 8 v < 12.
    expected = [edge_profile((12.0 - (x + 0.5)) / 8.0, deviation) for x in range(width)]
    error = np.maximum(truth.standard_error[0, :, 0], 1.0 / 4096)
    assert (np.abs(truth.image[0, :, 0] - expected) < 5 * error).all()  # 24 pixels, Student's t of 15: odds 4e-3


@pytest.mark.parametrize("deviation", [0.0, -1.0, 1e-3, 101.0, math.inf, math.nan, "wide"])
def test_bad_deviations_are_named(deviation):
    with pytest.raises(InputError, match=r"^deviation: got"):
        Aperture.gaussian(deviation)


@pytest.mark.parametrize("deviation", [0.01, 0.11, 0.116, 0.5])
def test_no_point_leaves_the_lens(deviation):
    corners = np.array([[0.0, 0.5], [0.5, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.3]])
    points = Aperture.gaussian(deviation).from_square(corners)
    assert (np.hypot(*points.T) <= 1.0 + 1e-15).all()  # one rounding of the rim
