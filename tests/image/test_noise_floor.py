"""The noise floor against its definition: the mean square of normal noise that a clip at white leaves to be seen."""

import math

import numpy as np
import pytest
from scipy import integrate

from refdof.image.noise_floor import noise_floor_psnr

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("steps", [-3.0, -1.0, -0.25, 0.0, 0.25, 1.0, 3.0])
def test_noise_near_white_is_the_clipped_gaussians(steps):
    # x is normal, in standard errors from white; shown is min(x, 0), and min(steps, 0) without noise.
    def square(x):
        return (min(x, 0.0) - min(steps, 0.0)) ** 2 * math.exp(-0.5 * (x - steps) ** 2) / math.sqrt(2.0 * math.pi)

    left = integrate.quad(square, steps - 12.0, steps + 12.0, points=sorted({0.0, steps}), epsabs=1e-14)[0]
    error = 2.0**-10
    value = 1.0 + steps * error
    slope = 1.055 / 2.4 * min(value, 1.0) ** (1.0 / 2.4 - 1.0)  # of the sRGB curve
    wanted = -10.0 * math.log10(left * (slope * error) ** 2)
    picture = np.full((2, 3, 3), value)
    # The integral is good to 1e-12, the tails lose digits where they cancel.
    assert noise_floor_psnr(picture, np.full_like(picture, error)) == pytest.approx(wanted, abs=1e-8)


def test_the_floor_is_that_of_the_mean_square():
    # On the straight part of the curve its slope is 12.92; half of the values have an error, far below white.
    picture, error = np.full((1, 2, 3), 0.001), np.zeros((1, 2, 3))
    error[0, 0] = 1e-4
    wanted = -10.0 * math.log10((12.92 * 1e-4) ** 2 / 2.0)
    assert noise_floor_psnr(picture, error) == pytest.approx(wanted, rel=1e-12)
