"""Error bars of single pixels by hand, and which pixels go on, against the sentence that says it."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof.truth.error_bar import Estimate, _score_interval, excess, summarise, unfinished

pytestmark = pytest.mark.fast

ESTIMATES = np.array([1.0, 2.0, 3.0, 6.0])
ERROR = math.sqrt(14 / 3 / 4)  # mean 3; deviations -2, -1, 0, 3; their squares' sum over 4 - 1, of a mean of 4
STUDENT = 3.182446  # any printed table: 3 degrees of freedom, 97.5 %
NORMAL = 1.959964  # the same quantile of the normal distribution, which is Wilson's


def sums_of(shape, noisy, channel=slice(None), spent=2):
    """Sums (4, N, 3) over `spent` points: every pixel shows 1 but `noisy` (y, x), whose channels are the ESTIMATES."""
    estimates = np.ones((4, *shape, 3))
    estimates[:, noisy[0], noisy[1], channel] = ESTIMATES[(...,) + (None,) * (channel == slice(None))]
    grid = np.arange(shape[0] * shape[1]).reshape(shape)
    return estimates.reshape(4, -1, 3) * spent, np.full(grid.size, spent), grid


def test_mean_and_standard_error_by_hand():
    found = summarise(*sums_of((1, 1), (0, 0)))
    assert_allclose(found.mean, [[3.0] * 3], rtol=1e-15)
    assert_allclose(found.error, [[ERROR] * 3], rtol=1e-15)
    # Student's end below. Above, a share of 2 / 5 between the extremes 1 and 6 with an error of ERROR / 5.
    assert_allclose(found.low, [[3.0 - STUDENT * ERROR] * 3], rtol=1e-6)
    trials = 0.4 * 0.6 / (ERROR / 5) ** 2
    pull = NORMAL**2 / trials
    middle = (0.4 + pull / 2) / (1 + pull)
    half = NORMAL / (1 + pull) * math.sqrt(0.4 * 0.6 / trials + NORMAL**2 / (4 * trials**2))
    assert_allclose(found.high, [[max(3.0 + STUDENT * ERROR, 1.0 + 5.0 * (middle + half))] * 3], rtol=1e-6)


@pytest.mark.parametrize("channel", [0, 1, 2])
def test_a_pixel_is_noisy_if_one_channel_is(channel):
    found = summarise(*sums_of((1, 2), (0, 0), channel))
    wanted = np.zeros((2, 3))
    wanted[0, channel] = ERROR
    wanted[1, channel] = (3.0 - 1.0) / (4 * 2)  # its neighbour may have missed what one of 8 samples would have seen
    assert_allclose(found.error, wanted, rtol=1e-15)


@pytest.mark.parametrize("dy", range(-3, 4))
@pytest.mark.parametrize("dx", range(-3, 4))
def test_what_a_pixel_may_have_missed(dx, dy):
    found = summarise(*sums_of((7, 7), (3 + dy, 3 + dx)))
    centre, distance = 3 * 7 + 3, max(abs(dx), abs(dy))
    if distance == 0:
        return
    # One sample of 4 x 2 next to it, nothing farther off; Wilson's share of no hit in 4, as far as two pixels.
    assert_allclose(found.error[centre], 0.25 if distance == 1 else 0.0, rtol=1e-15)
    share = NORMAL**2 / (4 + NORMAL**2) if distance <= 2 else 0.0
    assert_allclose(found.high[centre], 1.0 + share * (6.0 - 1.0), rtol=1e-6)
    assert_allclose(found.low[centre], 1.0, rtol=1e-15)


def todo(mean, error, spent, tolerance=0.1, most=64):
    grid = np.arange(spent.size).reshape(spent.shape)
    found = unfinished(mean.reshape(-1, 3), error.reshape(-1, 3), spent.ravel(), grid, tolerance, most)
    return found.reshape(spent.shape)


@pytest.mark.parametrize(
    ("mean", "error", "above"),
    [
        ((0.5, 0.2, 0.1), 0.11, True),
        ((0.5, 0.2, 0.1), 0.09, False),  # 0.1 for all that is not brighter than white
        ((0.5, 4.0, 0.1), 0.41, True),
        ((0.5, 4.0, 0.1), 0.39, False),  # a tenth of the brightest channel
        ((0.5, 0.2, -4.0), 0.39, False),
    ],
)
def test_the_tolerance_by_hand(mean, error, above):
    for channel in range(3):
        errors = np.zeros((1, 1, 3))
        errors[..., channel] = error
        assert todo(np.array([[mean]]), errors, np.full((1, 1), 8)).item() is above


@pytest.mark.parametrize(("spent", "goes_on"), [(63, True), (64, False), (128, False)])
def test_a_pixel_with_most_samples_is_done_however_large_its_error(spent, goes_on):
    assert todo(np.zeros((1, 1, 3)), np.ones((1, 1, 3)), np.full((1, 1), spent)).item() is goes_on


@pytest.mark.parametrize("seed", range(8))
def test_unfinished_pixels_in_words(seed):
    random = np.random.default_rng(seed)
    shape = (7, 9)
    above = random.random(shape) < 0.06
    spent = 8 * 2 ** random.integers(0, 4, shape)  # 64 at most: those are never to be done
    found = todo(np.zeros((*shape, 3)), np.where(above, 0.2, 0.05)[..., None] * np.ones(3), spent)
    # Within two pixels of one above the tolerance.
    y, x = np.nonzero(above)
    rows, columns = np.indices(shape)
    far = np.maximum(abs(rows[..., None] - y), abs(columns[..., None] - x))
    wanted = (far <= 2).any(axis=-1) & (spent < 64)
    wanted &= spent == spent[wanted].min(initial=64)  # the least sampled of them
    assert_array_equal(found, wanted)
    assert found.any()


@pytest.mark.parametrize("share", [0.01, 0.3, 0.9])
@pytest.mark.parametrize("spread", [0.004, 0.05])
def test_the_score_interval_solves_wilsons_equation(share, spread):
    """Its ends are the shares p with |p - share| = z sqrt(p (1 - p) / n): a quadratic equation, solved by NumPy.

    Light is 2 + 4 share, so that the coin's sides are 2 and 6; Student's interval is made narrower.
    """
    z, trials = 1.959964, share * (1.0 - share) / spread**2
    ends = np.sort(np.roots([1.0 + z * z / trials, -2.0 * share - z * z / trials, share * share]).real)
    found = _score_interval(2.0 + 4.0 * share, 4.0 * spread, 2.0, 6.0, 0.1)
    assert_allclose(found, 2.0 + 4.0 * ends, rtol=1e-6)  # z has seven digits


def test_excess_is_relative_to_the_brightest_channel_of_either_sign():
    error, mean = np.array([[0.1, 0.4, 0.2]] * 3), np.array([[0.1, 0.5, 0.2], [0.0, 4.0, 1.0], [-8.0, 1.0, 2.0]])
    assert_allclose(excess(Estimate(mean, error, mean, mean), 0.01), [40.0, 10.0, 5.0], rtol=1e-14)
