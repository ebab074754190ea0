"""Numbers that docstrings and comments state without a test beside their code: each is computed here anew."""

import math

import numpy as np
import pytest
from scipy import integrate

from refdof._check import LARGEST_LIGHT
from refdof.image.noise_floor import _share_below_white
from refdof.methods import poisson, singlepass
from refdof.methods.cascaded.gaussian import TRUNCATION
from refdof.methods.mipmap.upsample import _log2

pytestmark = pytest.mark.fast


def test_tails_that_gaussians_lose():
    assert round(100 * math.erfc(TRUNCATION / math.sqrt(2)), 2) == 0.27  # refdof/methods/cascaded/gaussian.py


def test_error_of_the_linear_logarithm():
    m = np.linspace(1.0, 2.0, 100_001)
    assert (
        round(float((0.5 * (np.log2(m) - (m - 1.0))).max()), 3) == 0.043
    )  # of a square's, refdof/raster/gpu/texture.py


@pytest.mark.parametrize(("above", "share"), [(0.0, 0.5), (2.0, 0.006)])
def test_noise_that_the_clip_at_white_leaves(above, share):
    def seen(x):  # x Gaussian of deviation 1 around `above`; what is above 0 is cut
        return min(x, 0.0) ** 2 * math.exp(-0.5 * (x - above) ** 2) / math.sqrt(2 * math.pi)

    exact = integrate.quad(seen, -10, 10, points=[0.0])[0]
    assert float(f"{exact:.1g}") == share  # refdof/image/noise_floor.py
    error = np.full((1, 1, 1), 0.01)
    assert _share_below_white(1.0 + above * error, error).item() == pytest.approx(exact, rel=1e-6)


def test_logarithm_of_the_mipmap_method():
    value = np.concatenate([np.linspace(0.5, 2.0, 301), [1e-300, 3.7e-5, 1e300]])
    s = (math.sqrt(2.0) - 1.0) / (math.sqrt(2.0) + 1.0)
    assert s * s < 0.0295
    assert 2e-17 <= s**20 / 21.0 < 3e-17  # the first term left out, refdof/methods/mipmap/upsample.py
    own = np.array([_log2(v) for v in value])
    np.testing.assert_allclose(own, np.log2(value), rtol=2.0**-51, atol=2.0**-52)  # both round


def test_the_worst_depth_for_ten_umbra_layers():
    # raster/rays/umbra.py: 30 degrees, 600 rows, 9 mm, from 1 m; a step is a pixel's tangent over the lens radius.
    step = 2.0 * math.tan(math.radians(15.0)) / 600.0 / 0.009
    assert 1.0 / (1.0 - 10.0 * step) == pytest.approx(131.66, abs=0.005)


@pytest.mark.parametrize("blur", [singlepass.blur, poisson.blur])
def test_the_largest_colours_fit_float32(blur):
    largest = LARGEST_LIGHT
    color = np.full((6, 6, 3), largest, dtype=np.float32)
    coc = np.where(np.indices((6, 6)).sum(axis=0) % 2, 4.0, -4.0)
    shown = blur(color, 1.0 / (2.0 - 0.1 * coc), coc)
    np.testing.assert_allclose(shown, largest, rtol=398 * 2.0**-23)  # as many roundings as taps


def test_memory_of_the_largest_lens_pattern():
    assert 64 * 64 * 4096 * (2 + 1) * 8 / 2**20 == 384  # refdof/optics/pixel_samples.py: x, y and weight in float64
