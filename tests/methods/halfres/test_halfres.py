"""halfres beside its naive twin, and what was measured of the engine's own form; the contract finds it by itself."""

import numpy as np
import pytest

from refdof.methods.halfres import Params, blur
from tests.methods.halfres.naive_halfres import naive_blur

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("variant", ["three", "pmndrs"])
@pytest.mark.parametrize("circles", ["thin_lens", "smoothstep"])
@pytest.mark.parametrize("size", [(7, 10), (1, 4)])
def test_matches_the_naive_twin(size, circles, variant):
    random = np.random.default_rng(2)
    color, depth, coc = random.random((*size, 3)), random.uniform(0.5, 1.5, size), random.uniform(-5, 5, size)
    depth.flat[-1], coc.flat[:2] = np.inf, 0.0
    params = Params(largest_px=3.0, circles=circles, variant=variant, focus_range=0.4)
    expected = naive_blur(color, depth, coc, params)
    # Means of 64 reads of numbers below 1, then three blends: 100 roundings, and those of where reads are.
    np.testing.assert_allclose(blur(color, depth, coc, params), expected, rtol=0, atol=200 * 2.3e-16)
    narrow = blur(*(a.astype(np.float32) for a in (color, depth, coc)), params)
    # As many roundings, and places of up to 10 texels, rounded to 24 bits.
    np.testing.assert_allclose(narrow, expected, rtol=0, atol=200 * 1.2e-7)


def spots(circle, light):
    """A square light in a field of one circle: energy over its own after the mean and after the maximum, centroid."""
    side = 8 * circle + 48
    color = np.zeros((side, side, 3))
    start = side // 2 - side // 2 % 2
    color[start : start + light, start : start + light] = 1.0
    coc = np.full((side, side), float(circle))
    staged = blur(color, np.ones((side, side)), coc, Params(largest_px=float(circle)), stages=True)
    mean, brightest = (staged.stages[name][..., 0] for name in ("far_mean", "far_brightest"))
    y, x = 2 * np.indices(mean.shape) + 1 - start - light / 2
    center = (mean * x).sum() / mean.sum(), (mean * y).sum() / mean.sum()
    return 4 * mean.sum() / light**2, 4 * brightest.sum() / light**2, center


@pytest.mark.long
@pytest.mark.parametrize(("light", "gain"), [(1, 7.4), (2, 4.9), (4, 3.9), (8, 3.4)])
def test_the_maximum_makes_small_lights_brighter(light, gain):
    # Measured of the engine's own form at 16 px, to two digits; a light of one pixel falls on single points or between.
    mean, brightest, _ = spots(16, light)
    assert mean == pytest.approx(1.0, abs=0.03)
    assert brightest == pytest.approx(gain, abs=0.1)


@pytest.mark.long
def test_the_points_are_off_their_middle():
    *_, (x, y) = spots(32, 8)
    assert (-x / 32, -y / 32) == pytest.approx((-0.003, 0.034), abs=0.002)  # as measured of the engine's table


def test_nothing_is_blurred_in_focus_and_with_no_reach():
    random = np.random.default_rng(3)
    color, ones = random.random((6, 9, 3)), np.ones((6, 9))
    for variant in ("three", "pmndrs"):
        np.testing.assert_array_equal(blur(color, ones, 0 * ones, Params(variant=variant)), color)
        np.testing.assert_array_equal(blur(color, ones, 5 * ones, Params(0.0, variant=variant)), color)
    np.testing.assert_array_equal(blur(color, ones, 9 * ones, Params(circles="smoothstep")), color)
