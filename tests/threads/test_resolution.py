"""Bug threads about the picture's size, its bits, and what one frame leaves for the next: docs/threads.md, part 8."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import View, render
from refdof.raster.gpu.gpu_model import store
from refdof.rendering import render_view
from tests import flat_scene
from tests.threads.pictures import CAMERA, FILTERS, LENS, even, filtered, noise, point, spread, wall

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)


def circles(size):
    """Circles [px] of depths 1 and 8 in a picture of this size, by the camera of 9 x 7 with P = 100."""
    return LENS.coc_px(np.array([1.0, 8.0]), CAMERA.with_size(size))


# By hand for 7 rows: 10 (1/2 - 1) = -5 and 10 (1/2 - 1/8) = 3.75 px; a share of the rows, it grows with them.
@pytest.mark.parametrize(
    ("size", "factor"),
    [
        pytest.param((36, 28), 4.0, id="godot_105127"),
        pytest.param((3, 2), 2.0 / 7.0, id="godot_57210"),
        pytest.param((9216, 7168), 1024.0, id="playcanvas_8833"),
        pytest.param((4608, 3584), 512.0, id="playcanvas_8834"),
        pytest.param((1920, 1080), 1080.0 / 7.0, id="stk_code_5874"),
        pytest.param((2048, 2048), 2048.0 / 7.0, id="speck_34"),
        pytest.param((640, 480), 480.0 / 7.0, id="dusklight_1295"),
        pytest.param((1280, 720), 720.0 / 7.0, id="markerpatch_54"),
        pytest.param((2560, 1440), 1440.0 / 7.0, id="mgs2_v_s_fix_115"),
    ],
)
def test_circles_are_a_share_of_the_rows(size, factor):
    assert_allclose(circles(size), np.array([-5.0, 3.75]) * factor, rtol=1e-13)


def test_playcanvas_8833_the_blur_of_a_large_picture_is_as_wide():
    # The spread of a light grows by 4 with the picture: r^2 / 4 at radii of 1.5 and 6 px, and a pixel's own 1 / 12.
    # Read at whole pixels that is a tenth off for small discs.
    sizes = (13, 1.5), (25, 6.0)
    moments = [spread(filtered("scatter", point((n, n)), *even((n, n), circle=c)))[0] for n, c in sizes]
    assert_allclose(moments, [1.5**2 / 4.0 + 1.0 / 12.0, 9.0 + 1.0 / 12.0], rtol=0.1)


def test_stk_code_5874_the_cut_of_circles_is_stated_in_pixels():
    # singlepass cuts circles at its largest blur, as its record says; a setting moves the cut with the picture.
    for largest in (2.0, 4.0):
        image = filtered("singlepass", point((17, 17)), *even((17, 17), circle=50.0), max_blur_size=largest)
        reach = np.hypot(*(np.argwhere(image[..., 0] > 0.0) - 8).T).max()
        assert largest - 0.5 <= reach <= largest + 1.5


def scene():
    return flat_scene.scene_of([wall(4.0, (0.9, 0.5, 0.1), -9.0, 0.013)], CAMERA, LENS, background=(0.2, 0.3, 0.7))


@pytest.mark.parametrize("name", ["scatter", "multiview", "cascaded"])
def test_unity_graphics_6371_another_size_in_between_changes_nothing(name):
    view = View(scene(), CAMERA, LENS)
    first = render_view(name, view).image
    other = render_view(name, view.with_size((5, 4))).image
    assert other.shape == (4, 5, 3)
    assert_array_equal(render_view(name, view).image, first)


def test_unity_graphics_4729_a_new_size_is_as_if_it_were_the_first():
    view = View(scene(), CAMERA, LENS)
    view.pinhole()
    fresh = View(scene(), CAMERA.with_size((6, 5)), LENS)
    assert_array_equal(view.with_size((6, 5)).coc_px(), fresh.coc_px())
    assert_array_equal(view.with_size((6, 5)).pinhole().color, fresh.pinhole().color)


@pytest.mark.parametrize("name", ["scatter", "separable", "singlepass"])
def test_unity_graphics_1193_a_moved_picture_is_blurred_alike(name):
    # Moved by 3 px, within borders of one colour: the same numbers, moved.
    random, color, coc = np.random.default_rng(1193), np.full((15, 22, 3), 0.3), np.full((15, 22), 2.0)
    depth = np.full((15, 22), 4.0)
    color[5:10, 6:12], coc[5:10, 6:12] = random.random((5, 6, 3)), random.uniform(-2.0, 2.0, (5, 6))
    depth[5:10, 6:12] = random.uniform(1.0, 4.0, (5, 6))
    image = filtered(name, color, depth, coc)
    moved = filtered(name, *(np.roll(part, 3, axis=1) for part in (color, depth, coc)))
    assert_allclose(moved[:, 4:-1], image[:, 1:-4], rtol=1e-13)


def test_unity_graphics_4502_half_a_pixel_moves_the_picture_by_half_a_pixel():
    # A wall's edge under circles of 2.5 px, drawn at x = 4.5 and 5: the light right of it grows by half a pixel.
    totals = []
    for edge in (0.0, 0.005):
        sheet = flat_scene.scene_of([wall(4.0, (1.0, 1.0, 1.0), -9.0, edge)], CAMERA, LENS)
        totals.append(render("accumulation", sheet, CAMERA, LENS, samples=64).image[..., 0].sum(axis=1).mean())
    # 64 lens points, of which columns see a part each: 3 of 64 off in either sum at most.
    assert totals[1] - totals[0] == pytest.approx(0.5, abs=6.0 / 64.0)


@pytest.mark.parametrize(("form", "step"), [("unorm8", 12.0 / 255.0), ("f16", 2.0**-9)])
def test_unity_postprocessing_138_short_circles_have_a_bounded_error(form, step):
    # Circles -6 .. 6 px in 8 bits, and as half floats, whose step from 4 to 8 is 2^-8: half a step at most.
    exact = np.random.default_rng(138).uniform(-6.0, 6.0, (9, 12)).astype(np.float32)
    if form == "unorm8":
        short = store((exact + np.float32(6.0)) / np.float32(12.0), form) * 12.0 - 6.0
        assert np.abs(short - exact).max() <= 0.5 * step * 1.0001  # float32 roundings of the scaling
        whole = (short + 6.0) / step
        assert_allclose(whole, np.rint(whole), atol=1e-4)
    else:
        short = store(exact, form)
        assert np.abs(short - exact).max() <= step
    color, depth = noise((9, 12)), np.full((9, 12), 4.0)
    error = np.abs(filtered("scatter", color, depth, short) - filtered("scatter", color, depth, exact)).max()
    # A share of 1 / (pi r^2) changes by 2 / r of its error per px, and the rim's by as much: below 4 errors a pixel.
    assert 0.0 < error < 4.0 * step
