"""What is done with eight texels at once, beside the same texel by texel."""

import numpy as np
import pytest

from refdof import _jit
from refdof._jit import texel_lanes

pytestmark = pytest.mark.fast


@_jit.tile_kernel
def fetch(texels, places, n, planes):
    texel_lanes.fetch_lanes(texels, places, n, planes)


@_jit.tile_kernel
def add(texels, upper, lower, across, down, n, sums, k):
    texel_lanes.add_reads(texels, upper, lower, across, down, n, sums, k)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_fetched_texels_lie_side_by_side(dtype):
    random = np.random.default_rng(1)
    texels, places = random.random((30, 4)).astype(dtype), random.integers(0, 30, 20).astype(np.int32)
    planes = np.full((5, 20), 9, dtype)
    expected = planes.copy()
    for n in range(3, 11):
        for c in range(4):
            expected[c, n] = texels[places[n], c]
    fetch(texels, places, 3, planes)
    np.testing.assert_array_equal(planes, expected)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_added_reads_are_blends_of_four(dtype):
    random = np.random.default_rng(2)
    texels, (across, down) = random.random((30, 4)).astype(dtype), random.random((2, 20)).astype(dtype)
    upper, lower = random.integers(0, 29, (2, 20)).astype(np.int32)
    sums = np.ones((2, 4), dtype)
    expected = np.ones((2, 4))
    for n in range(5, 13):
        x, y, t = float(across[n]), float(down[n]), texels.astype(float)
        above = (1 - x) * t[upper[n]] + x * t[upper[n] + 1]
        expected[1] += (1 - y) * above + y * ((1 - x) * t[lower[n]] + x * t[lower[n] + 1])
    add(texels, upper, lower, across, down, 5, sums, 1)
    # Sums up to 9, of three roundings for each of eight reads, and their own.
    np.testing.assert_allclose(sums, expected, rtol=0, atol=9 * 16 * np.finfo(dtype).eps)
