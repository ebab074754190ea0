"""Lens points, patterns and apertures by hand where statistics do not tell."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Aperture
from refdof._jit import tile_kernel
from refdof.optics.aperture_sampling import aperture_sampler_of, lens_point
from refdof.optics.lens_samples import lens_samples
from refdof.optics.pixel_samples import lens_point_sets

pytestmark = pytest.mark.fast


def test_jitter_along_x_and_y_is_drawn_apart():
    # A square aperture takes the unit square's areas: of jittered points in 20 x 20 cells, the places inside the cells.
    points, _ = lens_samples(400, "jittered", 3, Aperture.polygon(4))
    # The aperture's four sectors: `from_square` maps x to the sector and the place along its side, y to the squared
    # radius. Undo it.
    x, y = points.T
    angle = np.arctan2(y, x) % (2.0 * np.pi)
    sector = np.floor(angle / (np.pi / 2.0))
    turned = angle - sector * np.pi / 2.0
    reach = np.hypot(x, y)
    along = np.sin(turned) / (np.sin(turned) + np.cos(turned))
    radius = reach * (np.sin(turned) + np.cos(turned))
    square = np.stack([(sector + along) / 4.0, radius**2], axis=1)
    place = square * 20.0 % 1.0
    # 400 independent pairs: the correlation has a deviation of 1/20.
    assert abs(np.corrcoef(place.T)[0, 1]) < 4.0 / 20.0
    assert_allclose(place.mean(axis=0), 0.5, atol=4.0 * math.sqrt(1.0 / 12.0 / 400.0))


def test_noise_moves_each_point_by_a_pair_of_numbers_of_its_own():
    # Sixteen points, sixteen ordered pairs out of four numbers: of four points the two numbers are one and the same, of
    # the others they are independent. A wide square aperture keeps the inner points from being mirrored at the rim.
    aperture = Aperture.disc()
    still = lens_point_sets(16, aperture, "none", "sobol", 5).points[0]
    moved = lens_point_sets(16, aperture, "noise", "sobol", 5).points
    inner = np.hypot(*still.T) < 0.6
    assert inner.sum() >= 3
    shift = moved[:, inner] - still[inner]
    assert np.abs(shift).max() < 0.4  # no point was mirrored
    related = np.array([np.corrcoef(shift[:, k].T)[0, 1] for k in range(inner.sum())])
    same = np.flatnonzero(inner) % 4 == np.flatnonzero(inner) // 4
    assert_allclose(related[same], 1.0, atol=1e-12)
    assert (np.abs(related[~same]) < 5.0 / 64.0).all()  # 4096 pixels: a deviation of 1/64
    assert (~same).any()


def test_points_that_share_a_pair_of_numbers_follow_each_other():
    # 32 points, 16 pairs: points 2 k and 2 k + 1 move alike.
    aperture = Aperture.disc()
    still = lens_point_sets(32, aperture, "none", "vogel", 5).points[0]
    moved = lens_point_sets(32, aperture, "noise", "vogel", 5).points
    shift = moved[:, :16] - still[:16]  # of a spiral: within 0.71 of the middle
    assert np.abs(shift).max() < 0.2  # none was mirrored at the rim
    assert_allclose(shift[:, ::2], shift[:, 1::2], atol=1e-15)  # a rounding of each sum
    assert np.abs(shift[:, 1:-1:2] - shift[:, 2::2]).max(axis=(0, 2)).min() > 0.05


def test_points_beyond_the_rim_come_back_and_do_not_gather_there():
    points = lens_point_sets(8, Aperture.disc(), "noise", "vogel", 2).points
    reach = np.hypot(points[..., 0], points[..., 1])
    assert reach.max() <= 1.0
    # No number among 32768 is that close to 1 unless it was cut there: areas of 2e-9 hold 1e-4 points in the mean.
    assert (reach < 1.0 - 1e-9).all()


def test_halton_starts_anywhere_in_its_points():
    chosen = lens_point_sets(4, Aperture.disc(), "halton", seed=1).set
    assert_array_equal(np.unique(chosen), np.arange(8))
    # 4096 draws of 8: 512 each, with a deviation of 21.
    assert_allclose(np.bincount(chosen.ravel()), 512, atol=5 * 21)


@pytest.mark.parametrize("jitter", ["noise", "halton"])
def test_seeds_give_other_textures(jitter):
    one, other = (lens_point_sets(1 if jitter == "noise" else 4, Aperture.disc(), jitter, seed=seed) for seed in (1, 2))
    if jitter == "halton":
        assert (one.set != other.set).mean() > 0.8  # 7/8 of all pixels
    else:  # a single point goes anywhere: only the texture places it
        assert np.abs(one.points - other.points).max(axis=-1).min() > 0.0


@pytest.mark.parametrize("deviation", [0.05, 0.3, 0.5, 2.0])
def test_radii_of_a_gaussian_aperture_by_its_integral(deviation):
    # Along the middle of the square's right half the concentric map is the identity: the radius 2 u - 1 holds the share
    # q = (2 u - 1)^2 of an even disc, and has to hold as much of the Gaussian's light:
    # q = (1 - exp(-r^2 / 2 s^2)) / (1 - exp(-1 / 2 s^2)).
    q = np.array([1e-6, 0.01, 0.25, 0.5, 0.9, 1.0])
    square = np.stack([0.5 + 0.5 * np.sqrt(q), np.full(len(q), 0.5)], axis=1)
    points = Aperture.gaussian(deviation).from_square(square)
    whole = 1.0 - math.exp(-0.5 / deviation**2)
    radius = deviation * np.sqrt(-2.0 * np.log1p(-np.minimum(q * whole, 1.0 - 1e-16)))
    radius[-1] = 1.0
    assert_allclose(points[:-1, 0], radius[:-1], rtol=1e-9)
    assert points[-1, 0] <= 1.0
    assert_allclose(points[:, 1], 0.0, atol=1e-15)


@tile_kernel
def point_of(aperture_sampler, u, v):
    return lens_point(aperture_sampler, u, v)


def test_lens_points_of_kernels_by_hand():
    # A Gaussian is round: along the upper half of the square's middle the radius is that of the right half.
    aperture_sampler = aperture_sampler_of(Aperture.gaussian(0.5))
    right, up = point_of(aperture_sampler, 0.8, 0.5), point_of(aperture_sampler, 0.5, 0.8)
    assert_allclose(right[0], 0.5 * math.sqrt(-2.0 * math.log(1.0 - 0.36 * (1.0 - math.exp(-2.0)))), rtol=1e-12)
    assert_allclose([up[1], right[1], up[0]], [right[0], 0.0, 0.0], atol=1e-15)
    # Two texels side by side, of 1/4 and 3/4 of the light: u = 1/8 is the middle of the left one, u = 5/8 of the right
    # one. v = 0.9 is a tenth above the lower border.
    aperture_sampler = aperture_sampler_of(Aperture.image(np.array([[1.0, 3.0]])))
    assert_allclose(point_of(aperture_sampler, 0.125, 0.9), (-0.5, -0.8), rtol=1e-12)
    assert_allclose(point_of(aperture_sampler, 0.625, 0.9), (0.5, -0.8), rtol=1e-12)
    # One above the other: rows are drawn by v, the first on top.
    aperture_sampler = aperture_sampler_of(Aperture.image(np.array([[1.0], [3.0]])))
    assert_allclose(point_of(aperture_sampler, 0.9, 0.125), (0.8, 0.5), rtol=1e-12)
    assert_allclose(point_of(aperture_sampler, 0.9, 0.625), (0.8, -0.5), rtol=1e-12)
