"""Fronts, and answers to budgets, beside definitions written out in full."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof.sweep import fastest, front, nearest
from refdof.sweep.words import budget_answer, front_table, quality_answer, time_in_words
from tests.sweep.points import point

pytestmark = pytest.mark.fast

POINTS = st.lists(
    st.tuples(st.integers(1, 6), st.integers(20, 26)).map(lambda pair: (pair[0] / 8.0, float(pair[1]))), min_size=1
)


def points_of(pairs, floor=60.0):
    return [point(str(k), time_s, psnr, floor) for k, (time_s, psnr) in enumerate(pairs)]


@given(POINTS)
def test_front_is_what_no_point_beats(pairs):
    points = points_of(pairs)
    found = {(one.time_s, one.quality) for one in front(points)}
    for one in points:  # the definition: nothing as fast is better, nothing as good is faster
        beaten = any(
            (other.time_s < one.time_s and other.quality >= one.quality)
            or (other.time_s <= one.time_s and other.quality > one.quality)
            for other in points
        )
        assert ((one.time_s, one.quality) in found) == (not beaten)
    order = front(points)
    assert all(a.time_s < b.time_s and a.quality < b.quality for a, b in pairwise(order))


@given(POINTS, st.integers(1, 6), st.integers(19, 27))
def test_answers(pairs, eighths, quality):
    points, budget = points_of(pairs), eighths / 8.0
    best = nearest(points, budget)
    allowed = [one for one in points if one.time_s <= budget]
    assert (best is None) == (not allowed)
    if best is not None:
        assert best.quality == max(one.quality for one in allowed)
        assert best.time_s == min(one.time_s for one in allowed if one.quality == best.quality)
    quick = fastest(points, quality)
    good = [one for one in points if one.scores["psnr"] >= quality]
    assert (quick is None) == (not good)
    if quick is not None:
        assert quick.scores["psnr"] >= quality
        assert quick.time_s == min(one.time_s for one in good)


def test_the_noise_floor_ends_the_front():
    points = points_of([(0.1, 40.0), (0.2, 48.0), (0.4, 49.0), (0.8, 55.0)], floor=50.0)
    assert [one.time_s for one in front(points)] == [0.1, 0.2]
    assert front(points)[-1].quality == 47.0


def test_words():
    points = points_of([(0.05, 25.0), (0.5, 35.0)])
    assert budget_answer(points, 0.1).splitlines() == [
        "fence, 320 x 240: the nearest to the reference in 100 ms is lensblur with samples=16: 25.00 dB in 50.0 ms.",
        "    refdof render fence --method lensblur --set samples=16 -o lensblur.png",
    ]
    assert "nothing takes 1.0 ms or less; the fastest is lensblur" in budget_answer(points, 0.001)
    assert "the fastest with at least 32 dB is lensblur with samples=16: 35.00 dB in 500 ms" in quality_answer(
        points, 32.0
    )
    assert "nothing has 36 dB; the best is lensblur with samples=16: 35.00 dB" in quality_answer(points, 36.0)
    assert quality_answer(points, 60.5).splitlines() == [
        "fence, 320 x 240: 60.5 dB lies above the reference's noise floor of 60.0 dB: more --samples are needed; the "
        "best is lensblur with samples=16: 35.00 dB in 500 ms.",
        "    refdof render fence --method lensblur --set samples=16 -o lensblur.png",
    ]
    table = front_table(points)
    assert all(len(line) <= 80 for line in table.splitlines())
    assert len(table.splitlines()) == 4
    assert [time_in_words(one) for one in (0.0012, 0.25, 1.0, 61.234)] == ["1.2 ms", "250 ms", "1.00 s", "61.23 s"]
