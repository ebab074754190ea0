"""Lens blur on scenes: no slits, closed forms, the reference, and what the paper states of layers and footprints."""

import numpy as np
import pytest

import refdof
from refdof import Material, Part, ThinLens, View
from refdof.metrics import psnr
from refdof.raster.rays.umbra import survivors, worst_case_layers
from refdof.rendering import render_view
from tests import cards as polygons
from tests import flat_scene
from tests.closed_forms import circle_of_confusion, half_disc

BACKGROUND = (0.25, 0.5, 0.75)


def cards(*parts, width=24, height=16, radius=2.0, focus=2.0, background=BACKGROUND):
    """A view of cards; a card at depth d has 10 radius |1 / focus - 1 / d| px of blur."""
    shot = flat_scene.camera(width, height, 10.0)
    return View(flat_scene.scene_of(parts, shot, background=background), shot, ThinLens(radius, focus))


def wall(depth, color=(1.0, 1.0, 1.0), left=-99.0):
    return flat_scene.rectangle(left, 99.0, -99.0, 99.0, depth, color)


@pytest.mark.parametrize("depth", [1.5, 4.0])
def test_an_edge_before_the_background(depth):
    # 10 * 2 * |1/2 - 1/d| = 10/3 and 5 px. The edge lies on a border of texels, x = 20. Rays end up to 10 px aside.
    view = cards(wall(depth, left=0.0), background=(0, 0, 0), width=40, height=24)
    image = render_view("lensblur", view, samples=1024).image[12, 12:28, 0]
    size = abs(circle_of_confusion(10.0, 2.0, 2.0, depth))
    # 1024 points of a spiral know an edge's area to within 1024^-3/4 = 0.006 (one sigma).
    np.testing.assert_allclose(image, half_disc((np.arange(12, 28) + 0.5 - 20.0) / size), atol=0.02)


def test_any_power_of_two_scales_the_world():
    def pictured(s):
        parts = [
            flat_scene.rectangle(-99.0 * s, 99.0 * s, -99.0 * s, 99.0 * s, 3.0 * s, (0.2, 0.4, 0.6)),
            flat_scene.rectangle(0.02 * s, 99.0 * s, -99.0 * s, 99.0 * s, 1.0 * s),
        ]
        return render_view("lensblur", cards(*parts, radius=2.0 * s, focus=2.0 * s)).image

    np.testing.assert_array_equal(pictured(2.0**40), pictured(1.0))
    np.testing.assert_array_equal(pictured(2.0**-40), pictured(1.0))


@pytest.mark.parametrize("extent", [1, 2])
def test_peeling_stores_the_survivors_of_all_layers(extent):
    scene = refdof.load_scene("foliage")
    view = View(scene, scene.camera.with_size((64, 48)), scene.lens)
    every = view.layers()
    kept = survivors(every.depth, view.camera, view.lens, extent)
    peeled = view.umbra_layers(None, extent)
    assert len(every.depth) > 4 * len(peeled.depth)
    index = np.maximum(kept, 0)
    np.testing.assert_array_equal(
        peeled.depth, np.where(kept >= 0, np.take_along_axis(every.depth, index, axis=0), np.inf)
    )
    np.testing.assert_array_equal(
        peeled.triangle, np.where(kept >= 0, np.take_along_axis(every.triangle, index, axis=0), -1)
    )
    np.testing.assert_array_equal(view.surface_counts(extent), (kept >= 0).sum(axis=0))
    np.testing.assert_array_equal(view.umbra_layers(2, extent).color, peeled.color[:2])


@pytest.mark.parametrize(("far", "layers"), [(131.0, 10), (1000.0, 11)])
def test_the_papers_camera_needs_ten_layers_up_to_131_m(far, layers):
    # 30 degrees, 600 rows, 9 mm, from 1 m: walls just behind the umbra of each other, and many between them.
    shot, lens = refdof.Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=30.0, size=(1, 600)), ThinLens(0.009, 2.0)
    step = 2.0 * np.tan(np.radians(15.0)) / 600 / 0.009
    inverse = np.concatenate([1.0 - step * np.arange(11) * 1.0001, np.linspace(0.9999, 0.1, 100)])
    parts = [flat_scene.rectangle(-999, 999, -999, 999, 1.0 / s) for s in inverse if 1.0 / s < far]
    view = View(flat_scene.scene_of(parts, shot, lens), shot, lens)
    assert len(view.umbra_layers().depth) == layers == worst_case_layers(shot, lens, 1.0, far)


def room(seed, material=None):
    """A closed room with boxes in it, all of grey 0 .. 1; whoever sees the background, of 1000, slipped through."""
    random = np.random.default_rng([seed, 9])
    box = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)]
    parts = [
        Part(np.array(box) * [12.0, 9.0, 14.0] - [6.0, 4.5, 13.0], faces, material or flat_scene.paint((0.5, 0.5, 0.5)))
    ]
    for _ in range(12):
        size, place = random.uniform(0.1, 1.5, 3), random.uniform([-3.0, -2.5, -11.0], [2.0, 1.5, -3.0])
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        parts.append(
            Part((np.array(box) * size) @ turn + place, faces, material or flat_scene.paint(tuple(random.random(3))))
        )
    shot, lens = flat_scene.camera(64, 48, 50.0), ThinLens(0.2, 5.0)
    return View(flat_scene.scene_of(parts, shot, lens, (1000.0, 1000.0, 1000.0)), shot, lens)


@pytest.mark.parametrize("seed", range(12))
def test_no_ray_slips_through_a_closed_room(seed):
    view = room(seed)
    inner = np.s_[12:-12, 12:-12]  # rays end at most 50 * 0.2 / 5 = 2 px aside, and begin 50 * 0.2 / 2 = 5 px further
    for layers in (4, 0):
        result = render_view("lensblur", view, True, layers=layers)
        assert result.image.max() <= 1.0 + 1e-6
        assert result.stages["missed"][inner].max() == 0.0
    assert render_view("lensblur", view, peel="plain").image.max() > 1.0  # where no sample is extended


def test_a_quarter_of_the_rays_bounds_a_smaller_footprint():
    view = room(0)
    every, quarter = (render_view("lensblur", view, True, footprint=f) for f in ("rays", "quarter"))
    assert quarter.stages["steps"].mean() <= every.stages["steps"].mean()
    assert (quarter.stages["near"] <= every.stages["near"]).all()
    # The paper: "sufficiently accurate". Rays cut off too early are rare.
    assert psnr(every.image, quarter.image) > 50.0


def test_deferred_shading_of_matt_surfaces_changes_nothing():
    view = room(0, Material("lambert", base_color=(0.4, 0.6, 0.8)))
    early, late = (render_view("lensblur", view, deferred=d).image for d in (False, True))
    np.testing.assert_allclose(early, late, atol=1e-5)  # attributes are float32


def test_deferred_shading_sees_highlights_from_every_lens_point():
    ball = flat_scene.rectangle(-99, 99, -99, 99, 6.0)
    shiny = Material("phong", base_color=(0.1, 0.1, 0.1), specular=(1.0, 1.0, 1.0), shininess=30.0)
    shot, lens = flat_scene.camera(60, 40, 40.0), ThinLens(1.5, 5.0)
    scene = flat_scene.scene_of([Part(ball.vertices, ball.faces, shiny)], shot, lens)
    view, truth = View(scene, shot, lens), refdof.reference(scene, shot, lens, samples=256).image
    early, late = (render_view("lensblur", view, deferred=d).image[12:-12, 12:-12] for d in (False, True))
    error = [np.abs(image - truth[12:-12, 12:-12]).mean() for image in (early, late)]
    assert error[1] < 0.3 * error[0]


def test_all_layers_and_dense_pixels_converge_to_the_truth():
    errors = []
    for k in (1, 2, 4):
        squares = []
        for seed in range(6):
            scene = polygons.random_cards(seed, 12 * k, 9 * k, 12.0 * k)
            image = render_view("lensblur", View(scene.scene, *shot_of(scene.scene)), layers=0, samples=400).image
            inner = np.s_[3 * k : -3 * k, 3 * k : -3 * k]
            squares.append(((image - scene.truth)[inner] ** 2).mean())
        errors.append(np.sqrt(np.mean(squares)))
    assert errors[0] > errors[1] > errors[2]


def shot_of(scene):
    return scene.camera, scene.lens


def test_four_layers_of_foliage_come_near_to_all():
    scene = refdof.load_scene("foliage")
    view = View(scene, scene.camera.with_size((160, 120)), scene.lens)
    truth = refdof.reference(scene, view.camera, view.lens, samples=128).image
    four = psnr(truth, render_view("lensblur", view).image)
    every = psnr(truth, render_view("lensblur", view, peel="plain", layers=0).image)
    assert view.layers().depth.shape[0] > 60
    assert four > every - 1.0


@pytest.mark.parametrize("name", ["town", "foliage"])
def test_the_second_four_layers_cost_a_fraction(name):
    scene = refdof.load_scene(name)
    view = View(scene, scene.camera.with_size((160, 120)), scene.lens)
    four, eight = (render_view("lensblur", view, True, layers=k).stages["steps"].mean() for k in (4, 8))
    # The paper: 20 to 30 % of the tracing. Counted in texels walked, at most that.
    assert four <= eight < 1.3 * four


def test_thread_count_changes_no_bit():
    view = room(1)
    threads = refdof._jit.thread_count()
    try:
        refdof._jit.use_threads(1)
        one = render_view("lensblur", view, jitter="noise").image
    finally:
        refdof._jit.use_threads(threads)
    np.testing.assert_array_equal(render_view("lensblur", view, jitter="noise").image, one)
