"""Bug threads about degenerate lenses, and about NaN, infinity and great values: docs/threads.md, parts 2 and 3."""

import math
from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Frame, InputError, Part, ThinLens, metrics, render
from refdof.image.display import display
from refdof.methods.mipmap.method import _last_level
from refdof.methods.multiview.fields import fields_of
from refdof.optics.systems.system_lens import SystemLens
from refdof.optics.systems.trace import trace
from refdof.raster.gpu.gpu_model import LLVMPIPE, store
from tests import flat_scene
from tests.methods.scatter.discs import covered
from tests.optics.systems.lenses import double_gauss, singlet
from tests.threads.pictures import CAMERA, FILTERS, LENS, even, filtered, noise, point, wall

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)


def test_bevy_21816_focus_within_the_focal_length():
    for focus in (0.05, 0.04, 1e-3):
        with pytest.raises(InputError, match=r"focus_distance: got .*; allowed is a distance above the focal length"):
            ThinLens.from_f_number(0.05, 2.0, focus)
    just = ThinLens.from_f_number(0.05, 2.0, 0.0501)
    assert just.coc_px(np.array([np.inf]), CAMERA)[0] == pytest.approx(100.0 * 0.0125 / 0.0501, rel=1e-14)


def test_deeplens_65_focus_one_rounding_from_the_focal_length():
    for beside in (0.05, math.nextafter(0.05, 0.0)):
        with pytest.raises(InputError, match="focus_distance: "):
            ThinLens.from_f_number(0.05, 2.0, beside)
    lens = ThinLens.from_f_number(0.05, 2.0, math.nextafter(0.05, 1.0))
    assert_allclose(lens.coc_px(np.array([0.025, 0.05, 0.1]), CAMERA), [-25.0, 0.0, 12.5], atol=1e-12)


def test_pbrt_v3_122_focus_too_near_for_a_real_lens():
    allowed = r"more than [\d.]+ scene units of 1000 mm"
    with pytest.raises(InputError, match=rf"focus_distance: got 0\.01; allowed is {allowed}"):
        SystemLens(double_gauss(), 0.01)


def test_pbrt_v3_123_small_and_large_apertures_near_and_far():
    for radius in (1e-6, 1e-2, 1.0, 1e3):
        for focus in (1e-3, 1.0, 1e6):
            depth = np.array([focus / 3.0, focus * (1.0 + 1e-9), focus * 7.0])
            scale = Fraction(CAMERA.pixels_per_tangent) * Fraction(radius)
            exact = [float(scale * (1 / Fraction(focus) - 1 / Fraction(d))) for d in depth]
            assert_allclose(ThinLens(radius, focus).coc_px(depth, CAMERA), exact, rtol=1e-15)


def test_pbrt_v3_92_rays_that_start_inside_the_lens():
    # A ray is a line: begun in front of the lens, at its vertex or behind all of it, it leaves the lens the same way.
    lens, slope = singlet(), np.array([0.01, 0.02, 1.0])
    starts = np.stack([np.array([1.0, 2.0, 0.0]) + slope * z for z in (-50.0, 0.0, 3.0, 40.0)])
    found = trace(lens, starts, np.tile(slope, (4, 1)), 0.5876)
    assert found.passed.all()
    assert_allclose(found.origins - found.origins[0], 0.0, atol=1e-12)
    assert_allclose(found.directions - found.directions[0], 0.0, atol=1e-14)
    assert found.directions[0, 0] < 0.0  # bent towards the axis


def test_btoa_86_focus_at_zero():
    for focus in (0.0, -1.0, math.nan):
        with pytest.raises(InputError, match="focus_distance: "):
            ThinLens(0.1, focus)


@EACH
def test_unity_graphics_1407_all_in_focus_is_the_picture(name):
    color, depth = noise((7, 9)), np.random.default_rng(1).uniform(1.0, 9.0, (7, 9))
    # Circles of 0: every tap but the pixel itself is left out. The running mean of 398 equal terms rounds.
    assert_allclose(filtered(name, color, depth, np.zeros((7, 9))), color, rtol=1e-13)


@pytest.mark.parametrize("rows", [7, 27, 108])
def test_unity_graphics_3131_reach_follows_the_resolution(rows):
    # Circles of 0.3 rows at every size: windows and mip levels reach as far at each.
    circle, size = 0.3 * rows, (rows, rows)
    layers = np.full((1, *size), circle, dtype=np.float32)
    fields = fields_of(layers, np.float32([circle]), np.float32([circle]), 1.0)
    assert circle <= fields.reach[0] - 1
    assert fields.reach[0] <= circle + 3  # the wall, and a rounding up
    level = _last_level(circle, 4 * rows, 4 * rows)
    assert 2.0 ** (level - 1) >= 2.0 / 3.0 * circle > 2.0 ** (level - 2)


def test_mitsuba3_1508_a_tiny_lens_is_a_pinhole_in_every_answer():
    scene = flat_scene.scene_of([wall(4.0, (0.8, 0.4, 0.2), -9.0, 0.005)], CAMERA, LENS, background=(0.1, 0.2, 0.3))
    tiny, none = ThinLens(1e-5, 2.0), ThinLens(0.0, 2.0)
    assert abs(tiny.coc_px(np.array([4.0]), CAMERA)[0]) == pytest.approx(2.5e-4, rel=1e-14)
    for name in ("accumulation", "multiview", "lensblur", "scatter"):
        few = {"samples": 4} if name in ("accumulation", "multiview", "lensblur") else {}
        images = [render(name, scene, CAMERA, lens, **few).image for lens in (tiny, none)]
        # The edge lies at x = 5; 2.5e-4 px of blur mix so much of a contrast of 0.7 at most.
        assert_allclose(images[0], images[1], atol=0.7 * 2.5e-4)


@EACH
def test_olfallendoll_857_no_aperture_no_blur(name):
    color, depth = noise((7, 9), 2), np.random.default_rng(2).uniform(1.0, 9.0, (7, 9))
    coc = ThinLens(0.0, 2.0).coc_px(depth, CAMERA)
    assert not coc.any()
    assert_allclose(filtered(name, color, depth, coc), color, rtol=1e-13)  # as above


@pytest.mark.parametrize("bad", [np.nan], ids=["nan"])
@EACH
def test_unity_postprocessing_123_a_nan_pixel_is_refused(name, bad):
    color = noise((7, 9))
    color[3, 4, 1] = bad
    with pytest.raises(InputError, match=r"color: 1 of 189 values (is|are) NaN|color: .*NaN"):
        filtered(name, color, *even((7, 9)))


def test_unity_postprocessing_205_nan_in_a_scene_is_refused():
    square = np.array([[0.0, 0.0, -2.0], [1.0, 0.0, -2.0], [0.0, 1.0, -2.0]])
    with pytest.raises(InputError, match="NaN"):
        Part(square, [[0, 1, 2]], color=np.full((3, 3), np.nan))
    with pytest.raises(InputError, match="base_color"):
        flat_scene.paint((np.nan, 0.0, 0.0))


@EACH
@pytest.mark.parametrize("bad", [np.nan, 0.0, -3.0])
def test_unity_postprocessing_207_depth_that_is_no_depth_is_refused(name, bad):
    depth, coc = even((7, 9))
    depth[2, 2] = bad
    with pytest.raises(InputError, match="depth: "):
        filtered(name, noise((7, 9)), depth, coc)


@pytest.mark.parametrize("name", ["singlepass", "poisson"])
def test_unity_postprocessing_786_finite_in_finite_out_at_every_stage(name):
    color = noise((7, 9)) * 1e30
    depth = np.where(np.arange(63).reshape(7, 9) % 2 == 0, 1e-30, np.inf)
    coc = LENS.coc_px(depth, CAMERA)
    assert np.isfinite(coc).all()
    staged = FILTERS[name].blur(color, depth, coc, FILTERS[name].Params(), stages=True)
    assert np.isfinite(staged.image).all()
    assert staged.image.max() <= 1e30 * (1.0 + 1e-12)
    assert all(np.isfinite(stage).all() for stage in staged.stages.values())


@EACH
def test_unity_postprocessing_276_channels_have_the_same_weights(name):
    color = noise((7, 9)) * [1.0, 1e3, 1e5]
    depth = np.random.default_rng(4).uniform(1.0, 9.0, (7, 9))
    coc = LENS.coc_px(depth, CAMERA)
    image, turned = (filtered(name, color[..., order], depth, coc) for order in ([0, 1, 2], [2, 0, 1]))
    assert_array_equal(turned, image[..., [2, 0, 1]])
    if name == "filament":  # weighs all channels by the brightest, which must be the same
        color[..., 2] = color.max(axis=-1)
        image = filtered(name, color, depth, coc)
    grey = filtered(name, np.repeat(color[..., 2:], 3, axis=-1), depth, coc)
    assert_array_equal(grey, np.repeat(image[..., 2:], 3, axis=-1))


def test_unity_srp_5446_zero_times_infinity():
    depth = np.array([1e-300, 2.0, 1e300, np.inf])
    assert_array_equal(ThinLens(0.0, 2.0).coc_px(depth, CAMERA), np.zeros(4))
    assert_array_equal(ThinLens(0.1, np.inf).coc_px(depth[1:], CAMERA), [-5.0, -1e-299, -0.0])
    assert_allclose(ThinLens(1e308, 1e308).coc_px(depth[3:], CAMERA), [100.0], rtol=1e-15)
    assert np.isfinite(ThinLens(1e308, 1e-300).coc_px(depth, CAMERA)).all()


def test_unity_graphics_1562_scores_do_not_spread_nan():
    color = noise((11, 11))
    spoiled = color.copy()
    spoiled[5, 5, 0] = np.nan
    for score in (metrics.psnr, metrics.ssim, metrics.rmse):
        with pytest.raises(InputError, match="NaN"):
            score(color, spoiled)


def test_filament_6888_equal_circles_take_no_other_way():
    # Equal circles share one table of areas; circles that differ by a rounding do not. Both against areas by hand.
    circle, value = 2.3, 1e5
    area = covered(0, 0, circle), covered(1, 0, circle), covered(2, 2, circle), covered(3, 0, circle)
    share = np.array(area) / (math.pi * circle**2)
    coc = np.full((9, 9), circle)
    other = np.where(np.arange(81).reshape(9, 9) % 2 == 0, circle, math.nextafter(circle, 3.0))
    for circles in (coc, other):
        image = filtered("scatter", point((9, 9), value), np.full((9, 9), 4.0), circles)
        assert_allclose(image[[4, 4, 6, 4], [4, 5, 6, 7], 0], value * share, rtol=1e-12)
    assert share[0] == pytest.approx(1.0 / (math.pi * circle**2), rel=1e-12)  # the pixel itself lies inside
    # One disc over what is sharp: each pixel is the mean of its own black, of weight 1, and the disc's share.
    alone = np.where(point((9, 9))[..., 0] > 0.0, circle, 0.0)
    image = filtered("scatter", point((9, 9), value), np.full((9, 9), 4.0), alone)
    assert_allclose(image[[4, 6], [5, 6], 0], value * share[1:3] / (1.0 + share[1:3]), rtol=1e-12)


@EACH
def test_filament_6943_great_values_are_not_clamped(name):
    # Equal circles everywhere, all of the picture at 1e5: nothing may be cut at 1.
    image = filtered(name, np.full((7, 9, 3), 1e5), *even((7, 9)))
    assert_allclose(image, 1e5, rtol=1e-13)


def test_stride_3429_half_floats_end_at_65504():
    values = np.float32([65504.0, 65505.0, 65519.0, 65520.0, 1e6, np.inf])
    with np.errstate(over="ignore"):
        assert_array_equal(store(values, "f16"), [65504.0, 65504.0, 65504.0, np.inf, np.inf, np.inf])
    assert_array_equal(store(values, "f16", LLVMPIPE), [65504.0] * 5 + [np.inf])  # rounds towards zero
    # Circles beyond it in a texture of 16 bits: no NaN, and a picture of one colour stays.
    color, depth = np.full((8, 8, 3), 0.5, dtype=np.float32), np.full((8, 8), 4.0)
    for circle in (65504.0, 65505.0, 65520.0, 1e6):
        image = filtered("mipmap", color, depth, np.full((8, 8), circle), depth_format="f16")
        assert_allclose(image, 0.5, rtol=1e-6)


def test_godot_15756_a_bright_pixel_becomes_a_disc_of_its_energy():
    image = filtered("scatter", point((15, 15), 1e6), *even((15, 15), circle=3.0))
    assert image.sum(dtype=float) == pytest.approx(3e6, rel=1e-12)
    assert image.max() == pytest.approx(1e6 / (9.0 * math.pi), rel=1e-12)


@EACH
def test_oidn_210_an_infinite_pixel_is_refused(name):
    color = noise((7, 9))
    color[3, 4] = np.inf
    with pytest.raises(InputError, match="color: "):
        filtered(name, color, *even((7, 9)))


def test_oidn_18_an_infinite_pixel_of_a_file_is_refused():
    color, depth = np.ones((7, 9, 3)), np.full((7, 9), 4.0)
    color[0, 0, 2] = np.inf
    with pytest.raises(InputError, match="color: "):
        Frame(color, depth, CAMERA, LENS)


@pytest.mark.parametrize("score", [pytest.param(metrics.psnr, id="777"), pytest.param(metrics.psnr_8bit, id="829")])
def test_three_gpu_pathtracer_one_bright_pixel_sets_no_exposure(score):
    # White is 1 whatever the brightest pixel is: one of 1e30 counts as white and errs by 1 in 3 of 363 values. An
    # infinite one is shown as white, and scores refuse it.
    color = np.zeros((11, 11, 3))
    image = color.copy()
    image[5, 5] = 1e30
    assert score(color, image) == pytest.approx(10.0 * math.log10(121.0), rel=1e-12)
    image[5, 5] = np.inf
    assert_array_equal(np.unique(display(image)), [0.0, 1.0])
    with pytest.raises(InputError, match="image: has 3 infinite values"):
        score(color, image)


@pytest.mark.parametrize("value", [1e-38, 1e-20, 0.116, 1e30])
def test_lumit_38_geometric_means_of_small_values(value):
    color = np.full((8, 8, 3), value, dtype=np.float32)
    image = filtered("mipmap", color, np.full((8, 8), 4.0), np.full((8, 8), 2.7), blend="geometric")
    assert_allclose(image, np.float64(color[0, 0, 0]), rtol=2e-6)  # nine float32 terms
