"""`check_properties` passes a right filter, finds each planted mistake, and shows it on the fewest pixels.

All filters spread by one radius: `reach` is 1. Circles are 0.5, 1, 1.5 or 2 px, and where one is c, what is "near" ends
at c + 1 px. A disc of 0.5 px is its own pixel; in one of 1 px, the four neighbours have weight 1/2, and the diagonal
ones 1.5 - sqrt(2).
"""

import numpy as np
import pytest

from refdof import InputError
from refdof.methods._contract import PROMISES as PROMISES_OF_METHODS
from refdof.testing import PROMISES, PropertyError, check_properties
from refdof.testing.properties import PROPERTIES
from tests.testing import filters

pytestmark = pytest.mark.fast

WITH_LENS = {"inputs": ("color", "depth", "camera", "lens")}


def failures(function, promises=None, **words):
    with pytest.raises(PropertyError) as caught:
        check_properties(function, promises, **{"reach": 1.0, "examples": 30} | words)
    return {failure.promise: failure for failure in caught.value.report.failures}


def failure(function, promise, **words):
    return failures(function, (promise,), **words)[promise]


def test_a_right_filter_keeps_all_promises():
    report = check_properties(filters.gather, reach=1.0, examples=20)
    assert report.passed
    assert str(report) == f"{len(PROMISES)} of {len(PROMISES)} promises hold: {', '.join(PROMISES)}"
    # Of each, a fair share of the pictures has something to tell.
    assert min(report.tested.values()) >= 5


def test_a_light_that_is_lost_has_no_radius():
    found = failure(filters.black, "radius")
    assert "no light is left" in str(found)
    assert (found.expected, found.got) == (1.0, 0.0)


def test_a_right_filter_from_camera_and_lens_with_alpha():
    promises = ("call", "constant", "radius", "crop", "channels", "units", "far")
    assert check_properties(filters.own_circles, promises, reach=1.0, examples=20, channels=4, **WITH_LENS).passed


@pytest.mark.parametrize(
    ("function", "promise", "size", "unlike"),
    [
        # A light may not be within 2 (0.5 + 1) = 3 px of the border's outside: three pixels on each side of it.
        (filters.leaking, "energy", (7, 7), 1),
        (filters.leaking, "constant", (1, 1), 0),
        # One pixel has no neighbour to be mixed with.
        (filters.shifted, "pinhole", (1, 2), 1),
        (filters.shifted, "symmetry", (1, 2), 1),
        # Its left pixel sees itself, its right one both.
        (filters.lopsided, "symmetry", (1, 2), 1),
        (filters.lopsided, "transpose", (1, 2), 1),
        (filters.clamped, "pinhole", (1, 1), 0),
        (filters.clamped, "linearity", (1, 1), 0),
        (filters.swapped, "constant", (1, 1), 0),
        (filters.swapped, "channels", (1, 1), 0),
        # The pixel that changes has a circle of 1 px, which shows at the other end: 3 px off, more than 1 + 1.
        (filters.wrapped, "locality", (1, 4), 0),
        # A disc of 2 px for one of 1 px has an RMS radius of 1.527 px, 0.82 more than 0.707. Of 1 px for 0.5 px, the
        # second moment is (4 / 2 + 4 * 0.086 * 2) / (1 + 4 / 2 + 4 * 0.086), the radius 0.896, 0.54 more than 0.354.
        # A light of 1 px may not be within 2 (1 + 1) = 4 px of the border's outside.
        (filters.twice, "radius", (9, 9), 1),
        # In front 1 px is halved, which leaves each pixel alone; behind it mixes two.
        (filters.quarter_in_front, "sides", (1, 2), 1),
        (filters.smeared, "behind", (1, 2), 1),
        # Two pixels of different brightness.
        (filters.bright_first, "linearity", (1, 2), 1),
    ],
)
def test_a_mistake_is_shown_on_the_fewest_pixels(function, promise, size, unlike):
    found = failure(function, promise)
    assert found.size in (size, size[::-1]) if function is not filters.lopsided else found.size == size
    assert found.unlike == unlike


@pytest.mark.parametrize(
    ("function", "promise"),
    [
        (filters.by_width, "crop"),
        (filters.by_width, "tile"),
        (filters.by_width, "transpose"),
        (filters.in_metres, "units"),
        (filters.far_plane, "far"),
        (filters.wrapped, "crop"),
    ],
)
def test_other_mistakes_are_found(function, promise):
    words = WITH_LENS if function in (filters.by_width, filters.in_metres, filters.far_plane) else {}
    found = failure(function, promise, **words)
    assert found.promise == promise
    assert abs(found.expected - found.got) > 1e-5  # the default tolerance, of values of 1/4 or more


def test_a_mistake_breaks_only_what_it_must():
    """The promises of pictures that are not blurred, or only turned, hold for a filter that loses light."""
    broken = failures(filters.leaking, examples=10)
    assert {"constant", "energy"} <= set(broken)
    assert not {"call", "pinhole", "focus", "radius", "symmetry", "flip", "translation", "crop", "nan", "sides"} & set(
        broken
    )


def test_a_failure_tells_what_where_and_on_which_picture():
    found = failure(filters.swapped, "constant")
    color = found.picture.color
    assert color.shape == (1, 1, 3)
    assert found.where in ((0, 0, 0), (0, 0, 2))
    channel = found.where[2]
    assert found.expected == color[0, 0, channel]
    assert found.got == color[0, 0, 2 - channel]
    lines = str(found).splitlines()
    assert lines[0] == f"constant: {PROMISES['constant']}"
    assert lines[1] == "  picture: 1 px wide, 1 px high"
    assert lines[-1].startswith(f"  row 0, column 0, channel {channel}: expected ")


def test_a_filter_of_one_line_says_all_in_its_text():
    """What is printed: worked out by hand. Circle 0.5 px, white becomes 0.99."""
    found = failure(filters.leaking, "constant")
    assert str(found).splitlines()[1:] == [
        "  picture: 1 px wide, 1 px high",
        "    all pixels: color (1, 0, 0), depth inf, circle 0.5 px",
        "  row 0, column 0, channel 0: expected 1, got 0.99000001",  # the nearest float32
    ]


def test_every_call_finds_the_same():
    assert str(failure(filters.lopsided, "symmetry")) == str(failure(filters.lopsided, "symmetry"))


class Alternating:
    """Adds a millionth every other time."""

    calls = 0

    def __call__(self, color, depth, coc):
        self.calls += 1
        return color + np.float32(1e-3) * (self.calls % 2)


def writes(color, depth, coc):
    depth[0] = 1.0
    return color


def raises(color, depth, coc):
    raise RuntimeError("no\ndevice")


@pytest.mark.parametrize(
    ("function", "line"),
    [
        (raises, "raised RuntimeError: no device"),
        (lambda color, depth, coc: None, "returned values of type object; allowed are floats"),
        (lambda color, depth, coc: (color[0, 0], 1.0), "returned a tuple; allowed is an array"),
        (lambda color, depth, coc: color.astype(np.uint8), "returned values of type uint8; allowed are floats"),
        (lambda color, depth, coc: color[..., 0], "returned shape (1, 1); allowed is (1, 1, 3), that of color"),
        (
            lambda color, depth, coc: color * np.nan,
            "returned 3 of 3 values that are not finite; allowed are finite ones",
        ),
        (writes, "wrote to its input depth; allowed is to leave it alone"),
        (Alternating(), "returned two results for one picture; allowed is always the same one"),
        (lambda color, depth: color, "raised TypeError: "),
    ],
    ids=["raises", "nothing", "tuple", "bytes", "grey", "nan", "writes", "alternates", "arguments"],
)
def test_a_broken_call_is_one_line(function, line):
    with pytest.raises(PropertyError) as caught:
        check_properties(function, examples=10)
    (found,) = caught.value.report.failures
    assert str(found).startswith(f"call: the function {line}")
    assert str(found).endswith("; on a picture 1 px wide and 1 px high")
    assert len(str(found).splitlines()) == 1
    assert caught.value.report.skipped == tuple(PROMISES)[1:]


def test_an_unsteady_function_is_said_to_be_so_for_any_promise():
    assert "returned two results" in failure(Alternating(), "pinhole").broken


def test_who_refuses_what_is_not_finite_only_breaks_that_promise():
    def refuses(color, depth, coc):
        assert np.isfinite(color).all()
        return filters.gather(color, depth, coc)

    broken = failures(refuses, examples=5)
    assert list(broken) == ["nan"]
    assert "raised AssertionError" in str(broken["nan"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"function": 3}, "function: got 3; allowed is a function"),
        ({"function": None}, "function: got None; allowed is a function"),
        ({"promises": ["energie"]}, "promises: got 'energie'; did you mean 'energy'"),
        ({"promises": []}, "promises: got none"),
        ({"promises": "energy"}, "promises: got 'energy'; allowed is a list of str"),
        ({"inputs": "color"}, "inputs: got 'color'; allowed is a list of str"),
        ({"inputs": ["image"]}, "inputs: got 'image'"),
        ({"inputs": ["depth"]}, "inputs: got depth; allowed are words with color among them"),
        ({"channels": 2}, "channels: got 2"),
        ({"tolerance": -1}, "tolerance: got -1"),
        ({"reach": np.inf}, "reach: got inf"),
        ({"circle": 0}, "circle: got 0"),
        ({"examples": 0}, "examples: got 0"),
    ],
)
def test_bad_arguments(words, message):
    with pytest.raises(InputError) as caught:
        check_properties(**{"function": filters.gather, "promises": ["call"]} | words)
    assert str(caught.value).startswith(message)
    assert len(str(caught.value).splitlines()) == 1


def test_without_hypothesis_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "refdof.testing.search", None)
    with pytest.raises(InputError, match=r"^function: got one without hypothesis .*'refdof\[testing\]'$"):
        check_properties(filters.gather)


def test_every_promise_has_a_property_and_shared_names_are_those_of_methods():
    assert list(PROPERTIES) == list(PROMISES)
    # Only a scene can show what is behind something.
    assert set(PROMISES_OF_METHODS) - set(PROMISES) == {"occlusion"}


def test_the_default_reach_is_that_of_methods():
    from inspect import signature

    from refdof.methods._contract import REACH

    assert signature(check_properties).parameters["reach"].default == REACH
