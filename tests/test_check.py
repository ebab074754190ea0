"""Validation: what passes comes out as stated, what does not is named in one line."""

import re

import numpy as np
import pytest

from refdof import _check
from refdof._check import InputError

pytestmark = pytest.mark.fast

NAN, INF = float("nan"), float("inf")


def test_as_float_keeps_float_types_and_makes_doubles_of_the_rest():
    assert _check.as_float("x", np.float32([1, 2]), (2,)).dtype == np.float32
    assert _check.as_float("x", np.float64([1, 2]), (2,)).dtype == np.float64
    assert _check.as_float("x", np.float16([1, 2]), (2,)).dtype == np.float64
    assert _check.as_float("x", [1, 2], (2,)).dtype == np.float64
    assert _check.as_float("x", [1.5], (1,), dtype=np.float32).dtype == np.float32


def test_as_float_returns_contiguous_arrays_of_the_same_values():
    source = np.arange(12.0).reshape(3, 4).T
    array = _check.as_float("x", source, (4, None))
    assert array.flags.c_contiguous
    np.testing.assert_array_equal(array, source)


def test_as_float_takes_a_single_number():
    array = _check.as_float("x", 2.5, ())
    assert array.shape == ()
    assert array == 2.5


def test_as_float_allows_infinities_only_where_told():
    assert _check.as_float("x", [INF], (1,), finite=False)[0] == INF
    with pytest.raises(InputError, match=r"x: has 1 infinite"):
        _check.as_float("x", [INF, 1.0], (2,))


BAD_FLOATS = [
    ([1.0, NAN], {}, "1 NaN"),
    ([1.0, NAN], {"finite": False}, "1 NaN"),
    ([1.0, -0.5], {"minimum": 0.0}, "-0.5"),
    ([1.0, 2.0, 3.0], {}, r"\(3,\)"),
    ([[1.0, 2.0]], {}, r"\(1, 2\)"),
    (["a", "b"], {}, "allowed are numbers"),
    (["1", "2"], {}, "allowed are numbers"),
    ([1j, 2.0], {}, "allowed are numbers"),
    ([[1.0], [1.0, 2.0]], {}, "got a list; allowed are numbers in rows of equal length"),
    (None, {}, "got None; allowed are numbers"),
    ([None, 1.0], {"nan": True}, "allowed are numbers"),
    ([1e300, 0.0], {"dtype": np.float32}, "largest value is 1e\\+300; allowed are values <= 3.4"),
    ([-1e300, 0.0], {"dtype": np.float32}, "smallest value is -1e\\+300; allowed are values >= -3.4"),
    ([1.0, 2.0], {"maximum": 1.5}, "largest value is 2; allowed are values <= 1.5"),
]


@pytest.mark.parametrize(("value", "options", "words"), BAD_FLOATS)
def test_as_float_refuses(value, options, words):
    with pytest.raises(InputError, match=rf"^texture: .*{words}"):
        _check.as_float("texture", value, (2,), **options)


def test_as_index_makes_contiguous_int64():
    faces = _check.as_index("faces", np.array([[0, 1], [2, 0]], dtype=np.uint8).T, (None, 2), end=3)
    assert faces.dtype == np.int64
    assert faces.flags.c_contiguous
    np.testing.assert_array_equal(faces, [[0, 2], [1, 0]])


def test_as_index_takes_an_empty_list():
    assert _check.as_index("faces", np.zeros((0, 3)), (None, 3), end=0).dtype == np.int64


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ([0, 3], "3 is outside 0 .. 2"),
        ([-1, 0], "-1 is outside"),
        ([0.0, 1.0], "integers"),
        ([0, 1, 2], "shape"),
        ([True, False], "integers"),
        ([[0], [0, 1]], "rows of equal length"),
        ([2**70, 0], "allowed are integers"),
    ],
)
def test_as_index_refuses(value, words):
    with pytest.raises(InputError, match=f"^faces: .*{words}"):
        _check.as_index("faces", value, (2,), end=3)


def test_as_number_has_inclusive_and_exclusive_ends():
    assert _check.as_number("x", 0, minimum=0.0) == 0.0
    assert _check.as_number("x", "179", above=0.0, maximum=179.0) == 179.0
    assert _check.as_number("x", np.float32(0.5)) == 0.5
    assert _check.as_number("x", INF, finite=False) == INF


@pytest.mark.parametrize(
    "value",
    [NAN, INF, -INF, -0.1, 0.0, 10.5, "wide", None, [1.0], np.array([1.0]), 10**400, 1j, np.complex64(1), True],
)
def test_as_number_refuses(value):
    with pytest.raises(InputError, match=r"^focus: got .*; allowed is a finite number > 0 and <= 10$"):
        _check.as_number("focus", value, above=0.0, maximum=10.0)


def test_as_integer_takes_whole_numbers_of_any_type():
    for value in (3, 3.0, np.int64(3), np.float32(3)):
        number = _check.as_integer("samples", value, minimum=1)
        assert (type(number), number) == (int, 3)


@pytest.mark.parametrize("value", [0, -1, 9, 3.5, NAN, INF, True, None, "many", 10**400])
def test_as_integer_refuses(value):
    with pytest.raises(InputError, match=r"^samples: got .*; allowed is a whole number in 1 .. 8$"):
        _check.as_integer("samples", value, minimum=1, maximum=8)


@pytest.mark.parametrize("value", [(0, 0), (0, 0, 0, 0), (0, 0, NAN), (0, 0, INF), "xyz", 1.0, None])
def test_as_vector_refuses(value):
    with pytest.raises(InputError, match=r"^eye: "):
        _check.as_vector("eye", value)


def test_as_vector_and_color_return_plain_floats():
    assert _check.as_vector("eye", np.float32([1, -2, 3])) == (1.0, -2.0, 3.0)
    assert all(type(c) is float for c in _check.as_color("sky", [0, 1, 7]))  # HDR colours exceed 1
    with pytest.raises(InputError, match=r"^sky: "):
        _check.as_color("sky", (0, -1, 0))


@pytest.mark.parametrize("value", [(0, 1), (1, 100), (1,), (1, 2, 3), 5, (1.5, 2), None])
def test_as_pair_refuses(value):
    with pytest.raises(InputError, match=r"^size: "):
        _check.as_pair("size", value, minimum=1, maximum=99)


def test_as_choice_names_the_nearest():
    assert _check.as_choice("pattern", "sobol", ["sobol", "halton"]) == "sobol"
    with pytest.raises(InputError, match=r"^pattern: got 'sobl'; did you mean 'sobol'\? allowed are sobol, halton"):
        _check.as_choice("pattern", "sobl", ["sobol", "halton"])
    for value in ("zzz", None, 3, ["sobol"]):
        with pytest.raises(InputError, match=r"^pattern: got .* allowed are sobol, halton"):
            _check.as_choice("pattern", value, ["sobol", "halton"])


def test_messages_are_one_line():
    for call in (
        lambda: _check.as_number("x", "a\nb"),
        lambda: _check.as_number("x", np.zeros((40, 40))),
        lambda: _check.as_bool("x", [[0.0] * 40] * 40),
        lambda: _check.as_pair("x", ["a" * 1000], minimum=1, maximum=2),
        lambda: _check.as_float("x", ["a\nb"], (1,)),
        lambda: _check.as_instance("x", "a\nb", int),
        lambda: _check.as_choice("x", "a\nb", ["c"]),
        lambda: _check.as_integer("x", "a\nb", minimum=0),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert not re.search(r"[\r\n]", str(caught.value))
        assert len(str(caught.value)) < 200


@pytest.mark.parametrize("value", ["false", 0, 1, None])
def test_truth_values_are_not_guessed(value):
    with pytest.raises(InputError, match=r"culling: got .*; allowed are True and False"):
        _check.as_bool("culling", value)
    assert _check.as_bool("culling", np.bool_(True)) is True


def test_rows_of_unequal_length_have_no_shape():
    with pytest.raises(InputError, match="depth: got a list; allowed are numbers in rows of equal length"):
        _check.shape_of("depth", [[1, 2], [3]])


def test_large_numbers_whose_sum_overflows_are_finite():
    array = np.full(4, 3e38, dtype=np.float32)
    assert _check.as_float("color", array, (4,)) is array


def test_images_are_linear_light():
    assert _check.as_image("x", [[[0, 1, 2]]]).dtype == np.float64  # plain numbers are taken for what they are
    assert _check.as_image("x", np.zeros((2, 3, 3), np.float32), dtype=np.float64).dtype == np.float64
    for kind in (np.uint8, np.uint16, np.bool_):
        with pytest.raises(InputError, match=rf"^x: got {np.dtype(kind)} values; allowed are floats that hold linear"):
            _check.as_image("x", np.ones((2, 2, 3), dtype=kind))
    with pytest.raises(InputError, match=r"^x: got shape \(0, 2, 3\); allowed is at least one pixel"):
        _check.as_image("x", np.zeros((0, 2, 3)))
    for value, words in ((3e38, "largest value is 3e+38; allowed are values <= 1e+33"), (np.inf, "1 infinite")):
        with pytest.raises(InputError, match=re.escape(words)):
            _check.as_image("x", np.float32([[[0.0, value, 0.0]]]))


def test_depths_are_above_0_and_maps_have_a_pixel():
    depth = np.array([[0.5, np.inf]], dtype=np.float32)
    assert _check.as_depth(depth, (None, 2)) is depth
    assert np.isnan(_check.as_depth([1.0, np.nan], (2,), nan=True)[1])
    for value in (0.0, -0.0, -2.5, -np.inf):
        words = f"^depth: smallest value is {value:g}; allowed are values > 0"
        for nan in (False, True):
            with pytest.raises(InputError, match=words):
                _check.as_depth([1.0, value] + [np.nan] * nan, (None,), nan=nan)
    with pytest.raises(InputError, match=r"^depth: "):
        _check.as_depth([1.0, np.nan], (2,))
    assert _check.as_map("x", [[-1.0, np.inf]], (None, None)).tolist() == [[-1.0, np.inf]]
    with pytest.raises(InputError, match=r"^x: got shape \(0, 3\); allowed is at least one pixel"):
        _check.as_map("x", np.zeros((0, 3)), (None, None))


def test_paths_functions_and_lists_are_not_guessed():
    assert _check.as_path("out", "a.png").name == "a.png"
    for value in (3, None, b"a.png", "", "a\0.png", ["a.png"]):
        with pytest.raises(InputError, match=r"^out: got .*; allowed is a path"):
            _check.as_path("out", value)
    assert _check.as_function("progress", None) is None
    with pytest.raises(InputError, match="progress: got 'no'; allowed is a function"):
        _check.as_function("progress", "no")
    assert _check.as_instances("parts", [1, 2], int) == (1, 2)
    for value in (None, "ab", 3, {1, 2}):
        with pytest.raises(InputError, match=r"^parts: got .*; allowed is a list of int"):
            _check.as_instances("parts", value, int)
    with pytest.raises(InputError, match=r"^parts\[1\]: got str; allowed is a int"):
        _check.as_instances("parts", [1, "b"], int)


def test_numbers_too_long_to_print_are_refused_in_words():
    for refuse in (
        lambda: _check.as_number("x", 10**5000, minimum=0.0),
        lambda: _check.as_integer("x", 10**5000, minimum=0, maximum=9),
        lambda: _check.as_float("x", (10**5000, 0, 0), (3,)),
    ):
        with pytest.raises(InputError, match="x: got a number too long to print"):
            refuse()


def test_whole_numbers_that_no_float_holds_are_whole():
    assert _check.as_integer("seed", 2**53 + 1, minimum=0) == 2**53 + 1
    assert _check.as_integer("seed", np.uint64(2**63 + 1), minimum=0) == 2**63 + 1
    with pytest.raises(InputError, match="seed"):
        _check.as_integer("seed", 2**53 + 1, minimum=0, maximum=2**53)
