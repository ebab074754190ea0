"""Tiles and medians beside scipy and plain loops, and by hand."""

import numpy as np
import pytest
from scipy import ndimage

from refdof.raster.filters.median import median
from refdof.raster.filters.tiles import tiles_of

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [(1, 1), (1, 6), (5, 1), (2, 2), (7, 9)])
def test_median(size, dtype):
    picture = np.random.default_rng(5).integers(-4, 5, (*size, 4)).astype(dtype)  # with many ties
    expected = np.stack([ndimage.median_filter(picture[..., c], 3, mode="nearest") for c in range(4)], axis=2)
    np.testing.assert_array_equal(median(picture), expected)


def test_a_median_takes_a_lone_light_away_and_keeps_an_edge():
    picture = np.zeros((5, 6, 3))
    picture[2, 1] = 9.0
    picture[:, 3:] = 1.0
    expected = np.zeros((5, 6, 3))
    expected[:, 3:] = 1.0
    np.testing.assert_array_equal(median(picture), expected)


@pytest.mark.parametrize(("size", "side"), [((7, 9), 3), ((4, 4), 4), ((1, 10), 4)])
def test_tiles_and_those_around(size, side):
    values = np.random.default_rng(6).random(size)
    tiles = tiles_of(values, side)
    shape = tuple(-(-n // side) for n in size)
    assert tiles.least.shape == shape
    for times in (0, 1, 2):
        found = tiles.dilated(times)
        for j, i in np.ndindex(shape):
            rows = slice(max(0, (j - times) * side), (j + times + 1) * side)
            part = values[rows, max(0, (i - times) * side) : (i + times + 1) * side]
            assert (found.least[j, i], found.greatest[j, i]) == (part.min(), part.max())
