"""Bug threads about transparency and alpha: docs/threads.md, part 7."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Material, Part, ThinLens, View, render
from refdof.frame.files import load_frame
from tests import flat_scene
from tests.closed_forms import half_disc
from tests.frame import exr_files
from tests.threads.pictures import FILTERS, filtered, noise, wall
from tests.unlike import NONLINEAR

pytestmark = pytest.mark.fast
EACH = pytest.mark.parametrize("name", FILTERS)
WIDE = flat_scene.camera(24, 3, 100.0)
LENS = ThinLens(0.1, 4.0)  # 10 (1/4 - 1/d) px: -2.5 at 2, 1.25 at 8, 2.5 for the background
X = np.arange(24) + 0.5
RED, GREEN, BLUE = np.eye(3)
# A ray stops at a pane by chance: a share a of 64 rays of 3 rows scatters by sqrt(a (1 - a) / 192) = 0.036 at most.
CHANCE = 3 * 0.036


def pane(depth, color, opacity):
    """A wall of one opacity that fills the picture."""
    solid = wall(depth, color)
    return Part(solid.vertices, solid.faces, replace(solid.material, opacity=opacity))


def scene_of(*parts, background=(0.0, 0.0, 0.0)):
    return flat_scene.scene_of(parts, WIDE, LENS, background=background)


def traced(scene):
    """The traced picture, its three rows averaged: (24, 3)."""
    return render("accumulation", scene, WIDE, LENS, samples=64).image.mean(axis=0)


def view_of(scene):
    return View(scene, WIDE, LENS)


def masked(seed):
    """A premultiplied picture of one colour under a random mask, with depth and circles: (color, mask, depth, coc)."""
    random = np.random.default_rng(seed)
    mask = (random.random((9, 12)) < 0.6) * random.random((9, 12))
    depth = random.choice([1.0, 2.0, 4.0], (9, 12))
    return np.array([0.5, 0.25, 0.75]), mask, depth, 4.0 * (0.5 - 1.0 / depth)


@pytest.fixture(scope="module")
def veiled():
    """A pane of 1/4 before walls that meet at x = 12, traced: out of focus before walls in focus, and the reverse."""
    near = scene_of(pane(2.0, RED, 0.25), wall(4.0, GREEN, -9.0, 0.0), background=BLUE)
    far = scene_of(pane(4.0, RED, 0.25), wall(8.0, GREEN, -9.0, 0.0), wall(8.0, BLUE, 0.0))
    return traced(near), traced(far)


def test_filament_7663_a_transparent_pixel_carries_its_own_depth():
    scene = scene_of(pane(2.0, RED, 0.25), wall(4.0, GREEN))
    view = view_of(scene)
    assert_allclose(view.pinhole().depth, 2.0, rtol=1e-12)
    assert_allclose(view.layers().depth[:, 1, 5], [2.0, 4.0], rtol=1e-12)  # and the wall is a layer of its own
    assert_allclose(view.pinhole().color, np.broadcast_to([0.25, 0.75, 0.0], (3, 24, 3)), rtol=1e-6)


def test_unity_postprocessing_95_what_lies_behind_a_pane_keeps_its_own_blur(veiled):
    image = veiled[0]
    assert_allclose(image[:12, 2], 0.0, atol=1e-12)  # in focus: sharp, whatever the pane's circle
    assert_allclose(image[12:, 1], 0.0, atol=1e-12)


def test_unity_postprocessing_167_the_pane_has_its_share_everywhere(veiled):
    assert_allclose(veiled[0][:, 0], 0.25, atol=CHANCE)
    assert_allclose(veiled[0].mean(axis=0)[0], 0.25, atol=CHANCE / 4.0)  # 24 columns, a fifth of the scatter


def test_unity_postprocessing_168_two_panes_share_what_the_first_lets_pass():
    image = traced(scene_of(pane(2.0, RED, 0.5), pane(3.0, GREEN, 0.5), background=BLUE))
    assert_allclose(image.mean(axis=0), [0.5, 0.25, 0.25], atol=CHANCE / 4.0)
    assert_allclose(image.sum(axis=1), 1.0, rtol=1e-6)


def test_unity_postprocessing_839_full_opacity_is_opaque():
    behind = wall(4.0, GREEN)
    for name in ("accumulation", "multiview", "scatter"):
        few = {} if name == "scatter" else {"samples": 4}
        images = [
            render(name, scene_of(front, behind), WIDE, LENS, **few).image
            for front in (pane(2.0, RED, 1.0), wall(2.0, RED))
        ]
        assert_array_equal(images[0], images[1])


def test_unity_srp_654_circles_come_after_transparent_surfaces():
    assert_allclose(view_of(scene_of(pane(2.0, RED, 0.01), wall(8.0, GREEN))).coc_px(), -2.5, rtol=1e-6)
    assert_allclose(view_of(scene_of(pane(2.0, RED, 0.0), wall(8.0, GREEN))).coc_px(), 1.25, rtol=1e-6)  # a hole


@pytest.mark.parametrize(("depth", "circle"), [pytest.param(4.0, 0.0, id="28240"), pytest.param(2.0, -2.5, id="40948")])
def test_godot_one_picture_blurs_a_pane_with_all_behind_it(depth, circle):
    # What one picture can do: the pane in focus keeps a sharp background, out of focus both are blurred alike.
    scene = scene_of(pane(depth, RED, 0.25), wall(8.0, GREEN, -9.0, 0.0), background=BLUE)
    view = view_of(scene)
    assert_allclose(view.coc_px(), circle, atol=1e-12)
    image, sharp = render("singlepass", scene, WIDE, LENS, max_blur_size=4.0).image, view.pinhole().color
    if circle == 0.0:
        assert_allclose(image, sharp, rtol=1e-6)
    else:
        assert 0.1 < image[1, 12, 1] < 0.7
        assert_allclose(image[..., 0], 0.25, rtol=1e-5)


def test_pmndrs_postprocessing_601_the_background_inside_a_pane_is_blurred(veiled):
    # Walls at depth 8 meet at x = 12 under circles of 1.25 px, seen through a pane in focus.
    blue = 0.75 * half_disc((X - 12.0) / 1.25)
    assert_allclose(veiled[1][:, 2], blue, atol=CHANCE)
    assert 0.1 < veiled[1][12, 1] < 0.5


@EACH
def test_pmndrs_postprocessing_529_alpha_is_kept(name):
    # Alpha is filtered as one more channel, by the same weights.
    _, _, depth, coc = masked(529)
    alpha = np.full((9, 12, 3), 0.4)
    assert_allclose(filtered(name, alpha, depth, coc), 0.4, rtol=1e-12)


@pytest.mark.parametrize("name", [name for name in FILTERS if name != "filament"])  # bright colours weigh less there
def test_pmndrs_postprocessing_533_what_is_not_there_adds_no_black(name):
    color, mask, depth, coc = masked(533)
    image = filtered(name, mask[..., None] * color, depth, coc)
    alpha = filtered(name, np.repeat(mask[..., None], 3, axis=-1), depth, coc)
    assert_allclose(image, alpha * color, atol=1e-13)  # divided by alpha it is the colour itself


@EACH
def test_pmndrs_postprocessing_288_an_opaque_picture_stays_opaque(name):
    _, _, depth, coc = masked(288)
    assert_allclose(filtered(name, np.ones((9, 12, 3)), depth, coc), 1.0, rtol=1e-13)


@EACH
def test_pmndrs_postprocessing_481_a_full_mask_changes_nothing(name):
    _, _, depth, coc = masked(481)
    color = noise((9, 12), 481)
    assert_array_equal(filtered(name, color * np.ones((9, 12, 1)), depth, coc), filtered(name, color, depth, coc))


@EACH
def test_three_js_19223_a_picture_can_be_laid_over_another_later(name):
    # Filters are linear in colour: what is blurred over white is what is blurred over nothing, and white by the rest.
    color, mask, depth, coc = masked(19223)
    over_white = filtered(name, mask[..., None] * color + (1.0 - mask[..., None]), depth, coc)
    alone = filtered(name, mask[..., None] * color, depth, coc)
    alpha = filtered(name, np.repeat(mask[..., None], 3, axis=-1), depth, coc)
    later = alone + (1.0 - alpha)
    if name in NONLINEAR:
        assert np.abs(over_white - later).max() > 0.01
    else:
        assert_allclose(over_white, later, atol=1e-13)


@EACH
def test_molstar_1239_transparent_areas_are_not_darker(name):
    color, mask, depth, coc = masked(1239)
    shown = mask[..., None] * color + (1.0 - mask[..., None]) * [1.0, 1.0, 1.0]
    image = filtered(name, shown, depth, coc)
    assert (image >= shown.min(axis=(0, 1)) * (1.0 - 1e-12)).all()
    assert (image <= 1.0 + 1e-12).all()


@EACH
def test_unity_postprocessing_252_alpha_comes_out_as_it_went_in(name):
    _, mask, depth, _ = masked(252)
    alpha = np.repeat(mask[..., None], 3, axis=-1)
    assert_allclose(filtered(name, alpha, depth, np.zeros((9, 12))), alpha, rtol=1e-13)


def test_bevy_explorer_977_a_pixel_in_parts_has_the_depth_of_what_hides_half(tmp_path):
    # A veil of 1/4 at 1 before half of what is left at 2 and all at 5: half is hidden at 2.
    samples = [(0.25, 0.25, 0.25, 0.25, 1.0), (0.5, 0.5, 0.5, 0.5, 2.0), (1.0, 1.0, 1.0, 1.0, 5.0)]
    exr_files.write_deep(tmp_path / "deep.exr", [[samples, samples[1:]]], "RGBAZ")
    frame = load_frame(tmp_path / "deep.exr", fov_y=40.0, lens=LENS)
    assert_array_equal(frame.depth, [[2.0, 2.0]])
    assert_allclose(frame.color[0, :, 0], [0.25 + 0.75 * (0.5 + 0.5), 0.5 + 0.5], rtol=1e-6)


@pytest.mark.parametrize(
    ("depth", "opacity", "circle"),
    [pytest.param(2.0, 0.3, -2.5, id="551"), pytest.param(4.0, 0.1, 0.0, id="150")],
)
def test_talespire_fire_has_its_own_circle(depth, opacity, circle):
    # Before an empty background, whose circle is 2.5 px.
    assert_allclose(view_of(scene_of(pane(depth, RED, opacity))).coc_px(), circle, atol=1e-6)
    assert_allclose(view_of(scene_of()).coc_px(), 2.5, rtol=1e-12)


def test_webaverse_2064_depth_and_colour_have_the_same_holes():
    # Opacity 0, 0, 1, 1 along u, cut at 1/2: the card ends half-way between its texels, for colour and for depth.
    opacity = np.array([[0.0, 0.0, 1.0, 1.0]], dtype=np.float32)
    leaf = Material("unlit", base_color=(1.0, 0.0, 0.0), opacity_texture=opacity, cutoff=0.5, wrap="clamp")
    solid = wall(2.0, RED, -0.12, 0.12)
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    scene = scene_of(Part(solid.vertices, solid.faces, leaf, uv=uv), background=BLUE)
    view = view_of(scene)
    assert_array_equal(view.pinhole().depth[1] < 3.0, X > 12.0)
    assert_allclose(view.pinhole().color[1], np.where((X > 12.0)[:, None], RED, BLUE), atol=1e-6)
    assert_array_equal(view.layers().triangle[0, 1] >= 0, X > 12.0)
