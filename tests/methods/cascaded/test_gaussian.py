"""Gaussian, box and pyramid blurs against scipy's filters and against the variance that is asked for."""

import math

import numpy as np
import pytest
from scipy import ndimage

from refdof._jit import thread_count, use_threads
from refdof.methods.cascaded.fast_blurs import box_blur, box_of, pyramid_blur, pyramid_of
from refdof.methods.cascaded.gaussian import gaussian_blur, gaussian_taps

pytestmark = pytest.mark.fast

TYPES = (np.float32, np.float64)
BLURS = (gaussian_blur, box_blur, pyramid_blur)


def blurred(blur, planes, deviation, clamp=False):
    out = planes.copy()
    blur(out, deviation, np.empty_like(out), clamp)
    return out


def random_planes(shape, dtype=np.float64, seed=0):
    return np.random.default_rng(seed).random(shape).astype(dtype)


def second_moments(plane, x0, y0):
    y, x = np.indices(plane.shape)
    return (plane * (x - x0) ** 2).sum(), (plane * (y - y0) ** 2).sum()


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("deviation", [0.4, 1.0, 1.7, 2.4, 4.0])
@pytest.mark.parametrize("shape", [(1, 1, 1), (2, 1, 9), (1, 8, 1), (4, 11, 13)])
@pytest.mark.parametrize(("clamp", "mode"), [(False, "constant"), (True, "nearest")])
def test_gaussian_is_scipys(shape, deviation, dtype, clamp, mode):
    planes = random_planes(shape, dtype)
    reach = math.ceil(3.0 * deviation)  # up to 12: beyond the whole picture
    expected = [ndimage.gaussian_filter(p.astype(float), deviation, mode=mode, radius=reach) for p in planes]
    # Sums of positive terms that are below 1 in all: one rounding per tap and axis.
    room = 2 * (2 * reach + 3) * np.finfo(dtype).eps / 2
    np.testing.assert_allclose(blurred(gaussian_blur, planes, deviation, clamp), expected, rtol=0, atol=room)


@pytest.mark.parametrize("deviation", [0.5, 1.0, 2.236, 7.0])
def test_taps_sum_to_one_and_end_at_three_deviations(deviation):
    taps = gaussian_taps(deviation)
    assert len(taps) == math.ceil(3.0 * deviation) + 1
    assert taps[0] + 2.0 * taps[1:].sum() == pytest.approx(1.0, abs=1e-15)  # roundings
    assert taps[1] / taps[0] == pytest.approx(math.exp(-0.5 / deviation**2), rel=1e-14)


@pytest.mark.parametrize("blur", BLURS)
def test_no_deviation_changes_nothing(blur):
    planes = random_planes((2, 3, 4), np.float32)
    assert np.array_equal(blurred(blur, planes, 0.0), planes)


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("blur", [gaussian_blur, box_blur])
def test_a_mirrored_image_gives_the_mirrored_blur(blur, dtype, clamp):
    planes = random_planes((4, 4, 15), dtype)
    out, mirrored = blurred(blur, planes, 2.0, clamp), blurred(blur, planes[:, ::-1, ::-1].copy(), 2.0, clamp)
    if blur is gaussian_blur:
        assert np.array_equal(mirrored, out[:, ::-1, ::-1])
    else:  # running sums start at the other end: up to 30 roundings along a line of 15, then those of the type
        np.testing.assert_allclose(mirrored, out[:, ::-1, ::-1], rtol=30 * 2.0**-53 + 2 * np.finfo(dtype).eps)


@pytest.mark.parametrize("blur", BLURS)
def test_threads_change_no_bit(blur):
    planes, before = random_planes((4, 9, 17), np.float32), thread_count()
    try:
        use_threads(1)
        alone = [blurred(blur, planes, 3.0, clamp) for clamp in (False, True)]
    finally:
        use_threads(before)
    assert np.array_equal([blurred(blur, planes, 3.0, clamp) for clamp in (False, True)], alone)


@pytest.mark.parametrize("deviation", [0.6, 1.0, 1.4142135623730951, 2.5, 3.0])
def test_a_box_has_the_variance_asked_for(deviation):
    m, rim = box_of(deviation)
    assert 0.0 <= rim < 1.0
    offsets = np.arange(1, m + 1)
    variance = 2.0 * ((offsets**2).sum() + rim * (m + 1) ** 2) / (2 * m + 1 + 2.0 * rim)
    assert variance == pytest.approx(deviation**2, rel=1e-14)
    light = np.zeros((1, 23, 25))
    light[0, 11, 12] = 1.0
    spread = blurred(box_blur, light, deviation)[0]
    assert spread.sum() == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(second_moments(spread, 12, 11), deviation**2, rtol=1e-13)


@pytest.mark.parametrize(("clamp", "mode"), [(False, "constant"), (True, "nearest")])
@pytest.mark.parametrize("m", [1, 2, 4, 9])
@pytest.mark.parametrize("shape", [(2, 12, 14), (1, 1, 9), (1, 8, 1), (1, 3, 5)])
def test_a_whole_box_is_scipys_uniform_filter(shape, m, clamp, mode):
    planes = random_planes(shape)
    deviation = math.sqrt(m * (m + 1) / 3.0)
    expected = [ndimage.uniform_filter(p, 2 * m + 1, mode=mode) for p in planes]
    # The deviation's rounding leaves the rim at most 1e-14.
    np.testing.assert_allclose(blurred(box_blur, planes, deviation, clamp), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("deviation", [1.3, 2.5, 5.0])
@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 1, 9), (1, 8, 1), (2, 10, 13)])
@pytest.mark.parametrize("blur", BLURS)
def test_a_clamped_border_is_a_picture_that_goes_on(blur, shape, deviation):
    planes, margin = random_planes(shape), 24  # three deviations and a block; whole blocks of 2, 4 and 8
    larger = blurred(blur, np.pad(planes, ((0, 0), (margin, margin), (margin, margin)), mode="edge"), deviation)
    inside = larger[:, margin : margin + shape[1], margin : margin + shape[2]]
    # Numbers up to 1 in sums of up to 60 terms along each axis.
    np.testing.assert_allclose(blurred(blur, planes, deviation, clamp=True), inside, rtol=0, atol=120 * 2.0**-53)


def test_a_pyramid_is_a_gaussian_while_small():
    planes = random_planes((2, 9, 10), np.float32)
    assert pyramid_of(1.8)[0] == 1
    assert np.array_equal(blurred(pyramid_blur, planes, 1.8), blurred(gaussian_blur, planes, 1.8))


@pytest.mark.parametrize(("deviation", "side"), [(2.0, 2), (4.0, 4), (5.0, 4)])
def test_a_pyramid_has_the_variance_asked_for_on_average(deviation, side):
    assert pyramid_of(deviation)[0] == side
    size, variance, total = 48, [], []
    for shift in range(side):  # over all places in a block
        light = np.zeros((1, size, size))
        light[0, 24 + shift, 24 + shift] = 1.0
        spread = blurred(pyramid_blur, light, deviation)[0]
        total.append(spread.sum())
        variance.append(second_moments(spread, 24 + shift, 24 + shift))
    np.testing.assert_allclose(total, 1.0, rtol=1e-12)
    # The coarse Gaussian is cut at 3 deviations, as all are: that takes 0.6 to 2.7 % of its variance.
    np.testing.assert_allclose(np.mean(variance, axis=0), deviation**2, rtol=0.03)


@pytest.mark.parametrize("blur", BLURS)
def test_an_even_image_stays_even(blur):
    planes = np.full((1, 41, 43), 0.75)
    assert blurred(blur, planes, 2.5)[0, 20, 21] == pytest.approx(0.75, rel=1e-14)
    np.testing.assert_allclose(blurred(blur, planes, 2.5, clamp=True), 0.75, rtol=1e-14)


def test_a_box_takes_what_lies_outside_for_nothing():
    # Standard deviation 1: three taps of weight 1 and a rim of 1/6, (2 + 2 * 4 / 6) / (3 + 2 / 6) = 1. Light in the
    # last row and column is spread over three rows and columns, and does not come in again at the other end.
    planes = np.zeros((1, 8, 9))
    planes[0, 7, 8] = 1.0
    box_blur(planes, 1.0, np.empty_like(planes))
    spread = np.array([0.05, 0.3, 0.3])
    wanted = np.zeros((8, 9))
    wanted[5:, 6:] = spread[:, None] * spread
    np.testing.assert_allclose(planes[0], wanted, atol=1e-15)
    mirrored = np.zeros((1, 8, 9))
    mirrored[0, 0, 0] = 1.0
    box_blur(mirrored, 1.0, np.empty_like(planes))
    np.testing.assert_allclose(mirrored[0], wanted[::-1, ::-1], atol=1e-15)


def test_a_coarse_gaussian_of_the_least_deviation_is_wide_enough():
    # Deviation d with (d / 2)^2 - 1/4 = 0.8^2 to the last bit, and the number below it.
    deviation = float.fromhex("0x1.e30513d6a7203p+0")
    assert (deviation / 2.0) ** 2 - 0.25 == 0.8**2
    assert pyramid_of(deviation) == (2, math.sqrt(0.8**2))
    assert pyramid_of(math.nextafter(deviation, 0.0)) == (1, math.nextafter(deviation, 0.0))
    assert pyramid_of(4.0 * deviation) == (8, math.sqrt(0.8**2))
