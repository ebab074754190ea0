"""Poisson disc, separable and pyramidal filters: their twins, counted reads, hand numbers, and what they promise."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

import refdof
from refdof import InputError, ThinLens, View
from refdof.methods import METHODS, poisson, pyramidal, scatter, separable
from refdof.methods.pyramidal.pyramid import blurred, filled, level_count
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.methods import naive_baselines

pytestmark = pytest.mark.fast

NAMES = ("poisson", "pyramidal", "separable")
SIZES = [(1, 1), (1, 7), (13, 1), (3, 2), (8, 8), (7, 11)]
ROUNDING = 1e-13  # numbers up to 1, hundreds of roundings in float64


def images(seed, height, width, largest=7.0):
    """Colour, depth and circles that belong together, both signs, and background."""
    random = np.random.default_rng(seed)
    coc = random.uniform(-largest, largest, (height, width))
    coc[random.random(coc.shape) < 0.2] = 0.0
    coc.flat[0], coc.flat[-1] = largest, -largest
    depth = 1.0 / (0.5 - 0.4 * coc / largest)
    return random.random((height, width, 3)), depth, coc


@pytest.mark.parametrize("choice", [{}, {"code": "thin_lens"}, {"code": "thin_lens", "max_radius": 9.0}])
@pytest.mark.parametrize("size", SIZES)
def test_poisson_is_the_shader(size, choice):
    color, depth, coc = images(1, *size)
    params = poisson.Params(**choice)
    picture, reads = naive_baselines.poisson(color, poisson.code_of(depth, coc, params), params.max_radius)
    np.testing.assert_allclose(poisson.blur(color, depth, coc, params), picture, rtol=0, atol=ROUNDING)
    assert poisson.texture_reads(params, size[1], size[0]) * depth.size == pytest.approx(reads, rel=1e-12)


@pytest.mark.parametrize("leakage", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("size", SIZES)
def test_separable_is_its_two_passes(size, leakage):
    color, depth, coc = images(2, *size)
    params = separable.Params(leakage)
    picture, reads = naive_baselines.separable(color, depth, coc, leakage)
    np.testing.assert_allclose(separable.blur(color, depth, coc, params), picture, rtol=0, atol=ROUNDING)
    units = separable.texture_reads(params, size[1], size[0], mean=np.ceil(np.abs(coc)).mean())
    assert units * depth.size == pytest.approx(reads, rel=1e-12)


@pytest.mark.parametrize("largest_side", [1, 8])
@pytest.mark.parametrize("size", SIZES)
def test_pyramidal_is_its_sub_images(size, largest_side):
    color, depth, coc = images(3, *size)
    params = pyramidal.Params(largest_side)
    picture, reads = naive_baselines.pyramidal(color, coc, largest_side)
    np.testing.assert_allclose(pyramidal.blur(color, depth, coc, params), picture, rtol=0, atol=ROUNDING)
    if size != (1, 1):  # one pixel has one side only; units are of both
        units = pyramidal.texture_reads(params, size[1], size[0], largest=7.0)
        assert units * depth.size == pytest.approx(reads, rel=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", NAMES)
def test_constant_colour_stays(name, dtype):
    _, depth, coc = images(4, 13, 17)
    color = np.broadcast_to(np.array([0.1, 0.7, 30.0], dtype=dtype), (13, 17, 3))
    image = METHODS[name].blur(color, depth, coc)
    assert image.dtype == dtype
    np.testing.assert_allclose(image, color, rtol=100 * np.finfo(dtype).eps)  # 100 roundings of sums and shares


@pytest.mark.parametrize("name", NAMES)
def test_no_blur_changes_nothing(name):
    color, depth, coc = images(5, 9, 10)
    np.testing.assert_allclose(METHODS[name].blur(color, depth, 0 * coc), color, rtol=1e-14)


@settings(max_examples=10, deadline=None)
@given(st.integers(1, 8), st.integers(1, 8), st.sampled_from(NAMES), st.integers(0, 10**6))
def test_every_pixel_is_a_mean_of_the_picture(height, width, name, seed):
    color, depth, coc = images(seed, height, width)
    image = METHODS[name].blur(color, depth, coc)
    assert (image >= color.min(axis=(0, 1)) - ROUNDING).all()
    assert (image <= color.max(axis=(0, 1)) + ROUNDING).all()


@pytest.mark.parametrize("name", ["pyramidal", "separable"])
def test_mirrored_picture_gives_the_mirrored_result(name):
    color, depth, coc = images(6, 8, 16)  # pyramids start at the left: powers of two
    image = METHODS[name].blur(color, depth, coc)
    mirrored = METHODS[name].blur(color[:, ::-1], depth[:, ::-1], coc[:, ::-1])
    np.testing.assert_allclose(mirrored[:, ::-1], image, rtol=0, atol=ROUNDING)


def test_blur_codes_by_hand():
    depth = np.array([[1.0, 2.0, 3.0, 5.0, np.inf]])
    coc = 6.0 * (1 / 3 - 1 / depth)  # focus at 3: -4, -1, 0, 0.8, 2 px
    code = poisson.code_of(depth, coc, poisson.Params())
    np.testing.assert_allclose(code, [[0.0, 0.25, 0.5, 1.0, 1.0]], rtol=0, atol=1e-14)
    code = poisson.code_of(depth, coc, poisson.Params(code="thin_lens", max_radius=2.0))
    np.testing.assert_allclose(code, [[0.0, 0.25, 0.5, 0.7, 1.0]], rtol=0, atol=1e-14)


@pytest.mark.parametrize(("circle", "code"), [(-2.0, 0.0), (0.0, 0.5), (2.0, 1.0)])
def test_blur_code_of_a_flat_scene(circle, code):
    flat = np.full((2, 3), 7.0)
    assert np.array_equal(poisson.code_of(flat, np.full((2, 3), circle), poisson.Params()), np.full((2, 3), code))


def test_codes_differ_in_what_they_blur():
    color, depth, coc = images(7, 16, 16)
    linear, lens = (poisson.blur(color, depth, coc, poisson.Params(code)) for code in ("linear", "thin_lens"))
    assert np.abs(linear - lens).max() > 0.01


def test_poisson_keeps_a_pixel_whose_taps_weigh_nothing():
    # A far pixel at full blur among sharp nearer ones: no tap is as far, and each has blur 0.
    color, code = np.zeros((25, 25, 3)), np.full((25, 25), 0.5)
    color[12, 12], code[12, 12] = 1.0, 1.0
    coded = np.concatenate([color, code[..., None]], axis=-1)
    sharp = np.full((6, 6, 4), 0.5)
    image = poisson.gather(coded, sharp, poisson.TAPS * 2.0, 5.0)  # taps clear of the pixel's own texel
    assert np.array_equal(image[12, 12], color[12, 12])


def test_blur_code_is_linear_in_distance_on_either_side():
    # In focus at 2, from 1 to 10: 3 is an eighth of the way behind, 1.5 half the way in front.
    depth = np.array([[1.0, 1.5, 2.0, 3.0, 6.0, 10.0, np.inf]])
    code = poisson.code_of(depth, 4.0 * (0.5 - 1.0 / depth), poisson.Params())
    np.testing.assert_allclose(code, [[0.0, 0.25, 0.5, 0.5625, 0.75, 1.0, 1.0]], rtol=1e-12)


def test_poisson_counts_taps_as_blurred_as_the_centre_in_full():
    # A row whose left half has code 3/4 and is black, and whose right half has code 1/4 and is white. At the border six
    # taps fall on either side, all far from it: 60 px times 0.185 at least. The left ones are as far back as the pixel
    # and count 1, the right ones are nearer and count |2 / 4 - 1|.
    coc = np.repeat([60.0, -60.0], 256)[None]
    color = np.repeat([0.0, 1.0], 256)[None, :, None] * np.ones(3)
    image = poisson.blur(color, np.full((1, 512), 2.0), coc, poisson.Params("thin_lens", 120.0))
    np.testing.assert_allclose(image[0, 255], 3.0 / 9.0, rtol=1e-12)
    # Seen from the right, the left ones lie behind and count in full, too; so do those as blurred as the pixel.
    np.testing.assert_allclose(image[0, 256], 6.0 / 12.0, rtol=1e-12)


@pytest.mark.parametrize("circle", [2.0, 5.0])
def test_separable_even_blur_is_a_square_of_tents(circle):
    # One circle everywhere, whole: all neighbours but the outermost count alike: a box of 2 r - 1, and ends of 0.
    color = np.random.default_rng(8).random((31, 31, 3))
    image = separable.blur(color, np.ones((31, 31)), np.full((31, 31), circle))
    box = ndimage.uniform_filter(color, size=(2 * int(circle) - 1, 2 * int(circle) - 1, 1))
    np.testing.assert_allclose(image[8:-8, 8:-8], box[8:-8, 8:-8], rtol=0, atol=ROUNDING)


def test_separable_keeps_background_out_of_a_sharp_pixel():
    color, depth, coc = np.zeros((5, 20, 3)), np.full((5, 20), 2.0), np.full((5, 20), 6.0)
    color[:, 10:], depth[:, :10], coc[:, :10] = 1.0, 1.0, 0.0
    assert not separable.blur(color, depth, coc)[:, :10].any()


def test_pyramid_blur_has_the_width_of_its_levels():
    # Levels of 4 x 4 means and bilinear synthesis: variance 2 (4^n - 1) / 3 px^2, whatever the place, in the mean.
    for levels in (1, 2, 3):
        found = []
        for place in range(64, 64 + 2**levels):
            point = np.zeros((128, 128, 4))
            point[64, place] = 0.25
            row = blurred(point, levels).sum(axis=(0, 2))
            x = np.arange(128)
            found.append((row * x**2).sum() - (row * x).sum() ** 2 + ((row * x).sum() - place) ** 2)
        assert np.mean(found) == pytest.approx(2 * (4**levels - 1) / 3, rel=1e-12)


def test_filling_keeps_what_is_known():
    image = np.random.default_rng(9).random((11, 7, 4))
    known = np.random.default_rng(10).random((11, 7)) < 0.3
    full = filled(image, known)
    assert np.array_equal(full[known], image[known])
    assert (full >= image[known].min(axis=0)).all()
    assert (full <= image[known].max(axis=0)).all()
    assert not filled(image, np.zeros((11, 7), dtype=bool)).any()


@pytest.mark.parametrize(("size", "count"), [((1, 1), 0), ((2, 1), 1), ((3, 2), 2), ((1024, 768), 10), ((5, 1025), 11)])
def test_pyramids_end_at_one_texel(size, count):
    assert level_count(*size) == count


def test_pyramidal_mattes_add_up_to_two():
    circles = np.linspace(-8.0, 8.0, 321)[None]
    total = 0.0
    for i in range(-3, 4):
        layer = np.repeat(circles[..., None], 4, axis=-1)
        pyramidal.method._matte(layer, *pyramidal.method._corners(i, 3, 3))
        assert np.array_equal(layer[..., 0], circles * layer[..., 3])
        total = total + layer[..., 3]
    # In the core of one, and on the ramps of its neighbours, which add up to 1; the outermost have one neighbour, and
    # so has sub-image 0 on either side: what is in focus (circle 0) is in no other.
    inside = np.abs(circles) <= 2.55  # half-way between 1.7 and 3.4 px
    expected = 1.0 + np.minimum(np.abs(circles[inside]) / 0.85, 1.0)  # 0.85: half-way between 0 and 1.7 px
    np.testing.assert_allclose(total[inside], expected, rtol=0, atol=1e-12)
    assert (total >= 1.0 - 1e-12).all()


def test_one_blurred_pixel_leaves_what_is_in_focus_alone():
    color, depth = np.random.default_rng(12).random((30, 40, 3)), np.full((30, 40), 2.0)
    coc = np.zeros((30, 40))
    depth[25, 35], coc[25, 35] = 1.0, -1.2  # one level: texels around, 2 px to each side, and those they blend with
    image = pyramidal.blur(color, depth, coc)
    away = np.maximum(*np.abs(np.indices((30, 40)) - np.array([25, 35])[:, None, None])) > 6
    np.testing.assert_allclose(image[away], color[away], rtol=1e-14)
    assert np.abs(image - color)[~away].max() > 0.01  # a sixteenth of its colour over its neighbours


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("largest", [1e-30, 1e4, 3e38])
def test_extreme_circles_stay_finite(name, largest):
    color, depth, _ = (a.astype(np.float32) for a in images(11, 6, 7))
    coc = np.where(np.indices((6, 7)).sum(axis=0) % 2, np.float32(largest), np.float32(-largest))
    assert np.isfinite(METHODS[name].blur(color, depth, coc)).all()


@pytest.mark.parametrize("name", ["mipmap", "scatter", *NAMES])
@pytest.mark.parametrize("exponent", [-300, 0, 300])
def test_the_unit_of_length_changes_no_bit(name, exponent):
    scene = refdof.load_scene("branches")
    scaled = scene.scaled(2.0**exponent)
    image = refdof.render(name, scaled, scaled.camera.with_size((16, 12))).image
    np.testing.assert_array_equal(image, refdof.render(name, scene, scene.camera.with_size((16, 12))).image)


@pytest.mark.parametrize(
    ("name", "stages"),
    [
        ("poisson", ["coc", "code", "small"]),
        ("separable", ["coc", "across"]),
        ("pyramidal", ["coc", "sub-image 2", "sub-image 1", "sub-image 0", "sub-image -1", "sub-image -2"]),
    ],
)
def test_rendering_records_its_stages(name, stages):
    shot, lens = flat_scene.camera(24, 18, 24.0), ThinLens(0.5, 4.0)  # -3 px on the card, 3 px behind it
    view = View(
        flat_scene.scene_of([flat_scene.rectangle(-0.5, 0.5, -0.5, 0.5, 2.0, (0.8, 0.4, 0.2))], shot, lens), shot, lens
    )
    trace = StageRecorder(on=True)
    image = METHODS[name].render(view, METHODS[name].Params(), trace)
    assert list(trace.stages) == stages
    assert image.dtype == np.float32
    assert math.isfinite(image.sum())


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: poisson.Params(code="lens"), "code: got 'lens'; .*allowed are linear, thin_lens"),
        (lambda: poisson.Params(max_radius=0), "max_radius: got 0; allowed is a finite number > 0"),
        (lambda: separable.Params(leakage=-1), "leakage: got -1"),
        (lambda: pyramidal.Params(largest_side=0), "largest_side: got 0; allowed is a whole number in 1 .. 16"),
        *((lambda n=n: METHODS[n].blur(np.zeros((2, 3, 3)), np.ones((2, 3)), np.zeros(6)), "coc: got") for n in NAMES),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize("focus", [1e6, 1e12, np.inf])
def test_a_lens_focused_far_away_blurs_what_is_near(focus):
    depth = np.array([[2.0, 4.0], [2.0, 4.0]])
    coc = 100.0 * (1.0 / focus - 1.0 / depth)
    # Full blur in front is 0; the focal plane at 10^6 leaves 4 / 10^6 of it.
    np.testing.assert_allclose(poisson.code_of(depth, coc, poisson.Params()), 0.0, atol=4e-6)


@pytest.mark.parametrize("method", [scatter, separable, poisson, pyramidal])
def test_parameters_are_parameters(method):
    with pytest.raises(InputError, match="params: got NoneType; allowed is a Params"):
        method.blur(np.ones((2, 2, 3)), np.ones((2, 2)), np.zeros((2, 2)), None)
