"""Explanations of methods that draw the scene: rays and layers add up to the pixel, and rays go where they should."""

import numpy as np
import pytest

import refdof
from refdof import METHODS, ThinLens, View
from refdof.explain import explain_view
from tests import flat_scene
from tests.cards import random_cards

PIXELS = [(0, 0), (5, 4), (11, 8)]
CASES = {
    "accumulation": [{"samples": 16}, {"samples": 5, "shared_pattern": True}],
    "multiview": [
        {"samples": 9},
        {"samples": 9, "cones": "none"},
        {"samples": 9, "offscreen": "discard"},
        {"samples": 9, "offscreen": "discard", "cones": "none", "jitter": "noise"},
        {"samples": 9, "view_dependent": True},
    ],
    "lensblur": [
        {"samples": 9},
        {"samples": 9, "filter": "nearest", "misses": "black", "layers": 1},
        {"samples": 9, "misses": "pinhole", "layers": 1},
        {"samples": 9, "deferred": True},
    ],
    "cascaded": [{}, {"cascade": False}, {"normalize": False, "border": "transparent"}],
}
VIEWS = {seed: random_cards(seed).scene for seed in (1, 5)}


@pytest.mark.parametrize("seed", VIEWS)
@pytest.mark.parametrize(("method", "values"), [(name, values) for name in CASES for values in CASES[name]])
def test_the_table_adds_up_to_the_picture(method, values, seed):
    scene = VIEWS[seed]
    image = refdof.render(method, scene, **values).image
    for x, y in PIXELS:
        found = explain_view(method, View(scene, scene.camera, scene.lens), METHODS[method].Params(**values), (x, y))
        assert (found.value == image[y, x]).all()
        color = np.stack([found.column(name) for name in ("red", "green", "blue")])
        total = np.where(found.column("weight") > 0, found.column("weight") * color, 0.0).sum(axis=1)
        np.testing.assert_allclose(total, image[y, x], rtol=0, atol=1e-5)
        assert found.agrees


@pytest.mark.parametrize("method", METHODS)
def test_a_pinhole_shows_one_surface(method):
    scene = VIEWS[1]
    view = View(scene, scene.camera, ThinLens(0.0, 1.0))
    found = explain_view(method, view, METHODS[method].Params(), (5, 4))
    assert found.agrees
    assert found.value == pytest.approx(view.pinhole().color[4, 5], abs=2e-5)  # 398 sums in float32


def test_rays_meet_what_geometry_says():
    """A card over the left half at depth 1, focus at 2: a ray through lens point v of pixel x meets it where x does."""
    shot = flat_scene.camera(8, 6, 10.0)
    card = flat_scene.rectangle(-9.0, 0.0, -9.0, 9.0, 1.0, (1.0, 0.5, 0.25))
    scene = flat_scene.scene_of([card], shot, ThinLens(0.2, 2.0), (0.0, 0.0, 1.0))
    view = View(scene, scene.camera, scene.lens)
    found = explain_view("accumulation", view, METHODS["accumulation"].Params(samples=16), (4, 3))
    points = np.stack([found.column("lens_x"), found.column("lens_y")], axis=1)
    assert (np.hypot(*points.T) <= 1.0 + 1e-5).all()
    right, _ = flat_scene.tangents(8, 6, 10.0)
    # From the lens at 0.2 v to the focal point 2 t: half-way, at depth 1, at 0.1 v + t.
    meets = 0.1 * points[:, 0] + right[3, 4] < 0.0
    assert 0 < meets.sum() < len(meets)
    assert (np.isfinite(found.column("depth")) == meets).all()
    np.testing.assert_allclose(found.column("depth")[meets], 1.0, rtol=1e-6)
    np.testing.assert_allclose(found.column("coc")[meets], 10.0 * 0.2 * (1 / 2 - 1), rtol=1e-6)
    assert (found.column("blue") == np.where(meets, 0.25, 1.0)).all()
    assert (found.column("weight") == 1 / 16).all()


@pytest.mark.parametrize("method", ["multiview", "lensblur"])
def test_rays_of_layers_meet_what_geometry_says(method):
    """The same card: its circle is -1 px, and rays pass its plane at (x + 1/2 + v_x, y + 1/2 - v_y) px."""
    shot = flat_scene.camera(8, 6, 10.0)
    card = flat_scene.rectangle(-9.0, 0.0, -9.0, 9.0, 1.0, (1.0, 0.5, 0.25))
    scene = flat_scene.scene_of([card], shot, ThinLens(0.2, 2.0), (0.0, 0.0, 1.0))
    view = View(scene, scene.camera, scene.lens)
    values = {"cones": "none"} if method == "multiview" else {"filter": "nearest"}
    found = explain_view(method, view, METHODS[method].Params(samples=16, **values), (3, 3))
    points = np.stack([found.column("lens_x"), found.column("lens_y")], axis=1)
    counts = found.column("weight") > 0
    meets = 3.5 + points[:, 0] < 4.0
    assert (np.isfinite(found.column("depth"))[counts] == meets[counts]).all()
    np.testing.assert_allclose(found.column("coc")[counts & meets], -1.0, rtol=1e-5)
    assert found.value[2] == pytest.approx(np.where(meets, 0.25, 1.0)[counts].mean(), abs=1e-6)
    (layers,) = found.parts
    assert layers.rows[:, 1].sum() == pytest.approx(meets[counts].mean(), abs=1e-6)


def test_ways_of_the_cascade_are_all_of_the_weight():
    scene = VIEWS[1]
    found = explain_view("cascaded", View(scene, scene.camera, scene.lens), METHODS["cascaded"].Params(), (5, 4))
    ways = sum(found.column(name) for name in ("in_front", "in_focus", "in_back"))
    np.testing.assert_allclose(ways, found.column("weight"), atol=1e-6)
    assert all((found.column(name) > -1e-6).all() for name in ("in_front", "in_focus", "in_back"))


@pytest.mark.parametrize("stage", ["composite", "front", "back"])
def test_buffers_of_the_cascade_are_sums(stage):
    scene = VIEWS[1]
    params, recorded = METHODS["cascaded"].Params(), refdof.render("cascaded", scene, stages=True).stages
    found = explain_view("cascaded", View(scene, scene.camera, scene.lens), params, (5, 4), stage)
    assert (found.value == recorded[stage][4, 5, :3]).all()
    assert found.agrees
