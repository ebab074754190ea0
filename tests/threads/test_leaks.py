"""Bug threads about leaks, silhouettes and occlusion: docs/threads.md, part 6."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import ThinLens, View, render
from tests import flat_scene
from tests.closed_forms import half_disc
from tests.threads.pictures import CAMERA, FILTERS, LENS, wall

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)
WIDE = flat_scene.camera(24, 3, 100.0)
NEAR_LENS = ThinLens(0.1, 4.0)  # a card at depth 2 has circles of 10 (1/4 - 1/2) = -2.5 px
X = np.arange(24) + 0.5
# Share of the lens that a near card left of x = 12 hides from each column: all beyond 2.5 px to the left, none right.
HIDDEN = half_disc((12.0 - X) / 2.5)
RED, GREEN, BLUE = np.eye(3)


def card_over(behind, color=(0.0, 0.0, 0.0), background=(0.0, 0.0, 0.0)):
    """A card at depth 2 left of x = 12, over parts."""
    return flat_scene.scene_of([wall(2.0, color, -9.0, 0.0), *behind], WIDE, NEAR_LENS, background=background)


@pytest.fixture(scope="module")
def black_over_white():
    """A black card before a white wall in the focal plane, by the methods that see past edges: the middle row."""
    scene = card_over([wall(4.0, (1.0, 1.0, 1.0))])
    few = {"accumulation": {"samples": 64}, "multiview": {"samples": 64, "cones": "none"}, "lensblur": {"samples": 64}}
    return {name: render(name, scene, WIDE, NEAR_LENS, **p).image[1, :, 0] for name, p in few.items()}


# 64 lens points in an even pattern: along one axis their counts are off by at most 3 of 64.
POINTS = 3.0 / 64.0


def test_pbrt_v4_458_a_black_card_darkens_what_is_beside_it(black_over_white):
    assert_allclose(black_over_white["accumulation"], 1.0 - HIDDEN, atol=POINTS)
    assert_allclose(black_over_white["accumulation"][[9, 14]], 1.0 - HIDDEN[[9, 14]], atol=POINTS)
    assert black_over_white["accumulation"][12] == pytest.approx(1.0 - half_disc(-0.2), abs=POINTS)
    assert 0.3 < black_over_white["accumulation"][11] < 0.45  # averaged as 0, not left out


@pytest.mark.parametrize("name", ["multiview", "lensblur"])
def test_godot_88463_the_error_falls_with_quality(name):
    scene, errors = card_over([wall(4.0, (1.0, 1.0, 1.0))]), []
    more = {"cones": "none"} if name == "multiview" else {}
    for samples in (4, 16, 64):
        image = render(name, scene, WIDE, NEAR_LENS, samples=samples, **more).image[1, :, 0]
        errors.append(float(np.sqrt(np.mean((image - (1.0 - HIDDEN)) ** 2))))
    assert errors[2] < 0.6 * errors[0]  # lensblur's extended silhouettes stay
    assert errors[2] <= errors[1]


def test_pmndrs_postprocessing_176_the_edge_of_a_near_card_is_a_ramp(black_over_white):
    for name in ("multiview", "lensblur"):
        profile = 1.0 - black_over_white[name]
        assert (np.diff(profile) <= 1e-6).all()
        # lensblur extends silhouettes by up to a pixel, 0.3 of the ramp at its steepest, 2 / (pi 2.5) a pixel
        assert_allclose(profile, HIDDEN, atol=POINTS if name == "multiview" else POINTS + 2.0 / (math.pi * 2.5))


def test_unity_postprocessing_40_cutout_edges_show_a_blurred_background():
    # A card in focus left of x = 12; behind it red and green halves, which meet at x = 14 and are blurred by
    # 10 (1/4 - 1/8) = 1.25 px: beside the card's edge the green that only some of the lens sees.
    scene = flat_scene.scene_of(
        [wall(4.0, BLUE, -9.0, 0.0), wall(8.0, RED, -9.0, 0.02), wall(8.0, GREEN, 0.02)], WIDE, NEAR_LENS
    )
    image = render("accumulation", scene, WIDE, NEAR_LENS, samples=64).image[1]
    assert_allclose(image[:12], np.tile(BLUE, (12, 1)), atol=1e-6)
    assert_allclose(image[12:, 1], half_disc((X[12:] - 14.0) / 1.25), atol=POINTS)
    assert_allclose(image[12:, 0], 1.0 - half_disc((X[12:] - 14.0) / 1.25), atol=POINTS)


@pytest.mark.parametrize("name", ["multiview", "lensblur", "cascaded"])
def test_unity_postprocessing_53_edges_have_no_dark_seam(name):
    # Two bright cards and a bright background: no pixel is darker than the darkest of them.
    scene = card_over([wall(4.0, (0.9, 0.6, 0.7), -9.0, 0.05)], (0.6, 0.8, 0.7), (0.7, 0.7, 0.9))
    image = render(name, scene, WIDE, NEAR_LENS).image
    assert image.min() >= 0.6 * (1.0 - 1e-5)  # roundings of float32 sums
    assert image.max() <= 0.9 * (1.0 + 1e-5)


@pytest.mark.parametrize("edge", [0.0, 0.25, 0.5, 0.75])
def test_filament_3221_an_edge_in_focus_stays_sharp_wherever_it_lies(edge):
    # A card in focus before a blurred wall: its pixels and the wall's are as the pinhole has them, at each sub-pixel.
    scene = flat_scene.scene_of([wall(4.0, RED, -9.0, (edge - 0.1) / 100.0), wall(8.0, GREEN)], WIDE, NEAR_LENS)
    image = render("multiview", scene, WIDE, NEAR_LENS, samples=16).image[1]
    inside = 12.0 + edge - 0.1 > X
    assert_allclose(image[inside], np.tile(RED, (inside.sum(), 1)), atol=1e-6)
    assert image[~inside][1:, 0].max() < 1e-6


def three_depths(name, **params):
    """Red card at depth 2 left of x = 12, green wall in focus left of x = 18, blue background at infinity."""
    scene = card_over([wall(4.0, GREEN, -9.0, 0.06)], RED, BLUE)
    return render(name, scene, WIDE, NEAR_LENS, **params).image[1]


def test_filament_3729_what_a_near_card_hides_is_filled():
    # Over the card's blurred edge lies what is behind it there, the green wall, also where no pinhole ray meets it.
    image = three_depths("accumulation", samples=64)
    assert_allclose(image[8:15, 0], HIDDEN[8:15], atol=POINTS)
    assert_allclose(image[8:15, 1], 1.0 - HIDDEN[8:15], atol=POINTS)


@pytest.mark.parametrize("name", ["multiview", "lensblur"])
def test_filament_3918_no_halo_of_a_third_depth(name):
    image = three_depths(name, samples=32)
    assert_allclose(image[:15, 2], 0.0, atol=1e-6)  # no blue where the green wall lies behind the edge
    assert_allclose(image[:15].sum(axis=-1), 1.0, rtol=1e-5)


def test_unity_graphics_5050_depth_is_never_between_two_surfaces():
    scene = flat_scene.scene_of([_slanted(2.0), wall(6.0, (1.0, 1.0, 1.0))], CAMERA, LENS)
    depth = View(scene, CAMERA, LENS).pinhole().depth
    near = np.isclose(depth, 2.0, rtol=1e-12)
    assert 5 < near.sum() < 58
    assert_allclose(depth[~near], 6.0, rtol=1e-12)


def _slanted(depth):
    from refdof import Part

    corners = np.array([[-1.0, -1.0, -depth], [1.0, -1.0, -depth], [-1.0, 1.02, -depth]])
    return Part(corners, [[0, 1, 2]], flat_scene.paint((1.0, 0.0, 0.0)))


def test_unity_graphics_965_no_light_of_the_focal_plane_in_the_far_blur():
    # White in focus left of x = 12, a black far wall behind: right of the edge there is no white in the exact picture.
    scene = flat_scene.scene_of([wall(4.0, (1.0, 1.0, 1.0), -9.0, 0.0), wall(16.0, (0.0, 0.0, 0.0))], WIDE, NEAR_LENS)
    for name in ("accumulation", "multiview", "lensblur"):
        image = render(name, scene, WIDE, NEAR_LENS, samples=16).image[1, :, 0]
        assert_allclose(image, X < 12.0, atol=1e-6)
    image = render("singlepass", scene, WIDE, NEAR_LENS, max_blur_size=4.0).image[1, :, 0]
    assert_allclose(image[:11], 1.0, atol=1e-6)
    assert_array_equal(image[15:], np.zeros(9))  # circles of 1.9 px, and a texel of a bilinear tap


def test_unity_graphics_2353_near_blur_has_no_step(black_over_white):
    for profile in black_over_white.values():
        # The closed form's steepest step is 2 / (pi 2.5) = 0.25 a pixel; points add theirs on both sides.
        assert np.abs(np.diff(profile)).max() <= 2.0 / (math.pi * 2.5) + 2.0 * POINTS
        assert profile[8] < 0.05
        assert profile[15] > 0.95


def test_unity_graphics_3837_layers_agree_with_traced_rays(black_over_white):
    for name in ("multiview", "lensblur"):
        difference = black_over_white[name] - black_over_white["accumulation"]
        assert np.sqrt(np.mean(difference**2)) < 2.0 * POINTS


def test_beyond_all_reason_855_a_sharp_object_keeps_its_edge():
    scene = flat_scene.scene_of([wall(4.0, RED, -0.04, 0.04), wall(16.0, GREEN)], WIDE, NEAR_LENS)
    for name in ("multiview", "lensblur", "accumulation"):
        image = render(name, scene, WIDE, NEAR_LENS, samples=16).image[1]
        assert_allclose(image[8:16], np.tile(RED, (8, 1)), atol=1e-5)
        assert_allclose(image[[5, 18]], np.tile(GREEN, (2, 1)), atol=1e-5)
