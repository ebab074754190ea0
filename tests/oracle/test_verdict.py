"""Verdicts by numbers worked out by hand: each branch of the tolerance."""

import numpy as np
import pytest

from refdof.oracle.goldens import Tolerance
from refdof.oracle.verdict import excess, judge

pytestmark = pytest.mark.fast

INF, NAN = np.inf, np.nan


def tolerance(max_abs=0.0, max_rel=0.0, hard_factor=1.0, max_failing_fraction=0.0, **more):
    return Tolerance(max_abs, max_rel, hard_factor, max_failing_fraction, "by hand", **more)


@pytest.mark.parametrize(
    ("value", "low", "high", "limits", "ratio"),
    [
        (1.25, 1.0, 1.5, {}, 0.0),
        (1.0, 1.0, 1.0, {}, 0.0),  # exact
        (1.0 + 2**-40, 1.0, 1.0, {}, INF),
        (1.5, 1.0, 1.0, {"max_abs": 0.25}, 2.0),
        (0.5, 1.0, 2.0, {"max_abs": 0.25}, 2.0),
        (2.5, 1.0, 2.0, {"max_rel": 0.125}, 2.0),  # 0.5 over, 0.25 allowed
        (0.5, 1.0, 2.0, {"max_rel": 0.125}, 4.0),  # 0.5 under, 0.125 allowed: of that bound
        (-2.5, -2.0, -1.0, {"max_rel": 0.125}, 2.0),
        (3.0, 2.0, 2.0, {"max_abs": 0.5, "max_rel": 0.25}, 1.0),  # they add up
        (INF, INF, INF, {}, 0.0),
        (-INF, -INF, -INF, {}, 0.0),
        (-INF, INF, INF, {"max_rel": 1.0}, INF),
        (1e30, INF, INF, {"max_rel": 1.0}, INF),
        (INF, 1.0, 1.0, {"max_abs": 1e9}, INF),
        (1e30, 0.0, INF, {}, 0.0),
        (-1.0, 0.0, INF, {"max_abs": 0.5, "max_rel": 1.0}, 2.0),
        (1.5, -INF, 1.0, {"max_abs": 0.25, "max_rel": 0.0}, 2.0),
        (NAN, 0.0, 1.0, {"max_abs": 1.0}, NAN),
        (NAN, NAN, NAN, {}, NAN),
        (NAN, NAN, NAN, {"nan": "match"}, 0.0),
        (1.0, NAN, NAN, {"nan": "match", "max_abs": 1.0}, NAN),
        (NAN, 1.0, 1.0, {"nan": "match", "max_abs": 1.0}, NAN),
        (INF, NAN, NAN, {"nan": "match"}, NAN),
    ],
)
def test_excess_of_one_value(value, low, high, limits, ratio):
    found = excess(*(np.array([[number]]) for number in (value, low, high)), tolerance(**limits))
    np.testing.assert_equal(found, [[ratio]])
    finding = judge(*(np.array([[number]], np.float64) for number in (value, low, high)), tolerance(**limits))
    assert finding.status == ("pass" if ratio <= 1.0 else "fail")
    assert (finding.failing, finding.box is None) == ((0, True) if ratio <= 1.0 else (1, False))


def judged(off, count=10, **limits):
    """Of `count` x 1 zeros, but for the values `off` in the last rows."""
    values = np.zeros((count, 1))
    values[count - len(off) :, 0] = off
    return judge(values, np.zeros_like(values), np.zeros_like(values), tolerance(**limits))


@pytest.mark.parametrize(
    ("off", "fraction", "hard", "status"),
    [
        ([1.0], 0.0, 1.0, "pass"),
        ([1.5], 0.0, 10.0, "fail"),
        ([1.5], 0.1, 10.0, "quality warning"),  # one of ten, as allowed
        ([1.5, 1.5], 0.1, 10.0, "fail"),
        ([10.0], 0.1, 10.0, "quality warning"),
        ([10.5], 0.1, 10.0, "fail"),  # the hard limit
        ([NAN], 0.1, 10.0, "fail"),
        ([INF], 1.0, 1e9, "fail"),
        ([1.0, 1.0, 1.0], 0.0, 1.0, "pass"),
    ],
)
def test_few_failing_values(off, fraction, hard, status):
    assert judged(off, max_abs=1.0, max_failing_fraction=fraction, hard_factor=hard).status == status


@pytest.mark.parametrize(
    ("off", "max_rms", "rms", "status"),
    [
        ([0.6, 0.8], 0.5, 0.5, "pass"),  # sqrt((0.36 + 0.64) / 4)
        ([0.6, 0.8], 0.49, 0.5, "fail"),
        ([0.0], 0.0, 0.0, "pass"),
        ([1.0], None, 0.5, "pass"),
    ],
)
def test_root_mean_square(off, max_rms, rms, status):
    finding = judged(off, count=4, max_abs=1.0, max_rms=max_rms)
    assert finding.rms == pytest.approx(rms, rel=1e-12)
    assert finding.status == status
    assert ("RMS 0.5, allowed 0.49" in finding.words()) == (status == "fail")


def test_the_mean_square_counts_from_the_bounds_and_knows_no_nan():
    values = np.array([[4.0, 1.5], [NAN, INF]])
    low, high = np.array([[0.0, 1.0], [NAN, INF]]), np.array([[1.0, 2.0], [NAN, INF]])
    finding = judge(values, low, high, tolerance(max_abs=3.0, max_rms=1.5, nan="match"))
    assert (finding.status, finding.rms) == ("pass", 1.5)  # sqrt(9 / 4)
    assert judge(values, low, high, tolerance(max_abs=3.0, max_rms=1.5)).status == "fail"


def test_the_place_of_the_worst_value_and_the_box_of_all():
    values = np.zeros((5, 7, 3))
    values[1, 2, 0], values[3, 4, 2], values[2, 6, 1] = 2.0, -3.0, 1.0
    finding = judge(values, np.zeros_like(values), np.zeros_like(values), tolerance(max_abs=1.0))
    assert (finding.pixel, finding.worst, finding.got) == ((4, 3), 3.0, -3.0)
    assert (finding.box, finding.failing) == ((2, 1, 4, 3), 2)
    assert "2 values off, in x 2 .. 4, y 1 .. 3" in finding.words()
