"""Verdicts by hand."""

import math

import pytest

from refdof.claims.verdict import DIRECTION, NOT_TESTABLE, REFUTED, REPRODUCED, Rule, rounded, verdict_of

pytestmark = pytest.mark.fast

RANGES = Rule(within=(9.0, 11.0), direction=(0.0, math.inf))
BOUND = Rule(within=(-math.inf, 7.0))
ORDER = Rule(order=("a", "b", "c"), main="a")
LAST = Rule(order=("a", "b", "c"), main="c")


@pytest.mark.parametrize(
    ("rule", "figure", "verdict"),
    [
        (RANGES, 10.0, REPRODUCED),
        (RANGES, 9.0, REPRODUCED),
        (RANGES, 11.0, REPRODUCED),
        (RANGES, 11.1, DIRECTION),
        (RANGES, 0.0, DIRECTION),
        (RANGES, math.inf, DIRECTION),
        (RANGES, -0.1, REFUTED),
        (RANGES, math.nan, REFUTED),
        (RANGES, None, REFUTED),
        (BOUND, 7.0, REPRODUCED),
        (BOUND, 8.0, REFUTED),
        (BOUND, -1e9, REPRODUCED),
        (ORDER, {"a": 3.0, "b": 2.0, "c": 1.0}, REPRODUCED),
        (ORDER, {"a": 3.0, "b": 1.0, "c": 2.0}, DIRECTION),
        (ORDER, {"a": 3.0, "b": 1.0, "c": 1.0}, DIRECTION),
        (ORDER, {"a": 2.0, "b": 3.0, "c": 1.0}, REFUTED),
        (ORDER, {"a": 3.0, "b": 3.0, "c": 1.0}, REFUTED),
        (LAST, {"a": 2.0, "b": 3.0, "c": 1.0}, DIRECTION),
        (LAST, {"a": 3.0, "b": 1.0, "c": 2.0}, REFUTED),
        (Rule(order=("a", "b")), {"a": 1.0, "b": 2.0}, REFUTED),
        (Rule(not_testable="why"), None, NOT_TESTABLE),
        (Rule(not_testable="why"), 3.0, NOT_TESTABLE),
    ],
)
def test_verdicts(rule, figure, verdict):
    assert verdict_of(rule, figure) == verdict


@pytest.mark.parametrize(
    ("rule", "words"),
    [
        (RANGES, "reproduced from 9 to 11; its direction from 0"),
        (BOUND, "reproduced up to 7"),
        (Rule(within=(1.0, 1.0)), "reproduced at 1"),
        (Rule(within=(2.399963225, 2.399963235)), "reproduced from 2.399963225 to 2.399963235"),
        (ORDER, "reproduced if a > b > c; its direction if a is first"),
        (LAST, "reproduced if a > b > c; its direction if c is last"),
        (Rule(order=("a", "b")), "reproduced if a > b"),
        (Rule(not_testable="why"), ""),
    ],
)
def test_rules_in_words(rule, words):
    assert rule.in_words() == words


def test_figures_are_judged_as_they_are_shown():
    assert rounded(24.03515625, 6) == 24.0352
    assert rounded(1234567.0, 3) == 1230000.0
    assert rounded({"a": 0.0123456}, 2) == {"a": 0.012}
    assert rounded(None, 3) is None
