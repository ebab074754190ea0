"""Matting against the printed equations: trapezoids, their sums, and what happens at the ends."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof import InputError
from refdof.methods.cascaded.matting import ABSENT, RAMPS, layer_coordinate, matte, ramp_code

pytestmark = pytest.mark.fast

BOUNDS = np.array([1.0, 2.0, 4.0, 5.0, 9.0])  # z_(-1) .. z_3, four layers


def weights(depth, bounds=BOUNDS, boundary="extrapolate", ramp="corrected", first=True):
    """Weights (K,) of one depth."""
    coordinate = layer_coordinate(np.array([depth]), bounds, boundary, np.float64)[0]
    return [matte(coordinate - k, 1.0, ramp_code(ramp), first) for k in range(len(bounds) - 1)]


@pytest.mark.parametrize(
    ("depth", "expected"),
    [
        (1.5, [1, 0.5, 0, 0]),
        (2.0, [1, 1, 0, 0]),  # z_0: both cores are closed
        (2.5, [0.75, 1, 0.25, 0]),  # falling (4 - 2.5) / 2, rising (2.5 - 2) / 2
        (4.25, [0, 0.75, 1, 0.25]),
        (8.0, [0, 0, 0.25, 1]),
        (0.3, [1, 0, 0, 0]),  # before z_(-1)
        (9.0, [0, 0, 0, 1]),
        (math.inf, [0, 0, 0, 1]),
    ],
)
def test_trapezoids_by_hand(depth, expected):
    assert weights(depth) == expected


def test_further_buffers_end_hard():
    # Eq. (3): no falling ramp, and 1 at the border itself.
    assert weights(2.5, first=False) == [0, 1, 0.25, 0]
    assert weights(2.0, first=False) == [1, 1, 0, 0]


def test_the_printed_ramp_runs_the_wrong_way():
    # Eq. (4) as printed: (z_k - z) / (z_k - z_(k+1)), nearly 0 after z_0 = 2 and nearly 1 before z_1 = 4.
    for z in (2.001, 2.5, 3.999):
        assert weights(z, ramp="as_printed")[0] == pytest.approx((2.0 - z) / (2.0 - 4.0), abs=1e-12)
    assert weights(2.001, ramp="corrected")[0] > 0.999


def test_without_a_ramp_only_cores_are_left():
    assert weights(2.5, ramp="none") == [0, 1, 0, 0]


def test_a_ramp_to_infinity_is_linear_in_inverse_depth():
    found = weights(10.0, bounds=np.array([1.0, 2.0, 4.0, math.inf]))
    # 1/z runs from 1/4 to 0; 1/10 is 0.6 of the way.
    np.testing.assert_allclose(found, [0, 0.4, 1], rtol=1e-14)


def test_hard_ends_have_no_ramps():
    assert weights(1.5, boundary="hard") == [1, 0, 0, 0]
    assert weights(8.0, boundary="hard") == [0, 0, 0, 1]
    assert weights(2.5, boundary="hard") == [0.75, 1, 0.25, 0]


def test_one_layer_takes_everything():
    for boundary in ("extrapolate", "hard"):
        for depth in (0.5, 2.0, math.inf):
            assert weights(depth, np.array([1.0, math.inf]), boundary) == [1.0]


def test_equal_anchors_make_a_step():
    bounds = np.array([1.0, 2.0, 2.0, 3.0])
    assert weights(2.0, bounds)[:2] == [1, 1]
    np.testing.assert_allclose(weights(2.5, bounds), [0, 0.5, 1], rtol=1e-15)
    assert layer_coordinate(np.array([5.0]), np.array([1.0, 1.0, 1.0]))[0] == 2.0  # beyond: on the last anchor


def test_no_surface_has_no_weight():
    coordinate = layer_coordinate(np.array([np.nan]), BOUNDS)
    assert coordinate[0] == ABSENT
    assert not any(matte(ABSENT - k, 1.0, 0, True) for k in range(4))


@given(st.floats(2.0001, 4.9999), st.lists(st.floats(1.05, 3.0), min_size=4, max_size=9))
def test_weights_sum_to_two_between_the_ends(depth, ratios):
    bounds = np.concatenate([[0.5], 0.5 * np.cumprod([2.0, *ratios])])
    found = np.array(weights(depth * bounds[1] / 2.0, bounds))
    inside = bounds[1] < depth * bounds[1] / 2.0 < bounds[-2]
    # One core, and two ramps t and 1 - t; a depth that meets an anchor has two cores.
    assert found.sum() == pytest.approx(2.0 if inside else found.sum(), abs=1e-12)
    assert found.max() == 1.0


@given(st.floats(0.01, 100.0), st.sampled_from(RAMPS), st.sampled_from(["extrapolate", "hard"]))
def test_every_depth_is_whole_in_some_layer(depth, ramp, boundary):
    found = weights(depth, boundary=boundary, ramp=ramp)
    assert max(found) == 1.0
    assert min(found) >= 0.0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: layer_coordinate(np.ones(3), np.array([1.0])), "bounds: got"),
        (lambda: layer_coordinate(np.ones(3), np.array([2.0, 1.0])), "bounds: got"),
        (lambda: layer_coordinate(np.ones(3), np.array([1.0, math.inf, math.inf])), "bounds: got"),
        (lambda: layer_coordinate(np.zeros(3), BOUNDS), "depth: smallest value is 0"),
        (lambda: layer_coordinate(np.ones(3), BOUNDS, "soft"), "boundary: got 'soft'"),
        (lambda: ramp_code("rising"), "ramp: got 'rising'"),
    ],
)
def test_bad_arguments_are_named(call, words):
    with pytest.raises(InputError, match=words):
        call()
