"""circular beside its naive twin, and its kernels beside what was measured of the published coefficients."""

import math

import numpy as np
import pytest

from refdof.methods.circular import COMPONENTS, Params, blur, kernels
from tests.methods.circular.naive_circular import naive_blur

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(("fields", "components"), [("own", 1), ("own", 3), ("near_far", 2)])
@pytest.mark.parametrize("size", [(6, 9), (1, 5)])
def test_matches_the_naive_twin(size, fields, components):
    random = np.random.default_rng(6)
    nearest = -4.0 if fields == "own" else -0.6  # px: the far field is seen through the near one
    color, depth, coc = random.random((*size, 3)), random.uniform(1, 5, size), random.uniform(nearest, 4, size)
    coc[:, 3:5] = 0.0
    params = Params(components, 0.2, fields=fields, largest_px=3.0)
    expected = naive_blur(color, coc, params, COMPONENTS)
    # Sums of 17 taps twice, of parts that are up to ten times their sum: 300 roundings.
    np.testing.assert_allclose(blur(color, depth, coc, params), expected, rtol=0, atol=300 * 2.3e-16)
    narrow = blur(color.astype(np.float32), depth, coc, params)
    np.testing.assert_allclose(narrow, expected, rtol=0, atol=300 * 1.2e-7)


def continuous(components, transition, misprinted=False):
    """The kernel as it is printed, over the square of its taps: x (N,), values (N, N)."""
    x = (np.arange(-600, 600) + 0.5) / 600 * (1 + transition)
    kernel = 0.0
    for n, (a, b, real, imaginary) in enumerate(COMPONENTS[components]):
        f = np.exp((-a + 1j * b) * x * x)
        product = f[:, None] * f
        sign = -1.0 if misprinted and n == 1 else 1.0
        kernel = kernel + real * product.real + sign * imaginary * product.imag
    return x, kernel


@pytest.mark.parametrize(("components", "ripple"), [(2, 7.6), (3, 2.6), (4, 1.1), (5, 0.4)])
def test_ripple(components, ripple):
    x, kernel = continuous(components, 0.0)
    plateau = kernel[np.hypot(x, x[:, None]) < 0.9]
    assert 100 * np.ptp(plateau) / 2 / plateau.mean() == pytest.approx(ripple, abs=0.15)  # measured, to two digits


@pytest.mark.parametrize(("components", "percent"), [(2, 1.0), (3, 0.3)])
def test_negative_mass(components, percent):
    _, kernel = continuous(components, 0.2)
    assert -100 * kernel[kernel < 0].sum() / kernel.sum() == pytest.approx(percent, abs=0.11)  # measured, to a digit


def test_the_printed_size_is_7_percent_too_wide():
    x, kernel = continuous(2, 0.0)
    rms = math.sqrt((kernel * (x**2 + x[:, None] ** 2)).sum() / kernel.sum())
    assert rms * math.sqrt(2) == pytest.approx(1.07, abs=0.006)


def test_the_generators_sign_makes_a_ring():
    _, right = continuous(4, 0.0)
    _, wrong = continuous(4, 0.0, misprinted=True)
    assert wrong.max() / right.max() == pytest.approx(12, abs=0.5)
    first, second = kernels(4, 0.0), kernels(4, 0.0, misprinted=True)
    assert np.abs(first.second - second.second).max() > 1.0


def spot(**words):
    """A light of one pixel in a field of circles of 8 px whose taps are a pixel apart: (33, 33)."""
    color = np.zeros((33, 33, 3))
    color[16, 16] = 1.0
    params = Params(**words)
    circle = 8.0 * params.fitted_radius / (1 + params.transition)
    return blur(color, np.ones((33, 33)), np.full((33, 33), circle), params)[..., 0]


@pytest.mark.long
@pytest.mark.parametrize("components", [1, 2, 3, 4, 5])
def test_the_taps_are_the_printed_kernel(components):
    image = spot(components=components, transition=0.2)
    assert image.sum() == pytest.approx(1.0, abs=1e-12)
    x = np.arange(-8, 9) * 1.2 / 8
    expected = 0.0
    for a, b, real, imaginary in COMPONENTS[components]:
        f = np.exp((-a + 1j * b) * x * x)
        expected = expected + real * (f[:, None] * f).real + imaginary * (f[:, None] * f).imag
    np.testing.assert_allclose(image[8:25, 8:25], expected / expected.sum(), rtol=0, atol=1e-14)
    np.testing.assert_allclose(image, image[::-1, ::-1], rtol=0, atol=1e-15)
