"""Verdict rules, by figures made up by hand."""

import math

import pytest

from refdof.stability.verdict import BROKEN, DEGRADED, PASS, Figure, verdict_of

pytestmark = pytest.mark.fast


def figure(value, bound=10.0, name="error"):
    return Figure(name, value, bound, "px", "by hand")


@pytest.mark.parametrize(
    ("values", "documented", "verdict"),
    [
        ([], {}, PASS),
        ([0.0, 10.0], {}, PASS),  # a bound is allowed
        ([math.nextafter(10.0, 11.0)], {}, BROKEN),
        ([11.0], {"error": 12.0}, DEGRADED),
        ([12.0], {"error": 12.0}, DEGRADED),
        ([12.5], {"error": 12.0}, BROKEN),
        ([9.0], {"error": 12.0}, PASS),  # better than documented
        ([11.0], {"other": 12.0}, BROKEN),  # what is documented of another figure excuses nothing
        ([11.0, 13.0], {"error": 12.0}, BROKEN),  # the worst counts, in any order
        ([13.0, 11.0], {"error": 12.0}, BROKEN),
        ([math.nan], {}, BROKEN),
        ([math.nan], {"error": math.inf}, BROKEN),  # nothing excuses what is no number
        ([math.inf], {}, BROKEN),
    ],
)
def test_verdicts(values, documented, verdict):
    assert verdict_of([figure(value) for value in values], documented) == verdict


def test_the_worst_of_several_figures_counts():
    good, bad, odd = figure(1.0), figure(11.0, name="bad"), figure(11.0, name="odd")
    assert verdict_of([good, bad], {"bad": 11.0}) == DEGRADED
    assert verdict_of([bad, good], {"bad": 11.0}) == DEGRADED
    assert verdict_of([good, bad, odd], {"bad": 11.0}) == BROKEN
    assert verdict_of([good, bad, odd], {"bad": 11.0, "odd": 11.0}) == DEGRADED
