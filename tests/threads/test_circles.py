"""Bug threads about focus distance, units and circles of confusion: docs/threads.md, part 1."""

from dataclasses import fields
from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Camera, InputError, ThinLens, View, render
from refdof.frame.depth_kinds import planar_depth
from refdof.methods import poisson
from refdof.optics.lens_samples import lens_samples
from tests import flat_scene
from tests.threads.pictures import CAMERA, FILTERS, LENS, filtered, point, spread, wall

pytestmark = pytest.mark.fast


def test_pmndrs_postprocessing_426_distance_from_eye_or_plane():
    # An upright wall at planar depth 2 is in focus as a whole; what is 2 from the eye is so only in the middle.
    corner = np.hypot(4.0, 3.0) / 100.0  # tangent of the corner pixel of 9 x 7
    assert_array_equal(LENS.coc_px(np.full((7, 9), 2.0), CAMERA), np.zeros((7, 9)))
    planar = planar_depth(np.full((7, 9), 2.0), "radial", CAMERA)
    assert planar[3, 4] == 2.0
    assert planar[0, 0] == pytest.approx(2.0 / np.sqrt(1.0 + corner**2), rel=1e-15)  # a sphere bulges towards the eye
    assert LENS.coc_px(planar, CAMERA)[0, 0] < 0.0


def test_playcanvas_7211_distance_stays_when_the_camera_turns():
    # A point 2 from the eye, seen straight on and 30 degrees off the axis: as a distance to the eye it is the same.
    camera = flat_scene.camera(201, 1, 100.0 / np.tan(np.radians(30.0)))  # the last pixel's tangent is that of 30 deg
    planar = planar_depth(np.full((1, 201), 2.0), "radial", camera)
    assert planar[0, 100] == 2.0
    assert planar[0, 200] == pytest.approx(2.0 * np.cos(np.radians(30.0)), rel=1e-14)


def test_chunky_123_focus_is_a_plane():
    # Points of one plane, however far off the axis: their distance to the eye grows, their circle stays 0.
    view = View(flat_scene.scene_of([wall(2.0, (1.0, 1.0, 1.0))], CAMERA, LENS), CAMERA, LENS)
    assert_allclose(view.pinhole().depth, 2.0, rtol=1e-15)
    assert_allclose(view.coc_px(), 0.0, atol=1e-14)


def test_pbrt_v4_232_the_near_plane_moves_no_focus():
    depth = np.array([[0.75, 2.0, 6.0]])
    camera = CAMERA.with_size((3, 1))
    for near in (0.1, 0.25, 0.5):
        stored = 10.0 * (depth - near) / (depth * (10.0 - near))
        assert_allclose(planar_depth(stored, "device", camera, near=near, far=10.0), depth, rtol=1e-14)


@pytest.mark.parametrize("scale", [pytest.param(1.0, id="46"), pytest.param(1000.0, id="131")])
def test_pmndrs_react_postprocessing_focus_is_a_length(scale):
    # 0.5 is half a unit in front of the lens, not half-way to the far plane, whatever the scene's size.
    lens = ThinLens(0.1, 0.5 * scale)
    assert lens.coc_px(np.array([0.5 * scale]), CAMERA)[0] == 0.0
    assert lens.coc_px(np.array([scale]), CAMERA)[0] == pytest.approx(100.0 * 0.1 * 1.0 / scale, rel=1e-15)


def test_unity_postprocessing_29_twice_the_rows_twice_the_circle():
    low, high = (LENS.coc_px(np.array([0.5, 8.0]), CAMERA.with_size(size)) for size in ((9, 7), (18, 14)))
    assert_array_equal(high, 2.0 * low)
    assert_allclose(low, [-15.0, 3.75], rtol=1e-14)  # 10 (1/2 - 2) and 10 (1/2 - 1/8)


@pytest.mark.parametrize("step", [0.25, 0.5])
def test_unity_postprocessing_60_quality_does_not_change_the_spread(step):
    # A light of radius 4 px in one plane: r^2 / 4 along each axis. The listing's loop feathers the rim by half a
    # pixel and weighs by order, bilinear taps add 1/6 px^2: within a tenth at every density of taps.
    depth, coc = np.full((25, 25), 4.0), np.full((25, 25), 4.0)
    image = filtered("singlepass", point((25, 25)), depth, coc, rad_scale=step, max_blur_size=6.0)
    assert spread(image)[0] == pytest.approx(4.0, rel=0.1)


def test_three_js_11881_focus_at_a_plane_is_zero_there():
    focus = np.exp(np.random.default_rng(3).uniform(-10.0, 10.0, 200))
    for distance in focus:
        assert ThinLens(0.3, distance).coc_px(np.array([distance]), CAMERA)[0] == 0.0


def test_radeonprorender_usd_319_millimetres_or_metres():
    depth = np.array([0.5, 1.9, 2.1, 8.0, np.inf])
    metres = LENS.coc_px(depth, CAMERA)
    assert_allclose(ThinLens(100.0, 2000.0).coc_px(depth * 1000.0, CAMERA), metres, rtol=1e-14)
    assert_array_equal(ThinLens(0.1 * 2.0**40, 2.0**41).coc_px(depth * 2.0**40, CAMERA), metres)


def test_rs_pbrt_31_the_same_lens_points_give_the_same_picture():
    # A white card left of x = 16, nearer than focus: the ray of lens point v meets it at x - c vx. The picture is the
    # share of the points that do, counted by hand.
    camera, lens = flat_scene.camera(32, 1, 32.0), ThinLens(0.5, 4.0)
    scene = flat_scene.scene_of([wall(2.0, (1.0, 1.0, 1.0), -9.0, 0.0)], camera, lens)
    result = render("multiview", scene, camera, lens, stages=True, samples=16, cones="none")
    x, circle = np.arange(32) + 0.5, -4.0  # 32 * 0.5 (1/4 - 1/2)
    share = (x[:, None] - circle * result.stages["lens_points"][0, :, 0] < 16.0).mean(axis=1)
    assert len(np.unique(share)) > 5
    assert_allclose(result.image[0, :, 0], share, atol=1e-6)  # float32 sums of 16 equal shares


def test_lentil_187_circles_on_both_sides_of_focus():
    # 10 (1/2 - 1/d): five depths in front, five behind.
    depth = np.array([0.5, 0.8, 1.0, 1.25, 1.6, 2.5, 4.0, 5.0, 8.0, 20.0])
    wanted = [-15.0, -7.5, -5.0, -3.0, -1.25, 1.0, 2.5, 3.0, 3.75, 4.5]
    assert_allclose(LENS.coc_px(depth, CAMERA), wanted, rtol=1e-14)


def test_bloom_engine_5_circles_level_off_behind_focus():
    far = LENS.coc_px(np.array([1e3, 1e6, 1e30, np.inf]), CAMERA)
    assert (np.diff(far) >= 0.0).all()
    assert far[-1] == pytest.approx(5.0, rel=1e-15)  # P E / focus, the limit
    assert far[0] == pytest.approx(4.99, rel=1e-14)


def test_irrlichtbaw_140_scale_and_bias_form_of_random_cameras():
    # Of a device depth d = f (z - n) / (z (f - n)) the circle is a line: scale d + bias. Both have focus - focal length
    # below the line in the photographic form; the share (s - f) / s takes that to this camera's.
    random = np.random.default_rng(140)
    for _ in range(500):
        focal, near = np.exp(random.uniform(-4.0, -2.0)), np.exp(random.uniform(-3.0, -1.0))
        focus, far = focal + np.exp(random.uniform(-1.0, 2.0)), np.exp(random.uniform(3.0, 8.0))
        radius, z = focal / 4.0, np.exp(random.uniform(np.log(near), np.log(far), 20))
        scale = 100.0 * radius * (far - near) / (near * far)
        bias = 100.0 * radius * (near - focus) / (near * focus)
        device = far * (z - near) / (z * (far - near))
        lens = ThinLens.from_f_number(focal, 2.0, focus)
        assert_allclose(lens.coc_px(z, CAMERA), scale * device + bias, atol=1e-11 * scale)
        at_focus = scale * far * (focus - near) / (focus * (far - near)) + bias
        assert abs(at_focus) < 1e-12 * scale
        assert lens.coc_px(np.array([focus]), CAMERA)[0] == 0.0


def test_pmndrs_postprocessing_161_the_near_plane_acts_in_front_only():
    depth, coc = np.array([[1.0, 2.0, 3.0, 4.0, 8.0]]), np.array([[-2.0, -1.0, 0.0, 1.0, 2.0]])
    codes = [
        poisson.code_of(depth, coc, poisson.Params(near_plane=near, focus_plane=3.0, far_plane=8.0))
        for near in (0.5, 1.0)
    ]
    assert_array_equal(codes[0][0, 2:], codes[1][0, 2:])
    assert_allclose(codes[1][0, :2], [0.0, 0.25], atol=1e-15)  # 1/2 + (d - 3) / (3 - 1) / 2
    assert_allclose(codes[0][0, :2], [0.1, 0.3], rtol=1e-14)  # 1/2 + (d - 3) / (3 - 0.5) / 2


@pytest.mark.parametrize(
    ("what", "lenses"),
    [
        pytest.param("radius", [ThinLens(r, 2.0) for r in (0.01, 0.1, 1.0)], id="5"),
        pytest.param("f-number", [ThinLens.from_f_number(0.05, n, 2.0) for n in (16.0, 4.0, 1.4)], id="6"),
        pytest.param("focal length", [ThinLens.from_f_number(f, 2.0, 2.0) for f in (0.02, 0.05, 0.2)], id="11"),
    ],
)
def test_rayrender_a_wider_aperture_blurs_more(what, lenses):
    for depth in (0.5, 1.0, 3.0, np.inf):
        circles = [abs(lens.coc_px(np.array([depth]), CAMERA)[0]) for lens in lenses]
        assert circles == sorted(circles), what
        assert_allclose(np.divide(circles, circles[0]), [r.radius / lenses[0].radius for r in lenses], rtol=1e-14)


def test_vray_for_houdini_217_extreme_f_numbers_are_live():
    for number in (1e4, 1e-7):
        lens = ThinLens.from_f_number(0.05, number, 2.0)
        circle = lens.coc_px(np.array([4.0]), CAMERA)[0]
        assert circle == pytest.approx(100.0 * 0.05 / (2.0 * number) * 0.25, rel=1e-14)
    with pytest.raises(InputError, match="f_number: got 1e-310; allowed is one that gives the lens a finite radius"):
        ThinLens.from_f_number(0.05, 1e-310, 2.0)


def test_renderman_for_blender_148_f_number_to_radius():
    lens = ThinLens.from_f_number(focal_length=0.05, f_number=4.0, focus_distance=2.0)
    assert lens.radius == 0.00625  # 50 mm / (2 * 4) = 6.25 mm
    assert lens.coc_px(np.array([4.0]), CAMERA)[0] == pytest.approx(0.15625, rel=1e-14)  # 100 * 0.00625 / 4


def test_raytracing_in_one_weekend_546_the_disc_is_a_radius():
    # Similar triangles: from the lens's rim through the focal point, twice as far away, to the other side of the axis.
    circle = LENS.coc_px(np.array([4.0]), CAMERA)[0]
    edge = 0.1 * (2.0 - 4.0) / 2.0  # height at depth 4 of the ray from (0.1, 0) through (0, 2)
    assert circle == pytest.approx(-edge / 4.0 * 100.0, rel=1e-14)


def test_raytracing_in_one_weekend_1713_focus_distance_is_not_focal_length():
    assert [field.name for field in fields(ThinLens)] == ["radius", "focus_distance", "aperture"]
    with pytest.raises(InputError, match=r"focus_distance: got 0\.05; allowed is a distance above the focal length 2"):
        ThinLens.from_f_number(2.0, 2.0, 0.05)  # the two taken for each other
    near, far = (View(_card(), CAMERA, ThinLens(0.0, focus)).pinhole().color for focus in (1.0, 50.0))
    assert_array_equal(near, far)  # focus changes no field of view


def _card():
    return flat_scene.scene_of([wall(2.0, (1.0, 1.0, 1.0), -0.02, 0.02)], CAMERA, LENS)


@pytest.mark.parametrize(
    ("planes", "kept"),
    [
        pytest.param(({"far_plane": 6.0}, {"far_plane": 9.0}), np.s_[:3], id="62473"),
        pytest.param(({"far_limit": 0.25}, {"far_limit": 1.0}), np.s_[:3], id="62501"),
    ],
)
def test_godot_far_blur_leaves_near_blur_alone(planes, kept):
    depth, coc = np.array([[1.0, 2.0, 3.0, 4.0, 9.0]]), np.array([[-2.0, -1.0, 0.0, 1.0, 2.0]])
    first, second = (
        poisson.code_of(depth, coc, poisson.Params(**{"near_plane": 1.0, "focus_plane": 3.0, "far_plane": 9.0} | plane))
        for plane in planes
    )
    assert_allclose(first[0, kept], [0.0, 0.25, 0.5], atol=1e-15)
    assert_array_equal(first[0, kept], second[0, kept])
    assert (first[0, 3:] != second[0, 3:]).any()


@pytest.mark.parametrize("name", FILTERS)
def test_godot_26236_a_depth_that_was_never_written_is_refused(name):
    color, coc = np.ones((3, 4, 3)), np.zeros((3, 4))
    with pytest.raises(InputError, match="depth: "):
        filtered(name, color, np.zeros((3, 4)), coc)
    with pytest.raises(InputError, match="depth: "):
        filtered(name, color, np.ones((3, 5)), coc)


def test_sbox_6738_circles_at_far_focus_do_not_step():
    # Neighbouring float32 depths around focus distances of 2e3 to 1e6, against whole fractions.
    for focus in (2e3, 3e4, 1e6):
        depth = np.float32(focus) + np.arange(-40, 41).astype(np.float32) * np.spacing(np.float32(focus))
        coc = ThinLens(0.1, focus).coc_px(depth, Camera((0, 0, 0), (0, 0, -1), fov_y=90.0, size=(200, 200)))
        scale = Fraction(Camera((0, 0, 0), (0, 0, -1), fov_y=90.0, size=(200, 200)).pixels_per_tangent) * Fraction(0.1)
        exact = [float(scale * (1 / Fraction(focus) - 1 / Fraction(float(d)))) for d in depth]
        assert_allclose(coc, exact, rtol=2.0**-24 + 1e-14)  # float32, rounded once
        assert (np.diff(coc) > 0.0).all()


def test_unity_postprocessing_pr12_taps_lie_within_the_radius():
    # The lens disc is closed: no point lies outside, and points reach its rim as far as their number lets them.
    for pattern in ("vogel", "sobol", "halton", "jittered", "random", "poisson"):
        radius = np.hypot(*lens_samples(256, pattern, 3)[0].T)
        assert radius.max() <= 1.0 + 1e-12
        assert radius.max() > 0.95
    assert_allclose(np.hypot(*lens_samples(4, "vogel")[0].T) ** 2, [0.125, 0.375, 0.625, 0.875], rtol=1e-12)
