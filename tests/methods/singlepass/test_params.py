"""Params of the single pass: every field against the naive loop, and the difference that it makes."""

import math

import numpy as np
import pytest

from refdof import InputError
from refdof.methods import singlepass
from refdof.methods.singlepass import Params, blur, spiral
from tests.methods.singlepass import naive

pytestmark = pytest.mark.fast

SHORT = {"loop_bound": 6.0}  # 36 taps: enough for every rule, and quick
CHANGES = [
    {"rad_scale": 1.0},
    {"rad_scale": 3.0},
    {"max_blur_size": 2.0, "loop_bound": 6.0},
    {"max_blur_size": 1e6},
    {"behind_factor": 1.0},
    {"behind_factor": 0.0},
    {"angle_start": 2.39996323},
    {"angle_step": 2.39006323},
    {"radius_start": 1.0},
    {"loop_bound": 4.0},
    {"max_taps": 7},
    {"row_order": "up"},
    {"scale_x": 0.75},
    {"scale_y": -1.5},
    {"shift_x": 0.5},
    {"shift_y": -0.25},
    {"color_filter": "nearest"},
    {"order": "size"},
    {"order": "always"},
    {"border": "repeat"},
    {"border": "mirror"},
    {"precision": "float32"},
]


def name_of(changes):
    return ",".join(f"{name}={value}" for name, value in changes.items())


def circle_of(depth):
    """A lens's circle [px]: 6 px at infinity, sharp at 2."""
    with np.errstate(divide="ignore"):
        return 6.0 - 12.0 / depth


def picture(dtype=np.float64, height=8, width=11):
    """Bright and dark, near and far without order; circles of both signs."""
    random = np.random.default_rng(5)
    color = random.random((height, width, 3)) * 4.0
    depth = random.uniform(0.8, 9.0, (height, width)).astype(dtype)
    depth[:, :3] = np.round(depth[:, :3])
    return color.astype(dtype), depth, circle_of(depth).astype(dtype)


@pytest.mark.long
@pytest.mark.parametrize("depth_filter", ["nearest", "bilinear"])
@pytest.mark.parametrize("changes", CHANGES, ids=name_of)
def test_every_bit_of_every_field_is_the_naive_loops(changes, depth_filter):
    use = {**SHORT, **changes}
    color, depth, coc = picture(np.float32)
    image = blur(color, depth, coc, Params(depth_filter, **use))
    assert np.array_equal(image, naive.single_pass(color, depth, coc, depth_filter, **use))


@pytest.mark.long
@pytest.mark.parametrize("changes", [{}, *CHANGES], ids=name_of)
def test_depth_blended_as_a_texture_of_linear_depth(changes):
    use = {**SHORT, **changes}
    color, depth, coc = picture()
    image = blur(color, depth, coc, Params("bilinear_depth", **use))
    twin = naive.single_pass(color, depth, coc, "bilinear_depth", circle_of, **use)
    # The line through two pixels of the picture has slope and start to a few roundings of numbers near 12, and a size
    # moves smoothstep by 1.5 times as much.
    np.testing.assert_allclose(image, twin, rtol=0, atol=1e-12)


# A lens's circles are in the order of depths, and none is beyond the listing's largest: the two tests after the next.
@pytest.mark.parametrize(
    "changes", [c for c in CHANGES if c not in ({"order": "size"}, {"max_blur_size": 1e6})], ids=name_of
)
def test_every_field_makes_a_difference(changes):
    use = {**SHORT, **changes}
    images = picture()
    difference = np.abs(blur(*images, Params(**use)) - blur(*images, Params(**SHORT))).max()
    # Angles added up in single precision are 1e-6 rad off after 36 taps; all others move whole taps.
    assert difference > (1e-9 if "precision" in changes else 1e-3)


def test_signed_sizes_are_in_another_order_than_depths_where_they_are_not_a_lenss():
    color, depth, coc = picture()
    depth, size = (blur(color, depth, -coc, Params(order=order)) for order in ("depth", "size"))
    assert np.abs(depth - size).max() > 0.01


@pytest.mark.long
def test_sizes_that_are_not_cut_hold_less_back():
    color, depth, coc = picture()
    cut, whole = (blur(color, depth, 9.0 * coc, Params(max_blur_size=s, loop_bound=40.0)) for s in (20.0, 1e6))
    assert np.abs(cut - whole).max() > 0.01


@pytest.mark.parametrize("depth_filter", ["bilinear", "bilinear_depth"])
def test_every_depth_filter_makes_a_difference(depth_filter):
    images = picture()
    assert np.abs(blur(*images, Params(depth_filter)) - blur(*images)).max() > 0.01


def test_blends_of_depth_and_of_inverse_depth_by_hand():
    # Texels of depth 1 and 3, and circles of 1 - 1 / depth. The right one has one tap, half a pixel to the left: depth
    # 2 and circle 1/2, or inverse depth 2/3 and circle 1/3. It is nearer than the pixel, so that nothing is held back.
    color = np.zeros((1, 2, 3))
    color[0, 0] = 1.0
    depth = np.array([[1.0, 3.0]])
    coc = 1.0 - 1.0 / depth
    one = {"max_taps": 1, "angle_start": math.pi}  # half a pixel to the left
    # The nearest texel of a tap on a border is the right one: the pixel itself, of circle 2/3.
    for depth_filter, circle in (("bilinear", 1.0 / 3.0), ("bilinear_depth", 1.0 / 2.0), ("nearest", 2.0 / 3.0)):
        image = blur(color, depth, coc, Params(depth_filter, **one))
        m = circle * circle * (3.0 - 2.0 * circle)  # smoothstep(0, 1, circle)
        # The mean of black, and of half white by m.
        np.testing.assert_allclose(image[0, 1], 0.5 * m * 0.5, rtol=1e-14)


def test_a_blend_of_depth_with_the_background_is_the_background():
    color = np.random.default_rng(2).random((7, 9, 3))
    depth = np.where(np.arange(9) < 4, 1.0, np.inf) * np.ones((7, 1))
    coc = circle_of(depth)
    image = blur(color, depth, coc, Params("bilinear_depth"))
    assert np.isfinite(image).all()
    far = blur(color, np.minimum(depth, 1e12), circle_of(np.minimum(depth, 1e12)), Params("bilinear_depth"))
    np.testing.assert_allclose(image, far, rtol=0, atol=1e-6)  # the far one's circles within a texel's 1e-7 of a side


def test_depths_of_any_unit_give_the_same_blends():
    color, depth, coc = picture()
    expected = blur(color, depth, coc, Params("bilinear_depth"))
    for exponent in (-900, 100, 900):
        assert np.array_equal(blur(color, np.ldexp(depth, exponent), coc, Params("bilinear_depth")), expected)


def test_rows_from_below_are_the_picture_turned_over():
    # No tap lies on a border between two rows; weights of rows change places, which rounds anew.
    images = picture()
    over = [np.ascontiguousarray(image[::-1]) for image in images]
    np.testing.assert_allclose(blur(*over, Params(row_order="up"))[::-1], blur(*images), rtol=0, atol=1e-12)


def test_spirals_by_hand():
    assert spiral(Params(max_taps=0)).shape == (0, 3)
    assert spiral(Params(radius_start=30.0)).shape == (0, 3)
    up = spiral(Params(row_order="up"))
    np.testing.assert_array_equal(up, spiral() * (1.0, -1.0, 1.0))
    first, second = spiral(Params(rad_scale=2.0, max_taps=2, angle_start=math.pi / 2, angle_step=math.pi / 2))
    np.testing.assert_allclose(first, (0.0, 2.0, 2.0), rtol=0, atol=1e-15)  # down
    np.testing.assert_allclose(second, (-3.0, 0.0, 3.0), rtol=0, atol=1e-15)  # left
    assert len(spiral(Params(rad_scale=1.0))) == pytest.approx(20.0**2 / 2.0, rel=0.02)  # r^2 grows by 2 and a bit
    assert len(spiral(Params(max_blur_size=6.0))) == len(spiral(Params(loop_bound=6.0)))


def test_angles_in_single_precision_go_astray_with_many_taps():
    near, far = (
        np.abs(spiral(Params(rad_scale=s, precision="float32")) - spiral(Params(rad_scale=s))).max() for s in (0.5, 0.1)
    )
    assert near < 0.0007
    assert far > 0.1  # px


def test_no_tap_changes_nothing():
    images = picture()
    assert np.array_equal(blur(*images, Params(max_taps=0)), images[0])


@pytest.mark.parametrize("value", [0.0, 1e-9, -1.0, math.nan, math.inf, "much", True, None, 1e9])
@pytest.mark.parametrize("field", ["rad_scale", "max_blur_size"])
def test_bad_numbers_are_named(field, value):
    with pytest.raises(InputError, match=f"^{field}: got "):
        Params(**{field: value})


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"color_filter": "cubic"}, "color_filter: got 'cubic'; allowed are bilinear, nearest"),
        ({"row_order": "dwn"}, "row_order: got 'dwn'; did you mean 'down'"),
        ({"order": "depht"}, "order: got 'depht'; did you mean 'depth'"),
        ({"border": "wrap"}, "border: got 'wrap'; .*allowed are clamp, repeat, mirror"),
        ({"precision": "half"}, "precision: got 'half'; allowed are float64, float32"),
        ({"max_taps": 1.5}, "max_taps: got 1.5; allowed is a whole number in 0 .. 65536"),
        ({"rad_scale": 0.001}, "rad_scale: got 0.001, up to 200000 taps within 20 px; allowed are at most 65536"),
        ({"max_blur_size": 300.0}, "max_blur_size: got 300; allowed without a loop_bound is at most 256"),
        ({"behind_factor": -1.0}, "behind_factor: got -1"),
        ({"radius_start": 0.0}, "radius_start: got 0"),
        ({"loop_bound": 257.0}, "loop_bound: got 257"),
        ({"scale_x": 4.5}, "scale_x: got 4.5"),
        ({"shift_y": math.inf}, "shift_y: got inf"),
        ({"angle_step": "golden"}, "angle_step: got 'golden'"),
    ],
)
def test_bad_values_are_named(values, words):
    with pytest.raises(InputError, match=f"^{words}"):
        Params(**values)


def test_blends_of_depth_need_circles_of_a_lens():
    color, depth, _ = picture()
    coc = np.random.default_rng(0).uniform(-4.0, 4.0, depth.shape)
    with pytest.raises(InputError, match=r"^coc: is up to .* px from a line over 1 / depth"):
        blur(color, depth, coc, Params("bilinear_depth"))
    even = np.full_like(depth, 2.0)
    with pytest.raises(InputError, match=r"^coc: is up to"):
        blur(color, even, coc, Params("bilinear_depth"))
    assert np.isfinite(blur(color, even, np.full_like(coc, 3.0), Params("bilinear_depth"))).all()


def test_texture_reads_follow_the_loop():
    assert singlepass.texture_reads(Params(max_taps=7), 4, 4) == 14.0
