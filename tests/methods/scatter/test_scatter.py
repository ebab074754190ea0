"""Scatter: areas of discs in pixels, the twin that cuts polygons, energy, order in depth."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError, ThinLens, View
from refdof.methods import scatter
from refdof.methods.scatter import Params, blur, texture_reads
from refdof.methods.scatter.disc import inner_count, outer_count
from refdof.stages import StageRecorder
from tests import flat_scene
from tests.methods import naive_baselines
from tests.methods.scatter.discs import covered

pytestmark = pytest.mark.fast

ORDERS = ("none", "far_to_near")
POLYGON = 1e-8  # of the twin's discs, see naive_baselines: their 4000 sides err by far less than a pixel's share


def images(seed, height, width):
    random = np.random.default_rng(seed)
    coc = random.uniform(-1.0, 1.0, (height, width)) ** 3 * 5.0
    coc[0, 0] = 0.0
    return random.random((height, width, 3)), random.uniform(1.0, 5.0, (height, width)), coc


@pytest.mark.parametrize("radius", [0.2, 0.5, 0.55, 1 / math.sqrt(2), 1.0, 1.5, 2.0, 3.7, 6.5])
def test_areas_are_those_of_polygons(radius):
    reach = math.ceil(radius + 0.5)
    shares = naive_baselines.disc_shares(radius)
    for i in range(reach + 1):
        for j in range(reach + 1):
            assert covered(i, j, radius) / (math.pi * radius**2) == pytest.approx(shares.get((i, j), 0.0), abs=POLYGON)
            if i >= outer_count(j, radius):
                assert shares.get((i, j), 0.0) < POLYGON
            if i < inner_count(j, radius):
                assert covered(i, j, radius) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("size", [(1, 1), (1, 7), (5, 1), (7, 11)])
def test_picture_is_the_twins(size, order):
    color, depth, coc = images(3, *size)
    expected = naive_baselines.scatter(color, depth, coc, order == "far_to_near")
    np.testing.assert_allclose(blur(color, depth, coc, Params(order)), expected, rtol=0, atol=POLYGON)


@pytest.mark.parametrize("coc", [0.0, 0.3, -2.3, 6.0])
def test_an_interior_point_keeps_its_energy(coc):
    color = np.zeros((33, 33, 3))
    color[16, 16] = 1.0, 2.0, 5.0
    image = blur(color, np.ones((33, 33)), np.full((33, 33), coc))
    # Shares of a disc add up to 1, and so do shares in a pixel where all circles are alike and none reach over the
    # border, which is 16 px away: but for 33^2 roundings nothing is lost.
    np.testing.assert_allclose(image.sum(axis=(0, 1)), color[16, 16], rtol=1e-13)


@pytest.mark.parametrize("radius", [3.3, 0.5, np.nextafter(0.5, 0.0), np.nextafter(0.5, 1.0), 0.2])
def test_shares_of_interior_pixels_add_up_to_one(radius):
    trace = StageRecorder(on=True)
    scatter.method._blur(np.ones((24, 24, 3)), np.ones((24, 24)), np.full((24, 24), radius), Params(), trace)
    np.testing.assert_allclose(trace.stages["shares"][8:-8, 8:-8], 1.0, rtol=1e-13)


def test_a_disc_by_hand():
    # Radius 1: the middle pixel is inside but for its corners, at sqrt(1/2) from the centre: all of it, 1 of pi.
    color = np.zeros((5, 5, 3))
    color[2, 2] = 1.0
    image = blur(color, np.ones((5, 5)), np.ones((5, 5)))[..., 0]
    assert image[2, 2] == pytest.approx(1 / math.pi, rel=1e-14)
    # The rest are four corners, x > 1/2 and y > 1/2 inside the circle, and four sides.
    corner = math.pi / 12 + 0.25 - math.sqrt(3) / 4
    assert image[1, 1] == pytest.approx(corner / math.pi, rel=1e-12)
    assert image[2, 1] == pytest.approx((math.pi - 1 - 4 * corner) / 4 / math.pi, rel=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("order", ORDERS)
def test_constant_colour_stays(order, dtype):
    _, depth, coc = images(5, 9, 12)
    color = np.broadcast_to(np.array([0.1, 0.7, 30.0], dtype=dtype), (9, 12, 3))
    image = blur(color, depth, coc, Params(order))
    assert image.dtype == dtype
    np.testing.assert_allclose(image, color, rtol=2 * np.finfo(dtype).eps + 1e-14)


@pytest.mark.parametrize("order", ORDERS)
def test_small_discs_change_nothing(order):
    color, depth, coc = images(6, 6, 7)
    np.testing.assert_allclose(blur(color, depth, np.clip(coc, -0.5, 0.5), Params(order)), color, rtol=1e-15)


@settings(max_examples=10, deadline=None)
@given(st.integers(1, 7), st.integers(1, 7), st.sampled_from(ORDERS), st.integers(0, 10**6))
def test_every_pixel_is_a_mean_of_the_picture(height, width, order, seed):
    color, depth, coc = images(seed, height, width)
    image = blur(color, depth, coc, Params(order))
    assert (image >= color.min(axis=(0, 1)) - 1e-14).all()
    assert (image <= color.max(axis=(0, 1)) + 1e-14).all()


def test_nearer_discs_cover_farther_ones_only_where_order_counts():
    color = np.zeros((9, 9, 3))
    color[:, :4] = 1.0
    depth, coc = np.where(color[..., 0] > 0, 1.0, 2.0), np.full((9, 9), 0.6)  # shares near 1: the nearer one hides
    none, ordered = blur(color, depth, coc), blur(color, depth, coc, Params("far_to_near"))
    behind = blur(color, 3.0 - depth, coc, Params("far_to_near"))
    assert np.array_equal(none, blur(color, 3.0 - depth, coc))
    assert ordered[4, 4, 0] > none[4, 4, 0] > behind[4, 4, 0]


def test_bands_of_rows_fit_together():
    _, depth, _ = images(7, 130, 9)  # three bands
    color = np.random.default_rng(8).random((130, 9, 3))
    coc = np.full((130, 9), 4.4)
    upper, lower = blur(color[:80], depth[:80], coc[:80]), blur(color[50:], depth[50:], coc[50:])
    whole = blur(color, depth, coc)
    np.testing.assert_allclose(whole[:70], upper[:70], rtol=1e-13)
    np.testing.assert_allclose(whole[60:], lower[10:], rtol=1e-13)


@pytest.mark.parametrize("circle", [1e-30, 1e4, 3e38])
def test_extreme_circles_stay_finite(circle):
    color, depth, _ = (a.astype(np.float32) for a in images(9, 5, 6))
    coc = np.where(np.indices((5, 6)).sum(axis=0) % 2, np.float32(circle), np.float32(-circle))
    for order in ORDERS:
        assert np.isfinite(blur(color, depth, coc, Params(order))).all()


def test_rendering_records_its_stages():
    shot, lens = flat_scene.camera(12, 9, 24.0), ThinLens(0.5, 4.0)
    view = View(flat_scene.scene_of([flat_scene.rectangle(-1, 1, -1, 1, 2.0, (0.8, 0.4, 0.2))], shot, lens), shot, lens)
    trace = StageRecorder(on=True)
    image = scatter.render(view, Params(), trace)
    assert list(trace.stages) == ["coc", "shares"]
    np.testing.assert_allclose(np.abs(trace.stages["coc"]), 3.0, rtol=0, atol=1e-6)
    assert image.dtype == np.float32


def test_each_pixel_is_read_once():
    assert texture_reads(Params(), 64, 48) == 1.0


def test_bad_input_is_named():
    with pytest.raises(InputError, match=r"order: got 'sorted'; .*allowed are none, far_to_near"):
        Params("sorted")
    with pytest.raises(InputError, match="coc: got shape"):
        blur(np.zeros((2, 3, 3)), np.ones((2, 3)), np.zeros((3, 2)))
