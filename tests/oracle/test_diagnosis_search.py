"""The search for a whole number: the best one within half of the range around the start."""

import pytest

from refdof.oracle.diagnosis.search import _best_whole

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("best", [1, 37, 200, 256, 399])
def test_the_lowest_place_of_a_valley_is_found(best):
    assert _best_whole(lambda k: abs(k - best), 1, 180, 399) == best


def test_a_start_alone_in_its_range():
    assert _best_whole(lambda k: k, 5, 5, 5) == 5
