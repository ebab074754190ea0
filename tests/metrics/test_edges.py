"""Metrics at the edges of what they allow, and FLIP's viewing distance."""

import math

import flip_evaluator
import numpy as np
import pytest
from numpy.testing import assert_allclose

from refdof import metrics
from refdof._check import InputError
from refdof.image.display import display

pytestmark = pytest.mark.fast


def noise(height, width):
    return np.random.default_rng(5).uniform(0.0, 1.0, (2, height, width, 3)).astype(np.float32)


def test_flip_sees_a_display_of_its_authors_from_their_distance():
    # 3840 px on 0.7 m, seen from 0.7 m: a pixel is 1 / 3840 rad wide.
    assert_allclose(metrics.FLIP_PPD, 3840 * math.pi / 180, rtol=1e-6)  # printed with six digits
    first, second = noise(24, 20)
    # The evaluator's own default is that distance; a float32 mean of 480 values.
    _, mean, _ = flip_evaluator.evaluate(display(first), display(second), "LDR", inputsRGB=True, applyMagma=False)
    assert_allclose(metrics.flip(first, second), mean, rtol=1e-5)


def test_ssim_of_a_single_window():
    # 11 x 11 pixels hold one window: means, variances and covariance under its weights, in Eq. (13) of Wang et al.
    first, second = noise(11, 11)
    a, b = (display(image).astype(np.float64) for image in (first, second))
    side = np.exp(-(np.arange(-5, 6) ** 2) / (2 * 1.5**2))
    weight = (np.outer(side, side) / side.sum() ** 2)[..., None]
    mean_a, mean_b = (weight * a).sum(axis=(0, 1)), (weight * b).sum(axis=(0, 1))
    covariance = (weight * (a - mean_a) * (b - mean_b)).sum(axis=(0, 1))
    variances = (weight * ((a - mean_a) ** 2 + (b - mean_b) ** 2)).sum(axis=(0, 1))
    luminance = (2 * mean_a * mean_b + 1e-4) / (mean_a**2 + mean_b**2 + 1e-4)
    expected = (luminance * (2 * covariance + 9e-4) / (variances + 9e-4)).mean()
    assert_allclose(metrics.ssim(first, second), expected, atol=1e-10)  # E[x^2] - E[x]^2 cancels in float64


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.bool_])
def test_pixels_of_a_file_are_no_light(kind):
    light = np.full((12, 13, 3), 0.5)
    with pytest.raises(InputError, match=r"image: got .*; allowed are floats that hold linear light"):
        metrics.rmse(light, np.ones((12, 13, 3), dtype=kind))
    assert metrics.rmse(light, np.ones((12, 13, 3), dtype=np.int64)) == 0.5
