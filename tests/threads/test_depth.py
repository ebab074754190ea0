"""Bug threads about depth buffers, far planes, the sky and the picture's border: docs/threads.md, parts 4 and 5."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import InputError, ThinLens, View, render
from refdof.frame.depth_kinds import planar_depth
from tests import flat_scene
from tests.threads.pictures import CAMERA, FILTERS, LENS, even, filtered, noise, wall

pytestmark = pytest.mark.fast
NEAR, FAR = 0.5, 64.0
THREE = flat_scene.camera(3, 1, 100.0)
DEPTHS = np.array([[0.5, 1.0, 2.0, 7.0, 31.0, 63.0]])
ROW = flat_scene.camera(6, 1, 100.0)
ENCODED = {
    "device": FAR * (DEPTHS - NEAR) / (DEPTHS * (FAR - NEAR)),
    "reversed": NEAR * (FAR - DEPTHS) / (DEPTHS * (FAR - NEAR)),
    "reversed-infinite": NEAR / DEPTHS,
}


def decoded(kind):
    planes = {"near": NEAR} if kind == "reversed-infinite" else {"near": NEAR, "far": FAR}
    return planar_depth(ENCODED[kind], kind, ROW, **planes)


@pytest.mark.parametrize("kind", [pytest.param("reversed", id="32773"), pytest.param("reversed-infinite", id="33001")])
def test_three_js_reversed_depth_is_read(kind):
    assert_allclose(decoded(kind), DEPTHS, rtol=1e-13)
    assert_allclose(LENS.coc_px(decoded(kind), ROW), 10.0 * (0.5 - 1.0 / DEPTHS), atol=1e-12)


def test_godot_88328_both_directions_give_the_same_circles():
    circles = [LENS.coc_px(decoded(kind), ROW) for kind in ("device", "reversed")]
    assert_allclose(circles[0], circles[1], atol=1e-11)
    # Taken for the other direction it is another depth, not the same one a little off: 1/d and 1/d' are mirrored.
    wrong = planar_depth(ENCODED["reversed"], "device", ROW, near=NEAR, far=FAR)
    assert_allclose((1.0 / wrong + 1.0 / DEPTHS)[0, 1:], 1.0 / NEAR + 1.0 / FAR, rtol=1e-12)
    assert wrong[0, 0] == np.inf  # the near plane's number is that of an empty buffer


def test_otisfx_30_near_blur_of_reversed_depth():
    stored = np.array([[1.0, 0.75, 0.5]])  # near plane 0.5: depths 0.5, 2/3, 1, all in front of focus
    circles = LENS.coc_px(planar_depth(stored, "reversed-infinite", THREE, near=0.5), ROW)
    assert_allclose(circles, [[-15.0, -10.0, -5.0]], rtol=1e-13)


def test_pmndrs_postprocessing_445_logarithmic_depth_is_named():
    # No kind of depth buffer here is logarithmic. What is read as one is decoded first: d = log2(z / n) / log2(f / n).
    stored = np.log2(DEPTHS / NEAR) / math.log2(FAR / NEAR)
    with pytest.raises(InputError, match="kind: got 'logarithmic'; allowed are planar, radial, device"):
        planar_depth(stored, "logarithmic", ROW, near=NEAR, far=FAR)
    planar = NEAR * (FAR / NEAR) ** stored
    assert_allclose(planar_depth(planar, "planar", ROW), DEPTHS, rtol=1e-13)


@pytest.mark.parametrize(
    ("stored", "kind"),
    [
        pytest.param([[0.5, 4.0, 1e10]], "planar", id="13599"),
        pytest.param([[0.0, 64.0 * 3.5 / (4.0 * 63.5), 1.0]], "device", id="13660"),
        pytest.param([[1.0, 0.5 * 60.0 / (4.0 * 63.5), 0.0]], "reversed", id="14155"),
    ],
)
def test_three_js_a_known_depth_has_known_circles(stored, kind):
    planes = {} if kind == "planar" else {"near": NEAR, "far": FAR}
    depth = planar_depth(np.array(stored), kind, THREE, **planes)
    # Depths 0.5, 4 and nothing: 10 (1/2 - 2), 10 (1/2 - 1/4), 10 / 2.
    assert_allclose(LENS.coc_px(depth, ROW), [[-15.0, 2.5, 5.0]], rtol=1e-12)


@pytest.mark.parametrize("bits", [pytest.param(24, id="18607"), pytest.param(8, id="18613")])
def test_three_js_packed_depth_has_bounded_circles(bits):
    camera = flat_scene.camera(400, 1, 100.0)
    # Rounding d = f (z - n) / (z (f - n)) to n bits moves 1 / z by at most half a step of (1/n - 1/f): no bands.
    z = np.geomspace(NEAR, FAR * (1.0 - 1e-9), 400)[None]
    top = 2.0**bits - 1.0
    packed = np.rint(FAR * (z - NEAR) / (z * (FAR - NEAR)) * top) / top
    packed = np.minimum(packed, (top - 1.0) / top)  # the greatest is the background
    read = planar_depth(packed, "device", camera, near=NEAR, far=FAR)
    error = np.abs(LENS.coc_px(read, camera) - LENS.coc_px(z, camera))
    step = 10.0 * (1.0 / NEAR - 1.0 / FAR) / top
    assert error[:, :-40].max() <= 0.5 * step * (1.0 + 1e-6)
    assert error.max() <= 1.0 * step * (1.0 + 1e-6)  # what shares the background's number is one lower
    assert error.max() > 0.2 * step


def test_stk_code_5872_the_sky_is_as_blurred_as_what_is_near_it():
    far = np.array([1999.0, 2000.0, 2001.0, 1e5, np.inf])
    circles = LENS.coc_px(far, CAMERA)
    assert_allclose(circles, [10.0 * (0.5 - 1.0 / f) for f in far], rtol=1e-14)
    assert (np.diff(circles) > 0.0).all()
    assert np.diff(circles).max() < 0.005  # 10 / 2001 at most


def test_resonite_1563_far_planes_beyond_float32():
    # A sky at the far plane, stored in float32: the circle errs by what a rounding of d is worth, however far.
    for far in (1e3, 83886.0, 83887.0, 1e7):
        depth = np.full((2, 2), far * 0.9)
        camera = flat_scene.camera(2, 2, 100.0)
        circles = LENS.coc_px(depth, camera)
        stored = (far * (depth - NEAR) / (depth * (far - NEAR))).astype(np.float32).astype(float)
        stored = np.minimum(stored, 1.0 - 2.0**-24)
        read = planar_depth(stored, "device", camera, near=NEAR, far=far)
        assert_allclose(LENS.coc_px(read, camera), circles, atol=10.0 / NEAR * 2.0**-24)


def test_unity_postprocessing_884_circles_of_0_keep_the_sky_sharp():
    # The sky is masked by its circle; what is nearer is blurred by less than a pixel's distance to it.
    color, depth = noise((7, 9)), np.where(np.arange(9) < 5, 4.0, np.inf) * np.ones((7, 1))
    coc = np.where(np.isinf(depth), 0.0, 2.0)
    image = filtered("singlepass", color, depth, coc)
    assert_allclose(image[:, 7:], color[:, 7:], rtol=1e-13)  # beyond the reach of circles of 2 px
    assert np.abs(image[:, :5] - color[:, :5]).max() > 0.1


def test_godot_8140_what_wrote_no_depth_is_at_infinity():
    for kind, empty in (("device", 1.0), ("reversed", 0.0), ("reversed-infinite", 0.0)):
        planes = {"near": NEAR} if kind == "reversed-infinite" else {"near": NEAR, "far": FAR}
        assert_array_equal(planar_depth(np.full((1, 6), empty), kind, ROW, **planes), np.full((1, 6), np.inf))
    scene = flat_scene.scene_of([wall(2.0, (1.0, 1.0, 1.0), 0.0, 9.0)], CAMERA, LENS)
    assert_array_equal(np.isinf(View(scene, CAMERA, LENS).pinhole().depth[0]), [True] * 4 + [False] * 5)


@pytest.mark.parametrize("name", FILTERS)
def test_stk_code_5800_nothing_comes_round_from_the_other_side(name):
    color, (depth, coc) = np.zeros((9, 32, 3)), even((9, 32), circle=1.5)
    color[:, 0] = 1e3
    image = filtered(name, color, depth, coc)
    assert image[:, 0].min() > 100.0
    assert_array_equal(image[:, 24:], np.zeros((9, 8, 3)))  # beyond the reach of any method: 5 radii, and two texels


def test_lentil_177_a_disc_partly_outside_keeps_what_is_inside():
    # A lamp of 1 px at depth 4 is a disc of 3 px: 100 * 0.12 (1/2 - 1/4). Its middle lies 1.5 px from the right border.
    camera, lens = flat_scene.camera(12, 10, 100.0), ThinLens(0.12, 2.0)
    lamp = flat_scene.rectangle(0.04 * 4, 0.05 * 4, -0.005 * 4, 0.005 * 4, 4.0, (1.0, 1.0, 1.0))
    image = render("accumulation", flat_scene.scene_of([lamp], camera, lens), camera, lens, samples=64).image
    outside = (9.0 * math.acos(0.5) - 1.5 * math.sqrt(9.0 - 1.5**2)) / (9.0 * math.pi)  # a segment of the disc
    # 28 pixels of 64 rays, 1 in 28 of which meets the lamp: 64 hits. Random ones would scatter by an eighth, nets less.
    assert image[..., 0].sum(dtype=float) == pytest.approx(1.0 - outside, rel=0.125)


@pytest.mark.parametrize("name", ["singlepass", "separable", "scatter"])
def test_oidn_62_a_tile_is_the_same_as_a_part_of_the_whole(name):
    # Circles of at most 2 px: what a tile needs of its neighbours is 3 px of them.
    random, color = np.random.default_rng(62), noise((12, 20))
    depth, coc = random.uniform(1.0, 9.0, (12, 20)), random.uniform(-2.0, 2.0, (12, 20))
    params = {"max_blur_size": 2.0} if name == "singlepass" else {}
    whole = filtered(name, color, depth, coc, **params)
    for part in (np.s_[:, :10], np.s_[:, 10:]):
        grown = np.s_[:, : 10 + 5] if part[1].start is None else np.s_[:, 10 - 5 :]
        tile = filtered(name, color[grown], depth[grown], coc[grown], **params)
        kept = tile[:, :10] if part[1].start is None else tile[:, 5:]
        assert_allclose(kept, whole[part], rtol=1e-13)
