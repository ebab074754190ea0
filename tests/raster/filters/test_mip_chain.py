"""Mip chains of extremes and of coverage against loops; fast downsampling against the reads that they stand for."""

import dataclasses

import numpy as np
import pytest
from scipy import ndimage

from refdof._check import InputError
from refdof._jit import thread_count, use_threads
from refdof.methods.multiview.coverage import average_color, coverage_mipmaps
from refdof.raster.filters.mip_chain import box_mipmaps, extreme_mipmaps, gaussian_mipmaps, generate_mipmaps
from refdof.raster.gpu.gpu_model import EXACT
from refdof.raster.gpu.texture import trilinear
from tests.raster.filters import naive_mip_chain as naive

pytestmark = pytest.mark.fast

# Reads like EXACT, but is not equal to it: takes the way of general reads.
SLOW = dataclasses.replace(EXACT, subpixel_bits=8)


def awkward(shape, channels, seed=51):
    """Values with infinities, both zeros, denormals and differences that do not fit."""
    random = np.random.default_rng(seed)
    image = random.normal(size=(*shape, channels)).astype(np.float32)
    kind = random.integers(0, 40, image.shape)
    for k, value in enumerate((np.inf, -np.inf, 0.0, -0.0, 3e38, -3e38, 1e-40, np.nan)):
        image[kind == k] = value
    return image


def same_bits(a, b):
    return np.array_equal(np.isnan(a), np.isnan(b)) and np.array_equal(
        np.where(np.isnan(a), 0, a).view(np.uint32), np.where(np.isnan(b), 0, b).view(np.uint32)
    )


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("shape", [(8, 16), (2, 6), (1, 8), (40, 4), (4, 516)])  # the last is wider than two tiles
@pytest.mark.parametrize("chain", [generate_mipmaps, gaussian_mipmaps])
def test_fast_halvings_have_the_bits_of_general_reads(chain, shape, channels):
    # Coordinates of even sizes are exact in float32 as well.
    image = awkward(shape, channels)
    with np.errstate(invalid="ignore", over="ignore"):
        fast, slow = chain(image), chain(image, SLOW)
    assert all(same_bits(a, b) for a, b in zip(fast, slow, strict=True))


def test_drawn_levels_miss_the_centres_by_their_plane():
    # Three texels of six: u = 1 - 2.5 / 3 at the first, where the product is 2^-22 / 6 too large after rounding.
    ramp = np.tile(np.array([0, 1], dtype=np.float32), 3)[None, :, None]
    drawn, centred = (
        generate_mipmaps(ramp, dataclasses.replace(EXACT, drawn_mipmaps=drawn))[1][0, :, 0] for drawn in (True, False)
    )
    np.testing.assert_array_equal(centred, 0.5)
    np.testing.assert_array_equal(drawn, [0.5 - 2.0**-22, 0.5 - 2.0**-22, 0.5])


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("shape", [(8, 16), (7, 5), (1, 6)])
def test_box_is_the_mean_of_slices(shape, channels):
    image = awkward(shape, channels)
    with np.errstate(invalid="ignore", over="ignore"):
        fine, coarse = box_mipmaps(image)[:2]
        height, width = coarse.shape[:2]
        down, right = min(shape[0] - 1, 1), min(shape[1] - 1, 1)
        a, b, c, d = (fine[y::2, x::2][:height, :width] for y in (0, down) for x in (0, right))
        assert same_bits(coarse, ((a + b) + (c + d)) / np.float32(4))


def test_gaussian_level_is_a_separable_filter():
    # Nine bilinear reads midway between texels: (side, 1 + side, 1 + side, side) / 2 (1 + 2 side) per axis.
    image = np.random.default_rng(52).random((16, 24, 3))
    side = np.exp(-0.5)
    taps = np.array([side, 1 + side, 1 + side, side]) / (2 + 4 * side)
    wanted = image
    for axis in (0, 1):  # scipy centres four taps on the third; ours lie one texel up and two down of an even one
        wanted = ndimage.correlate1d(wanted, taps, axis, mode="nearest", origin=-1)
    # Values below 1, some twenty roundings.
    assert np.abs(gaussian_mipmaps(image)[1] - wanted[::2, ::2]).max() <= 4e-15


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 1), (6, 10), (13, 8)])
def test_extremes_are_those_of_the_pixels_below(shape, dtype):
    random = np.random.default_rng(53)
    depth = random.uniform(1.0, 9.0, shape).astype(dtype)
    depth[random.random(shape) < 0.4] = np.inf
    lowest, highest = extreme_mipmaps(depth)
    assert len(lowest) == max(shape).bit_length()
    for level, (least, greatest) in enumerate(zip(lowest, highest, strict=True)):
        assert least.dtype == dtype
        for y, x in np.ndindex(least.shape):
            assert (least[y, x], greatest[y, x]) == naive.extremes(depth, x, y, level)


def test_nothing_has_no_extremes():
    lowest, highest = extreme_mipmaps(np.full((4, 6), np.inf))
    assert all((level == np.inf).all() for level in lowest)
    assert all((level == -np.inf).all() for level in highest)


@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float32, 1e-6), (np.float64, 2e-15)])
def test_coverage_and_mean_colour(dtype, tolerance):
    random = np.random.default_rng(54)
    color, covered = random.random((8, 16, 3)).astype(dtype), random.random((8, 16)) < 0.4
    covered[:4, :4] = False
    color[~covered] = np.nan
    for level, texels in enumerate(coverage_mipmaps(color, covered)):
        mean = average_color(texels)
        for y, x in np.ndindex(texels.shape[:2]):
            part, wanted = naive.covered_mean(color, covered, x, y, level)
            assert texels[y, x, 3] == part  # halves of halves are exact
            # Values below 1; two roundings a level and one division, over a coverage that may be 1 / 64 of the sum.
            assert np.abs(mean[y, x] - wanted).max() <= tolerance


def test_one_colour_stays_itself_at_every_level():
    covered = np.random.default_rng(55).random((16, 16)) < 0.3
    levels = coverage_mipmaps(np.full((16, 16, 1), 0.7), covered)
    u, v = np.random.default_rng(56).random((2, 50))
    read = trilinear(levels, u, v, 5 * u)
    assert np.allclose(average_color(read)[read[:, 1] > 0], 0.7, rtol=1e-14)  # a few roundings of both channels


def test_halvings_are_the_same_on_one_thread():
    image, before = np.random.default_rng(57).random((64, 70, 3)), thread_count()

    def run():
        return [level for chain in (generate_mipmaps, box_mipmaps, gaussian_mipmaps) for level in chain(image)]

    try:
        use_threads(1)
        alone = run()
    finally:
        use_threads(before)
    assert all(np.array_equal(a, b) for a, b in zip(run(), alone, strict=True))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: extreme_mipmaps(np.ones((0, 3))), r"depth: got shape \(0, 3\)"),
        (lambda: extreme_mipmaps([[np.nan]]), "depth: has 1 NaN"),
        (lambda: coverage_mipmaps(np.ones((2, 2, 3)), np.ones((2, 2))), "covered: got float64"),
        (lambda: coverage_mipmaps(np.ones((2, 3, 3)), np.ones((2, 2), dtype=bool)), "color: got shape"),
        (lambda: coverage_mipmaps(np.ones((2, 2, 3), dtype=int), np.ones((2, 2), dtype=bool)), "color: got int64"),
        (lambda: average_color(np.ones((2, 1))), "texels: got shape"),
        (lambda: average_color([0.5, np.inf]), "texels: has 1 infinite"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(InputError, match=message):
        call()
