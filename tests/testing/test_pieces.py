"""Pieces of `refdof.testing`, by hand: distances, cuts, circles, and what is taken away."""

import math

import numpy as np
import pytest

from refdof.testing.compared import Compared, Room, distance_to, inside
from refdof.testing.picture import DEPTHS, Case, Picture
from refdof.testing.report import Failure, PropertyError, Report
from refdof.testing.shrink import smallest

pytestmark = pytest.mark.fast


def picture(height, width, circle=2.0):
    return Picture(np.zeros((height, width, 3), np.float32), np.full((height, width), np.inf, np.float32), circle)


def test_circles_by_hand():
    """c (1 - 4 / depth): exact, since all are powers of two but P, which rounds once."""
    one = picture(1, 5).with_(depth=np.array([DEPTHS], np.float32))
    np.testing.assert_allclose(one.coc, [[0.0, 2.0, -2.0, 1.0, 1.5]], rtol=1e-6)
    scaled = one.with_(depth=8.0 * one.depth, unit=8.0)
    np.testing.assert_array_equal(scaled.coc, one.coc)
    assert one.camera.size == (5, 1)
    assert one.camera.pixels_per_tangent == pytest.approx(64.0)
    assert one.moved(lambda a: np.swapaxes(a, 0, 1)).camera.size == (1, 5)


def test_a_margin_is_nothing_without_blur():
    room = Room(1e-5, 3.0)
    assert room.margin(0.0) == 0.0
    assert room.margin(2.0) == 7.0


def test_places_far_from_a_cut():
    # Of ten places 2 .. 7 remain; what is more than 2 from 1 and from 8 is 4 and 5.
    np.testing.assert_array_equal(np.flatnonzero(inside(10, 2, 8, 2.0)), [4, 5])
    # The ends of the whole are no cuts.
    np.testing.assert_array_equal(np.flatnonzero(inside(10, 0, 8, 2.0)), range(6))
    np.testing.assert_array_equal(np.flatnonzero(inside(10, 2, 10, 0.0)), range(2, 10))


def test_distances():
    marked = np.zeros((2, 3), dtype=bool)
    assert (distance_to(marked) == np.inf).all()
    marked[0, 0] = True
    np.testing.assert_allclose(distance_to(marked), [[0.0, 1.0, 2.0], [1.0, math.sqrt(2.0), math.sqrt(5.0)]])


def test_the_worst_place_is_the_largest_difference_that_counts():
    zero = np.zeros((1, 3, 1))
    got = np.array([0.5, 2.0, -3.0]).reshape(1, 3, 1)
    assert Compared(zero, got, 1.0).worst() == (0, 2, 0)
    assert Compared(zero, got, 1.0, np.array([[True, True, False]])).worst() == (0, 1, 0)
    assert Compared(zero, got, 3.0).worst() is None
    assert Compared(zero, zero * np.nan, 1e9).worst() == (0, 0, 0)
    assert Compared(np.array(1.0), np.array(3.0), 1.0).worst() == ()


def test_pixels_unlike_the_rest():
    one = picture(2, 3)
    one.color[1, 1] = 1.0
    one.depth[0, 2] = 4.0
    assert one.unlike() == [(0, 2), (1, 1)]
    assert one.usual() == (0, 0)
    pair = picture(1, 2)
    pair.color[0, 1] = 1.0  # of as many, those like the first are usual
    assert pair.unlike() == [(0, 1)]


def test_what_fails_for_one_bright_pixel_with_a_neighbour_ends_as_two_pixels():
    random = np.random.default_rng(1)
    start = picture(9, 8).with_(color=random.choice([0.0, 0.25, 3.0], (9, 8, 3)).astype(np.float32))

    def fails(case):
        bright = (case.picture.color == 3.0).any(axis=2)
        return bool(bright.any() and case.picture.depth.shape[1] >= 2 and case.numbers[0] >= 2)

    found = smallest(Case(start, (5, 1)), fails, (0.5, 1.0, 2.0))
    assert found.picture.depth.shape == (1, 2)
    assert found.numbers == (2, 0)
    assert found.picture.circle == 0.5
    assert fails(found)


def test_a_report_that_fails_travels_with_its_error():
    failure = Failure("energy", "words", picture(1, 1), "sums", (2,), 1.0, 0.5)
    report = Report({"call": 3, "energy": 4}, [failure])
    error = PropertyError(report)
    assert isinstance(error, AssertionError)
    assert error.__reduce__()[1] == (report,)
    assert str(error).splitlines() == [
        "1 of 2 promises hold: call",
        "energy: words",
        "  picture: 1 px wide, 1 px high",
        "    all pixels: color (0, 0, 0), depth inf, circle 2 px",
        "  sums",
        "  channel 2: expected 1, got 0.5",
    ]
