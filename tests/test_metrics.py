"""Metrics against numbers worked out by hand, other libraries and slow definitions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage.color import rgb2lab
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio

from refdof import metrics
from refdof._check import InputError
from refdof.display import display, linear_from_display, to_8_bit


def constant(value, size=(12, 13)):
    return np.full((*size, 3), value, dtype=np.float32)


@pytest.fixture
def pair():
    random = np.random.default_rng(5)
    reference = random.uniform(0.0, 1.3, (19, 23, 3)).astype(np.float32)  # some values are clipped
    return reference, (reference + random.normal(0.0, 0.1, reference.shape)).astype(np.float32)


def test_pointwise_errors_of_three_values():
    reference = np.array([[[0.0, 1.0, 2.0]]])
    image = np.array([[[0.1, 1.0, 1.5]]])
    # d = (0.1, 0, -0.5): mean of squares (0.01 + 0.25) / 3; relative: 0.01 / 0.01 and 0.25 / 4.01.
    # Tolerance: a few roundings of float64.
    assert metrics.rmse(reference, image) == pytest.approx(math.sqrt(0.26 / 3.0), rel=1e-14)
    assert metrics.rel_mse(reference, image) == pytest.approx((1.0 + 0.25 / 4.01) / 3.0, rel=1e-14)
    assert metrics.max_abs(reference, image) == pytest.approx(0.5, rel=1e-14)


def test_rel_mse_counts_light_that_leaks_into_black():
    reference, image = np.zeros((12, 12, 3)), np.zeros((12, 12, 3))
    image[3, 4] = 0.2
    # 3 of 432 values, each 0.04 / 0.01. Tolerance: rounding of a sum of 432 values.
    assert metrics.rel_mse(reference, image) == pytest.approx(3 * 4.0 / 432.0, rel=1e-12)


def test_psnr_by_hand():
    # Linear 0 and 0.0031308 / 2 lie on the straight piece of sRGB: display 0 and 12.92 * 0.0015654 =
    # 0.020224968. Tolerance: the display image is float32 (6e-8 relative), twice that in the square, 4.3 dB
    # per e-fold.
    expected = -20.0 * math.log10(12.92 * 0.0015654)
    assert metrics.psnr(constant(0.0), constant(0.0015654)) == pytest.approx(expected, abs=1e-5)
    # In 8 bits: 0.020224968 * 255 = 5.157 becomes 5. Exact up to rounding of float64.
    assert metrics.psnr_8bit(constant(0.0), constant(0.0015654)) == pytest.approx(20 * math.log10(255 / 5), rel=1e-14)


def test_psnr_and_rmse_agree_with_scikit_image(pair):
    reference, image = pair
    shown = display(reference).astype(np.float64), display(image).astype(np.float64)
    # Same formula in float64: only the order of the sums differs.
    assert metrics.psnr(*pair) == pytest.approx(peak_signal_noise_ratio(*shown, data_range=1.0), rel=1e-12)
    exact = reference.astype(np.float64), image.astype(np.float64)
    assert metrics.rmse(*pair) == pytest.approx(math.sqrt(mean_squared_error(*exact)), rel=1e-12)
    expected = peak_signal_noise_ratio(to_8_bit(reference), to_8_bit(image), data_range=255)
    assert metrics.psnr_8bit(*pair) == pytest.approx(expected, rel=1e-12)


def naive_ssim(first, second):
    """Wang et al. (2004), Eqs. (13) to (17), one window after the other, on every channel."""
    offset = np.arange(-5, 6)
    weight = np.exp(-(offset[:, None] ** 2 + offset[None, :] ** 2) / (2 * 1.5**2))
    weight /= weight.sum()
    c1, c2 = 0.01**2, 0.03**2
    values = []
    for channel in range(3):
        for y in range(5, first.shape[0] - 5):
            for x in range(5, first.shape[1] - 5):
                a = first[y - 5 : y + 6, x - 5 : x + 6, channel]
                b = second[y - 5 : y + 6, x - 5 : x + 6, channel]
                mean_a, mean_b = (weight * a).sum(), (weight * b).sum()
                var_a, var_b = (weight * (a - mean_a) ** 2).sum(), (weight * (b - mean_b) ** 2).sum()
                cov = (weight * (a - mean_a) * (b - mean_b)).sum()
                luminance = (2 * mean_a * mean_b + c1) / (mean_a**2 + mean_b**2 + c1)
                values.append(luminance * (2 * cov + c2) / (var_a + var_b + c2))
    return np.mean(values)


def test_ssim_agrees_with_its_definition(pair):
    expected = naive_ssim(*(display(image).astype(np.float64) for image in pair))
    # E[x^2] - E[x]^2 against E[(x - E[x])^2] in float64: cancellation of values near 1, far below 1e-10.
    assert metrics.ssim(*pair) == pytest.approx(expected, abs=1e-10)


def test_ssim_of_two_constants_is_its_luminance_term():
    a, b = (display(constant(value)).astype(np.float64)[0, 0, 0] for value in (0.2, 0.6))
    expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4)
    # Variances that should be 0 are of the size of float64 roundings, 1e-16 against C2 = 9e-4.
    assert metrics.ssim(constant(0.2), constant(0.6)) == pytest.approx(expected, abs=1e-12)


def flip_of_constants(first, second):
    """Andersson et al. (2020), Section 4: without structure only the colour pipeline is left.

    Constant images pass the contrast filters unchanged and have no features, so the error is the
    redistributed HyAB distance of Hunt-adjusted L*a*b*.
    """

    def hunt_lab(color):
        lightness, a, b = rgb2lab(np.reshape(np.asarray(color, dtype=np.float64), (1, 1, 3)))[0, 0]
        return np.array([lightness, 0.01 * lightness * a, 0.01 * lightness * b])

    def distance(one, other):
        d = hunt_lab(one) - hunt_lab(other)
        return (abs(d[0]) + math.hypot(d[1], d[2])) ** 0.7

    largest = distance((0, 1, 0), (0, 0, 1))
    value, knee = distance(first, second), 0.4 * largest
    if value < knee:
        return 0.95 / knee * value
    return 0.95 + (value - knee) / (largest - knee) * 0.05


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        ((0.25, 0.25, 0.25), (0.5, 0.5, 0.5)),
        ((0.8, 0.2, 0.1), (0.2, 0.5, 0.9)),
        ((0.31, 0.62, 0.4), (0.33, 0.6, 0.4)),
    ],
)
def test_flip_of_constant_images(first, second):
    images = [linear_from_display(np.broadcast_to(color, (24, 20, 3))) for color in (first, second)]
    # scikit-image rounds the sRGB matrix and the white point to 4 to 6 digits; grey then gets a chroma of
    # up to 0.01, and HyAB values of 1 and more to the power 0.7 spread that to at most 0.002 in FLIP.
    assert metrics.flip(*images) == pytest.approx(flip_of_constants(first, second), abs=2e-3)


def test_flip_of_black_and_white_is_the_known_figure():
    # HyAB is 100, 100^0.7 = 25.119; the largest, green to blue, 41.276: 0.95 + 0.05 * 8.609 / 24.766 =
    # 0.96738. Tolerance: the last digit of those figures.
    assert metrics.flip(constant(0.0), constant(1.0)) == pytest.approx(0.96738, abs=2e-5)


def test_flip_does_not_depend_on_the_order_of_two_ldr_images(pair):
    # Every step of LDR-FLIP is symmetric; float32 sums may differ in the last digits.
    assert metrics.flip(*pair) == pytest.approx(metrics.flip(*reversed(pair)), abs=1e-6)


def test_flip_survives_what_ends_the_interpreter_in_hdr_mode():
    assert metrics.flip(constant(0.0, (1, 1)), constant(0.0, (1, 1))) == 0.0


def test_flip_sees_values_above_one_as_white():
    assert metrics.flip(constant(1.0), constant(50.0)) == 0.0


def test_scores_of_identical_images(pair):
    expected = {
        "psnr": math.inf,
        "psnr_8bit": math.inf,
        "ssim": 1.0,
        "flip": 0.0,
        "rmse": 0.0,
        "rel_mse": 0.0,
        "max_abs": 0.0,
    }
    found = metrics.scores(pair[0], pair[0])
    assert list(found) == list(expected)
    # All but SSIM are exact; SSIM divides two equal numbers and averages the ones.
    assert found == {**expected, "ssim": pytest.approx(1.0, abs=1e-12)}
    assert metrics.psnr_8bit(pair[0], pair[0]) == math.inf


def test_scores_are_the_single_metrics(pair):
    for name, value in metrics.scores(*pair).items():
        assert value == getattr(metrics, name)(*pair)


@pytest.mark.parametrize("name", metrics.METRICS)
def test_the_registry_says_which_way_is_better_and_of_which_values(name, pair):
    reference, image = np.clip(pair[0], 0.1, 0.9), np.clip(pair[1], 0.1, 0.9)
    metric = metrics.METRICS[name]
    near, far = (metric.function(reference, reference + share * (image - reference)) for share in (0.25, 1.0))
    assert (near > far) == (metric.better == "high")
    assert metric.better in ("high", "low")
    # Display values end at white: what is above it does not count there.
    above = metric.function(np.full((16, 16, 3), 2.0), np.full((16, 16, 3), 3.0))
    best = metric.function(reference, reference)
    assert (above == pytest.approx(best)) == (metric.values == "display")


def test_two_independent_references_remove_their_noise():
    random = np.random.default_rng(11)
    shape, bias, sigma = (64, 64, 3), 0.05, 0.05
    truth = random.uniform(0.2, 0.8, shape)
    first, second = (truth + random.normal(0.0, sigma, shape) for _ in range(2))
    image = truth + bias
    # One value of the product (bias - n1)(bias - n2) has the variance 2 bias^2 sigma^2 + sigma^4. Five
    # standard deviations of the mean of 12288: 2e-4, a twelfth of the bias sigma^2 that one reference alone
    # gives.
    tolerance = 5.0 * math.sqrt((2 * bias**2 * sigma**2 + sigma**4) / truth.size)
    assert metrics.rmse(first, image, second) ** 2 == pytest.approx(bias**2, abs=tolerance)
    assert metrics.rmse(first, image) ** 2 - bias**2 > sigma**2 - tolerance - 5.0 * sigma**2 * math.sqrt(2 / truth.size)


def test_two_independent_references_of_rel_mse():
    random = np.random.default_rng(12)
    shape, bias, sigma = (128, 128, 3), 0.05, 0.02
    truth = random.uniform(0.4, 0.8, shape)
    first, second = (truth + random.normal(0.0, sigma, shape) for _ in range(2))
    base = truth**2 + 0.01
    # The documented rest: the denominator's noise is correlated with the numerator's.
    expected = np.mean(bias**2 / base + 2 * truth * bias * sigma**2 / base**2)
    # Five standard deviations of the mean as above, under weights of at most 1 / 0.17; the next terms of the
    # expansion, weight'' / 4 * sigma^2 (bias^2 + sigma^2) with weight'' <= 191, are below 0.6e-4.
    tolerance = 5.0 / 0.17 * math.sqrt((2 * bias**2 * sigma**2 + sigma**4) / truth.size) + 0.6e-4
    assert metrics.rel_mse(first, truth + bias, second) == pytest.approx(expected, abs=tolerance)
    assert metrics.rel_mse(first, truth + bias) > expected + tolerance


def test_product_of_differences_below_zero_counts_as_zero():
    zero = np.zeros((1, 1, 3))
    assert metrics.rmse(zero + 1.0, zero, zero - 1.0) == 0.0


@pytest.mark.parametrize("value", [0.001, 0.2, 0.5, 0.97, 0.99, 1.0, 1.01, 1.02])
def test_noise_floor_agrees_with_simulated_noise(value):
    error = min(0.01, value / 10.0)
    random = np.random.default_rng(3)
    count = 200_000
    truth = constant(value, (1, 1))
    noisy = random.normal(value, error, (count // 100, 100, 3))
    squares = (display(noisy).astype(np.float64) - display(truth).astype(np.float64)) ** 2
    floor = 10.0 ** (-metrics.noise_floor_psnr(truth, constant(error, (1, 1))) / 10.0)
    # Five standard errors of the simulation, and 2 % for the curve's bend across one tenth of the value: its
    # second-order term is (7/12 * 0.1)^2 = 0.3 %, its third-order one about as large.
    assert floor == pytest.approx(squares.mean(), rel=0.02, abs=5.0 * squares.std() / math.sqrt(squares.size))


def test_noise_floor_of_a_reference_without_visible_noise_is_infinite():
    assert metrics.noise_floor_psnr(constant(0.5), constant(0.0)) == math.inf
    assert metrics.noise_floor_psnr(constant(9.0), constant(0.01)) == math.inf  # 800 standard errors above white


def test_an_image_with_only_the_references_noise_scores_the_floor():
    random = np.random.default_rng(8)
    truth = random.uniform(0.1, 0.9, (100, 100, 3))
    error = 0.003 * np.sqrt(truth)
    reference = truth + random.normal(0.0, 1.0, truth.shape) * error
    # Mean of 30000 squares: a relative standard error of sqrt(2 / 30000) = 0.8 %, five of them 0.18 dB; the
    # slopes vary with the noise by far less.
    assert metrics.psnr(reference, truth) == pytest.approx(metrics.noise_floor_psnr(reference, error), abs=0.18)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 10.0))
def test_linear_errors_scale_with_exposure(seed, gain):
    first, second = np.random.default_rng(seed).uniform(0.0, 2.0, (2, 3, 4, 3))
    # One rounding in each product of float64 values.
    assert metrics.rmse(gain * first, gain * second) == pytest.approx(gain * metrics.rmse(first, second), rel=1e-12)
    assert metrics.max_abs(gain * first, gain * second) == pytest.approx(
        gain * metrics.max_abs(first, second), rel=1e-12
    )


def with_value(value):
    image = constant(0.5)
    image[2, 3, 1] = value
    return image


BAD_IMAGES = {
    "NaN": (with_value(np.nan), "image: has 1 NaN"),
    "infinite": (with_value(np.inf), "image: has 1 infinite"),
    "other size": (constant(0.5, (13, 12)), "image: got shape"),
    "four channels": (np.full((12, 13, 4), 0.5), "image: got shape"),
    "grey": (np.full((12, 13), 0.5), "image: got shape"),
    "8 bits": (np.full((12, 13, 3), 128, dtype=np.uint8), "image: got uint8"),
    "words": ("picture", "image: got an array of <U7, shape"),
}
METRICS = ["rmse", "rel_mse", "max_abs", "psnr", "psnr_8bit", "ssim", "flip", "scores"]


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("case", BAD_IMAGES)
def test_bad_images_are_named(metric, case):
    image, message = BAD_IMAGES[case]
    with pytest.raises(InputError, match=message):
        getattr(metrics, metric)(constant(0.5), image)
    if case != "other size":
        with pytest.raises(InputError, match=message.replace("image", "reference")):
            getattr(metrics, metric)(image, constant(0.5))


def test_bad_second_reference_and_standard_error_are_named():
    with pytest.raises(InputError, match="second_reference: got shape"):
        metrics.rmse(constant(0.5), constant(0.5), constant(0.5, (1, 1)))
    with pytest.raises(InputError, match="second_reference: has 1 NaN"):
        metrics.rel_mse(constant(0.5), constant(0.5), with_value(np.nan))
    with pytest.raises(InputError, match="standard_error: got shape"):
        metrics.noise_floor_psnr(constant(0.5), constant(0.0, (1, 1)))
    with pytest.raises(InputError, match="standard_error: smallest value is -1"):
        metrics.noise_floor_psnr(constant(0.5), with_value(-1.0))


def test_ssim_names_the_size_of_its_window():
    with pytest.raises(InputError, match=r"reference: got 40 x 10 pixels.* at least 11 x 11"):
        metrics.ssim(constant(0.5, (10, 40)), constant(0.5, (10, 40)))
    with pytest.raises(InputError, match="at least one pixel"):
        metrics.psnr(np.zeros((0, 4, 3)), np.zeros((0, 4, 3)))


@pytest.mark.parametrize(("value", "bias"), [(0.5, 0.05), (0.5, -0.05), (0.02, 0.3), (0.0, 0.1)])
def test_the_rest_that_two_references_leave_in_rel_mse(value, bias):
    step = 1e-4  # two references of value +- step: the mean over all four pairs is the expectation
    pairs = [(value + a, value + b) for a in (-step, step) for b in (-step, step)]
    image = np.full((1, 1, 3), value + bias)
    mean = np.mean([metrics.rel_mse(np.full((1, 1, 3), a), image, np.full((1, 1, 3), b)) for a, b in pairs])
    base = value**2 + 0.01
    rest = step**2 * (2 * value * bias / base**2 + bias**2 * (1.5 * value**2 - 0.005) / base**3)
    # The next terms have step^4 / base^2 of size and a factor of some hundreds; float64 rounds the mean to 1e-15.
    assert mean - bias**2 / base == pytest.approx(rest, rel=2e-3, abs=1e-14)
