"""Bounds at ties: every choice of a few taps tried out, float32 shaders inside, and faults of one tap outside."""

import itertools
import math

import numpy as np
import pytest

from refdof import InputError
from refdof.methods.singlepass import Params, blur, bounds, spiral
from refdof.stages import Bounds
from tests.methods.singlepass import naive, shader32
from tests.methods.singlepass.test_params import picture

pytestmark = pytest.mark.fast

# Values in 0 .. 1; see tests/gl/test_singlepass_gl.py.
TOLERANCE = 2e-5
ROWS = slice(3, None, 24)  # of the large picture, with noise among them: all columns of ten rows


def outside(image, found):
    """How far each pixel is outside of the bounds, over all channels."""
    return np.maximum(found.low - image, image - found.high).max(axis=-1)


def tied(taps, epsilon):
    """Numbers of the taps beside a border, and the nudges that reach all texels near them."""
    nudges = {}
    for k, place in enumerate(taps[:, :2]):
        near = [abs(c + 0.5 - round(c + 0.5)) <= epsilon for c in place]
        if any(near):
            steps = [(-epsilon, epsilon) if yes else (0.0,) for yes in near]
            nudges[k] = list(itertools.product(*steps))
    return nudges


def all_choices(images, params, epsilon, **use):
    """Least and greatest of the naive loop over every choice at every tie: (H, W, 3) each, and how many there are."""
    taps = spiral(params)
    places = tied(taps, epsilon)
    results = []
    for choice in itertools.product(*places.values()):
        nudges = [(0.0, 0.0)] * len(taps)
        for k, nudge in zip(places, choice, strict=True):
            nudges[k] = nudge
        image = np.empty_like(images[0])
        for y, x in np.ndindex(images[1].shape):
            last = naive.taps_at(x, y, *images, "nearest", nudges=nudges, **use)[-1]
            image[y, x] = last["total_color"] / last["total"]
        results.append(image)
    return np.min(results, axis=0), np.max(results, axis=0), len(results)


def test_bounds_are_met_by_some_choice_and_passed_by_none():
    use, epsilon = {"max_taps": 16}, 0.12  # not the bound, which would be tied, too
    images = picture(height=4, width=5)
    low, high, count = all_choices(images, Params(**use), epsilon, **use)
    assert count >= 32
    found = bounds(*images, Params(**use), epsilon)
    np.testing.assert_allclose(found.low, low, rtol=0, atol=1e-13)  # a dozen roundings of numbers up to 4
    np.testing.assert_allclose(found.high, high, rtol=0, atol=1e-13)
    assert np.array_equal(found.ambiguity, (found.high > found.low).any(axis=-1))
    assert found.ambiguity.mean() > 0.2


def test_colour_at_nearest_texels_has_ties_of_its_own():
    use, epsilon = {"max_taps": 12, "color_filter": "nearest"}, 0.1
    images = picture(height=4, width=5)
    low, high, _ = all_choices(images, Params(**use), epsilon, **use)  # colour and depth from one place
    found = bounds(*images, Params(**use), epsilon)
    assert (found.low <= low + 1e-13).all()
    assert (found.high >= high - 1e-13).all()
    assert np.abs(found.low - low).max() < 0.5 * np.abs(high - low).max()  # not much wider


def test_without_ties_both_bounds_are_the_picture():
    images = picture()
    for depth_filter in ("nearest", "bilinear", "bilinear_depth"):
        params = Params(depth_filter, radius_start=0.61, angle_start=0.3, loop_bound=6.0)
        found = bounds(*images, params, 0.0, 0.0) if depth_filter == "nearest" else bounds(*images, params)
        assert not found.ambiguity.any()
        assert np.array_equal(found.low, found.high)
        np.testing.assert_allclose(found.low, blur(*images, params), rtol=0, atol=1e-12)


def test_the_first_tap_by_hand():
    # On the border of the middle texel, of circle 0, and of the right one, of circle 1: a weight of 0, or of
    # smoothstep(0, 1, 1), of half the right one's white.
    color = np.zeros((1, 3, 3))
    color[0, 2] = 1.0
    coc = np.array([[0.0, 0.0, 1.0]])
    found = bounds(color, np.ones((1, 3)), coc, Params(max_taps=1))
    assert found.low[0, 1].tolist() == [0.0] * 3
    assert found.high[0, 1].tolist() == [0.25] * 3
    assert found.ambiguity.tolist() == [[False, True, False]]


def test_an_order_by_a_hair_may_be_either():
    # From behind or not: the tap's 4 px are cut at twice the sharp pixel's 0 px, or cover it in full.
    color, coc = np.zeros((1, 3, 3)), np.array([[4.0, 0.0, 4.0]])
    color[0, 2] = 1.0
    params = Params(max_taps=1, radius_start=1.0)
    for nearer, low, high in (
        (1e-7, 0.0, 0.5),
        (-1e-7, 0.0, 0.5),
        (1e-3, 0.0, 0.0),
        (-1e-3, 0.5, 0.5),
        (0.0, 0.5, 0.5),
    ):
        depth = np.array([[1.0, 1.0, 1.0 + nearer]])
        found = bounds(color, depth, coc, params)
        assert found.low[0, 1, 0] == low
        assert found.high[0, 1, 0] == high
    # A blend of equal depths may round.
    found = bounds(color, np.ones((1, 3)), coc, Params("bilinear", max_taps=1, radius_start=1.0))
    assert (found.low[0, 1, 0], found.high[0, 1, 0]) == (0.0, 0.5)


def test_a_bound_that_a_radius_meets_may_end_the_loop_or_not():
    images = picture()
    radius = spiral()[:, 2]
    found = bounds(*images, Params(loop_bound=radius[9]), hair=0.0)
    for taps in (9, 10):
        one = bounds(*images, Params(max_taps=taps), hair=0.0)
        assert (found.low <= one.low).all()
        assert (found.high >= one.high).all()
    assert found.ambiguity.mean() > 0.5
    assert not bounds(*images, Params(loop_bound=radius[9] + 0.01), 0.0, 0.0).ambiguity.any()


def test_a_shifted_pixel_may_be_another_one():
    images = picture()
    found = bounds(*images, Params(shift_x=0.5, max_taps=20))
    for shift in (0.4999, 0.5001):
        image = blur(*images, Params(shift_x=shift, max_taps=20))
        assert outside(image, found).max() < 1e-2  # colour moves by 1e-4 texels of up to 4


@pytest.fixture(scope="module")
def frame():
    """317 x 239: cards and noise, near, sharp and far, circles of a lens up to 20 px; colours in 0 .. 1."""
    random = np.random.default_rng(3)
    y, x = np.indices((239, 317))
    depth = np.where(x % 71 < 30, 1.0, np.where(y % 53 < 25, 4.0, 2.0 + 0.01 * x))
    depth = np.where(y % 48 >= 24, random.uniform(1.0, 9.0, depth.shape), depth)
    coc = 22.0 - 44.0 / depth
    color = random.random((239, 317, 3)) * (random.random((239, 317, 1)) < 0.3)
    return tuple(image.astype(np.float32) for image in (color, depth, coc))


@pytest.fixture(scope="module")
def found(frame):
    return Bounds(*(part[ROWS] for part in bounds(*frame)))


@pytest.mark.long
@pytest.mark.parametrize("divided", [False, True])
def test_shaders_in_float32_are_inside(frame, found, divided):
    image = shader32.listing(*frame, divided, rows=ROWS)
    assert outside(image, found).max() <= TOLERANCE
    # One picture alone refuses them: at the first tap some columns read another texel.
    alone = bounds(*frame, epsilon=0.0, hair=0.0)  # the picture itself, without running the kernel interpreted
    assert np.array_equal(alone.low, alone.high)
    off = np.abs(image - alone.low[ROWS]).max(axis=-1)
    assert off.max() > 100 * TOLERANCE
    assert off[~found.ambiguity].max() <= TOLERANCE
    assert 0.01 < found.ambiguity.mean() < 0.5


@pytest.mark.parametrize(
    "fault",
    [(0, "skip"), (60, "skip"), (397, "skip"), (1, "twice"), (200, "twice"), (3, (1, 0)), (390, (0, -1))],
)
def test_a_fault_of_one_tap_is_outside(frame, found, fault):
    image = shader32.listing(*frame, faults=[fault], rows=ROWS)
    assert (outside(image, found) > 5 * TOLERANCE).sum() > 10  # pixels, by far


@pytest.mark.parametrize("value", [-1e-9, 0.26, math.nan, "wide", None])
@pytest.mark.parametrize("argument", ["epsilon", "hair"])
def test_bad_numbers_are_named(argument, value):
    with pytest.raises(InputError, match=f"^{argument}: got "):
        bounds(*picture(), **{argument: value})
