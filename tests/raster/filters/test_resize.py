"""Reads around the pixel centres of another size beside one read after the other in plain Python, and by hand."""

import numpy as np
import pytest

from refdof.raster.filters.resize import corner_means, resize
from tests.methods.naive_reads import read

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(("size", "target"), [((6, 8), (3, 4)), ((5, 7), (9, 3)), ((1, 1), (2, 2)), ((4, 1), (1, 5))])
def test_matches_plain_reads(size, target, dtype):
    picture = np.random.default_rng(4).random((*size, 4)).astype(dtype)
    right, down = size[1] / target[1], size[0] / target[0]
    tolerance = 30 * float(
        np.finfo(dtype).eps
    )  # places of up to 10 texels, then sums of up to four blends of three steps
    for apart in (0.5, 2.5):
        corners, centre = corner_means(picture, *target, apart), resize(picture, *target)
        for y, x in np.ndindex(target):
            u, v = (x + 0.5) * right, (y + 0.5) * down
            assert centre[y, x] == pytest.approx(read(picture, u, v), abs=tolerance)
            places = [(u + i * apart * right, v + j * apart * down) for i in (-1, 1) for j in (-1, 1)]
            expected = sum(read(picture, *place) for place in places) / 4
            assert corners[y, x] == pytest.approx(expected, abs=tolerance)


def test_half_of_an_even_size_is_the_mean_of_four_and_twice_the_size_a_tent():
    picture = np.zeros((2, 4, 4))
    picture[0, :, 0] = 1.0, 2.0, 4.0, 8.0
    assert resize(picture, 1, 2)[..., 0].tolist() == [[0.75, 3.0]]
    assert resize(picture, 2, 8)[0, :, 0].tolist() == [1.0, 1.25, 1.75, 2.5, 3.5, 5.0, 7.0, 8.0]
