"""Flicker of stacks whose second differences are known, and of noise."""

import math

import numpy as np
import pytest

from refdof import InputError
from refdof.metrics.artefacts import flicker

pytestmark = pytest.mark.fast


def test_even_changes_do_not_flicker():
    still = np.random.default_rng(0).random((4, 5, 3))
    slope = np.arange(6.0)[:, None, None, None] * 0.25  # exact in float64, to the rounding of the sum
    assert flicker(still + slope) < 1e-15


def test_a_curve_and_a_jump():
    time = np.arange(8.0)[:, None, None, None]
    assert flicker(0.5 * 0.01 * time**2 + np.zeros((8, 3, 4, 3))) == pytest.approx(0.01, rel=1e-12)
    frames = np.zeros((8, 3, 4, 3))
    frames[4:, 1, 2, 0] = 0.6
    # 0.6 twice, in one of 36 values and two of six times.
    assert flicker(frames) == pytest.approx(2 * 0.6 / (6 * 36), rel=1e-12)
    region = np.zeros((3, 4), dtype=bool)
    region[1, 2] = True
    assert flicker(frames, region) == pytest.approx(2 * 0.6 / (6 * 3), rel=1e-12)
    assert flicker(frames, ~region) == 0.0
    assert math.isnan(flicker(frames, region & ~region))


def test_flicker_by_loops():
    frames = np.random.default_rng(1).random((5, 2, 3, 3))
    total, count = 0.0, 0
    for t in range(1, 4):
        for y, x, c in np.ndindex(2, 3, 3):
            total += abs(frames[t - 1, y, x, c] - 2 * frames[t, y, x, c] + frames[t + 1, y, x, c])
            count += 1
    assert flicker(frames) == pytest.approx(total / count, rel=1e-12)


@pytest.mark.parametrize("true", [0.0, 0.01, 0.1, 0.5])
def test_noise_does_not_count_with_a_second_sequence(true):
    random, noise, size = np.random.default_rng(2), 0.04, (3, 200, 200, 3)
    truth = np.zeros(size)
    truth[1] = true / 2.0  # a second difference of -true
    first, second = truth + random.normal(0.0, noise, (2, *size))
    spread = math.sqrt(6.0) * noise  # of 1, -2, 1 times independent values
    count = 120000
    # Alone, noise of no motion has the mean of a half-normal value.
    if true == 0.0:
        expected = spread * math.sqrt(2.0 / math.pi)
        assert flicker(first) == pytest.approx(expected, abs=4 * spread * math.sqrt(1 - 2 / math.pi) / math.sqrt(count))
    expected = true * math.erf(true / (spread * math.sqrt(2.0)))
    found = flicker(first, None, second)
    # Each term's variance is at most true^2 + spread^2.
    assert found == pytest.approx(expected, abs=4 * math.hypot(true, spread) / math.sqrt(count))
    assert found <= true + 4 * spread / math.sqrt(count)
    assert flicker(second, None, first) == pytest.approx(found, abs=1e-15)


def test_a_second_sequence_without_noise_changes_nothing():
    frames = np.random.default_rng(3).random((5, 4, 3, 3))
    assert flicker(frames, None, frames) == pytest.approx(flicker(frames), rel=1e-12)


def test_bad_stacks_are_named():
    frames = np.zeros((4, 2, 3, 3))
    for call, message in (
        (lambda: flicker(frames[:2]), "frames: got 2; allowed are at least 3"),
        (lambda: flicker(frames[0]), "frames: got shape"),
        (lambda: flicker(frames, np.ones((3, 2))), "region: got shape"),
        (lambda: flicker(frames, None, frames[:3]), "second: got shape"),
    ):
        with pytest.raises(InputError, match=message):
            call()
