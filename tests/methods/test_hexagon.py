"""hexagon beside its naive twin, by hand, and beside what was measured of the engine's own form."""

import math

import numpy as np
import pytest

from refdof.methods.hexagon import Params, blur
from tests.methods.naive_hexagon import naive_blur

pytestmark = pytest.mark.fast

FORMS = ("engine", "equal")


@pytest.mark.parametrize("rhombi", FORMS)
@pytest.mark.parametrize("size", [(9, 12), (1, 5), (6, 1), (1, 1)])
def test_matches_the_naive_twin(size, rhombi):
    random = np.random.default_rng(1)
    color, depth, coc = random.random((*size, 3)), random.uniform(1, 5, size), random.uniform(-4, 4, size)
    coc.flat[0] = 2.5  # a half
    expected = naive_blur(color, coc, 3.0, rhombi == "equal")
    # Two means of four reads, each blended in three steps: 40 roundings of numbers below 1.
    found = blur(color, depth, coc, Params(largest_px=3.0, rhombi=rhombi))
    np.testing.assert_allclose(found, expected, rtol=0, atol=40 * 2.3e-16)
    narrow = blur(color.astype(np.float32), depth, coc, Params(largest_px=3.0, rhombi=rhombi))
    np.testing.assert_allclose(narrow, expected, rtol=0, atol=40 * 1.2e-7)  # and those of the colours


def moments(rhombi, circle):
    """What a light of one pixel becomes: energy, brightest value over the mean, and centroid from its middle [px]."""
    side = 4 * circle + 41
    color = np.zeros((side, side, 3))
    color[side // 2, side // 2] = 1.0
    image = blur(color, np.ones((side, side)), np.full((side, side), float(circle)), Params(rhombi=rhombi))[..., 0]
    y, x = np.indices(image.shape) - side // 2
    energy = image.sum()
    return energy, image.max() / energy * 1.5 * math.sqrt(3) * circle**2, (image * x).sum(), (image * y).sum()


@pytest.mark.long
def test_the_engines_rhombi_are_not_alike():
    # docs: measured of the engine's own form at 60 px across: (-3.2, -1.9) px off, and a ridge of three times the mean.
    energy, ridge, x, y = moments("engine", 30)
    assert energy == pytest.approx(1.0, rel=1e-12)  # all pixels share the light out alike
    # By hand: a light is seen from pixels that lie against the directions. Half of it is in one rhombus, a quarter in
    # each of the others; mean steps of s / 2 along each of a rhombus's two directions add up to this.
    steps = 15.0
    assert x == pytest.approx(-steps * math.sqrt(3) / 2 / 4, abs=1e-9)
    assert y == pytest.approx(-steps / 8, abs=1e-9)
    assert (round(x, 1), round(y, 1)) == (-3.2, -1.9)
    assert 2.7 < ridge < 3.3


@pytest.mark.long
def test_equal_rhombi_are_in_the_middle():
    energy, ridge, x, y = moments("equal", 30)
    assert energy == pytest.approx(1.0, rel=1e-12)
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert ridge < 1.5


def test_a_white_pixel_by_hand():
    color = np.zeros((3, 3, 3))
    color[1, 1] = 1.0
    image = blur(color, np.ones((3, 3)), np.full((3, 3), [[0.2, -0.4, 0.5]]))[..., 0]
    np.testing.assert_array_equal(image, color[..., 0])  # no step anywhere: halves round to even
    one = np.zeros((3, 3))
    one[0, 1] = 1.0  # one step from this pixel alone, which sees the white one below it
    # Downwards: half of 1. Up to the right there is nothing. V = 1/2, D = 0, M = 1/4. In the second pass: the means of
    # (V, V beside it) and (M, M beside it), which are 0 there: 1/4 and 1/8, and of V and M at that place, half of each
    # read lands on the pixel itself, as the rows above the picture repeat it.
    found = blur(color, np.ones((3, 3)), one)[..., 0]
    share = 1.0 - math.sqrt(3) / 2  # of the pixel in a read one step to the side
    assert found[0, 1] == pytest.approx((0.25 * (1 + share) + 0.125 * (1 + share)) / 2, rel=1e-12)
    assert found[1, 1] == 1.0
    assert np.count_nonzero(found) == 2
