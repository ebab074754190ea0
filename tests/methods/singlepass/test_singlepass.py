"""Single pass: the article's loop pixel by pixel, closed forms of its running mean, and hand numbers."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import refdof
from refdof import InputError, ThinLens, View
from refdof.methods import singlepass
from refdof.methods.singlepass import Params, blur, spiral
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.methods.singlepass import naive

pytestmark = pytest.mark.fast

FILTERS = ("nearest", "bilinear")
TYPES = (np.float32, np.float64)
DEVIATION = 4 * 398  # roundings in 398 steps of the mean: tap, share, sum of both, total


def images(random, height, width, dtype):
    """Colour, depth with background and an even part, and circles of confusion of both signs up to 40 px."""
    color = random.random((height, width, 3)) * 10.0 ** random.uniform(-2.0, 2.0)
    depth = random.uniform(0.5, 5.0, (height, width))
    depth[:, width // 2 :] = np.round(depth[:, width // 2 :])  # many texels of equal depth
    depth[random.random(depth.shape) < 0.2] = np.inf
    coc = random.uniform(-1.0, 1.0, (height, width)) ** 3 * 40.0
    return color.astype(dtype), depth.astype(dtype), coc.astype(dtype)


def even(value, height=3, width=3, dtype=np.float64):
    return np.full((height, width), value, dtype=dtype)


def weights(size):
    """Shares of the 398 taps in the result for one size everywhere: A' = A + m (x - A) / (t + 1), written out."""
    radius = spiral()[:, 2]
    t = np.clip(size - (radius - 0.5), 0.0, 1.0)
    share = (3.0 * t**2 - 2.0 * t**3) / (np.arange(398) + 2.0)
    kept = np.append(np.cumprod((1.0 - share)[::-1])[::-1], 1.0)  # what the taps after a tap leave of it
    return share * kept[1:], kept[0]


@pytest.mark.long
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("depth_filter", FILTERS)
@pytest.mark.parametrize("size", [(1, 1), (1, 7), (7, 1), (8, 11)])
def test_every_bit_is_the_articles_loop(size, depth_filter, dtype):
    color, depth, coc = images(np.random.default_rng(size), *size, dtype)
    image = blur(color, depth, coc, Params(depth_filter))
    assert image.dtype == dtype
    assert np.array_equal(image, naive.single_pass(color, depth, coc, depth_filter))


@pytest.mark.long
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("depth_filter", FILTERS)
def test_every_bit_of_some_pixels_of_a_larger_image(depth_filter, dtype):
    random = np.random.default_rng(7)
    color, depth, coc = images(random, 30, 40, dtype)
    image = blur(color, depth, coc, Params(depth_filter))
    corners = [(0, 0), (39, 0), (0, 29), (39, 29)]
    for x, y in corners + random.integers(0, (40, 30), (40, 2)).tolist():
        assert np.array_equal(image[y, x], naive.single_pass_at(x, y, color, depth, coc, depth_filter))


@pytest.mark.long
@pytest.mark.parametrize("depth_filter", FILTERS)
def test_every_bit_where_all_is_background(depth_filter):
    color, _, coc = images(np.random.default_rng(8), 4, 6, np.float32)
    depth = even(np.inf, 4, 6, np.float32)
    expected = naive.single_pass(color, depth, coc, depth_filter)
    assert np.array_equal(blur(color, depth, coc, Params(depth_filter)), expected)


def test_the_spiral_by_hand():
    taps = spiral()
    assert taps.shape == (398, 3)
    # 0.5, then r + 0.5 / r; the last one is known to three digits.
    np.testing.assert_allclose(taps[:3, 2], [0.5, 1.5, 1.5 + 1.0 / 3.0], rtol=1e-15)
    assert round(taps[-1, 2], 3) == 19.989
    assert taps[0].tolist() == [0.5, 0.0, 0.5]
    # The listing prints the golden angle pi (3 - sqrt 5) with nine digits: 397 steps of at most 5e-9 each.
    angle = np.arange(398) * math.pi * (3.0 - math.sqrt(5.0))
    turned = np.exp(-1j * angle) * (taps[:, 0] + 1j * taps[:, 1]) / taps[:, 2]
    np.testing.assert_allclose(turned, 1.0, rtol=0, atol=397 * 5e-9)


@pytest.mark.parametrize("radius", [3.0, 7.0, 12.0, 19.98])
def test_one_tap_per_pi_square_pixels(radius):
    # r_k^2 = 1/4 + k + sum of 1 / (4 r_i^2): radius^2 taps, less a logarithm that is below 3 up to 20 px.
    taps = (spiral()[:, 2] <= radius).sum()
    assert radius**2 - 3.0 < taps <= radius**2 + 1.0


def test_the_spiral_added_up_in_single_precision():
    radius, angle, taps = np.float32(0.5), np.float32(0.0), []
    while radius < np.float32(20.0):
        taps.append((np.cos(angle) * radius, np.sin(angle) * radius))
        angle += np.float32(2.39996323)
        radius += np.float32(0.5) / radius
    assert len(taps) == 398
    # The constant is 9e-8 short in single precision: 397 of that at 20 px are 0.0007 px. The sums' own roundings, of
    # either sign, stay below it.
    np.testing.assert_allclose(np.array(taps), spiral()[:, :2], rtol=0, atol=0.0007)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("depth_filter", FILTERS)
@pytest.mark.parametrize(
    ("size", "right"),
    [
        (0.25, 0.5 * 0.15625 / 2),  # smoothstep(0, 1, 1/4) = 3/16 - 2/64
        (0.5, 0.125),  # half of a tap that is half of the right neighbour, in a mean of two
        (1.0, 0.25),  # the whole tap; the next one, at 1.5 px, is not reached
    ],
)
def test_small_circles_by_hand(size, right, depth_filter, sign):
    # Only the first tap is reached: half a pixel to the right, on the middle between two texels.
    color = np.zeros((1, 3, 3))
    color[0, 2] = 1.0, 2.0, 4.0
    image = blur(color, even(2.0, 1), even(sign * size, 1), Params(depth_filter))
    # Shares of an eighth are exact; dividing 398 times by up to 399 and adding is not.
    np.testing.assert_allclose(image[0, 1], right * color[0, 2], rtol=DEVIATION * 2.0**-53)
    assert not image[0, 0].any()


@pytest.mark.long
@pytest.mark.parametrize("size", [0.75, 3.3, 8.0, 33.0])
def test_even_blur_is_the_weighted_mean_of_the_taps(size):
    reach = math.ceil(min(size, 20.0)) + 1
    side = 2 * reach + 1
    y, x = np.indices((side, side)) - float(reach)
    color = np.stack([x, y, x * y], axis=-1)  # bilinear interpolation is exact on these
    image = blur(color, even(2.0, side, side), even(size, side, side))
    shares, _ = weights(min(size, 20.0))
    dx, dy, _ = spiral().T
    expected = [shares @ dx, shares @ dy, shares @ (dx * dy)]
    # Numbers up to 400 in 398 steps of a few roundings each.
    np.testing.assert_allclose(image[reach, reach], expected, rtol=0, atol=DEVIATION * 400 * 2.0**-53)


def test_a_point_of_light_keeps_the_centres_share():
    color = np.zeros((17, 17, 3))
    color[8, 8] = 1.0
    image = blur(color, even(2.0, 17, 17), even(6.0, 17, 17))
    shares, center = weights(6.0)
    dx, dy, _ = spiral().T
    tent = np.maximum(1.0 - np.abs(dx), 0.0) * np.maximum(1.0 - np.abs(dy), 0.0)  # bilinear weight of the middle
    # The result is at most 1: one rounding of it per operation.
    np.testing.assert_allclose(image[8, 8], center + shares @ tent, rtol=0, atol=DEVIATION * 2.0**-53)


@pytest.mark.long
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("depth_filter", FILTERS)
def test_constant_colour_stays(depth_filter, dtype):
    _, depth, coc = images(np.random.default_rng(9), 12, 15, dtype)
    color = np.broadcast_to(np.array([0.1, 0.7, 30.0], dtype=dtype), (12, 15, 3))
    image = blur(color, depth, coc, Params(depth_filter))
    np.testing.assert_allclose(image, color, rtol=DEVIATION * np.finfo(dtype).eps / 2, atol=0)


@pytest.mark.long
@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("depth_filter", FILTERS)
def test_a_pinhole_changes_nothing_but_rounding(depth_filter, dtype):
    # smoothstep(0, 1, 0) = 0: not even the first tap counts, and 398 times the mean is added to its own sum.
    color, depth, coc = images(np.random.default_rng(10), 12, 15, dtype)
    image = blur(color, depth, np.zeros_like(coc), Params(depth_filter))
    np.testing.assert_allclose(image, color, rtol=DEVIATION * np.finfo(dtype).eps / 2, atol=0)


@pytest.mark.long
@settings(max_examples=20, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.sampled_from(FILTERS), st.integers(0, 10**6))
def test_every_pixel_is_a_mean_of_its_neighbourhood(height, width, depth_filter, seed):
    color, depth, coc = images(np.random.default_rng(seed), height, width, np.float32)
    image = blur(color, depth, coc, Params(depth_filter))
    low, high = color.min(axis=(0, 1)), color.max(axis=(0, 1))
    slack = DEVIATION * 2.0**-24 * high  # every partial sum lies below total * high and is rounded to 24 bits
    assert (image >= low - slack).all()
    assert (image <= high + slack).all()


def two_halves(near_coc, far_coc, far_depth=4.0):
    """One row after the blur: black at depth 1, and from x = 30 on white behind it. Above and below are the same."""
    near = np.arange(60) < 30
    color = np.broadcast_to(np.where(near, 0.0, 1.0)[None, :, None], (1, 60, 3))
    depth = np.broadcast_to(np.where(near, 1.0, far_depth), (1, 60))
    coc = np.broadcast_to(np.where(near, near_coc, far_coc), (1, 60))
    return blur(color, depth, coc)[0, :, 0]


def test_background_does_not_leak_onto_a_sharp_foreground():
    assert not two_halves(0.0, 15.0)[:30].any()  # 2 * 0 px: no tap from behind counts


def test_background_leaks_twice_as_far_as_the_foreground_is_blurred():
    row = two_halves(-3.0, 15.0)
    # Taps from behind count up to 2 * 3 + 0.5 px; the foreground's own reach the white one by less than that.
    assert not row[: 30 - 7].any()
    assert row[30 - 5] > 0.0
    assert row[29] > 0.1


def test_only_what_lies_behind_is_held_back():
    held, level, in_front = (two_halves(0.0, 15.0, depth) for depth in (4.0, 1.0, 0.5))
    assert not held[:30].any()
    # Even depth and nearer light: white taps count in full, sharp black ones never do, so white takes over.
    assert 0.5 < level[29] < 1.0
    np.testing.assert_array_equal(level, in_front)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"color": np.zeros((2, 3))}, "color: got shape"),
        ({"color": np.zeros((2, 3, 4))}, "color: got shape"),
        ({"color": np.zeros((0, 3, 3)), "depth": np.zeros((0, 3)), "coc": np.zeros((0, 3))}, "color: got shape"),
        ({"color": np.zeros((2, 0, 3)), "depth": np.zeros((2, 0)), "coc": np.zeros((2, 0))}, "color: got shape"),
        ({"color": np.full((2, 3, 3), np.nan)}, "color: has 18 NaN"),
        ({"color": np.full((2, 3, 3), np.inf)}, "color: has 18 infinite"),
        ({"color": "red"}, "color: got an array of <U3, shape"),
        ({"depth": np.ones((3, 2))}, "depth: got shape"),
        ({"depth": even(np.nan, 2)}, "depth: has 6 NaN"),
        ({"depth": even(0.0, 2)}, "depth: smallest value is 0"),
        ({"depth": even(-2.0, 2)}, "depth: smallest value is -2"),
        ({"depth": even(-np.inf, 2)}, "depth: smallest value is -inf"),
        ({"coc": np.zeros((2, 4))}, "coc: got shape"),
        ({"coc": even(np.nan, 2)}, "coc: has 6 NaN"),
        ({"coc": even(np.inf, 2)}, "coc: has 6 infinite"),
    ],
)
def test_bad_images_are_named(change, words):
    good = {"color": np.zeros((2, 3, 3)), "depth": even(1.0, 2), "coc": even(0.0, 2)}
    with pytest.raises(InputError, match=words):
        blur(**{**good, **change})


def test_a_bad_filter_is_named():
    with pytest.raises(InputError, match=r"depth_filter: got 'linear'; .*allowed are nearest, bilinear"):
        Params("linear")


@pytest.mark.long
def test_rendering_blurs_the_pinhole_and_shows_its_stages():
    shot = flat_scene.camera(24, 18, 24.0)
    card = flat_scene.rectangle(-0.5, 0.5, -0.5, 0.5, 2.0, (0.8, 0.4, 0.2))
    lens = ThinLens(0.5, 4.0)  # 24 * 0.5 * (1/4 - 1/2) = -3 px on the card, 24 * 0.5 / 4 = 3 px behind it
    view = View(flat_scene.scene_of([card], shot, lens, (0.1, 0.2, 0.3)), shot, lens)
    trace = StageRecorder(on=True)
    image = singlepass.render(view, Params(), trace)
    on_card = np.zeros((18, 24), dtype=bool)
    on_card[3:15, 6:18] = True  # 24 px per unit at depth 1: the card spans 12 px in the middle
    color = np.where(on_card[..., None], [0.8, 0.4, 0.2], [0.1, 0.2, 0.3]).astype(np.float32)
    depth, coc = np.where(on_card, 2.0, np.inf), np.where(on_card, -3.0, 3.0)
    # 1e-6 px: the trip through the camera's angle, a few roundings of numbers near 1.
    np.testing.assert_allclose(trace.stages["coc"], coc, rtol=0, atol=1e-6)
    np.testing.assert_allclose(trace.stages["size"], 3.0, rtol=0, atol=1e-6)
    assert np.array_equal(trace.stages["taps"], spiral())
    assert image.dtype == np.float32
    # 1e-5: slope 1.5 of smoothstep times a size that is 1e-6 px off, and single precision's roundings.
    np.testing.assert_allclose(image, blur(color, depth, coc), rtol=0, atol=1e-5)


def test_depths_one_rounding_apart_keep_their_order():
    color = np.random.default_rng(0).random((5, 5, 3), dtype=np.float32)
    depth = np.full((5, 5), 1.9, dtype=np.float32)
    depth[2, 2] = np.nextafter(depth[2, 2], np.float32(0))  # 1 / depth is the same number
    coc = np.full((5, 5), 10, dtype=np.float32)
    coc[2, 2] = 0
    out = blur(color, depth, coc, Params())
    np.testing.assert_allclose(out[2, 2], color[2, 2], rtol=1e-4)  # 398 roundings: nothing from behind comes in


@pytest.mark.long
@pytest.mark.parametrize("exponent", [-300, -160, -140, 0, 125, 140, 300])
def test_the_unit_of_length_changes_no_bit(exponent):
    scene = refdof.load_scene("branches")
    camera = scene.camera.with_size((20, 15))
    expected = refdof.render("singlepass", scene, camera).image
    scaled = scene.scaled(2.0**exponent)
    image = refdof.render("singlepass", scaled, scaled.camera.with_size((20, 15))).image
    np.testing.assert_array_equal(image, expected)


@pytest.mark.parametrize("depth_filter", ["nearest", "bilinear"])
def test_extreme_circles_and_depths_stay_finite(depth_filter):
    color = np.random.default_rng(1).random((6, 7, 3), dtype=np.float32)
    coc = np.where(np.indices((6, 7)).sum(axis=0) % 2, np.float32(3e38), np.float32(-3e38))
    depth = np.full((6, 7), 1e-39, dtype=np.float32)
    assert np.isfinite(blur(color, depth, coc, Params(depth_filter))).all()
