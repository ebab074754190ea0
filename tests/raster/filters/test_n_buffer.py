"""N-buffers against brute force, against scipy's window filters, and where their answers are exact."""

import math

import hypothesis.extra.numpy as arrays
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from scipy import ndimage

from refdof._check import InputError
from refdof._jit import thread_count, tile_kernel, use_threads
from refdof.raster.filters.n_buffer import Rectangles, _four_squares, highest_in, lowest_in, n_buffer, query
from tests.raster.filters import naive_n_buffer

pytestmark = pytest.mark.fast

SIZES = [(1, 1), (1, 9), (7, 1), (2, 2), (13, 17), (16, 16), (5, 33)]


def made_up(shape, seed=0, empty=0.3):
    """Depths in 1 .. 9, some of them empty."""
    rng = np.random.default_rng(seed)
    depth = rng.uniform(1.0, 9.0, shape)
    depth[rng.random(shape) < empty] = np.inf
    return depth


def random_rectangles(shape, count, seed=1):
    rng = np.random.default_rng(seed)
    x = np.sort(rng.integers(0, shape[1], (2, count)), axis=0)
    y = np.sort(rng.integers(0, shape[0], (2, count)), axis=0)
    return x[0], y[0], x[1], y[1]


@st.composite
def picture_and_rectangle(draw):
    height, width = draw(st.integers(1, 23)), draw(st.integers(1, 23))
    values = st.sampled_from([1.0, 2.0, 3.5, 8.0, math.inf])
    depth = draw(arrays.arrays(np.float64, (height, width), elements=values))
    x0, y0 = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    return depth, x0, y0, draw(st.integers(x0, width - 1)), draw(st.integers(y0, height - 1))


def ask(buffer, x0, y0, x1, y1, exact=False):
    found = query(buffer, [x0], [y0], [x1], [y1], exact=exact)
    return found.lowest[0], found.highest[0]


@given(picture_and_rectangle())
def test_exact_query_is_brute_force(case):
    depth, *rectangle = case
    assert ask(n_buffer(depth), *rectangle, exact=True) == naive_n_buffer.extremes_in(depth, *rectangle)


@given(picture_and_rectangle(), st.integers(1, 25))
def test_too_few_levels_cost_look_ups_but_not_truth(case, largest):
    depth, *rectangle = case
    few = n_buffer(depth, largest=largest)
    assert ask(few, *rectangle, exact=True) == naive_n_buffer.extremes_in(depth, *rectangle)
    least, greatest = naive_n_buffer.extremes_in(depth, *rectangle)
    found = ask(few, *rectangle)
    assert found[0] <= least
    assert found[1] >= greatest


@given(picture_and_rectangle())
def test_query_is_the_union_of_four_squares(case):
    depth, *rectangle = case
    side, corners = naive_n_buffer.four_squares(*rectangle)
    squares = [naive_n_buffer.extremes_in(depth, x, y, x + side - 1, y + side - 1) for x, y in corners]
    expected = min(s[0] for s in squares), max(s[1] for s in squares)
    assert ask(n_buffer(depth), *rectangle) == expected


@given(picture_and_rectangle())
def test_query_is_exact_iff_documented(case):
    # Outside the rectangle everything is nearer or farther than inside: the answer tells whether squares reach past.
    depth, x0, y0, x1, y1 = case
    height, width = depth.shape
    inside = np.zeros(depth.shape, dtype=bool)
    inside[y0 : y1 + 1, x0 : x1 + 1] = True
    side, _ = naive_n_buffer.four_squares(x0, y0, x1, y1)
    past = (x0 + side - 1 > x1 and x1 < width - 1) or (y0 + side - 1 > y1 and y1 < height - 1)
    if side <= min(x1 - x0 + 1, y1 - y0 + 1):
        assert not past
    nearer, farther = np.where(inside, 5.0, 1.0), np.where(inside, 5.0, 9.0)
    assert (ask(n_buffer(nearer), x0, y0, x1, y1) == (5.0, 5.0)) == (not past)
    assert (ask(n_buffer(farther), x0, y0, x1, y1) == (5.0, 5.0)) == (not past)


@given(picture_and_rectangle(), st.integers(1, 5))
def test_blocks_answer_for_every_block_they_touch(case, block):
    depth, *rectangle = case
    if max(rectangle[2] - rectangle[0], rectangle[3] - rectangle[1]) == 0:
        x, y = rectangle[0] // block * block, rectangle[1] // block * block
        expected = naive_n_buffer.extremes_in(depth, x, y, x + block - 1, y + block - 1)
        assert ask(n_buffer(depth, block=block), *rectangle) == expected
    least, greatest = naive_n_buffer.extremes_in(depth, *rectangle)
    found = ask(n_buffer(depth, block=block), *rectangle)
    assert found[0] <= least
    assert found[1] >= greatest


@pytest.mark.parametrize("shape", SIZES)
def test_every_level_is_a_window_filter(shape):
    depth = made_up(shape)
    buffer = n_buffer(depth)
    assert len(buffer.lowest) == len(buffer.highest) == 1 + math.ceil(math.log2(max(shape)))
    for level in range(len(buffer.lowest)):
        # scipy centres a window of even size one pixel right of its middle; the origin moves its corner to the pixel.
        side = 2**level
        window = {"size": side, "origin": -(side // 2) if side > 1 else 0, "mode": "constant"}
        low = ndimage.minimum_filter(depth, cval=np.inf, **window)
        high = ndimage.maximum_filter(np.where(np.isinf(depth), -np.inf, depth), cval=-np.inf, **window)
        np.testing.assert_array_equal(buffer.lowest[level], low)
        np.testing.assert_array_equal(buffer.highest[level], high)


def test_squares_double_and_do_not_grow_by_one():
    # A neighbour at distance 1 instead of 2^i makes a window only i + 1 wide, which misses the one near pixel here.
    depth = np.full((1, 16), 5.0)
    depth[0, 7] = 1.0
    buffer = n_buffer(depth)
    np.testing.assert_array_equal(buffer.lowest[3, 0], [1.0] * 8 + [5.0] * 8)
    assert ask(buffer, 0, 0, 15, 0) == (1.0, 5.0)


def test_one_square_does_not_answer_for_a_rectangle():
    # 5 x 3 pixels need squares of side 4 (two by two); the near pixel is only in the right one.
    depth = np.full((8, 8), 5.0)
    depth[1, 4] = 2.0
    assert ask(n_buffer(depth), 0, 0, 4, 2) == (2.0, 5.0)


def test_hand_numbers():
    buffer = n_buffer([[3.0, 1.0, np.inf], [4.0, 1.5, 9.0]])
    np.testing.assert_array_equal(buffer.lowest[1], [[1.0, 1.0, 9.0], [1.5, 1.5, 9.0]])
    np.testing.assert_array_equal(buffer.highest[1], [[4.0, 9.0, 9.0], [4.0, 9.0, 9.0]])
    assert ask(buffer, 2, 0, 2, 0) == (np.inf, -np.inf)


@pytest.mark.parametrize("shape", SIZES)
@pytest.mark.parametrize("block", [1, 2])
def test_nothing_is_found_among_empty_pixels(shape, block):
    buffer = n_buffer(np.full(shape, np.inf), block=block)
    found = query(buffer, *random_rectangles(shape, 20))
    assert (found.lowest == np.inf).all()
    assert (found.highest == -np.inf).all()


def test_layers_share_a_buffer_of_their_extremes():
    layers = np.sort(np.stack([made_up((9, 14), seed) for seed in range(4)]), axis=0)
    shared = n_buffer(layers)
    np.testing.assert_array_equal(shared.lowest[0], layers.min(axis=0))
    np.testing.assert_array_equal(shared.highest[0], np.where(np.isinf(layers), -np.inf, layers).max(axis=0))


def test_border_blocks_are_partial():
    buffer = n_buffer(np.arange(15.0).reshape(3, 5), block=2)
    np.testing.assert_array_equal(buffer.lowest[0], [[0, 2, 4], [10, 12, 14]])
    np.testing.assert_array_equal(buffer.highest[0], [[6, 8, 9], [11, 13, 14]])
    assert n_buffer([[1.0, 2.0]], block=7).lowest.tolist() == [[[1.0]]]


@pytest.mark.parametrize("block", [1, 2, 3])
def test_levels_only_as_many_as_asked(block):
    depth = made_up((37, 53))
    full = n_buffer(depth, block=block)
    for largest in (1, 2, 3, 8, 9, 60):
        few = n_buffer(depth, largest=largest, block=block)
        assert len(few.lowest) <= len(full.lowest)
        x0, y0, _, _ = random_rectangles(depth.shape, 200)
        rectangles = x0, y0, np.minimum(x0 + largest - 1, 52), np.minimum(y0 + largest - 1, 36)
        np.testing.assert_array_equal(query(few, *rectangles), query(full, *rectangles))
    assert [len(n_buffer(depth, largest=m).lowest) for m in (1, 2, 3, 4, 5, 8, 9)] == [1, 1, 2, 2, 3, 3, 4]


def test_one_side_alone_is_half_of_both():
    depth = made_up((11, 6))
    both = n_buffer(depth)
    low, high = n_buffer(depth, extremes="min"), n_buffer(depth, extremes="max")
    np.testing.assert_array_equal(low.lowest, both.lowest)
    np.testing.assert_array_equal(high.highest, both.highest)
    rectangles = random_rectangles(depth.shape, 30)
    assert query(low, *rectangles).highest.size == query(high, *rectangles).lowest.size == 0
    np.testing.assert_array_equal(query(high, *rectangles).highest, query(both, *rectangles).highest)


@pytest.mark.parametrize("block", [1, 2])
def test_float32_and_float64_agree_bit_for_bit(block):
    narrow = made_up((13, 17)).astype(np.float32)
    small, large = n_buffer(narrow, block=block), n_buffer(narrow.astype(np.float64), block=block)
    assert small.lowest.dtype == np.float32
    assert small.lowest.tobytes() == large.lowest.astype(np.float32).tobytes()
    assert small.highest.tobytes() == large.highest.astype(np.float32).tobytes()
    rectangles = random_rectangles(narrow.shape, 200)
    pair = query(small, *rectangles), query(large, *rectangles)
    assert np.array(pair[0]).tobytes() == np.array(pair[1]).astype(np.float32).tobytes()


def test_threads_change_no_bit():
    depth, before = made_up((40, 31)), thread_count()

    def run():
        buffer = n_buffer(depth, block=2)
        found = query(buffer, *random_rectangles(depth.shape, 500))
        return buffer.lowest.tobytes() + buffer.highest.tobytes() + np.array(found).tobytes()

    try:
        use_threads(1)
        alone = run()
    finally:
        use_threads(before)
    assert run() == alone


@pytest.mark.parametrize(
    ("depth", "words"),
    [
        ([[1.0, np.nan]], "depth: has 1 NaN"),
        (np.ones(3), "depth: got shape"),
        (np.ones((2, 2, 2, 2)), "depth: got shape"),
        (np.ones((0, 4)), "depth: got shape"),
        (np.ones((4, 0)), "depth: got shape"),
        (np.ones((0, 4, 4)), "depth: got shape"),
    ],
)
def test_bad_pictures_are_named(depth, words):
    with pytest.raises(InputError, match=words):
        n_buffer(depth)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"block": 0}, "block: got 0"),
        ({"largest": 0}, "largest: got 0"),
        ({"largest": 2.5}, "largest: got 2.5"),
        ({"extremes": "mim"}, "did you mean 'min'"),
    ],
)
def test_bad_options_are_named(options, words):
    with pytest.raises(InputError, match=words):
        n_buffer(np.ones((3, 3)), **options)


@pytest.mark.parametrize(
    ("rectangle", "words"),
    [
        (([-1], [0], [1], [1]), "x0: index -1"),
        (([-(2**63)], [0], [2**63 - 1], [1]), "x0: index -9223372036854775808"),
        (([0], [0], [4], [1]), "x1: index 4"),
        (([0], [0], [1], [3]), "y1: index 3"),
        (([2], [0], [1], [1]), "x1: got 1 with x0 2"),
        (([0], [2], [1], [1]), "y1: got 1 with y0 2"),
        (([0, 1], [0], [1], [1]), "y0: got shape"),
        (([0.5], [0], [1], [1]), "x0: got .* allowed are integers"),
    ],
)
def test_bad_rectangles_are_named(rectangle, words):
    with pytest.raises(InputError, match=words):
        query(n_buffer(np.ones((3, 4))), *rectangle)


def test_bad_questions_are_named():
    with pytest.raises(InputError, match="exact: got True"):
        query(n_buffer(np.ones((3, 4)), block=2), [0], [0], [1], [1], exact=True)
    with pytest.raises(InputError, match="nbuffer: got ndarray"):
        query(np.ones((3, 4)), [0], [0], [1], [1])


def test_levels_in_any_memory_order_answer_alike():
    depth = made_up((20, 30))
    buffer, rectangles = n_buffer(depth), random_rectangles((20, 30), 200)
    wanted = query(buffer, *rectangles)
    columns = buffer._replace(
        lowest=np.asfortranarray(buffer.lowest), highest=np.repeat(buffer.highest, 2, 2)[..., ::2]
    )
    np.testing.assert_array_equal(query(columns, *rectangles), wanted)
    alone = buffer._replace(lowest=np.empty((0, 0, 0)))
    np.testing.assert_array_equal(query(alone, *rectangles).highest, wanted.highest)


@pytest.mark.parametrize("change", [{"width": 10}, {"lowest": np.ones((1, 20, 30))}, {"highest": np.ones((6, 20, 29))}])
def test_levels_that_do_not_fit_are_named(change):
    with pytest.raises(InputError, match="nbuffer: got levels of shape"):
        query(n_buffer(made_up((20, 30)))._replace(**change), [0], [0], [1], [1])


@tile_kernel
def answers_of_kernels(lowest, highest, block, rectangles, out):
    for k in range(len(rectangles)):
        x0, y0, x1, y1 = rectangles[k, 0], rectangles[k, 1], rectangles[k, 2], rectangles[k, 3]
        out[k, 0] = lowest_in(lowest, block, x0, y0, x1, y1, False)
        out[k, 1] = highest_in(highest, block, x0, y0, x1, y1, False)


@pytest.mark.parametrize("block", [1, 2, 4])
def test_kernels_miss_no_pixel_of_any_rectangle(block):
    # Every rectangle of a small picture of numbers in any order.
    depth = np.random.default_rng(11).permutation(7 * 6).reshape(6, 7).astype(np.float64)
    buffer = n_buffer(depth, block=block)
    rectangles = np.array(
        [(x0, y0, x1, y1) for x0 in range(7) for x1 in range(x0, 7) for y0 in range(6) for y1 in range(y0, 6)]
    )
    out = np.empty((len(rectangles), 2))
    answers_of_kernels(buffer.lowest, buffer.highest, block, rectangles, out)
    parts = [depth[y0 : y1 + 1, x0 : x1 + 1] for x0, y0, x1, y1 in rectangles]
    # Squares may reach past a rectangle, but not past the picture, and never fall short of it.
    assert (out[:, 0] <= [part.min() for part in parts]).all()
    assert (out[:, 1] >= [part.max() for part in parts]).all()
    if block == 1:  # as the array's door answers
        answer = query(buffer, *rectangles.T)
        np.testing.assert_array_equal(out, np.stack([answer.lowest, answer.highest], axis=1))


@pytest.mark.parametrize(("levels", "covers"), [(1, False), (2, True), (3, True)])
def test_two_by_two_squares_cover_what_is_twice_as_wide(levels, covers):
    # A rectangle of 4 x 3 needs squares of 2 pixels, those of the second level.
    rectangle = Rectangles(*(np.array([at]) for at in (1, 2, 4, 4)))
    assert _four_squares(rectangle, (levels, 8, 9), False, np.zeros((3, 1), np.int64)) == (True, covers)
