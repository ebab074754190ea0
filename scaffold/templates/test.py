"""NAME beside its naive twin and by hand; the contract tests find the method by themselves."""

import numpy as np
import pytest
from naive_NAME import naive_blur

from refdof.methods.NAME import Params, blur

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("size", [(9, 12), (1, 5)])
def test_matches_the_naive_twin(size):
    random = np.random.default_rng(1)
    color, depth, coc = random.random((*size, 3)), random.uniform(1, 5, size), random.uniform(-4, 4, size)
    # 29 pixels at most, summed in float64 in another order: 29 roundings.
    expected = naive_blur(color, coc, 3.0)
    np.testing.assert_allclose(blur(color, depth, coc, Params(largest_px=3.0)), expected, rtol=29 * 2.3e-16)


def test_a_white_pixel_by_hand():
    color = np.zeros((3, 3, 3))
    color[1, 1] = 1.0
    image = blur(color, np.ones((3, 3)), np.ones((3, 3)))
    # A circle of 1 px has five pixel centres: the pixel and its four neighbours, if the picture has them.
    np.testing.assert_array_equal(image[..., 0], [[0, 1 / 4, 0], [1 / 4, 1 / 5, 1 / 4], [0, 1 / 4, 0]])
